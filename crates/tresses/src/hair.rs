//! One groom on the GPU. Lifetimes: pipelines live as long as the device ([`Context`]), a groom's buffers as long as
//! its [`Hair`], render targets as long as their [`crate::view::View`], and parameters for one frame ([`HairFrame`]).

use crate::{
    Camera, Context, Error, Pose, Progress, Result,
    avoid::{self, AvoidOptions, Avoidance},
    body::Skin,
    collide::{Collider, ColliderDescriptor, ColliderSet},
    groom::{BoundStrands, Groom, SdfGrid, TriMesh, cards::CardSheet},
    light::{HairSet, cards::CardBuffers, hair::knot_bytes},
    lod::{self, Detail, GuideOrder, Lod, LodLevel, LodOptions},
    math::hash::pcg,
    progress::at_once,
    roots::{RootReport, Roots},
    simulate::{GuideTraits, Links, RestOptions, RestShape, Simulation, SimulationParams, rest},
    strands::{GuideBuffers, GuideSample, Strand, StrandBinding, StrandBuffers, buffers::storage},
    tessellate::rest_samples,
    volume::{Volume, VolumeOptions},
    wind::Air,
};

use effects::Effects;
use glam::Vec3;
use motion::Motion;
use sleep::{Sleep, sees};
use std::sync::Arc;

mod curves;
mod effects;
mod frame;
mod hold;
mod meet;
mod motion;
mod pose;
mod record;
mod share;
mod sleep;
mod state;

pub(crate) use curves::Curves;
pub use frame::HairFrame;
pub use state::GuideState;

/// Options for uploading a groom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairOptions {
    /// Physics for which the rest shape is computed.
    pub simulation: SimulationParams,
    /// Whether the groom's pose already includes gravity.
    pub rest: RestShape,
    /// Distance that guides and strands keep from the head, meters, where they have it at rest.
    pub clearance: f32,
    /// The grid for self-collision.
    pub volume: VolumeOptions,
    /// Strand collision; can be changed later ([`Hair::avoidance`]).
    pub avoid: AvoidOptions,
    /// Level of detail; can be changed later ([`Lod::options`]). The tables for [`LodOptions::strand_width`] and
    /// [`LodOptions::curve_error`] are measured at load, for the values given here.
    pub lod: LodOptions,
}

impl Default for HairOptions {
    fn default() -> Self {
        Self {
            simulation: SimulationParams::default(),
            rest: RestShape::SagFree,
            clearance: 1.5e-3,
            volume: VolumeOptions::default(),
            avoid: AvoidOptions::default(),
            lod: LodOptions::default(),
        }
    }
}

/// One groom on the GPU with its state of motion.
#[derive(Debug)]
pub struct Hair {
    pub(crate) context: Context,
    /// State of the simulated guides.
    pub guides: GuideBuffers,
    /// Buffers of the drawn strands.
    pub strands: StrandBuffers,
    /// Material, and the data that shading and drawing read.
    pub set: HairSet,
    /// Strand collision: options, and state that is kept between frames.
    pub avoidance: Avoidance,
    /// Level of detail.
    pub lod: Lod,
    /// Colliders.
    pub colliders: ColliderSet,
    /// Grid of hair density and velocity around the head.
    pub volume: Volume,
    /// Air around the head; `None` until there is wind.
    pub air: Option<Air>,
    /// Forces on the guides besides their own physics.
    effects: Effects,
    pub(crate) simulation: Simulation,
    /// Clock, and the spaces in which the hair is simulated and drawn.
    pub(crate) motion: Motion,
    /// Stages from guides to strands.
    pub(crate) curves: Curves,
    /// Bounding box of the hair at rest: center (groom space) and longest side, meters.
    extent: (Vec3, f32),
    /// Roots that follow a skinned mesh.
    pub roots: Option<Roots>,
    /// Whether the strand buffers hold only the strands that the level of detail draws.
    fits: bool,
    /// Order in which levels of detail drop guides.
    order: Arc<GuideOrder>,
    sleep: Sleep,
    /// Substeps requested by the last frame, before level of detail.
    substeps: u32,
}

impl Hair {
    /// Uploads `groom`, at rest with the head at the origin. The only collider is the head's distance field `head`
    /// (groom space).
    ///
    /// # Errors
    /// As [`with_colliders`](Self::with_colliders).
    pub fn new(
        context: &Context,
        groom: &Groom,
        options: &HairOptions,
        head: Option<&SdfGrid>,
    ) -> Result<Self> {
        let colliders = ColliderDescriptor { head, ..Default::default() };
        Self::with_colliders(context, groom, options, &colliders)
    }

