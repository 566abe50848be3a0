//! Instances: heads with the same groom share the data that never changes.
//!
//! | shared | per head |
//! |---|---|
//! | rest state of guides; bindings and rest curves of strands; measured tables of levels | state of guides; their samples |
//! | the fields of the collider atlas | poses of colliders |
//! | scratch memory: self-collision grids, forces on guides, shading samples | obstacles in the grids, density at rest |
//! | index lists; fiber tables, while the fibers are the same | material, level of detail, drawn vertices |
//!
//! An instance allocates strand buffers only for the strands that its level of detail draws: drawn vertices, their
//! colors and the lists of tiles are most of a groom's memory. Before a frame that needs more, it moves into larger
//! buffers, half an octave at a time. The sizes follow from the level of detail, without a readback.

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
    /// Creates another head with the same groom, at rest, among `colliders` besides the head's field. Its material,
    /// level of detail and options are its own and start as copies of this one's. It draws bit-identically to hair
    /// uploaded separately. A deforming skin must be [attached](Self::attach) again.
    ///
    /// # Errors
    /// As [`with_colliders`](Self::with_colliders).
    pub fn another(&self, colliders: &[Collider]) -> Result<Self> {
        self.another_on(colliders, None)
    }

    /// [`another`](Self::another) with roots on `skin`, an instance of the mesh that this hair's roots follow.
    pub(crate) fn another_on(&self, colliders: &[Collider], skin: Option<&Skin<'_>>) -> Result<Self> {
        let mut guides = self.guides.another(&self.context)?;
        // The first frame allocates the buffers, when their size is known.
        let mut strands = self.strands.another(&self.context, Room { strands: 1, vertices: 1 })?;
        strands.drawn.count = 0;
        let roots = self.roots.as_ref().zip(skin);
        let instance =
            |(roots, skin): (&Roots, _)| roots.instance(&self.context, (&mut guides, &mut strands), skin);
        let roots = roots.map(instance).transpose()?;
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
            roots,
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

    /// Enlarges the strand buffers of an instance to what its level of detail draws. Must run before a frame records
    /// anything that reads strands.
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

    /// Whether the strand buffers hold only the strands that the level of detail draws.
    pub(crate) fn shares_room(&self) -> bool {
        self.fits
    }

    /// Returns the GPU memory of this head alone, bytes.
    pub fn own_bytes(&self) -> u64 {
        self.bytes() - self.shared_bytes()
    }

    /// Returns the GPU memory that depends on `room`, bytes: strands, their widening, their collision state and their
    /// vertices.
    pub(crate) fn strand_bytes(&self, room: Room) -> u64 {
        (size_of::<Strand>() + 4 + size_of::<StrandState>()) as u64 * u64::from(room.strands)
            + size_of::<StrandVertex>() as u64 * u64::from(room.vertices)
    }

    /// Returns the GPU memory that all heads with this groom share, bytes. `n` heads take it once, and the rest of
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

    /// Returns the GPU memory including the [shared](Self::shared_bytes) part, bytes. Excludes the buffers of each view
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
