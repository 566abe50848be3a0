//! The three lifetimes: pipelines live as long as the device ([`HairRenderer`]), buffers as long
//! as a groom is shown ([`Hair`]), parameters for a frame ([`crate::frame::Frame`]).

use crate::{
    Error, Pose, Progress, Result,
    avoid::{self, Avoid, AvoidOptions, Avoidance},
    collide::{Collider, ColliderDescriptor, ColliderPoses, ColliderSet, Moments},
    draw::{DrawOptions, DrawStage, HairSet, View},
    frame::Frame,
    gpu::bindings,
    groom::{BoundStrands, Groom, SdfGrid},
    interpolate::{Interpolate, InterpolateParams},
    lod::{self, Detail, Lod, LodLevel, Widths},
    math::hash::pcg,
    progress::at_once,
    simulate::{
        Clock, Forces, Grab, GuideTraits, Mode, Ray, RestOptions, RestShape, Simulate, Simulation,
        SimulationParams, Step, Target, rest,
    },
    strands::{GuideBuffers, Strand, StrandBuffers},
    tessellate::{Tessellate, TessellateParams, rest_samples},
    volume::{HairHairMode, Volume, VolumeOptions, VolumeStage},
    wind::{Air, Fluid, HairGrid, Wind},
};

use glam::Vec3;

/// Every pipeline; made once per device.
#[derive(Debug)]
pub struct HairRenderer {
    /// Guides fill a grid.
    pub volume: VolumeStage,
    /// Air moves.
    pub wind: Fluid,
    /// Guides move.
    pub simulate: Simulate,
    /// Guides become curves.
    pub tessellate: Tessellate,
    /// Guides become strands.
    pub interpolate: Interpolate,
    /// Strands leave obstacles.
    pub avoid: Avoid,
    /// Widths of strands at a level of detail.
    pub widths: Widths,
    /// Lights to picture.
    pub draw: DrawStage,
}

impl HairRenderer {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device, options: &DrawOptions) -> Self {
        Self {
            volume: VolumeStage::new(device),
            wind: Fluid::new(device),
            simulate: Simulate::new(device),
            tessellate: Tessellate::new(device),
            interpolate: Interpolate::new(device),
            avoid: Avoid::new(device),
            widths: Widths::new(device),
            draw: DrawStage::new(device, options),
        }
    }
}

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
}

