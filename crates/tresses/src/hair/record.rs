//! A frame's work on one groom: [`begin`](Hair::begin) and [`prepare`](Hair::prepare) write what its
//! stages read, the rest records them, in the order of [`crate::frame`].

use super::{Hair, sleep::Back};
use crate::{
    Pipelines, Result, avoid,
    clock::{Mode, Steps},
    collide::{Journey, Moments},
    frame::Frame,
    interpolate,
    lod::{Detail, Widths},
    simulate::{self, Forces, Shifting, SimulationParams, grab::Sights},
    space::{Carried, Shift},
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
        self.volume.begin();
        frame.simulation.check()?;
        frame.space.check()?;
        frame.drawn_in.map_or(Ok(()), |space| space.check())?;
        self.substeps = frame.simulation.substeps;
        let back = self.sleep.carried(frame);
        if self.dozes(frame) {
            if let Some(deformation) = &mut self.colliders.deformation {
                deformation.forget();
            }
            self.shifts = false;
            return Ok(0);
        }
        let physics = &self.coarse(frame.simulation);
        self.lead(device, queue, pipelines)?;
        let usual = self.clock.teleport_distance;
        match back {
            Back::Here => {}
            // Any motion of a head that nobody saw is a jump.
            Back::Moved => self.clock.teleport_distance = -1.0,
            Back::Elsewhere => self.clock.reset(),
        }
        let carried = self.tick(queue, frame, physics);
        self.clock.teleport_distance = usual;
        let Carried { steps, fields, passage, shift } = carried?;
        // Whoever moves through the air has wind.
        let felt = fields.last().map(|field| Wind { velocity: field.wind, ..physics.wind });
        self.windy = felt.map_or(self.windy, |wind| wind.blows());
        if self.windy {
            self.make_air(device, queue, pipelines, &physics.wind)?;
        }
        self.passage = passage;
        let way = shift.map(|shift| shift.way).unwrap_or_default();
        self.shift(device, queue, pipelines, shift);
        self.forced = self.windy
            || physics.hair_hair.mode != HairHairMode::Off
            || self.links.is_some()
            || self.simulation.ties().is_some();
        if let Some(links) = &self.links {
            links.prepare(queue, &physics.hair_hair, physics.step);
        }
        if self.forced {
            let due = Steps { steps: &steps, length: physics.step, substeps: physics.substeps };
            self.volume.prepare(queue, &physics.hair_hair, &due, &self.colliders);
            self.volume.prepare_others(queue, &physics.hair_hair, &due, way);
            if let Some(air) = self.air.as_mut().filter(|_| self.windy) {
                let grid = &self.volume.grid;
                let hair = HairGrid { bias: grid.bias, scale: grid.scale };
                air.prepare_in(queue, &physics.wind, physics.diameter, &due, &fields, Some(hair));
            }
            let air = self.air.as_ref().filter(|_| self.windy);
            self.forces.prepare(queue, physics, air, steps.len());
        }
        if let Some(air) = self.air.as_mut().filter(|_| !self.windy) {
            // When the wind comes back it finds no traces of the last one.
            air.reset();
        }
        let (stage, buffers) = (&pipelines.simulate, (&self.guides, &self.strands));
        let seen = frame.way_to_view();
        let sights = Sights {
            to_carrier: passage.at(1.0).after(&seen.inverse()),
            to_last: self.drawn_in.from(&frame.seen()),
            shift: way,
        };
        let held = self.grab.prepare(device, queue, stage, physics, &steps, buffers, &sights, self.forced)?;
        if let Some(roots) = &mut self.roots {
            let counts = [self.guides.count, self.strands.drawn.count];
            let fresh = steps.first().is_some_and(|step| step.mode == Mode::Reset);
            roots.prepare(queue, (&frame.head, &seen), counts, fresh);
        }
        self.simulation.prepare_in(queue, physics, &steps, &fields, self.forced || held)
    }

    /// Prepares that the frame begins from another origin, if it does.
    fn shift(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        shift: Option<Shift>,
    ) {
        self.shifts = shift.is_some();
        let Some(shift) = shift else { return };
        let make = || Shifting::new(device, &pipelines.simulate, &self.guides);
        self.shifting.get_or_insert_with(make).prepare(queue, &shift);
        if let Some(air) = &mut self.air {
            air.shift(shift.way);
        }
    }

    /// Whether the frame begins from another origin.
    pub(crate) fn is_shifted(&self) -> bool {
        self.shifts
    }

    /// The state from that origin: before the first step.
    pub(crate) fn record_shift(&self, pass: &mut crate::gpu::ComputePass<'_>, stage: &simulate::Pipelines) {
        if let Some(shifting) = &self.shifting {
            shifting.record(stage, pass);
        }
    }

    /// Whether hair is to be left as it is in this frame: nobody sees it, or it has come to rest.
    fn dozes(&mut self, frame: &Frame<'_>) -> bool {
        // What a hand, the wind or skin does, the frame does not tell.
        let may = self.lod.options.sleep
            && !self.is_on_skin()
            && !self.grab.is_active()
            && !self.volume.meets()
            && !frame.simulation.wind.blows();
        if !may {
            self.sleep.wake();
        }
        self.sleep.unseen || (may && self.sleep.rests(frame, self.lod.current().pixel))
    }

    /// Whether strands are drawn already as they are to be in this frame.
    pub(crate) fn is_drawn(&mut self) -> bool {
        let drawn = self.sleep.drawn && self.lod.is_set();
        self.sleep.drawn = self.sleep.asleep;
        self.sleep.unseen || drawn
    }

    /// The physics at the level of detail.
    fn coarse(&self, physics: &SimulationParams) -> SimulationParams {
        let Detail { step, substeps, together, .. } = *self.lod.current();
        let mut hair_hair = physics.hair_hair;
        if together < 1.0 {
            hair_hair.speed *= together;
            hair_hair.friction *= together;
            hair_hair.fixed *= together;
            if together <= 0.0 {
                hair_hair.mode = HairHairMode::Off;
            }
        }
        SimulationParams {
            step: (physics.step * step).min(0.1),
            substeps: ((physics.substeps as f32 * substeps).round() as u32).max(1),
            hair_hair,
            ..*physics
        }
    }

    /// How many guides are to be simulated at `detail`, and with how many substeps.
    pub(crate) fn motion_at(&self, detail: &Detail) -> [u32; 2] {
        let guides = match detail.reach {
            // Roots on skin, and what a hand holds, are each guide's own.
            reach if reach > 0.0 && self.roots.is_none() && !self.grab.is_active() => {
                self.order.enough(reach)
            }
            _ => self.guides.count,
        };
        let substeps = self.substeps as f32 * detail.substeps;
        [guides, (substeps.round() as u32).max(1)]
    }

    /// Chooses the guides that are simulated.
    fn lead(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, pipelines: &Pipelines) -> Result<()> {
        let [enough, _] = self.motion_at(self.lod.current());
        if enough < self.guides.count {
            let tree = self.order.tree(device, queue, &self.guides.info)?;
            self.simulation.simulate_first(device, &pipelines.simulate, &self.guides, &tree, enough);
        } else {
            self.simulation.simulate_all();
        }
        Ok(())
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

    /// Whether its roots go with skin that bends, or what it collides with does.
    pub(crate) fn is_on_skin(&self) -> bool {
        self.roots.is_some() || self.colliders.deformation.is_some()
    }

    /// Where skin carries roots, and how it deforms fields.
    pub(crate) fn record_roots(&self, pass: &mut crate::gpu::ComputePass<'_>, stage: &Pipelines) {
        if let Some(roots) = &self.roots {
            roots.record(&stage.roots, pass, [self.guides.count, self.strands.drawn.count]);
        }
        if let Some(deformation) = &self.colliders.deformation {
            deformation.record(&stage.deform, pass);
        }
    }

    /// Whether this frame needs the grid of the hair.
    pub(crate) fn uses_volume(&self) -> bool {
        self.forced
    }

    /// What is due in `frame`, where hair is simulated; the colliders are moved.
    ///
    /// # Errors
    /// What [`ColliderSet::advance`](crate::collide::ColliderSet::advance) says.
    fn tick(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>, params: &SimulationParams) -> Result<Carried> {
        let (space, head) = (frame.space.normalized(), &frame.head);
        let dt = if frame.dt.is_finite() { f64::from(frame.dt.max(0.0)) } else { 0.0 };
        let times = (dt, f64::from(params.step));
        if let Some(map) = self.carrier.enter(&space, head, &self.clock, times) {
            self.clock.enter(&map);
            self.colliders.enter(&map);
        }
        let ticks = self.clock.tick(frame.dt, params.step, head);
        let carried = self.carrier.carry(&space, (&self.clock, &ticks), times, self.extent.0, params);
        let moments = Moments {
            steps: &carried.steps,
            substeps: params.substeps,
            step: params.step,
            head: frame.way_to_view().pose(head),
            alpha: ticks.alpha,
        };
        let journey = Journey { head: *head, passage: carried.passage };
        self.colliders.journey(queue, frame.colliders, &moments, &journey)?;
        self.states.2 = ticks.alpha;
        if !ticks.steps.is_empty() {
            self.span = params.step;
        }
        self.moved_away = ticks.steps.iter().any(|step| step.mode != Mode::Step);
        for step in &carried.steps {
            self.states = match step.mode {
                Mode::Step => (step.begin, step.end, ticks.alpha),
                Mode::Carry | Mode::Reset => (step.end, step.end, ticks.alpha),
            };
        }
        Ok(carried)
    }

    /// Writes the uniforms of the stages that follow the guides.
    pub(crate) fn prepare(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>) {
        let seen = frame.way_to_view();
        self.head = seen.pose(&frame.head);
        self.drawn_in = frame.seen();
        self.to_drawn = seen.after(&self.passage.at(1.0).inverse()).as_pose();
        let (previous, current, blend) = self.states;
        let drawn = (blend, self.simulation.twists());
        let params = TessellateParams::new(&self.guides, (&previous, &current, self.span), &self.head, drawn);
        self.tessellation.prepare(queue, &params);
        self.interpolation.prepare(queue, &self.guides, &self.strands);
        let counts = (&self.guides, &self.strands);
        let fresh = self.lod.begin();
        self.avoidance.prepare(queue, counts, frame.dt, self.moved_away, fresh);
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
        if let Some(links) = &self.links {
            links.record(stage, pass);
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
