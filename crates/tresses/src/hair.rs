//! One groom on the GPU. Pipelines live as long as the device ([`Pipelines`]), a groom's buffers as long as it is
//! there ([`Hair`]), those of a picture as long as somebody looks ([`crate::view::View`]), parameters for a frame
//! ([`crate::frame::Frame`]).

use crate::{
    Camera, Error, Pipelines, Pose, Progress, Result,
    avoid::{self, AvoidOptions, Avoidance},
    clock::Clock,
    collide::{Collider, ColliderDescriptor, ColliderSet},
    groom::{BoundStrands, Groom, SdfGrid, TriMesh},
    interpolate::Interpolation,
    light::{HairSet, hair::knot_bytes},
    lod::{self, Detail, GuideOrder, Lod, LodLevel, LodOptions},
    math::hash::pcg,
    progress::at_once,
    roots::{RootReport, Roots, Skin},
    simulate::{
        Forces, Grab, GuideTraits, Links, RestOptions, RestShape, Shifting, Simulation, SimulationParams,
        rest,
    },
    space::{Carrier, Passage, Space},
    strands::{GuideBuffers, GuideSample, Strand, StrandBinding, StrandBuffers, buffers::storage},
    tessellate::{Tessellation, rest_samples},
    volume::{Volume, VolumeOptions},
    wind::Air,
};

use glam::Vec3;
use sleep::{Sleep, sees};
use std::sync::Arc;

mod hold;
mod meet;
mod record;
mod share;
mod sleep;

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
    forces: Forces,
    /// By what neighbouring guides hold each other, where they do.
    links: Option<Links>,
    /// The box around the hair at rest: its middle (groom space) and its longest side, metres.
    extent: (Vec3, f32),
    /// Whether the wind blows in this frame.
    windy: bool,
    /// Whether the grids act on the guides in this frame.
    forced: bool,
    grab: Grab,
    pub(crate) simulation: Simulation,
    pub(crate) clock: Clock,
    /// What carries it along with the space of its frames.
    carrier: Carrier,
    /// From that space to the carrier, in this frame.
    passage: Passage,
    /// What puts its state before another origin, once it has strayed, and whether this frame does.
    shifting: Option<Shifting>,
    shifts: bool,
    /// Where it is drawn, and the way there from where it is simulated.
    pub(crate) drawn_in: Space,
    pub(crate) to_drawn: Pose,
    /// Poses of the head before and after the last step, and the blend between them.
    states: (Pose, Pose, f32),
    /// Length of the last step, s.
    span: f32,
    /// Where the head is drawn in the frame that is recorded.
    pub(crate) head: Pose,
    /// Whether the last frame put the hair somewhere else.
    moved_away: bool,
    tessellation: Tessellation,
    interpolation: Interpolation,
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

/// What hair is made of that another head does not get in the same way.
struct Parts {
    guides: GuideBuffers,
    strands: StrandBuffers,
    set: HairSet,
    avoidance: Avoidance,
    lod: Lod,
    colliders: ColliderSet,
    volume: Volume,
    links: Option<Links>,
    extent: (Vec3, f32),
    order: Arc<GuideOrder>,
    substeps: u32,
    fits: bool,
}

