//! The frame of reference in which hair is simulated: its origin moves with a point of the space, its axes do not
//! rotate.
//!
//! With the origin at `O(t)`, a vertex at `x` obeys `x'' = F/m + g - O''`. The only extra term is the acceleration of
//! the origin, which is the same for all hair. A point `p` that is fixed in the space is at `R(t) (p - o)` in the
//! carrier, where `R` is the space's rotation and `o` the origin's position in it. The space's own place affects only
//! `O''` and the gusts of the world's wind.

use super::{FAR, FASTEST, JOLT, Space};
use crate::{
    Pose,
    clock::{MAX_STEPS, Mode, Step, StepClock, Ticks},
    math::map::Map,
};
use glam::{DQuat, DVec3, Vec3};

/// The transform from a space to the carrier during a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Passage {
    from: DQuat,
    to: DQuat,
    axes: DQuat,
    fixed: DVec3,
}

impl Passage {
    /// Returns the transform at the fraction `f` of the frame's motion.
    pub fn at(&self, f: f32) -> Map {
        let rotation = relative(self.axes, self.rotation_at(f));
        Map { rotation, translation: -(rotation * self.fixed) }
    }

    /// Returns the space's rotation in the world at `f`.
    fn rotation_at(&self, f: f32) -> DQuat {
        if self.from == self.to || f >= 1.0 { self.to } else { self.from.slerp(self.to, f.into()) }
    }
}

/// Gravity and air in one step, in the axes of the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Field {
    /// Acceleration in free fall relative to the carrier, m/s².
    pub gravity: Vec3,
    /// Velocity of the undisturbed air at the origin, m/s.
    pub wind: Vec3,
    /// Angular velocity of the air about the origin, rad/s.
    pub spin: Vec3,
    /// Change of all air's velocity in this step because the carrier's velocity changes, m/s.
    pub kick: Vec3,
    /// Mean velocity of the air relative to its ground (the world or the cabin), m/s.
    pub own: Vec3,
    /// Position of the origin relative to that ground, meters.
    pub at: DVec3,
}

impl Field {
    /// Creates the field for a carrier at rest.
    pub fn of(gravity: Vec3, wind: Vec3) -> Self {
        Self { gravity, wind, spin: Vec3::ZERO, kick: Vec3::ZERO, own: wind, at: DVec3::ZERO }
    }
}

/// Change of the GPU state when the carrier's origin moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shift {
    /// Offset added to positions, whole meters.
    pub offset: Vec3,
    /// Offset added to velocities, m/s.
    pub velocity: Vec3,
}

/// A frame relative to the carrier.
#[derive(Clone, Debug, Default)]
pub(crate) struct CarrierFrame {
    /// The steps of the frame.
    pub steps: Vec<Step>,
    /// Gravity and air in each step.
    pub fields: Vec<Field>,
    /// Transform from the space to the carrier.
    pub passage: Passage,
    /// Shift to apply before the first step.
    pub shift: Option<Shift>,
}

impl CarrierFrame {
    /// Returns the displacement of all positions by the shift, meters.
    pub fn displacement(&self) -> Vec3 {
        self.shift.as_ref().map_or(Vec3::ZERO, |shift| shift.offset)
    }
}

/// The carrier of one groom.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carrier {
    /// Space of the last frame; `None` before the first.
    before: Option<Space>,
    /// Position of the origin in the space, meters.
    fixed: DVec3,
    /// Orientation of the carrier's axes in the world.
    axes: DQuat,
    /// State at the end of the last step: rotation of the space, position of the origin in the world, and its velocity,
    /// m/s.
    rotation: DQuat,
    origin: DVec3,
    velocity: Option<DVec3>,
    /// Velocity measured in the last frame, if it was rejected as a jump.
    candidate: Option<DVec3>,
}

impl Carrier {
    /// Detects a change of coordinates: the head stays in the world but is given in another space than before. Returns
    /// the map from the old space to the new one in that case. Call it before the clock's tick of a frame of `dt`
    /// seconds.
    pub fn enter(
        &mut self,
        space: &Space,
        head: &Pose,
        clock: &StepClock,
        (dt, step): (f64, f64),
    ) -> Option<Map> {
        let before = self.before.filter(|before| !before.is_where(space))?;
        let state = clock.state()?;
        let steps = clock.steps_to(dt, step);
        let displacement = self.velocity.unwrap_or_default() * dt;
        let predicted = Space { at: before.at + displacement, ..before };
        let map = space.from(&predicted);
        let stays = map.pose(state);
        // Such an unexpected displacement of the origin is a jump and exerts no force, so reinterpreting it loses no
        // motion.
        let came = space.at - predicted.at + space.rotation * self.fixed - before.rotation * self.fixed;
        let leaps = came.length() > JOLT * dt
            && clock.relative_motion(&stays, head) < clock.relative_motion(state, head);
        if !(leaps || clock.jumps(state, head, steps)) || clock.jumps(&stays, head, steps) {
            return None;
        }
        self.fixed = map.point(self.fixed);
        self.rotation = match self.rotation == before.rotation {
            true => space.rotation,
            false => (self.rotation * map.rotation.inverse()).normalize(),
        };
        self.before = Some(Space { at: space.at - displacement, ..*space });
        Some(map)
    }

