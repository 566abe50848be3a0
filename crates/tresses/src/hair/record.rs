//! The work of a frame on one groom. [`begin`](Hair::begin) and [`prepare`](Hair::prepare) write the inputs of its
//! stages; the other methods record them, in the order of [`crate::frame`].

use super::{Hair, HairFrame, sleep::Reentry};
use crate::{
    Result,
    clock::{Mode, Step, Steps},
    collide::{Journey, Moments},
    lod::Detail,
    simulate::{Forces, Links, Shifting, SimulationParams, grab::RayTransforms},
    space::{CarrierFrame, Field, Shift},
    tessellate::TessellateParams,
    volume::HairHairMode,
    wind::{Air, HairGrid, Wind},
};

impl Hair {
    /// Begins a frame: writes the inputs of its fixed steps. Returns the number of steps.
    pub(crate) fn begin(&mut self, frame: &HairFrame<'_>) -> Result<u32> {
        frame.simulation.check()?;
        frame.space.check()?;
        frame.drawn_in.map_or(Ok(()), |space| space.check())?;
        self.volume.begin();
        self.substeps = frame.simulation.substep_count;
        if !self.wakes(frame) {
            self.motion.shifts = false;
            return Ok(0);
        }
        let physics = &self.coarse(frame.simulation);
        self.fit_to(physics)?;
        let carrier_frame = self.tick(frame, physics)?;
        self.shift(carrier_frame.shift.as_ref());
        self.blow(physics, &carrier_frame.fields)?;
        let is_forced = self.prepare_forces(physics, &carrier_frame);
        let is_held = self.prepare_grab(frame, physics, &carrier_frame, is_forced)?;
        self.prepare_roots(frame, &carrier_frame.steps);
        self.simulation.prepare_in(physics, &carrier_frame.steps, &carrier_frame.fields, is_forced || is_held)
    }

    /// Whether the frame moves the hair. Hair that comes back into view continues where its head is now.
    fn wakes(&mut self, frame: &HairFrame<'_>) -> bool {
        let reentry = self.sleep.reentry(frame);
        if self.dozes(frame) {
            if let Some(deformation) = &mut self.colliders.deformation {
                deformation.forget();
            }
            return false;
        }
        match reentry {
            Reentry::InPlace => {}
            Reentry::WithHead => self.motion.clock.teleport(),
            Reentry::AtRest => self.motion.clock.reset(),
        }
        true
    }

    /// Creates what `physics` need for the first time, and chooses the guides to simulate.
    fn fit_to(&mut self, physics: &SimulationParams) -> Result<()> {
        let asset = self.asset.clone();
        let context = &asset.context;
        if physics.twist > 0.0 && !self.guides.can_twist() {
            self.guides.add_twist(context)?;
            self.bind_guides()?;
        }
        let distance = (physics.hair_hair.cohesion > 0.0).then_some(physics.hair_hair.cohesion_distance);
        if self.effects.links.as_ref().map(|links| links.asset.distance) != distance {
            let links: Option<Result<_>> =
                distance.map(|distance| Ok(Links::new(context, &self.guides, asset.links(distance)?)));
            self.effects.links = links.transpose()?;
        }
        let [enough, _] = self.motion_at(self.lod.current());
        if enough < self.guides.count {
            let tree = asset.order.tree(context, &self.guides.info)?;
            self.simulation.simulate_first(&self.guides, &tree, enough);
        } else {
            self.simulation.simulate_all();
        }
        Ok(())
    }

    /// Creates the air if it moves relative to the hair in a step, by wind or by motion.
    fn blow(&mut self, physics: &SimulationParams, fields: &[Field]) -> Result<()> {
        let felt = fields.last().map(|field| Wind { velocity: field.wind, ..physics.wind });
        self.effects.windy = felt.map_or(self.effects.windy, |wind| wind.blows());
        if self.effects.windy {
            return self.make_air(&physics.wind);
        }
        if let Some(air) = &mut self.air {
            // The next wind starts with still air.
            air.reset();
        }
        Ok(())
    }

