//! A frame's work on one groom: [`begin`](Hair::begin) and [`prepare`](Hair::prepare) write what its
//! stages read, the rest records them, in the order of [`crate::frame`].

use super::Hair;
use crate::{
    Pipelines, Pose, Result, avoid,
    clock::{Mode, Step, Steps},
    collide::{ColliderPoses, Moments},
    frame::Frame,
    interpolate,
    lod::Widths,
    roots,
    simulate::{self, Forces, SimulationParams},
    tessellate::{self, TessellateParams},
    volume::{self, HairHairMode},
    wind::{self, Air, HairGrid, Wind},
};

impl Hair {
    /// Begins a frame: writes what its fixed steps read and returns how many are due.
    pub(crate) fn begin(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        frame: &Frame<'_>,
    ) -> Result<u32> {
        frame.simulation.check()?;
        let slow = self.lod.current().step;
        let physics =
            &SimulationParams { step: (frame.simulation.step * slow).min(0.1), ..*frame.simulation };
        self.windy = physics.wind.blows();
        if self.windy {
            self.make_air(device, queue, pipelines, &physics.wind)?;
        }
        let steps = self.tick(queue, frame.dt, physics, &frame.head, frame.colliders)?;
        self.forced = self.windy || physics.hair_hair.mode != HairHairMode::Off;
        if self.forced {
            let due = Steps { steps: &steps, length: physics.step, substeps: physics.substeps };
            self.volume.prepare(queue, &physics.hair_hair, &due, &self.colliders);
            if let Some(air) = self.air.as_mut().filter(|_| self.windy) {
                let grid = &self.volume.grid;
                let hair = HairGrid { bias: grid.bias, scale: grid.scale };
                air.prepare(queue, &physics.wind, physics.diameter, &due, Some(hair));
            }
            let air = self.air.as_ref().filter(|_| self.windy);
            self.forces.prepare(queue, physics, air, steps.len());
        }
        if let Some(air) = self.air.as_mut().filter(|_| !self.windy) {
            // When the wind comes back it finds no traces of the last one.
            air.reset();
        }
        let (stage, buffers) = (&pipelines.simulate, (&self.guides, &self.strands));
        let held = self.grab.prepare(device, queue, stage, physics, &steps, buffers, self.forced)?;
        if let Some(roots) = &mut self.roots {
            let counts = [self.guides.count, self.strands.drawn.count];
            let fresh = steps.first().is_some_and(|step| step.mode == Mode::Reset);
            roots.prepare(queue, &frame.head, counts, fresh);
        }
        self.simulation.prepare(queue, physics, &steps, self.forced || held)
    }

    /// Makes the air for `wind` unless it is there.
    fn make_air(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        wind: &Wind,
    ) -> Result<()> {
        let (middle, side) = self.extent;
        let size = side * wind.room;
        let fits = |air: &Air| air.cells == wind.cells && air.cell == size / wind.cells as f32;
        if !self.air.as_ref().is_some_and(fits) {
            let air =
                Air::new(device, queue, &pipelines.wind, wind.cells, (middle, size), &self.volume.hair)?;
            self.forces = Forces::new(device, &pipelines.simulate, &self.guides, &self.volume, Some(&air));
            self.air = Some(air);
        }
        Ok(())
    }

    /// Whether the wind blows in this frame.
    pub(crate) fn uses_wind(&self) -> bool {
        self.windy
    }

    /// Step `i` of the air.
    pub(crate) fn record_wind(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        stage: &wind::Pipelines,
        i: u32,
    ) {
        if let Some(air) = &self.air {
            air.record(stage, pass, &self.colliders, i);
        }
    }

    /// Where roots go with skin that bends: where that carries them.
    pub(crate) fn record_roots(&self, pass: &mut crate::gpu::ComputePass<'_>, stage: &roots::Pipelines) {
        if let Some(roots) = &self.roots {
            roots.record(stage, pass, [self.guides.count, self.strands.drawn.count]);
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
        if !ticks.steps.is_empty() {
            self.span = params.step;
        }
        self.moved_away = ticks.steps.iter().any(|step| step.mode != Mode::Step);
        for step in &ticks.steps {
            self.states = match step.mode {
                Mode::Step => (step.begin, step.end, ticks.alpha),
                Mode::Carry | Mode::Reset => (step.end, step.end, ticks.alpha),
            };
        }
        Ok(ticks.steps)
    }

    /// Writes the uniforms of the stages that follow the guides: the head is at `head`, `dt` seconds
    /// after the last frame.
    pub(crate) fn prepare(&mut self, queue: &wgpu::Queue, head: &Pose, dt: f32) {
        self.head = *head;
        let (previous, current, blend) = self.states;
        let params = TessellateParams::new(&self.guides, (&previous, &current, self.span), head, blend);
        self.tessellation.prepare(queue, &params);
        self.interpolation.prepare(queue, &self.guides, &self.strands);
        let counts = (&self.guides, &self.strands);
        let fresh = self.lod.begin();
        self.avoidance.prepare(queue, counts, dt, self.moved_away, fresh);
    }

    /// Step `i` of the guides: what the grids do to them, then the step itself.
    pub(crate) fn record_simulate(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        stage: &simulate::Pipelines,
        i: u32,
    ) {
        if self.forced {
            self.forces.record(stage, pass, i);
        }
        self.grab.record(stage, pass, &self.colliders, i);
        self.simulation.record(stage, pass, &self.colliders, i);
    }

    /// Step `i` of the grid of the hair.
    pub(crate) fn record_volume(
        &mut self,
        pass: &mut crate::gpu::ComputePass<'_>,
        stage: &volume::Pipelines,
        i: u32,
    ) {
        self.volume.record(stage, pass, &self.colliders, i);
    }

    pub(crate) fn record_tessellate(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        stage: &tessellate::Pipelines,
    ) {
        self.tessellation.record(stage, pass, &self.guides);
    }

    pub(crate) fn record_interpolate(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        stage: &interpolate::Pipelines,
        widths: &Widths,
    ) {
        self.lod.record(pass, widths);
        self.interpolation.record(stage, pass, &self.strands);
    }

    pub(crate) fn record_avoid(&self, pass: &mut crate::gpu::ComputePass<'_>, stage: &avoid::Pipelines) {
        self.avoidance.record(stage, pass, &self.colliders, &self.strands);
    }
}
