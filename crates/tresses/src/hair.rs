//! Hair on the GPU. Lifetimes: pipelines live as long as the device ([`crate::Context`]), a groom as long as its
//! [`HairAsset`], the state of one head as long as its [`Hair`], render targets as long as their [`crate::view::View`],
//! and parameters for one frame ([`HairFrame`]).

use crate::{
    Camera, Pose, Result,
    avoid::{AvoidOptions, Avoidance, StrandState},
    body::Skin,
    collide::{Collider, ColliderSet},
    groom::TriMesh,
    light::HairSet,
    lod::{Detail, Lod, LodOptions},
    roots::{RootAsset, RootReport, Roots},
    simulate::{Links, RestOptions, Shifting, Simulation, SimulationParams},
    strands::{GuideBuffers, Strand, StrandBuffers, StrandCapacity, StrandVertex},
    volume::{Volume, VolumeOptions},
    wind::Air,
};

use effects::Effects;
use motion::Motion;
use sleep::{Sleep, is_sphere_in_view};
use std::sync::Arc;

mod asset;
mod curves;
mod effects;
mod frame;
mod hold;
mod motion;
mod neighbors;
mod pose;
mod record;
mod sleep;
mod state;

pub use asset::{HairAsset, HairDescriptor};
pub(crate) use curves::Curves;
pub use frame::HairFrame;
pub use state::GuideState;

/// Options of a [`HairAsset`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HairOptions {
    /// Physics under which the groom's pose is at rest. Each frame has its own ([`HairFrame::simulation`]).
    pub simulation: SimulationParams,
    /// Rest state of the guides; can be changed later ([`HairAsset::set_rest`]).
    pub rest: RestOptions,
    /// The grid for self-collision.
    pub volume: VolumeOptions,
    /// Strand collision that hair starts with; can be changed later ([`Hair::avoidance`]).
    pub avoid: AvoidOptions,
    /// Level of detail that hair starts with; can be changed later ([`Lod::options`]). The tables for
    /// [`LodOptions::strand_width`] and [`LodOptions::curve_error`] are measured at load, for the values given here.
    pub lod: LodOptions,
}

/// Hair on one head, with its state of motion.
///
/// It allocates strand buffers only for the strands that its level of detail draws: drawn vertices, their colors and
/// the lists of tiles are most of its memory. Before a frame that needs more, it moves into larger buffers, half an
/// octave at a time. The sizes follow from the level of detail, without a readback.
#[derive(Debug)]
pub struct Hair {
    pub(crate) asset: Arc<HairAsset>,
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
    pub(crate) volume: Volume,
    /// Air around the head; `None` until there is wind.
    pub(crate) air: Option<Air>,
    /// Forces on the guides besides their own physics.
    effects: Effects,
    pub(crate) simulation: Simulation,
    /// Clock, and the spaces in which the hair is simulated and drawn.
    pub(crate) motion: Motion,
    /// Stages from guides to strands.
    pub(crate) curves: Curves,
    /// Roots that follow a skinned mesh.
    pub roots: Option<Roots>,
    sleep: Sleep,
    /// Substeps requested by the last frame, before level of detail.
    substeps: u32,
}

impl Hair {
    /// Creates hair at rest, with the head at the origin. Its material, level of detail and options are its own.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold it, [`crate::Error::Parameter`] for invalid options, and
    /// the errors of `ColliderSet::replace`.
    pub fn new(asset: &Arc<HairAsset>) -> Result<Self> {
        Self::on(asset, &asset.colliders, None)
    }

