//! A frame's work on one groom: [`begin`](Hair::begin) and [`prepare`](Hair::prepare) write what its
//! stages read, the rest records them, in the order of [`crate::frame`].

use super::{Hair, HairFrame, sleep::Back};
use crate::{
    Result,
    clock::{Mode, Steps},
    collide::{Journey, Moments},
    lod::Detail,
    simulate::{Forces, Shifting, SimulationParams, grab::Sights},
    space::{Carried, Field, Shift},
    tessellate::TessellateParams,
    volume::HairHairMode,
    wind::{Air, HairGrid, Wind},
};

impl Hair {
    /// Begins a frame: writes what its fixed steps read and returns how many are due.
    pub(crate) fn begin(&mut self, frame: &HairFrame<'_>) -> Result<u32> {
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
            self.motion.shifts = false;
            return Ok(0);
        }
        let physics = &self.coarse(frame.simulation);
        self.lead()?;
        let usual = self.motion.clock.teleport_distance;
        match back {
            Back::Here if std::mem::take(&mut self.motion.teleports) => {
                self.motion.clock.teleport_distance = -1.0
            }
            Back::Here => {}
            // Any motion of a head that nobody saw is a jump.
            Back::Moved => self.motion.clock.teleport_distance = -1.0,
            Back::Elsewhere => self.motion.clock.reset(),
        }
        let carried = self.tick(frame, physics);
        self.motion.clock.teleport_distance = usual;
        let Carried { steps, fields, passage, shift } = carried?;
        // Whoever moves through the air has wind.
        let felt = fields.last().map(|field| Wind { velocity: field.wind, ..physics.wind });
        self.effects.windy = felt.map_or(self.effects.windy, |wind| wind.blows());
        if self.effects.windy {
            self.make_air(&physics.wind)?;
        }
        self.motion.passage = passage;
        let way = shift.map(|shift| shift.way).unwrap_or_default();
        self.shift(shift);
        self.effects.forced = self.effects.windy
            || physics.hair_hair.mode != HairHairMode::Off
            || self.effects.links.is_some()
            || self.simulation.ties().is_some();
        if let Some(links) = &self.effects.links {
            links.prepare(&self.context, &physics.hair_hair, physics.step);
        }
        if self.effects.forced {
            let due = Steps { steps: &steps, length: physics.step, substeps: physics.substeps };
            self.volume.prepare(&self.context, &physics.hair_hair, &due, &self.colliders);
            self.volume.prepare_others(&self.context, &physics.hair_hair, &due, way);
            if let Some(air) = self.air.as_mut().filter(|_| self.effects.windy) {
                let grid = &self.volume.grid;
                let hair = HairGrid { bias: grid.bias, scale: grid.scale };
                air.prepare_in(&self.context, &physics.wind, physics.diameter, &due, &fields, Some(hair));
            }
            let air = self.air.as_ref().filter(|_| self.effects.windy);
            self.effects.forces.prepare(&self.context, physics, air, steps.len());
        }
        if let Some(air) = self.air.as_mut().filter(|_| !self.effects.windy) {
            // When the wind comes back it finds no traces of the last one.
            air.reset();
        }
        let buffers = (&self.guides, &self.strands);
        let seen = frame.way_to_view();
        let sights = Sights {
            to_carrier: passage.at(1.0).after(&seen.inverse()),
            to_last: self.motion.drawn_in.from(&frame.seen()),
            shift: way,
        };
        let held = self.effects.grab.prepare(
            &self.context,
            physics,
            &steps,
            buffers,
            &sights,
            self.effects.forced,
        )?;
        if let Some(roots) = &mut self.roots {
            let counts = [self.guides.count, self.strands.drawn.count];
            let fresh = steps.first().is_some_and(|step| step.mode == Mode::Reset);
            roots.prepare(&self.context, (&frame.head, &seen), counts, fresh);
        }
        self.simulation.prepare_in(&self.context, physics, &steps, &fields, self.effects.forced || held)
    }

    /// Prepares that the frame begins from another origin, if it does.
    fn shift(&mut self, shift: Option<Shift>) {
        self.motion.shifts = shift.is_some();
        let Some(shift) = shift else { return };
        let make = || Shifting::new(&self.context, &self.guides);
        self.motion.shifting.get_or_insert_with(make).prepare(&self.context, &shift);
        if let Some(air) = &mut self.air {
            air.shift(shift.way);
        }
    }

    /// Whether the frame begins from another origin.
    pub(crate) fn is_shifted(&self) -> bool {
        self.motion.shifts
    }

    /// The state from that origin: before the first step.
    pub(crate) fn record_shift(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        if let Some(shifting) = &self.motion.shifting {
            shifting.record(pass);
        }
    }

    /// Whether hair is to be left as it is in this frame: nobody sees it, or it has come to rest.
    fn dozes(&mut self, frame: &HairFrame<'_>) -> bool {
        // The frame describes neither grabs nor wind nor skinning.
        let may = self.lod.options.sleep
            && (!self.is_on_skin() || self.motion.skin_is_still)
            && !self.effects.grab.is_active()
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
            reach if reach > 0.0 && self.roots.is_none() && !self.effects.grab.is_active() => {
                self.order.enough(reach)
            }
            _ => self.guides.count,
        };
        let substeps = self.substeps as f32 * detail.substeps;
        [guides, (substeps.round() as u32).max(1)]
    }

    /// Chooses the guides that are simulated.
    fn lead(&mut self) -> Result<()> {
        let [enough, _] = self.motion_at(self.lod.current());
        if enough < self.guides.count {
            let tree = self.order.tree(&self.context, &self.guides.info)?;
            self.simulation.simulate_first(&self.guides, &tree, enough);
        } else {
            self.simulation.simulate_all();
        }
        Ok(())
    }

    /// Makes the air for `wind` unless it is there.
    fn make_air(&mut self, wind: &Wind) -> Result<()> {
        let (middle, side) = self.extent;
        let size = side * wind.room;
        let fits = |air: &Air| air.cells == wind.cells && air.cell == size / wind.cells as f32;
        if !self.air.as_ref().is_some_and(fits) {
            let air = Air::new(&self.context, wind.cells, (middle, size), &self.volume.hair)?;
            self.effects.forces = Forces::new(&self.context, &self.guides, &self.volume, Some(&air));
            self.air = Some(air);
        }
        Ok(())
    }

    /// Whether the wind blows in this frame.
    pub(crate) fn uses_wind(&self) -> bool {
        self.effects.windy
    }

    /// Step `i` of the air.
    pub(crate) fn record_wind(&self, pass: &mut crate::gpu::ComputePass<'_>, i: u32) {
        if let Some(air) = &self.air {
            air.record(pass, &self.colliders, i);
        }
    }

    /// Whether its roots go with skin that bends, or what it collides with does.
    pub(crate) fn is_on_skin(&self) -> bool {
        self.roots.is_some() || self.colliders.deformation.is_some()
    }

    /// Where skin carries roots, and how it deforms fields.
    pub(crate) fn record_roots(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        if let Some(roots) = &self.roots {
            roots.record(pass, [self.guides.count, self.strands.drawn.count]);
        }
        if let Some(deformation) = &self.colliders.deformation {
            deformation.record(pass);
        }
    }

    /// Whether this frame needs the grid of the hair.
    pub(crate) fn uses_volume(&self) -> bool {
        self.effects.forced
    }

    /// What is due in `frame`, where hair is simulated; the colliders are moved.
    ///
    /// # Errors
    /// What [`ColliderSet::advance`](crate::collide::ColliderSet::advance) says.
    fn tick(&mut self, frame: &HairFrame<'_>, params: &SimulationParams) -> Result<Carried> {
        let (space, head) = (frame.space.normalized(), &frame.head);
        let dt = if frame.dt.is_finite() { f64::from(frame.dt.max(0.0)) } else { 0.0 };
        let times = (dt, f64::from(params.step));
        if let Some(map) = self.motion.carrier.enter(&space, head, &self.motion.clock, times) {
            self.motion.clock.enter(&map);
            self.colliders.enter(&map);
        }
        let ticks = self.motion.clock.tick(frame.dt, params.step, head);
        let world = Field::of(params.gravity, params.wind.velocity);
        let carried =
            self.motion.carrier.carry(&space, (&self.motion.clock, &ticks), times, self.extent.0, &world);
        let moments = Moments {
            steps: &carried.steps,
            substeps: params.substeps,
            step: params.step,
            head: frame.way_to_view().pose(head),
            alpha: ticks.alpha,
        };
        let journey = Journey { head: *head, passage: carried.passage };
        self.colliders.journey(frame.colliders, &moments, &journey)?;
        self.motion.states.2 = ticks.alpha;
        if !ticks.steps.is_empty() {
            self.motion.span = params.step;
        }
        self.motion.moved_away = ticks.steps.iter().any(|step| step.mode != Mode::Step);
        for step in &carried.steps {
            self.motion.states = match step.mode {
                Mode::Step => (step.begin, step.end, ticks.alpha),
                Mode::Carry | Mode::Reset => (step.end, step.end, ticks.alpha),
            };
        }
        Ok(carried)
    }

    /// Writes the uniforms of the stages that follow the guides.
    pub(crate) fn prepare(&mut self, frame: &HairFrame<'_>) {
        let seen = frame.way_to_view();
        self.motion.head = seen.pose(&frame.head);
        self.motion.drawn_in = frame.seen();
        self.motion.to_drawn = seen.after(&self.motion.passage.at(1.0).inverse()).as_pose();
        let (previous, current, blend) = self.motion.states;
        let drawn = (blend, self.simulation.twists());
        let params = TessellateParams::new(
            &self.guides,
            (&previous, &current, self.motion.span),
            &self.motion.head,
            drawn,
        );
        self.curves.tessellation.prepare(&self.context, &params);
        self.curves.interpolation.prepare(&self.context, &self.guides, &self.strands);
        let counts = (&self.guides, &self.strands);
        let fresh = self.lod.begin();
        self.avoidance.prepare(&self.context, counts, frame.dt, self.motion.moved_away, fresh);
    }

    /// Step `i` of the guides: what the grids do to them, then the step itself.
    pub(crate) fn record_simulate(&self, pass: &mut crate::gpu::ComputePass<'_>, i: u32) {
        if self.effects.forced {
            self.effects.forces.record(pass, i);
        }
        if let Some(links) = &self.effects.links {
            links.record(pass);
        }
        self.effects.grab.record(pass, &self.colliders, i);
        self.simulation.record(pass, &self.colliders, i);
    }

    /// Step `i` of the grid of the hair.
    pub(crate) fn record_volume(&mut self, pass: &mut crate::gpu::ComputePass<'_>, i: u32) {
        self.volume.record(pass, &self.colliders, i);
    }

    pub(crate) fn record_tessellate(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        self.curves.tessellation.record(pass, &self.guides);
    }

    pub(crate) fn record_interpolate(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        self.lod.record(pass);
        self.curves.interpolation.record(pass, &self.strands);
    }

    pub(crate) fn record_avoid(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        self.avoidance.record(pass, &self.colliders, &self.strands);
    }
}