impl Default for HairOptions {
    fn default() -> Self {
        Self {
            simulation: SimulationParams::default(),
            rest: RestShape::SagFree,
            clearance: 1.5e-3,
            volume: VolumeOptions::default(),
            avoid: AvoidOptions::default(),
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
    /// Index buffers, shaded values and bind groups of the drawing stages.
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
    /// The box around the hair at rest: its middle (groom space) and its longest side, metres.
    extent: (Vec3, f32),
    /// Whether the wind blows in this frame.
    windy: bool,
    /// Whether the grids act on the guides in this frame.
    forced: bool,
    grab: Grab,
    pub(crate) simulation: Simulation,
    pub(crate) clock: Clock,
    /// Poses of the head before and after the last step, and the blend between them.
    states: (Pose, Pose, f32),
    /// Whether the last frame put the hair somewhere else.
    moved_away: bool,
    tessellate_params: wgpu::Buffer,
    tessellate_group: wgpu::BindGroup,
    interpolate_params: wgpu::Buffer,
    interpolate_group: wgpu::BindGroup,
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
        renderer: &HairRenderer,
        groom: &Groom,
        options: &HairOptions,
        head: Option<&SdfGrid>,
    ) -> Result<Self> {
        let colliders = ColliderDescriptor { head, ..Default::default() };
        Self::with_colliders(device, queue, renderer, groom, options, &colliders)
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
        renderer: &HairRenderer,
        groom: &Groom,
        options: &HairOptions,
        colliders: &ColliderDescriptor<'_>,
    ) -> Result<Self> {
        at_once(Self::with_progress(device, queue, renderer, groom, options, colliders, &()))
    }

    /// The same, telling `progress`.
    ///
    /// # Errors
    /// As [`with_colliders`](Self::with_colliders).
    pub async fn with_progress(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        renderer: &HairRenderer,
        groom: &Groom,
        options: &HairOptions,
        colliders: &ColliderDescriptor<'_>,
        progress: &impl Progress,
    ) -> Result<Self> {
        let head = colliders.head;
        progress.step("preparing the strands", 0.0).await;
        if groom.guides.is_empty() || groom.strands.is_empty() {
            return Err(Error::Groom("the groom has no strands".into()));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        let vertex_count = groom.guides.vertex_count;
        let sample_count = vertex_count.max(groom.strands.vertex_count);
        let guides = GuideBuffers::new(device, count(groom.guides.len())?, vertex_count, sample_count)?;
        let strands = StrandBuffers::new(device, count(groom.strands.len())?, groom.strands.vertex_count)?;

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
            head,
        )?;
        rest.upload(queue, &guides)?;
        let sample_rest: Vec<[f32; 4]> = (0..groom.guides.len())
            .flat_map(|i| rest_samples(groom.guides.guide(i), sample_count))
            .map(|p| p.extend(0.0).to_array())
            .collect();
        queue.write_buffer(&guides.sample_rest, 0, bytemuck::cast_slice(&sample_rest));
        let infos = with_locks(&arranged);
        queue.write_buffer(&strands.strands, 0, bytemuck::cast_slice(&infos));
        queue.write_buffer(&strands.bindings, 0, bytemuck::cast_slice(&arranged.bindings));
        match head {
            Some(head) => {
                let rest = avoid::sunk(&arranged, head, options.clearance);
                queue.write_buffer(&strands.rest, 0, bytemuck::cast_slice(&rest));
            }
            None => queue.write_buffer(&strands.rest, 0, bytemuck::cast_slice(&arranged.rest)),
        }

        let colliders = ColliderSet::new(device, queue, colliders)?;
        let simulation = Simulation::new(device, &renderer.simulate, &guides);
        let volume = Volume::new(device, &renderer.volume, &guides, &rest, &options.volume)?;
        let uniform = |label, size| bindings::uniform(device, label, size);
        let tessellate_params = uniform("tessellate", size_of::<TessellateParams>());
        let interpolate_params = uniform("interpolate", size_of::<InterpolateParams>());
        Ok(Self {
            set: HairSet::new(device, &renderer.draw, &strands)?,
            lod: Lod::new(device, queue, &renderer.widths, &arranged, &infos, &strands, progress).await?,
            tessellate_group: renderer.tessellate.bind(device, &tessellate_params, &guides),
            interpolate_group: renderer.interpolate.bind(device, &interpolate_params, &guides, &strands),
            forces: Forces::new(device, &renderer.simulate, &guides, &volume, None),
            air: None,
            windy: false,
            extent: extent(groom),
            volume,
            forced: false,
            grab: Grab::default(),
            avoidance: Avoidance::new(
                device,
                queue,
                &renderer.avoid,
                options.avoid,
                options.clearance,
                &guides,
                &strands,
            )?,
            clock: Clock::default(),
            states: (Pose::IDENTITY, Pose::IDENTITY, 1.0),
            moved_away: false,
            guides,
            strands,
            colliders,
            simulation,
            tessellate_params,
            interpolate_params,
        })
    }

    /// Puts the hair to rest at the next frame, wherever the head is then.
    pub fn reset(&mut self) {
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

    /// Grabs the lock that `ray` (world space, from the eye through the cursor: [`View::ray`]) meets
    /// first: all of the hair that hangs on guide vertices within `radius` metres of there, or on the nearest. It
    /// holds it until [`release`](Self::release), until the head jumps or until the hair is
    /// [reset](Self::reset); a ray that meets no hair, or the head before it, holds nothing. See
    /// [`crate::simulate::grab`].
    ///
    /// # Errors
    /// [`Error::Parameter`] for a ray without a direction, and a radius that is not from 1 mm to 1 m.
    pub fn grab(&mut self, ray: &Ray, radius: f32) -> Result<()> {
        self.grab.begin(ray, radius)
    }

    /// Where what is grabbed is to be at the next frame. Nothing when nothing is.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what is not finite.
    pub fn drag_to(&mut self, target: &Target) -> Result<()> {
        self.grab.drag(target)
    }

    /// Lets go of what is grabbed.
    pub fn release(&mut self) {
        self.grab.end();
    }

    /// The hand: whether it holds, and what the GPU knows of it.
    pub fn grabbed(&self) -> &Grab {
        &self.grab
    }

    /// The frames from here on are drawn at the level of detail that [`Lod::options`](crate::lod::Lod::options)
    /// have for what `view` sees on a head at `head`. Call it before a frame is recorded; without it hair
    /// is drawn in full detail.
    pub fn look_from(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, view: &View, head: &Pose) {
        self.set_detail(device, queue, self.lod.seen(view, head));
    }

    /// The frames from here on are drawn as `detail` says, which comes from [`Lod::detail`](crate::lod::Lod::detail).
    pub fn set_detail(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, detail: Detail) {
        self.lod.set(queue, &mut self.strands, detail);
        self.set.show(device, &self.strands.drawn);
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
            return Err(Error::Groom("levels of detail must be painted on the groom of the hair".into()));
        }
        let mut arranged = groom.strands.clone();
        lod::arrange(&mut arranged);
        self.lod.paint(queue, &arranged, levels, skull)
    }

    /// Begins a frame: writes what its fixed steps read and returns how many are due.
    pub(crate) fn begin(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        renderer: &HairRenderer,
        frame: &Frame<'_>,
    ) -> Result<u32> {
        frame.simulation.check()?;
        let slow = self.lod.current().step;
        let physics =
            &SimulationParams { step: (frame.simulation.step * slow).min(0.1), ..*frame.simulation };
        self.windy = physics.wind.blows();
        if self.windy {
            self.make_air(device, queue, renderer, &physics.wind)?;
        }
        let steps = self.tick(queue, frame.dt, physics, &frame.head, frame.colliders)?;
        self.forced = self.windy || physics.hair_hair.mode != HairHairMode::Off;
        if self.forced {
            self.volume.prepare(queue, physics, &steps, &self.colliders);
            if let Some(air) = self.air.as_mut().filter(|_| self.windy) {
                let grid = &self.volume.grid;
                let hair = HairGrid { bias: grid.bias, scale: grid.scale };
                air.prepare(queue, physics, &steps, Some(hair));
            }
            let air = self.air.as_ref().filter(|_| self.windy);
            self.forces.prepare(queue, physics, air, steps.len());
        }
        if let Some(air) = self.air.as_mut().filter(|_| !self.windy) {
            // When the wind comes back it finds no traces of the last one.
            air.reset();
        }
        let (stage, buffers) = (&renderer.simulate, (&self.guides, &self.strands));
        let held = self.grab.prepare(device, queue, stage, physics, &steps, buffers, self.forced)?;
        self.simulation.prepare(queue, physics, &steps, self.forced || held)
    }

    /// Makes the air for `wind` unless it is there.
    fn make_air(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        renderer: &HairRenderer,
        wind: &Wind,
    ) -> Result<()> {
        let (middle, side) = self.extent;
        let size = side * wind.room;
        let fits = |air: &Air| air.cells == wind.cells && air.cell == size / wind.cells as f32;
        if !self.air.as_ref().is_some_and(fits) {
            let air = Air::new(device, queue, &renderer.wind, wind.cells, (middle, size), &self.volume.hair)?;
            self.forces = Forces::new(device, &renderer.simulate, &self.guides, &self.volume, Some(&air));
            self.air = Some(air);
        }
        Ok(())
    }

    /// Whether the wind blows in this frame.
    pub(crate) fn uses_wind(&self) -> bool {
        self.windy
    }

    /// Step `i` of the air.
    pub(crate) fn record_wind(&self, pass: &mut wgpu::ComputePass<'_>, stage: &Fluid, i: u32) {
        if let Some(air) = &self.air {
            stage.record(pass, air, &self.colliders, i);
        }
    }

    /// Whether this frame needs the grid of the hair.
    pub(crate) fn uses_volume(&self) -> bool {
        self.forced
    }

    /// The fixed steps that are due `dt` seconds after the last frame, the head now at `head` and the
    /// colliders at `poses`, which are moved.
    ///
    /// # Errors
    /// What [`ColliderSet::advance`] says.
    fn tick(
        &mut self,
        queue: &wgpu::Queue,
        dt: f32,
        params: &SimulationParams,
        head: &Pose,
        poses: &ColliderPoses,
    ) -> Result<Vec<Step>> {
        let ticks = self.clock.tick(dt, params.step, head);
        let moments = Moments {
            steps: &ticks.steps,
            substeps: params.substeps,
            step: params.step,
            head: *head,
            alpha: ticks.alpha,
        };
        self.colliders.advance(queue, poses, &moments)?;
        self.states.2 = ticks.alpha;
        self.moved_away = ticks.steps.iter().any(|step| step.mode != Mode::Step);
        for step in &ticks.steps {
            self.states = match step.mode {
                Mode::Step => (step.begin, step.end, ticks.alpha),
                Mode::Carry | Mode::Reset => (step.end, step.end, ticks.alpha),
            };
        }
        Ok(ticks.steps)
    }

    /// Bytes of GPU memory, without render targets and shadow maps.
    pub fn bytes(&self) -> u64 {
        self.guides.bytes()
            + self.strands.bytes()
            + self.set.bytes()
            + self.lod.bytes()
            + self.avoidance.bytes()
            + self.simulation.bytes()
            + self.colliders.bytes()
            + self.volume.bytes()
            + self.forces.bytes()
            + self.grab.bytes()
            + self.air.as_ref().map_or(0, Air::bytes)
    }

    /// Writes the uniforms of the stages that follow the guides: the head is at `head`, `dt` seconds
    /// after the last frame.
    pub(crate) fn prepare(&mut self, queue: &wgpu::Queue, head: &Pose, dt: f32) {
        let (previous, current, blend) = self.states;
        let params = TessellateParams::new(&self.guides, &previous, &current, head, blend);
        queue.write_buffer(&self.tessellate_params, 0, bytemuck::bytes_of(&params));
        let params = InterpolateParams::new(&self.guides, &self.strands);
        queue.write_buffer(&self.interpolate_params, 0, bytemuck::bytes_of(&params));
        let counts = (&self.guides, &self.strands);
        let fresh = self.lod.begin();
        self.avoidance.prepare(queue, counts, dt, self.moved_away, fresh);
    }

    /// Step `i` of the guides: what the grids do to them, then the step itself.
    pub(crate) fn record_simulate(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        device: &wgpu::Device,
        stage: &Simulate,
        i: u32,
    ) {
        if self.forced {
            self.forces.record(stage, pass, i);
        }
        self.grab.record(stage, pass, &self.colliders, i);
        self.simulation.record_step(stage, device, pass, &self.colliders, i);
    }

    /// Step `i` of the grid of the hair.
    pub(crate) fn record_volume(&mut self, pass: &mut wgpu::ComputePass<'_>, stage: &VolumeStage, i: u32) {
        self.volume.record(stage, pass, &self.colliders, i);
    }

    pub(crate) fn record_tessellate(&self, pass: &mut wgpu::ComputePass<'_>, stage: &Tessellate) {
        stage.record(pass, &self.tessellate_group, &self.guides);
    }

    pub(crate) fn record_interpolate(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        stage: &Interpolate,
        widths: &Widths,
    ) {
        self.lod.record(pass, widths);
        stage.record(pass, &self.interpolate_group, &self.strands);
    }

    pub(crate) fn record_avoid(&self, pass: &mut wgpu::ComputePass<'_>, stage: &Avoid) {
        self.avoidance.record(pass, stage, &self.colliders, &self.strands);
    }
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
    u32::try_from(n).map_err(|_| Error::Groom(format!("{n} strands are more than 32 bits can count")))
}

/// The strands with the upper half of their seeds shared by all that hang on the same first guide.
fn with_locks(strands: &BoundStrands) -> Vec<Strand> {
    let strands = strands.strands.iter().zip(&strands.bindings);
    strands
        .map(|(strand, binding)| Strand {
            seed: (pcg(binding.guides[0]) & 0xffff_0000) | (strand.seed & 0xffff),
            ..*strand
        })
        .collect()
}