    /// Writes the inputs of the grids, links and forces. Returns whether any of them acts.
    fn prepare_forces(&mut self, physics: &SimulationParams, carrier_frame: &CarrierFrame) -> bool {
        let Self { volume, effects, air, colliders, simulation, .. } = self;
        let CarrierFrame { steps, fields, .. } = carrier_frame;
        let mut air = air.as_mut().filter(|_| effects.windy);
        effects.forced = effects.windy
            || physics.hair_hair.mode != HairHairMode::Off
            || effects.links.is_some()
            || simulation.ties().is_some();
        if let Some(links) = &effects.links {
            links.prepare(&physics.hair_hair, physics.step);
        }
        if effects.forced {
            let due = Steps { steps, length: physics.step, substeps: physics.substep_count };
            volume.prepare(&physics.hair_hair, &due, colliders);
            volume.prepare_others(&physics.hair_hair, &due, carrier_frame.displacement());
            if let Some(air) = &mut air {
                let hair = HairGrid { bias: volume.grid.bias, scale: volume.grid.scale };
                air.prepare_in(&physics.wind, physics.diameter, &due, fields, Some(hair));
            }
            effects.forces.prepare(physics, air.as_deref(), steps.len());
        }
        effects.forced
    }

    /// Writes the inputs of a grab or brush. Returns whether it acts.
    fn prepare_grab(
        &mut self,
        frame: &HairFrame<'_>,
        physics: &SimulationParams,
        carrier_frame: &CarrierFrame,
        is_forced: bool,
    ) -> Result<bool> {
        let rays = RayTransforms {
            to_carrier: carrier_frame.passage.at(1.0).after(&frame.map_to_drawn().inverse()),
            to_last: self.motion.drawn_in.from(&frame.drawn_space()),
            shift: carrier_frame.displacement(),
        };
        let buffers = (&self.guides, &self.strands);
        let context = &self.asset.context;
        self.effects.grab.prepare(context, physics, &carrier_frame.steps, buffers, &rays, is_forced)
    }

    /// Writes the inputs of roots on skin.
    fn prepare_roots(&mut self, frame: &HairFrame<'_>, steps: &[Step]) {
        if let Some(roots) = &mut self.roots {
            let counts = [self.guides.count, self.strands.drawn.count];
            let fresh = steps.first().is_some_and(|step| step.mode == Mode::Reset);
            roots.prepare((&frame.head, &frame.map_to_drawn()), counts, fresh);
        }
    }

    /// Prepares the shift to another origin, if the frame starts with one.
    fn shift(&mut self, shift: Option<&Shift>) {
        self.motion.shifts = shift.is_some();
        let Some(shift) = shift else { return };
        let make = || Shifting::new(&self.asset.context, &self.guides);
        self.motion.shifting.get_or_insert_with(make).prepare(shift);
        if let Some(air) = &mut self.air {
            air.shift(shift.offset);
        }
    }

    /// Whether the frame starts with a shift to another origin.
    pub(crate) fn is_shifted(&self) -> bool {
        self.motion.shifts
    }

    /// Records that shift: before the first step.
    pub(crate) fn record_shift(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        if let Some(shifting) = &self.motion.shifting {
            shifting.record(pass);
        }
    }

    /// Whether the frame skips the hair because it is out of view or at rest.
    fn dozes(&mut self, frame: &HairFrame<'_>) -> bool {
        // Grabs, wind, other hair and skinning move the hair while the inputs of the frame stay equal.
        let may = self.lod.options.can_sleep
            && (!self.is_on_skin() || self.motion.skin_is_still)
            && !self.effects.grab.is_active()
            && !self.volume.has_neighbors()
            && !frame.simulation.wind.blows();
        if !may {
            self.sleep.wake();
        }
        self.sleep.out_of_view || (may && self.sleep.rests(frame, self.lod.current().pixel))
    }

    /// Whether the drawn strands are already up to date for this frame.
    pub(crate) fn is_drawn(&mut self) -> bool {
        let drawn = self.sleep.drawn && self.lod.is_set();
        self.sleep.drawn = self.sleep.asleep;
        self.sleep.out_of_view || drawn
    }