    /// Uploads `groom`, at rest with the head at the origin, among `colliders`. Strands are reordered by
    /// [`lod::arrange`].
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it, [`Error::Groom`] and [`Error::Parameter`] when the groom or
    /// the options are invalid, and the errors of [`ColliderSet::new`].
    pub fn with_colliders(
        context: &Context,
        groom: &Groom,
        options: &HairOptions,
        colliders: &ColliderDescriptor<'_>,
    ) -> Result<Self> {
        at_once(Self::with_progress(context, groom, options, colliders, &()))
    }

    /// [`with_colliders`](Self::with_colliders) that reports to `progress`.
    ///
    /// # Errors
    /// As [`with_colliders`](Self::with_colliders).
    pub async fn with_progress(
        context: &Context,
        groom: &Groom,
        options: &HairOptions,
        colliders: &ColliderDescriptor<'_>,
        progress: &impl Progress,
    ) -> Result<Self> {
        let Context { queue, .. } = context;
        let resting = colliders.rest.or(colliders.head);
        progress.step("preparing the strands", 0.0).await;
        if groom.guides.is_empty() || groom.strands.is_empty() {
            return Err(Error::unusable("the groom has no strands"));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        let vertex_count = groom.guides.vertex_count;
        // Strands that are their own guides need no samples.
        let single = |binding: &StrandBinding| binding.weight_b == 0.0 && binding.weight_c == 0.0;
        let follows = groom.guides.len() >= groom.strands.len() && groom.strands.bindings.iter().all(single);
        let sample_count = if follows { 0 } else { vertex_count.max(groom.strands.vertex_count) };
        let mut guides = GuideBuffers::new(context, count(groom.guides.len())?, vertex_count, sample_count)?;
        if options.simulation.twist > 0.0 {
            guides = guides.with_twist(context)?;
        }
        let strands = StrandBuffers::new(context, count(groom.strands.len())?, groom.strands.vertex_count)?;

        let scratch = scratch(context, &guides, &strands, &options.volume)?;
        guides.forces = scratch.clone();

        let traits: Vec<_> = (0..groom.guides.len())
            .map(|i| GuideTraits {
                stiffness: groom.guides.stiffness[i],
                strands: groom.guides.strands[i],
                tip_pinned: groom.guides.tip_pinned[i],
            })
            .collect();
        let rest = rest::guides(
            &groom.guides.positions,
            vertex_count,
            &traits,
            &options.simulation,
            &RestOptions { shape: options.rest, clearance: options.clearance },
            resting,
        )?;
        rest.upload(context, &guides)?;
        let hair_hair = &options.simulation.hair_hair;
        let links =
            (hair_hair.cohesion > 0.0).then(|| Links::new(context, &guides, &rest, hair_hair)).transpose()?;
        if !follows {
            let samples: Vec<_> = (0..groom.guides.len())
                .flat_map(|i| rest_samples(groom.guides.guide(i), sample_count))
                .map(GuideSample::at_rest)
                .collect();
            queue.write_buffer(&guides.samples, 0, bytemuck::cast_slice(&samples));
        }
        let infos = with_locks(&arranged);
        queue.write_buffer(&strands.strands, 0, bytemuck::cast_slice(&infos));
        queue.write_buffer(&strands.bindings, 0, bytemuck::cast_slice(&arranged.bindings));
        match resting {
            Some(field) => {
                let rest = avoid::sunk(&arranged, field, options.clearance);
                queue.write_buffer(&strands.rest, 0, bytemuck::cast_slice(&rest));
            }
            None => queue.write_buffer(&strands.rest, 0, bytemuck::cast_slice(&arranged.rest)),
        }

        let colliders = ColliderSet::new(context, colliders)?;
        let volume = Volume::within(context, &guides, &rest, &options.volume, scratch.clone())?;
        let order = Arc::new(lod::guide_order(groom, rest.info, &arranged));
        let lod = Lod::new(context, arranged, &infos, &strands, &options.lod, progress).await?;
        let mut set = HairSet::new(context, &strands)?.within(&scratch);
        set.area = lod.area();
        let (avoid, clearance) = (options.avoid, options.clearance);
        let avoidance = Avoidance::new(context, avoid, clearance, &guides, &strands)?;
        let (extent, substeps) = (extent(groom), options.simulation.substeps);
        Ok(Self {
            context: context.clone(),
            effects: Effects::new(context, &guides, &volume, links),
            simulation: Simulation::new(context, &guides),
            curves: Curves::new(context, &guides, &strands),
            motion: Motion::default(),
            sleep: Sleep::default(),
            air: None,
            roots: None,
            fits: false,
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
        })
    }

    /// Makes the roots follow a deforming skin from the next frame on. `mesh` is the skin at rest (groom space). `skin`
    /// holds its vertices in each frame, in a space whose pose is [`Roots::pose`]. [`HairFrame::head`](HairFrame::head)
    /// remains the pose of the rigid part. `groom` is the one that the hair was made from. No root may be farther than
    /// `reach` meters from the mesh; the report contains the distances.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for another groom, a root that is too far away, or a skin that does not fit
    /// `mesh`; [`Error::Limit`].
    pub fn attach(
        &mut self,
        groom: &Groom,
        mesh: &TriMesh,
        skin: &Skin<'_>,
        reach: f32,
    ) -> Result<RootReport> {
        if groom.strands.len() != self.strands.count as usize
            || groom.guides.len() != self.guides.count as usize
        {
            return Err(Error::unusable(
                "roots can only be attached for the groom that the hair was created from",
            ));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        let buffers = (&mut self.guides, &mut self.strands);
        let (roots, report) = Roots::new(&self.context, (groom, &arranged), buffers, mesh, skin, reach)?;
        self.roots = Some(roots);
        // Rebuild the stages that read the roots' buffers.
        let untied = Simulation::new(&self.context, &self.guides);
        let before = std::mem::replace(&mut self.simulation, untied);
        self.simulation.tie_as(&self.context, &self.guides, &before)?;
        self.curves = Curves::new(&self.context, &self.guides, &self.strands);
        Ok(report)
    }

    /// Draws the hair as cards. The groom of the hair has the columns of the cards as strands
    /// ([`Cards::strands`](crate::groom::cards::Cards::strands)); `strands` are its strands. All cards are then drawn at
    /// any distance.
    ///
    /// # Errors
    /// [`Error::Groom`] for another groom, [`Error::Limit`].
    pub fn set_cards(&mut self, strands: &BoundStrands, sheet: &CardSheet) -> Result<()> {
        if strands.len() != self.strands.count as usize {
            return Err(Error::unusable("cards can only be set on the groom that the hair was created from"));
        }
        let strips = sheet.strips_in(&lod::order(strands))?;
        let cards = CardBuffers::new(&self.context, &strips, sheet)?;
        self.set.cards = Some(Arc::new(cards));
        self.lod.columns = Some(strands.len() as f32 / sheet.strands.max(1) as f32);
        self.set.drawn = self.lod.drawn();
        Ok(())
    }

    /// Whether the hair is drawn as cards.
    pub fn is_cards(&self) -> bool {
        self.set.cards.is_some()
    }

    /// Makes the next frame carry the hair rigidly with the head, whatever the distance.
    pub fn teleport(&mut self) {
        self.sleep.wake();
        self.motion.teleports = true;
    }

    /// Puts the hair into its rest pose at the next frame, at the head's pose then.
    pub fn reset(&mut self) {
        self.sleep.wake();
        self.motion.clock.reset();
    }

    /// Replaces the obstacles besides the head's field from the next frame on, for example when a ball appears, changes
    /// or disappears. Frames give their poses. See [`ColliderSet::replace`].
    ///
    /// # Errors
    /// As [`ColliderSet::replace`].
    pub fn set_colliders(&mut self, colliders: &[Collider]) -> Result<()> {
        self.colliders.replace(colliders)
    }

    /// Returns the transform from simulation space to the space in which the hair is drawn, as of the last frame.
    /// Simulation space has its origin near the hair and moves with it ([`crate::space`]). Callers that read the state
    /// of guides or of a grab need it.
    pub fn place(&self) -> Pose {
        self.motion.to_drawn
    }

    /// Chooses the level of detail for the next frames from what `camera` sees on a head at `head`, by
    /// [`Lod::options`](crate::lod::Lod::options). Camera and head are in the space in which the hair is drawn. Call it
    /// before a frame is recorded; otherwise hair is drawn at full detail.
    pub fn look_from(&mut self, camera: &Camera, head: &Pose) {
        self.look_at(camera, head, self.lod.seen(camera, head));
    }

    /// [`look_from`](Self::look_from) with a given level of detail.
    pub(crate) fn look_at(&mut self, camera: &Camera, head: &Pose, detail: Detail) {
        self.set_detail(detail);
        self.sleep.unseen = self.lod.options.sleep && !self.sees(camera, head);
    }

    /// Whether any hair is in view of `camera` on a head at `head`.
    pub(crate) fn sees(&self, camera: &Camera, head: &Pose) -> bool {
        let (middle, radius) = self.lod.sphere;
        sees(camera, (head.point(middle), radius))
    }

    /// Excludes the hair from frames until [`look_from`](Self::look_from) is called again.
    pub(crate) fn hide(&mut self) {
        self.sleep.unseen = true;
    }

    /// Whether the hair was in view at the last call of [`look_from`](Self::look_from). Hair that is out of view and
    /// may [sleep](crate::lod::LodOptions::sleep) is neither simulated nor drawn.
    pub fn is_seen(&self) -> bool {
        !self.sleep.unseen
    }

    /// Whether the hair has come to rest and is not simulated.
    pub fn is_asleep(&self) -> bool {
        self.sleep.asleep
    }

    /// Returns the number of simulated guides: all, unless a [level of detail](crate::lod::LodOptions::guides) drops
    /// some.
    pub fn simulated_guides(&self) -> u32 {
        self.simulation.simulated()
    }

    /// Sets the level of detail of the next frames, as returned by [`Lod::detail`](crate::lod::Lod::detail).
    pub fn set_detail(&mut self, detail: Detail) {
        self.sleep.unseen = false;
        self.lod.set(&self.context, &mut self.strands, detail);
        if !self.fits {
            self.set.show(&self.strands.drawn);
        }
    }

    /// Sets painted levels of detail: at most [`lod::MAX_LEVELS`] with descending sizes; an empty slice removes them.
    /// `groom` is the one that the hair was made from. `skull` is the center of its braincase (groom space, meters;
    /// [`SKULL_CENTER`](crate::groom::mannequin::SKULL_CENTER) for the built-in head). The levels take effect at the
    /// next [`look_from`](Self::look_from).
    ///
    /// # Errors
    /// [`Error::Parameter`] for invalid levels, [`Error::Groom`] for another groom.
    pub fn paint_levels(&mut self, groom: &Groom, levels: &[LodLevel], skull: Vec3) -> Result<()> {
        if groom.strands.len() != self.strands.count as usize {
            return Err(Error::unusable(
                "levels of detail can only be painted on the groom that the hair was created from",
            ));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        self.lod.paint(&self.context, &arranged, levels, skull)
    }
}

/// Creates the scratch buffer of a groom. A step uses it for the cells of the density grid, then for the forces on
/// guides; drawing uses it for shading samples. None of these is read after another has been written, in any order of
/// heads and views.
fn scratch(
    context: &Context,
    guides: &GuideBuffers,
    strands: &StrandBuffers,
    volume: &VolumeOptions,
) -> Result<wgpu::Buffer> {
    let Context { device, .. } = context;
    let knots = knot_bytes([strands.count, strands.vertex_count]);
    storage::<u8>(device, "scratch of a groom", knots.max(volume.cell_bytes()?).max(guides.forces.size()))
}

/// Returns the bounding box of the guides at rest: center and longest side, meters.
fn extent(groom: &Groom) -> (Vec3, f32) {
    let (lo, hi) = groom
        .guides
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    (0.5 * (lo + hi), (hi - lo).max_element().max(0.05))
}

/// Converts a number of strands or guides to the GPU's 32 bits.
fn count(n: usize) -> Result<u32> {
    u32::try_from(n).map_err(|_| Error::unusable(format!("{n} strands are more than 32 bits can count")))
}

/// Returns the strands with seeds whose upper half is shared by all strands of the same first guide.
fn with_locks(strands: &BoundStrands) -> Vec<Strand> {
    let strands = strands.strands.iter().zip(&strands.bindings);
    strands
        .map(|(strand, binding)| Strand {
            seed: (pcg(binding.guides[0]) & 0xffff_0000) | (strand.seed & 0xffff),
            ..*strand
        })
        .collect()
}