    /// [`new`](Self::new) among `colliders`, with `roots` on a skin.
    pub(crate) fn on(
        asset: &Arc<HairAsset>,
        colliders: &[Collider],
        roots: Option<(&RootAsset, &Skin<'_>)>,
    ) -> Result<Self> {
        let (context, options) = (&asset.context, &asset.options);
        let mut guides = GuideBuffers::of(context, &asset.guides)?;
        context.queue.write_buffer(&guides.samples, 0, bytemuck::cast_slice(&asset.samples()));
        // The first frame allocates the buffers, when their size is known.
        let mut strands =
            StrandBuffers::of(context, &asset.strands, StrandCapacity { strands: 1, vertices: 1 })?;
        let buffers = (&mut guides, &mut strands);
        let roots = roots.map(|(roots, skin)| Roots::new(context, roots, buffers, skin)).transpose()?;
        let volume = Volume::new(context, &asset.volume, &guides)?;
        let lod = Lod::new(context, &asset.lod, &strands);
        strands.drawn.count = 0;
        let mut set = HairSet::of(context, &asset.set, &strands)?;
        set.area = asset.lod.area();
        strands.drawn = lod.drawn();
        let mut simulation = Simulation::new(context, &guides);
        simulation.tie(context, &guides, asset.ties.as_ref())?;
        Ok(Self {
            effects: Effects::new(context, &guides, &volume),
            simulation,
            curves: Curves::new(context, &guides, &strands),
            motion: Motion::default(),
            sleep: Sleep::default(),
            air: None,
            roots,
            set,
            avoidance: Avoidance::new(context, options.avoid, options.rest.clearance, &guides, &strands)?,
            lod,
            colliders: ColliderSet::of(&asset.fields, colliders)?,
            volume,
            guides,
            strands,
            substeps: options.simulation.substep_count,
            asset: asset.clone(),
        })
    }

    /// Returns what this hair shares with other hair of the same groom.
    pub fn asset(&self) -> &Arc<HairAsset> {
        &self.asset
    }

    /// Makes the roots follow a deforming skin from the next frame on. `mesh` is the skin at rest (groom space). `skin`
    /// holds its vertices in each frame, in a space whose pose is `Roots::pose`. [`HairFrame::head`](HairFrame::head)
    /// remains the pose of the rigid part. No root may be farther than `max_distance` meters from the mesh; the report
    /// contains the distances.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for a root that is too far away, or a skin that does not fit `mesh`;
    /// [`crate::Error::Limit`].
    pub fn attach(&mut self, mesh: &TriMesh, skin: &Skin<'_>, max_distance: f32) -> Result<RootReport> {
        for (buffer, words) in [skin.positions, skin.normals] {
            words.hold(buffer, mesh)?;
        }
        let roots = self.asset.bind_roots(mesh, max_distance)?;
        let buffers = (&mut self.guides, &mut self.strands);
        self.roots = Some(Roots::new(&self.asset.context, &roots, buffers, skin)?);
        self.bind_guides()?;
        Ok(roots.report)
    }

    /// Computes the rest shape again for all hair of the asset: [`HairAsset::set_rest`].
    ///
    /// # Errors
    /// As [`HairAsset::set_rest`].
    pub fn set_rest(&mut self, physics: &SimulationParams, options: &RestOptions) -> Result<()> {
        self.sleep.wake();
        self.asset.set_rest(physics, options)
    }

    /// Binds the guides' buffers to all stages again, after one of them has been replaced.
    fn bind_guides(&mut self) -> Result<()> {
        let (context, guides) = (&self.asset.context, &self.guides);
        self.volume.bind(guides);
        self.effects.bind(context, guides, &self.volume, self.air.as_ref());
        let ties = self.simulation.ties().map(|ties| ties.asset.clone());
        self.simulation = Simulation::new(context, guides);
        self.simulation.tie(context, guides, ties.as_ref())?;
        self.motion.shifting = None;
        self.curves = Curves::new(context, guides, &self.strands);
        Ok(())
    }

    /// Whether the hair is drawn as cards.
    pub fn is_cards(&self) -> bool {
        self.set.cards().is_some()
    }

    /// Makes the next frame carry the hair rigidly with the head, whatever the distance.
    pub fn teleport(&mut self) {
        self.sleep.wake();
        self.motion.clock.teleport();
    }

    /// Puts the hair into its rest pose at the next frame, at the head's pose then.
    pub fn reset(&mut self) {
        self.sleep.wake();
        self.motion.clock.reset();
    }

    /// Replaces the obstacles besides the head's field from the next frame on, for example when a ball appears, changes
    /// or disappears. Frames give their poses. See `ColliderSet::replace`.
    ///
    /// # Errors
    /// As `ColliderSet::replace`.
    pub fn set_colliders(&mut self, colliders: &[Collider]) -> Result<()> {
        self.colliders.replace(colliders)
    }

    /// Returns the transform from simulation space to the space in which the hair is drawn, as of the last frame.
    /// Simulation space has its origin near the hair and moves with it. Callers that read the state
    /// of guides or of a grab need it.
    pub fn simulation_transform(&self) -> Pose {
        self.motion.to_drawn
    }

    /// Chooses the level of detail for the next frames from what `camera` sees on a head at `head`, by
    /// [`Lod::options`](crate::lod::Lod::options). Camera and head are in the space in which the hair is drawn. Call it
    /// before a frame is recorded; otherwise hair is drawn at full detail.
    pub fn look_from(&mut self, camera: &Camera, head: &Pose) {
        self.look_at(camera, head, self.lod.detail_for_camera(camera, head));
    }

    /// [`look_from`](Self::look_from) with a given level of detail.
    pub(crate) fn look_at(&mut self, camera: &Camera, head: &Pose, detail: Detail) {
        self.set_detail(detail);
        self.sleep.out_of_view = self.lod.options.can_sleep && !self.is_in_view(camera, head);
    }

    /// Whether any hair is in view of `camera` on a head at `head`.
    pub(crate) fn is_in_view(&self, camera: &Camera, head: &Pose) -> bool {
        let (center, radius) = self.lod.sphere();
        is_sphere_in_view(camera, (head.point(center), radius))
    }

    /// Excludes the hair from frames until [`look_from`](Self::look_from) is called again.
    pub(crate) fn hide(&mut self) {
        self.sleep.out_of_view = true;
    }

    /// Whether the hair was in view at the last call of [`look_from`](Self::look_from). Hair that is out of view and
    /// may [sleep](crate::lod::LodOptions::can_sleep) is neither simulated nor drawn.
    pub fn is_visible(&self) -> bool {
        !self.sleep.out_of_view
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
        self.sleep.out_of_view = false;
        self.lod.set(&mut self.strands, detail);
    }

    /// Resizes the strand buffers to what the level of detail draws. Must run before a frame records anything that
    /// reads strands.
    pub(crate) fn resize_buffers(&mut self) -> Result<()> {
        let (context, drawn) = (&self.asset.context, self.strands.drawn);
        if self.sleep.out_of_view {
            self.set.drawn.count = 0;
            return Ok(());
        }
        let need = [drawn.count, drawn.count * drawn.vertex_count];
        let Some(capacity) = self.strands.capacity.resized(need, self.asset.strands.full_capacity()) else {
            self.set.show(&drawn);
            return Ok(());
        };
        let roots = self.strands.roots.clone();
        self.strands =
            StrandBuffers { roots, drawn, ..StrandBuffers::of(context, &self.asset.strands, capacity)? };
        self.lod.resize(context, &self.strands);
        self.avoidance.resize(context, &self.guides, &self.strands)?;
        self.curves = Curves::new(context, &self.guides, &self.strands);
        self.effects.grab.forget_buffers();
        self.set.resize(&self.strands);
        Ok(())
    }

    /// Returns the capacity of the strand buffers for `strands` strands with `vertices` vertices in total, and the GPU
    /// memory of this head with it, bytes.
    pub(crate) fn sized_for(&self, need: [u32; 2]) -> (StrandCapacity, u64) {
        // Strands, their widening, their collision state and their vertices.
        let bytes = |capacity: StrandCapacity| {
            (size_of::<Strand>() + 4 + size_of::<StrandState>()) as u64 * u64::from(capacity.strands)
                + size_of::<StrandVertex>() as u64 * u64::from(capacity.vertices)
        };
        let capacity = StrandCapacity::of(need, self.asset.strands.full_capacity());
        (capacity, self.own_bytes() - bytes(self.strands.capacity) + bytes(capacity))
    }

    /// Returns the GPU memory that all hair of the asset shares, bytes.
    pub fn shared_bytes(&self) -> u64 {
        self.asset.bytes()
            + self.set.fiber_bytes(true)
            + self.roots.as_ref().map_or(0, |roots| roots.asset.bytes())
    }

    /// Returns the GPU memory of this head alone, bytes. Excludes the buffers of each view
    /// ([`View::shaded_bytes`](crate::view::View::shaded_bytes)).
    pub fn own_bytes(&self) -> u64 {
        self.guides.own_bytes()
            + self.strands.own_bytes()
            + self.set.fiber_bytes(false)
            + self.lod.own_bytes()
            + self.avoidance.bytes()
            + self.simulation.own_bytes()
            + self.colliders.own_bytes()
            + self.volume.own_bytes()
            + self.effects.forces.bytes()
            + self.effects.links.as_ref().map_or(0, Links::own_bytes)
            + self.effects.grab.bytes()
            + self.air.as_ref().map_or(0, Air::bytes)
            + self.motion.shifting.as_ref().map_or(0, Shifting::bytes)
            + self.roots.as_ref().map_or(0, Roots::own_bytes)
    }

    /// Returns the GPU memory including the [shared](Self::shared_bytes) part, bytes.
    pub fn bytes(&self) -> u64 {
        self.own_bytes() + self.shared_bytes()
    }
}
