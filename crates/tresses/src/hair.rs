//! One groom on the GPU. Pipelines live as long as the device ([`Context`]), a groom's buffers as long as it is
//! there ([`Hair`]), those of a picture as long as somebody looks ([`crate::view::View`]), parameters for a frame
//! ([`HairFrame`]).

use crate::{
    Camera, Context, Error, Pose, Progress, Result,
    avoid::{self, AvoidOptions, Avoidance},
    body::Skin,
    collide::{Collider, ColliderDescriptor, ColliderSet},
    groom::{BoundStrands, Groom, SdfGrid, TriMesh},
    light::{HairSet, hair::knot_bytes},
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
mod record;
mod share;
mod sleep;

pub(crate) use curves::Curves;
pub use frame::HairFrame;

/// How a groom is brought to the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairOptions {
    /// The physics for which the rest shape is computed.
    pub simulation: SimulationParams,
    /// Whether the groom's pose is the shape under gravity or without it.
    pub rest: RestShape,
    /// Distance that guides and strands keep from the head, metres, where they have it at rest.
    pub clearance: f32,
    /// The grid in which hair meets hair.
    pub volume: VolumeOptions,
    /// How drawn strands avoid obstacles; can be changed later ([`Hair::avoidance`]).
    pub avoid: AvoidOptions,
    /// How levels of detail are chosen; can be changed later ([`Lod::options`]). What strands cost that are as wide, and
    /// that stray as far, is measured at load.
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

/// One groom on the GPU, and its state of motion.
#[derive(Debug)]
pub struct Hair {
    pub(crate) context: Context,
    /// What is simulated.
    pub guides: GuideBuffers,
    /// What is drawn.
    pub strands: StrandBuffers,
    /// What it looks like, and what light and draw need of it.
    pub set: HairSet,
    /// How drawn strands avoid obstacles, and what is remembered of it from frame to frame.
    pub avoidance: Avoidance,
    /// How much of it is drawn.
    pub lod: Lod,
    /// What it collides with.
    pub colliders: ColliderSet,
    /// Density and velocity of the hair around the head.
    pub volume: Volume,
    /// The air around the head, once the wind has blown.
    pub air: Option<Air>,
    /// What acts on the guides besides their own physics.
    effects: Effects,
    pub(crate) simulation: Simulation,
    /// Its clock, and the frames that it is simulated and drawn in.
    pub(crate) motion: Motion,
    /// From guides to strands.
    pub(crate) curves: Curves,
    /// The box around the hair at rest: its middle (groom space) and its longest side, metres.
    extent: (Vec3, f32),
    /// The skin that it grows on, where that bends.
    pub roots: Option<Roots>,
    /// Whether it has room for no more strands than its level of detail draws.
    fits: bool,
    /// In which order guides are left out.
    order: Arc<GuideOrder>,
    sleep: Sleep,
    /// Substeps that the last frame asked for, in full detail.
    substeps: u32,
}

impl Hair {
    /// Brings `groom` to the GPU, at rest, the head at the origin. It collides with the head's
    /// distance field `head` (groom space) alone.
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

    /// Brings `groom` to the GPU, at rest, the head at the origin, among `colliders`. The strands are put
    /// in the order of [`lod::arrange`].
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it, [`Error::Groom`] and [`Error::Parameter`]
    /// when the groom or the options make no sense, and what [`ColliderSet::new`] says.
    pub fn with_colliders(
        context: &Context,
        groom: &Groom,
        options: &HairOptions,
        colliders: &ColliderDescriptor<'_>,
    ) -> Result<Self> {
        at_once(Self::with_progress(context, groom, options, colliders, &()))
    }

    /// The same, telling `progress`.
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

    /// From the next frame on its roots go with a skin that bends: `mesh` as it is at rest (groom space), `skin` as it is
    /// in each frame, in a space whose pose is [`Roots::pose`]. [`HairFrame::head`](HairFrame::head) remains
    /// the pose of what is rigid. `groom` is the one the hair was made from. No root may be farther than `reach` metres
    /// from the mesh; the report says how far they are.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for another groom, a root that is farther away, and a skin that `mesh` does
    /// not fit; [`Error::Limit`].
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
            return Err(Error::unusable("roots are those of the groom that the hair was made from"));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        let buffers = (&mut self.guides, &mut self.strands);
        let (roots, report) = Roots::new(&self.context, (groom, &arranged), buffers, mesh, skin, reach)?;
        self.roots = Some(roots);
        self.follow_roots()?;
        Ok(report)
    }

    /// Binds the roots' buffers, which have come, to the stages that read them.
    fn follow_roots(&mut self) -> Result<()> {
        let untied = Simulation::new(&self.context, &self.guides);
        let before = std::mem::replace(&mut self.simulation, untied);
        self.simulation.tie_as(&self.context, &self.guides, &before)?;
        self.curves = Curves::new(&self.context, &self.guides, &self.strands);
        Ok(())
    }

    /// Lets the next frame carry the hair along with the head without moving it against the head, however far that goes.
    pub fn teleport(&mut self) {
        self.sleep.wake();
        self.motion.teleports = true;
    }

    /// Puts the hair to rest at the next frame, wherever the head is then.
    pub fn reset(&mut self) {
        self.sleep.wake();
        self.motion.clock.reset();
    }

    /// From the next frame on these are the obstacles besides the head's field, whose poses the frames give:
    /// a ball can come, change and go. See [`ColliderSet::replace`].
    ///
    /// # Errors
    /// As [`ColliderSet::replace`].
    pub fn set_colliders(&mut self, colliders: &[Collider]) -> Result<()> {
        self.colliders.replace(colliders)
    }

    /// From where guides are simulated, an origin near the hair that goes along with it ([`crate::space`]), to where hair
    /// is drawn, as of the last frame: for who reads the state of guides or of a grab.
    pub fn place(&self) -> Pose {
        self.motion.to_drawn
    }

    /// The frames from here on are drawn at the level of detail that [`Lod::options`](crate::lod::Lod::options)
    /// have for what `camera` sees on a head at `head`, both in the space that hair is drawn in. Call it before a
    /// frame is recorded; without it hair is drawn in full detail.
    pub fn look_from(&mut self, camera: &Camera, head: &Pose) {
        self.look_at(camera, head, self.lod.seen(camera, head));
    }

    /// The same at a level of detail that somebody else has chosen.
    pub(crate) fn look_at(&mut self, camera: &Camera, head: &Pose, detail: Detail) {
        self.set_detail(detail);
        self.sleep.unseen = self.lod.options.sleep && !self.sees(camera, head);
    }

    /// Whether `camera` sees anything of it on a head at `head`.
    pub(crate) fn sees(&self, camera: &Camera, head: &Pose) -> bool {
        let (middle, radius) = self.lod.sphere;
        sees(camera, (head.point(middle), radius))
    }

    /// Leaves it out of the next frames, until a camera [looks](Self::look_from) again.
    pub(crate) fn hide(&mut self) {
        self.sleep.unseen = true;
    }

    /// Whether it was in view when a camera [looked](Self::look_from) last. Hair that is not, and may
    /// [sleep](crate::lod::LodOptions::sleep), is neither simulated nor drawn.
    pub fn is_seen(&self) -> bool {
        !self.sleep.unseen
    }

    /// Whether it has come to rest and is left as it is.
    pub fn is_asleep(&self) -> bool {
        self.sleep.asleep
    }

    /// How many guides are simulated: all of them but for a [level of detail](crate::lod::LodOptions::guides).
    pub fn simulated_guides(&self) -> u32 {
        self.simulation.simulated()
    }

    /// The frames from here on are drawn as `detail` says, which comes from [`Lod::detail`](crate::lod::Lod::detail).
    pub fn set_detail(&mut self, detail: Detail) {
        self.sleep.unseen = false;
        self.lod.set(&self.context, &mut self.strands, detail);
        if !self.fits {
            self.set.show(&self.strands.drawn);
        }
    }

    /// Paints levels of detail: at most [`lod::MAX_LEVELS`], their sizes falling; none takes them away.
    /// `groom` is the one the hair was made from, `skull` the middle of its braincase (groom space, metres;
    /// [`SKULL_CENTRE`](crate::groom::mannequin::SKULL_CENTRE) for the built-in head). They act from the
    /// next [`look_from`](Self::look_from) on.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the levels make no sense, [`Error::Groom`] when it is another groom.
    pub fn paint_levels(&mut self, groom: &Groom, levels: &[LodLevel], skull: Vec3) -> Result<()> {
        if groom.strands.len() != self.strands.count as usize {
            return Err(Error::unusable("levels of detail must be painted on the groom of the hair"));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        self.lod.paint(&self.context, &arranged, levels, skull)
    }
}

/// Memory that a groom needs for a while only: in a step the cells of its grid, then the forces on its guides; in a picture
/// the knots of its shading. None of them is read after another is written, in whatever order heads and views come.
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

/// The box around the guides at rest: its middle and its longest side, metres.
fn extent(groom: &Groom) -> (Vec3, f32) {
    let (lo, hi) = groom
        .guides
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    (0.5 * (lo + hi), (hi - lo).max_element().max(0.05))
}

/// A number of strands or guides as the GPU counts them.
fn count(n: usize) -> Result<u32> {
    u32::try_from(n).map_err(|_| Error::unusable(format!("{n} strands are more than 32 bits can count")))
}

/// The strands, with the upper half of their seeds shared by all that follow the same first guide.
fn with_locks(strands: &BoundStrands) -> Vec<Strand> {
    let strands = strands.strands.iter().zip(&strands.bindings);
    strands
        .map(|(strand, binding)| Strand {
            seed: (pcg(binding.guides[0]) & 0xffff_0000) | (strand.seed & 0xffff),
            ..*strand
        })
        .collect()
}