    /// Converts the frame described by `ticks`, `dt` seconds after the last one, to the carrier. `center` is the center
    /// of the hair at rest, groom space. `world` contains gravity and wind in the axes of the world.
    pub fn advance(
        &mut self,
        space: &Space,
        (clock, ticks): (&StepClock, &Ticks),
        (dt, step): (f64, f64),
        center: Vec3,
        world: &Field,
    ) -> CarrierFrame {
        let first = ticks.steps.first();
        let mode = first.map(|step| step.mode);
        // The first frame has no predecessor to measure a velocity from.
        let since = if self.before.is_some() { dt } else { 0.0 };
        let before = self.before.unwrap_or(*space);
        if mode == Some(Mode::Reset) {
            *self = Self { axes: space.rotation, rotation: space.rotation, ..Self::default() };
        }
        self.before = Some(*space);
        // A space that turns abruptly turns the carrier's axes with it.
        let max_angle = clock.teleport_angle * (dt / step).clamp(1.0, MAX_STEPS.into()) as f32;
        if self.rotation.angle_between(space.rotation) > f64::from(max_angle) {
            let still = self.axes == self.rotation;
            let rotated_axes = space.rotation * self.rotation.inverse() * self.axes;
            self.axes = if still { space.rotation } else { rotated_axes.normalize() };
            self.rotation = space.rotation;
        }
        let angular = match space.velocity {
            Some(velocity) => velocity.angular,
            None if dt > 0.0 && before.rotation != space.rotation => {
                let q = relative(before.rotation.inverse(), space.rotation.inverse()).inverse();
                let q = if q.w < 0.0 { -q } else { q };
                q.to_scaled_axis() / dt
            }
            None => DVec3::ZERO,
        };
        let start = self.passage(space);
        let mut shift = None;
        if let Some(first) = first {
            // The pose from which the step moves the hair, or at which it is placed.
            let pose = match first.mode {
                Mode::Step => start.at(0.0).pose(&first.begin),
                Mode::Rigid | Mode::Reset => start.at(1.0).pose(&first.end),
            };
            let strayed = pose.point(center) - center;
            if strayed.abs().max_element() > FAR {
                let rotation = if first.mode == Mode::Step { self.rotation } else { space.rotation };
                shift = Some(self.move_origin(strayed.round(), rotation, angular));
            }
        }
        let origin = space.at + space.rotation * self.fixed;
        if mode == Some(Mode::Reset) {
            self.origin = origin;
        }
        let (velocity, change) = self.moves(space, &before, since, angular);
        let felt = if dt > 0.0 { (dt - f64::from(ticks.skipped)).max(0.0) / dt } else { 0.0 };
        let change = if mode == Some(Mode::Step) { change * felt } else { DVec3::ZERO };
        let passage = self.passage(space);
        let mut frame = CarrierFrame { passage, ..CarrierFrame::default() };
        let mut last: Option<Pose> = None;
        for tick in &ticks.steps {
            let (begin, to, part) = match tick.mode {
                Mode::Step => {
                    let begin = last.unwrap_or_else(|| passage.at(tick.from).pose(&tick.begin));
                    (begin, tick.to, f64::from(tick.to) - f64::from(tick.from))
                }
                // Carried hair was where the origin had been.
                Mode::Rigid => (start.at(0.0).pose(&tick.begin), 1.0, 0.0),
                Mode::Reset => (passage.at(1.0).pose(&tick.begin), 1.0, 0.0),
            };
            let end = passage.at(to).pose(&tick.end);
            last = Some(end);
            let v = velocity + change * f64::from(to);
            let at = self.origin.lerp(origin, to.into());
            let mut field = self.field(space, world, &passage.at(to), (v, change * part, at), angular);
            if change != DVec3::ZERO {
                let pull = self.axes.inverse() * (change * (part / step));
                field.gravity = (field.gravity.as_dvec3() - pull).as_vec3();
            }
            if let Some(Shift { velocity, .. }) = shift.filter(|_| frame.fields.is_empty()) {
                field.kick += velocity;
            }
            frame.fields.push(field);
            frame.steps.push(Step { begin, end, ..*tick });
        }
        match ticks.steps.last() {
            Some(tick) if tick.mode == Mode::Step => {
                self.rotation = passage.rotation_at(tick.to);
                self.origin = self.origin.lerp(origin, tick.to.into());
                let rest = if ticks.skipped > 0.0 { 1.0 } else { f64::from(tick.to) };
                self.velocity = self.velocity.map(|_| velocity + change * rest);
                frame.shift = shift;
            }
            Some(_) => (self.rotation, self.origin) = (space.rotation, origin),
            None => {}
        }
        frame
    }

