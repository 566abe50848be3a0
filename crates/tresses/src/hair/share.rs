//! Many heads with the same groom: what never changes is on the GPU once.
//!
//! | shared | a head's own |
//! |---|---|
//! | where guides rest; bindings and rest curves of strands; tables of levels, measured once | where guides are; their samples |
//! | the fields of the collider atlas | poses of colliders |
//! | the grids in which hair meets hair, forces on guides and knots of shading, of which nothing is left for later | where obstacles are in them, density at rest |
//! | index lists; tables of fibres, while their fibres are alike | material, level of detail, drawn vertices |
//!
//! A head that shares has room for the strands that its level draws, not for all: drawn vertices, their colours and the
//! lists of tiles are most of a groom's memory. Before a frame needs more it moves into larger buffers, by half an octave
//! at a time; nothing is read back.

use super::{Hair, curves::Curves, effects::Effects, motion::Motion, sleep::Sleep};
use crate::{
    Result,
    avoid::StrandState,
    body::Skin,
    collide::Collider,
    roots::Roots,
    simulate::{Links, Shifting, Simulation, Ties},
    strands::{Room, Strand, StrandVertex},
    wind::Air,
};

impl Hair {
    /// Another head with the same groom, at rest, among `colliders` besides the head's field. It has a material, a level
    /// of detail and options of its own, which begin as they are here. What it draws is, to the bit, what hair would that
    /// was uploaded for it; skin that bends is [attached](Self::attach) anew.
    ///
    /// # Errors
    /// As [`with_colliders`](Self::with_colliders).
    pub fn another(&self, colliders: &[Collider]) -> Result<Self> {
        let guides = self.guides.another(&self.context)?;
        // Room is made in the first frame, when it is known for what.
        let mut strands = self.strands.another(&self.context, Room { strands: 1, vertices: 1 })?;
        strands.drawn.count = 0;
        let volume = self.volume.another(&self.context, &guides)?;
        let link = |links: &Links| links.another(&self.context, &guides);
        let links = self.effects.links.as_ref().map(link).transpose()?;
        let set = self.set.another(&strands);
        let avoidance = self.avoidance.another(&self.context, &guides, &strands)?;
        let lod = self.lod.another(&self.context, &strands);
        strands.drawn = self.lod.drawn();
        let colliders = self.colliders.another(colliders)?;
        let (extent, order, substeps) = (self.extent, self.order.clone(), self.substeps);
        let mut other = Self {
            context: self.context.clone(),
            effects: Effects::new(&self.context, &guides, &volume, links),
            simulation: Simulation::new(&self.context, &guides),
            curves: Curves::new(&self.context, &guides, &strands),
            motion: Motion::default(),
            sleep: Sleep::default(),
            air: None,
            roots: None,
            fits: true,
            guides,
            strands,
            set,
            avoidance,
            lod,
            colliders,
            volume,
            extent,
            order,
            substeps,
        };
        other.simulation.tie_as(&self.context, &other.guides, &self.simulation)?;
        Ok(other)
    }

    /// [`another`](Self::another) whose roots follow `skin`, another body of the mesh that these roots follow.
    pub(crate) fn another_on(&self, colliders: &[Collider], skin: Option<&Skin<'_>>) -> Result<Self> {
        let mut other = self.another(colliders)?;
        if let (Some(roots), Some(skin)) = (&self.roots, skin) {
            let buffers = (&mut other.guides, &mut other.strands);
            other.roots = Some(roots.instance(&self.context, buffers, skin)?);
            other.follow_roots()?;
        }
        Ok(other)
    }

    /// Makes room for what the level of detail draws, where hair has no more than that. Before anything of a frame is
    /// recorded that knows of strands.
    pub(crate) fn make_room(&mut self) -> Result<()> {
        let drawn = self.strands.drawn;
        if self.sleep.unseen {
            self.set.drawn.count = 0;
            return Ok(());
        }
        if !self.fits {
            if self.set.drawn.count == 0 {
                self.set.show(&drawn);
            }
            return Ok(());
        }
        let need = [drawn.count, drawn.count * drawn.vertex_count];
        let Some(room) = self.strands.room.another(need, self.strands.whole()) else {
            self.set.show(&drawn);
            return Ok(());
        };
        let roots = self.strands.roots.clone();
        self.strands = crate::strands::StrandBuffers { roots, ..self.strands.another(&self.context, room)? };
        self.lod.move_into(&self.context, &self.strands);
        self.avoidance.move_into(&self.context, &self.guides, &self.strands)?;
        self.curves = Curves::new(&self.context, &self.guides, &self.strands);
        self.effects.grab.forget_buffers();
        self.set.move_into(&self.strands);
        Ok(())
    }

    /// Whether it has room for what its level of detail draws alone.
    pub(crate) fn shares_room(&self) -> bool {
        self.fits
    }

    /// Bytes of GPU memory of this head alone.
    pub fn own_bytes(&self) -> u64 {
        self.bytes() - self.shared_bytes()
    }

    /// Bytes of those that go with its room: strands, their widening, what is remembered of them, their vertices.
    pub(crate) fn strand_bytes(&self, room: Room) -> u64 {
        (size_of::<Strand>() + 4 + size_of::<StrandState>()) as u64 * u64::from(room.strands)
            + size_of::<StrandVertex>() as u64 * u64::from(room.vertices)
    }

    /// Bytes of its GPU memory that all heads with this groom share: those of `n` heads take this once, and the rest of
    /// [`bytes`](Self::bytes) each.
    pub fn shared_bytes(&self) -> u64 {
        self.guides.shared_bytes()
            + self.strands.shared_bytes()
            + self.set.shared_bytes()
            + self.lod.shared_bytes()
            + self.colliders.shared_bytes()
            + self.volume.shared_bytes()
            + self.effects.links.as_ref().map_or(0, Links::shared_bytes)
            + self.simulation.ties().map_or(0, Ties::shared_bytes)
            + self.order.bytes()
    }

    /// Bytes of GPU memory, those that it [shares](Self::shared_bytes) included, without what each view has of it
    /// ([`View::shaded_bytes`](crate::view::View::shaded_bytes)).
    pub fn bytes(&self) -> u64 {
        self.guides.bytes()
            + self.strands.bytes()
            + self.set.bytes()
            + self.lod.bytes()
            + self.avoidance.bytes()
            + self.simulation.bytes()
            + self.colliders.bytes()
            + self.volume.bytes()
            + self.effects.forces.bytes()
            + self.effects.links.as_ref().map_or(0, Links::bytes)
            + self.effects.grab.bytes()
            + self.air.as_ref().map_or(0, Air::bytes)
            + self.motion.shifting.as_ref().map_or(0, Shifting::bytes)
            + self.roots.as_ref().map_or(0, Roots::bytes)
            + self.order.bytes()
    }
}