    /// Returns the physics at the current level of detail.
    fn coarse(&self, physics: &SimulationParams) -> SimulationParams {
        let Detail { step_scale: step, substep_scale: substeps, self_collision_scale: together, .. } =
            *self.lod.current();
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
            substep_count: ((physics.substep_count as f32 * substeps).round() as u32).max(1),
            hair_hair,
            ..*physics
        }
    }

    /// Returns the number of guides to simulate at `detail`, and the number of substeps.
    pub(crate) fn motion_at(&self, detail: &Detail) -> [u32; 2] {
        let guides = match detail.guide_distance {
            // Roots on skin and grabbed guides are individual: none of them can follow another guide.
            guide_distance
                if guide_distance > 0.0 && self.roots.is_none() && !self.effects.grab.is_active() =>
            {
                self.asset.order.enough(guide_distance)
            }
            _ => self.guides.count,
        };
        let substeps = self.substeps as f32 * detail.substep_scale;
        [guides, (substeps.round() as u32).max(1)]
    }

    /// Creates the air for `wind` unless it exists.
    fn make_air(&mut self, wind: &Wind) -> Result<()> {
        let (center, side) = self.asset.extent;
        let size = side * wind.grid_size;
        let fits = |air: &Air| air.cells == wind.resolution && air.cell == size / wind.resolution as f32;
        if !self.air.as_ref().is_some_and(fits) {
            let air = Air::new(&self.asset.context, wind.resolution, (center, size), &self.volume.hair)?;
            self.effects.forces = Forces::new(&self.asset.context, &self.guides, &self.volume, Some(&air));
            self.air = Some(air);
        }
        Ok(())
    }

    /// Whether there is wind in this frame.
    pub(crate) fn uses_wind(&self) -> bool {
        self.effects.windy
    }

    /// Records step `i` of the air.
    pub(crate) fn record_wind(&self, pass: &mut crate::gpu::ComputePass<'_>, i: u32) {
        if let Some(air) = &self.air {
            air.record(pass, &self.colliders, i);
        }
    }

    /// Whether the roots or the colliders follow a deforming skin.
    pub(crate) fn is_on_skin(&self) -> bool {
        self.roots.is_some() || self.colliders.deformation.is_some()
    }

    /// Records the motion of roots on the skin and the deformation of fields.
    pub(crate) fn record_roots(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        if let Some(roots) = &self.roots {
            roots.record(pass, [self.guides.count, self.strands.drawn.count]);
        }
        if let Some(deformation) = &self.colliders.deformation {
            deformation.record(pass);
        }
    }

    /// Whether this frame needs the density grid.
    pub(crate) fn uses_volume(&self) -> bool {
        self.effects.forced
    }

    /// Returns the steps of `frame` in simulation space, and advances the colliders.
    ///
    /// # Errors
    /// As [`ColliderSet::advance`](crate::collide::ColliderSet::advance).
    fn tick(&mut self, frame: &HairFrame<'_>, params: &SimulationParams) -> Result<CarrierFrame> {
        let (space, head) = (frame.space.normalized(), &frame.head);
        let dt = if frame.dt.is_finite() { f64::from(frame.dt.max(0.0)) } else { 0.0 };
        let times = (dt, f64::from(params.step));
        if let Some(map) = self.motion.carrier.enter(&space, head, &self.motion.clock, times) {
            self.motion.clock.enter(&map);
            self.colliders.enter(&map);
        }
        let ticks = self.motion.clock.tick(frame.dt, params.step, head);
        let world = Field::of(params.gravity, params.wind.velocity);
        let carrier_frame = self.motion.carrier.advance(
            &space,
            (&self.motion.clock, &ticks),
            times,
            self.asset.extent.0,
            &world,
        );
        let moments = Moments {
            steps: &carrier_frame.steps,
            substeps: params.substep_count,
            step: params.step,
            head: frame.map_to_drawn().pose(head),
            alpha: ticks.alpha,
        };
        let journey = Journey { head: *head, passage: carrier_frame.passage };
        self.colliders.journey(frame.colliders, &moments, &journey)?;
        self.motion.passage = carrier_frame.passage;
        self.motion.states.2 = ticks.alpha;
        if !ticks.steps.is_empty() {
            self.motion.span = params.step;
        }
        self.motion.has_jumped = ticks.steps.iter().any(|step| step.mode != Mode::Step);
        for step in &carrier_frame.steps {
            self.motion.states = match step.mode {
                Mode::Step => (step.begin, step.end, ticks.alpha),
                Mode::Rigid | Mode::Reset => (step.end, step.end, ticks.alpha),
            };
        }
        Ok(carrier_frame)
    }

    /// Writes the uniforms of the stages after the guides.
    pub(crate) fn prepare(&mut self, frame: &HairFrame<'_>) {
        let to_drawn_space = frame.map_to_drawn();
        self.motion.head = to_drawn_space.pose(&frame.head);
        self.motion.drawn_in = frame.drawn_space();
        self.motion.to_drawn = to_drawn_space.after(&self.motion.passage.at(1.0).inverse()).as_pose();
        let (previous, current, blend) = self.motion.states;
        let drawn = (blend, self.simulation.twists());
        let params = TessellateParams::new(
            &self.guides,
            (&previous, &current, self.motion.span),
            &self.motion.head,
            drawn,
        );
        self.curves.tessellation.prepare(&params);
        self.curves.interpolation.prepare(&self.guides, &self.strands);
        let counts = (&self.guides, &self.strands);
        let fresh = self.lod.begin();
        self.avoidance.prepare(counts, frame.dt, self.motion.has_jumped, fresh);
    }

    /// Records step `i` of the guides: forces, links and grab, then the step itself.
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

    /// Records step `i` of the density grid.
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