    /// Returns the velocity relative to another carrier, in this one's axes, m/s; zero where either is unknown.
    pub(crate) fn faster_than(&self, other: &Self) -> Vec3 {
        match (self.velocity, other.velocity) {
            (Some(own), Some(other)) => (self.axes.inverse() * (own - other)).as_vec3(),
            _ => Vec3::ZERO,
        }
    }

    /// Returns the transform from `space` to the carrier in its current state.
    fn passage(&self, space: &Space) -> Passage {
        Passage { from: self.rotation, to: space.rotation, axes: self.axes, fixed: self.fixed }
    }

    /// Moves the origin by `offset` meters in the carrier's axes. The space has `rotation` and the angular velocity
    /// `angular`.
    fn move_origin(&mut self, offset: Vec3, rotation: DQuat, angular: DVec3) -> Shift {
        let space_offset = relative(self.axes, rotation).inverse() * offset.as_dvec3();
        let faster = angular.cross(rotation * space_offset);
        self.fixed += space_offset;
        self.origin += rotation * space_offset;
        self.velocity = self.velocity.map(|v| v + faster);
        Shift { offset: -offset, velocity: -(self.axes.inverse() * faster).as_vec3() }
    }

    /// Returns the origin's velocity at the end of the last step, and its change in this frame, m/s.
    fn moves(&mut self, space: &Space, before: &Space, dt: f64, angular: DVec3) -> (DVec3, DVec3) {
        let known = self.velocity.unwrap_or_default();
        let tolerance = 4.0 * f64::EPSILON * space.at.abs().max(before.at.abs()) / dt;
        let now = match space.velocity {
            Some(velocity) => velocity.linear + angular.cross(space.rotation * self.fixed),
            None if dt > 0.0 => {
                let arm = space.rotation * self.fixed - before.rotation * self.fixed;
                let v = (space.at - before.at + arm) / dt;
                // Values below the rounding error are not motion.
                DVec3::select(v.abs().cmple(tolerance), DVec3::ZERO, v)
            }
            None => return (known, DVec3::ZERO),
        };
        let Some(known) = self.velocity else {
            self.velocity = Some(now);
            return (now, DVec3::ZERO);
        };
        let mut change = now - known;
        if space.velocity.is_none() {
            change = DVec3::select(change.abs().cmple(2.0 * tolerance), DVec3::ZERO, change);
        }
        if change.length() <= JOLT {
            self.candidate = None;
            return (known, change);
        }
        let goes_on = self.candidate.is_some_and(|candidate| candidate.distance(now) <= JOLT);
        self.candidate = (!goes_on).then_some(now);
        self.velocity = Some(if goes_on { now } else { known });
        (self.velocity.unwrap_or_default(), DVec3::ZERO)
    }

    /// Returns gravity and air for a step in which the carrier's velocity has changed by `change` to `v`, with the
    /// origin `at` a position in the world.
    fn field(
        &self,
        space: &Space,
        world: &Field,
        map: &Map,
        (v, change, at): (DVec3, DVec3, DVec3),
        angular: DVec3,
    ) -> Field {
        let to_axes = Map { rotation: relative(self.axes, DQuat::IDENTITY), translation: DVec3::ZERO };
        let wind = world.wind;
        let gravity = to_axes.vector(world.gravity);
        if space.moves_air {
            let own = map.vector(wind);
            let spin = to_axes.point(angular).as_vec3();
            return Field { spin, at: map.rotation * self.fixed, ..Field::of(gravity, own) };
        }
        let own = to_axes.vector(wind);
        let still = Field { at: to_axes.point(at), ..Field::of(gravity, own) };
        if v == DVec3::ZERO || v.length() > FASTEST {
            return still;
        }
        let felt = (own.as_dvec3() - to_axes.point(v)).as_vec3();
        // Below a millimeter per second the air counts as calm.
        let felt = if felt.length() < 1e-3 { Vec3::ZERO } else { felt };
        Field { wind: felt, kick: -to_axes.point(change).as_vec3(), ..still }
    }
}

/// Returns `a⁻¹ b`: the rotation from axes turned by `b` to axes turned by `a`. Exactly the identity if they are equal.
fn relative(a: DQuat, b: DQuat) -> DQuat {
    if a == b {
        DQuat::IDENTITY
    } else if a == DQuat::IDENTITY {
        b
    } else {
        (a.inverse() * b).normalize()
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