impl Hair {
    /// Brings `groom` to the GPU, at rest, the head at the origin. It collides with the head's
    /// distance field `head` (groom space) alone.
    ///
    /// # Errors
    /// As [`with_colliders`](Self::with_colliders).
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        groom: &Groom,
        options: &HairOptions,
        head: Option<&SdfGrid>,
    ) -> Result<Self> {
        let colliders = ColliderDescriptor { head, ..Default::default() };
        Self::with_colliders(device, queue, pipelines, groom, options, &colliders)
    }

    /// Brings `groom` to the GPU, at rest, the head at the origin, among `colliders`. The strands are put
    /// in the order of [`lod::arrange`].
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it, [`Error::Groom`] and [`Error::Parameter`]
    /// when the groom or the options make no sense, and what [`ColliderSet::new`] says.
    pub fn with_colliders(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        groom: &Groom,
        options: &HairOptions,
        colliders: &ColliderDescriptor<'_>,
    ) -> Result<Self> {
        at_once(Self::with_progress(device, queue, pipelines, groom, options, colliders, &()))
    }

    /// The same, telling `progress`.
    ///
    /// # Errors
    /// As [`with_colliders`](Self::with_colliders).
    pub async fn with_progress(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        groom: &Groom,
        options: &HairOptions,
        colliders: &ColliderDescriptor<'_>,
        progress: &impl Progress,
    ) -> Result<Self> {
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
        let mut guides = GuideBuffers::new(device, count(groom.guides.len())?, vertex_count, sample_count)?;
        if options.simulation.twist > 0.0 {
            guides = guides.with_twist(device)?;
        }
        let strands = StrandBuffers::new(device, count(groom.strands.len())?, groom.strands.vertex_count)?;

        let scratch = scratch(device, &guides, &strands, &options.volume)?;
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
        rest.upload(queue, &guides)?;
        let hair_hair = &options.simulation.hair_hair;
        let links = (hair_hair.cohesion > 0.0)
            .then(|| Links::new(device, queue, &pipelines.simulate, &guides, &rest, hair_hair))
            .transpose()?;
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

        let colliders = ColliderSet::new(device, queue, colliders)?;
        let volume =
            Volume::within(device, &pipelines.volume, &guides, &rest, &options.volume, scratch.clone())?;
        let order = Arc::new(lod::guide_order(groom, rest.info, &arranged));
        let lod =
            Lod::new(device, queue, &pipelines.widths, arranged, &infos, &strands, &options.lod, progress)
                .await?;
        let mut set = HairSet::new(device, &strands)?.within(&scratch);
        set.area = lod.area();
        let (avoid, clearance) = (options.avoid, options.clearance);
        let avoidance = Avoidance::new(device, queue, &pipelines.avoid, avoid, clearance, &guides, &strands)?;
        let (extent, substeps) = (extent(groom), options.simulation.substeps);
        let parts = Parts {
            guides,
            strands,
            set,
            avoidance,
            lod,
            colliders,
            volume,
            links,
            extent,
            order,
            substeps,
            fits: false,
        };
        Ok(Self::at_rest(device, pipelines, parts))
    }

    /// Hair of such parts that has not moved yet.
    fn at_rest(device: &wgpu::Device, pipelines: &Pipelines, parts: Parts) -> Self {
        let Parts {
            guides,
            strands,
            set,
            avoidance,
            lod,
            colliders,
            volume,
            links,
            extent,
            order,
            substeps,
            fits,
        } = parts;
        let tessellation = Tessellation::new(device, &pipelines.tessellate, &guides);
        Self {
            interpolation: interpolation(device, pipelines, &guides, &strands, &tessellation),
            forces: Forces::new(device, &pipelines.simulate, &guides, &volume, None),
            simulation: Simulation::new(device, &pipelines.simulate, &guides),
            tessellation,
            guides,
            strands,
            set,
            avoidance,
            lod,
            colliders,
            volume,
            links,
            air: None,
            extent,
            windy: false,
            forced: false,
            grab: Grab::default(),
            clock: Clock::default(),
            carrier: Carrier::default(),
            passage: Passage::default(),
            shifting: None,
            shifts: false,
            drawn_in: Space::WORLD,
            to_drawn: Pose::IDENTITY,
            states: (Pose::IDENTITY, Pose::IDENTITY, 1.0),
            span: 0.0,
            head: Pose::IDENTITY,
            moved_away: false,
            roots: None,
            fits,
            order,
            sleep: Sleep::default(),
            substeps,
        }
    }

    /// From the next frame on its roots go with a skin that bends: `mesh` as it is at rest (groom space), `skin` as it is
    /// in each frame, in a space whose pose is [`Roots::pose`]. [`Frame::head`](crate::frame::Frame::head) remains
    /// the pose of what is rigid. `groom` is the one the hair was made from. No root may be farther than `reach` metres
    /// from the mesh; the report says how far they are.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for another groom, a root that is farther away, and a skin that `mesh` does
    /// not fit; [`Error::Limit`].
    #[allow(clippy::too_many_arguments)]
    pub fn attach(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
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
        let (roots, report) =
            Roots::new(device, queue, &pipelines.roots, (groom, &arranged), buffers, mesh, skin, reach)?;
        self.roots = Some(roots);
        let untied = Simulation::new(device, &pipelines.simulate, &self.guides);
        let before = std::mem::replace(&mut self.simulation, untied);
        self.simulation.tie_as((device, queue), &pipelines.simulate, &self.guides, &before)?;
        self.tessellation = Tessellation::new(device, &pipelines.tessellate, &self.guides);
        self.interpolation =
            interpolation(device, pipelines, &self.guides, &self.strands, &self.tessellation);
        Ok(report)
    }

    /// Puts the hair to rest at the next frame, wherever the head is then.
    pub fn reset(&mut self) {
        self.sleep.wake();
        self.clock.reset();
    }

    /// From the next frame on these are the obstacles besides the head's field, whose poses the frames give:
    /// a ball can come, change and go. See [`ColliderSet::replace`].
    ///
    /// # Errors
    /// As [`ColliderSet::replace`].
    pub fn set_colliders(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        colliders: &[Collider],
    ) -> Result<()> {
        self.colliders.replace(device, queue, colliders)
    }

    /// From where guides are simulated, an origin near the hair that goes along with it ([`crate::space`]), to where hair
    /// is drawn, as of the last frame: for who reads the state of guides or of a grab.
    pub fn place(&self) -> Pose {
        self.to_drawn
    }

    /// The frames from here on are drawn at the level of detail that [`Lod::options`](crate::lod::Lod::options)
    /// have for what `camera` sees on a head at `head`, both in the space that hair is drawn in. Call it before a
    /// frame is recorded; without it hair is drawn in full detail.
    pub fn look_from(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, camera: &Camera, head: &Pose) {
        self.look_at(device, queue, camera, head, self.lod.seen(camera, head));
    }

    /// The same at a level of detail that somebody else has chosen.
    pub(crate) fn look_at(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        camera: &Camera,
        head: &Pose,
        detail: Detail,
    ) {
        self.set_detail(device, queue, detail);
        self.sleep.unseen = self.lod.options.sleep && !self.sees(camera, head);
    }

    /// Whether `camera` sees anything of it on a head at `head`.
    pub(crate) fn sees(&self, camera: &Camera, head: &Pose) -> bool {
        let (middle, radius) = self.lod.sphere;
        sees(camera, (head.point(middle), radius))
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
    pub fn set_detail(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, detail: Detail) {
        self.sleep.unseen = false;
        self.lod.set(queue, &mut self.strands, detail);
        if !self.fits {
            self.set.show(device, &self.strands.drawn);
        }
    }

    /// Paints levels of detail: at most [`lod::MAX_LEVELS`], their sizes falling; none takes them away.
    /// `groom` is the one the hair was made from, `skull` the middle of its braincase (groom space, metres;
    /// [`SKULL_CENTRE`](crate::groom::mannequin::SKULL_CENTRE) for the built-in head). They act from the
    /// next [`look_from`](Self::look_from) on.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the levels make no sense, [`Error::Groom`] when it is another groom.
    pub fn paint_levels(
        &mut self,
        queue: &wgpu::Queue,
        groom: &Groom,
        levels: &[LodLevel],
        skull: Vec3,
    ) -> Result<()> {
        if groom.strands.len() != self.strands.count as usize {
            return Err(Error::unusable("levels of detail must be painted on the groom of the hair"));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        self.lod.paint(queue, &arranged, levels, skull)
    }
}

/// How `strands` follow `guides`: by samples, or each along its own where those have none.
fn interpolation(
    device: &wgpu::Device,
    pipelines: &Pipelines,
    guides: &GuideBuffers,
    strands: &StrandBuffers,
    tessellation: &Tessellation,
) -> Interpolation {
    if guides.sample_count == 0 {
        Interpolation::following(device, &pipelines.interpolate, guides, strands, tessellation)
    } else {
        Interpolation::new(device, &pipelines.interpolate, guides, strands)
    }
}

/// Memory that a groom needs for a while only: in a step the cells of its grid, then the forces on its guides; in a picture
/// the knots of its shading. None of them is read after another is written, in whatever order heads and views come.
fn scratch(
    device: &wgpu::Device,
    guides: &GuideBuffers,
    strands: &StrandBuffers,
    volume: &VolumeOptions,
) -> Result<wgpu::Buffer> {
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
