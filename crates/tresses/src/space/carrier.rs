//! The frame in which hair is simulated: its origin goes with a point of the space, its axes do not turn.
//!
//! With the origin at `O(t)` a vertex at `x` obeys `x'' = F/m + g - O''`: the acceleration of the origin is all that
//! there is to add, and it is the same for all hair. A point that goes with the space is at `R(t) (p - o)`, `R` being
//! the space's rotation and `o` the origin's place in it; the space's own place drops out of everything but `O''`
//! and the gusts of the world's wind.

use super::{FAR, FASTEST, JOLT, Space};
use crate::{
    Pose,
    clock::{Clock, MAX_STEPS, Mode, Step, Ticks},
    math::map::Map,
};
use glam::{DQuat, DVec3, Vec3};

/// The way from a space into the carrier during a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Passage {
    from: DQuat,
    to: DQuat,
    axes: DQuat,
    fixed: DVec3,
}

impl Passage {
    /// At the fraction `f` of the frame's motion.
    pub fn at(&self, f: f32) -> Map {
        let rotation = relative(self.axes, self.turned(f));
        Map { rotation, translation: -(rotation * self.fixed) }
    }

    /// How the space is turned in the world then.
    fn turned(&self, f: f32) -> DQuat {
        if self.from == self.to || f >= 1.0 { self.to } else { self.from.slerp(self.to, f.into()) }
    }
}

/// What acts in a step, in the axes of the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Field {
    /// The acceleration of what falls freely, as the carrier has it, m/s².
    pub gravity: Vec3,
    /// Velocity of the undisturbed air at the origin, m/s.
    pub wind: Vec3,
    /// How it turns about the origin, radians per second.
    pub spin: Vec3,
    /// By how much the velocity of all air changes with the step, because that of the carrier does, m/s.
    pub kick: Vec3,
    /// The mean velocity of the air over its own ground, m/s.
    pub own: Vec3,
    /// Where the origin is over that ground, metres.
    pub at: DVec3,
}

impl Field {
    /// Where nothing moves but the air.
    pub fn of(gravity: Vec3, wind: Vec3) -> Self {
        Self { gravity, wind, spin: Vec3::ZERO, kick: Vec3::ZERO, own: wind, at: DVec3::ZERO }
    }
}

/// What the state on the GPU becomes because the carrier's origin is another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shift {
    /// What is added to positions, whole metres.
    pub way: Vec3,
    /// What is added to velocities, m/s.
    pub velocity: Vec3,
}

/// A frame as the carrier has it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carried {
    /// Its steps.
    pub steps: Vec<Step>,
    /// What acts in each.
    pub fields: Vec<Field>,
    /// From the space to the carrier.
    pub passage: Passage,
    /// What comes before the first step.
    pub shift: Option<Shift>,
}

/// The frame that carries one groom.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carrier {
    /// The space of the frame before; none before the first.
    before: Option<Space>,
    /// Where in the space the origin is, metres.
    fixed: DVec3,
    /// The axes in the world.
    axes: DQuat,
    /// When the last step ended: how the space was turned, where the origin was in the world, and its velocity, m/s.
    rotation: DQuat,
    origin: DVec3,
    velocity: Option<DVec3>,
    /// The velocity of the frame before, where that would have been a jump.
    candidate: Option<DVec3>,
}

impl Carrier {
    /// Before the clock's tick of a frame of `dt` seconds. Where the head stays in the world but is given in another
    /// space than before: what takes poses of the old one into the new.
    pub fn enter(
        &mut self,
        space: &Space,
        head: &Pose,
        clock: &Clock,
        (dt, step): (f64, f64),
    ) -> Option<Map> {
        let before = self.before.filter(|before| !before.is_where(space))?;
        let state = clock.state()?;
        let steps = clock.steps_to(dt, step);
        let way = self.velocity.unwrap_or_default() * dt;
        let there = Space { at: before.at + way, ..before };
        let map = space.from(&there);
        let stays = map.pose(state);
        // No carrier feels a motion of its origin like this one: nothing is lost where it was none.
        let came = space.at - there.at + space.rotation * self.fixed - before.rotation * self.fixed;
        let leaps = came.length() > JOLT * dt && clock.way(&stays, head) < clock.way(state, head);
        if !(leaps || clock.jumps(state, head, steps)) || clock.jumps(&stays, head, steps) {
            return None;
        }
        self.fixed = map.point(self.fixed);
        self.rotation = match self.rotation == before.rotation {
            true => space.rotation,
            false => (self.rotation * map.rotation.inverse()).normalize(),
        };
        self.before = Some(Space { at: space.at - way, ..*space });
        Some(map)
    }

    /// The frame that `ticks` says, `dt` seconds after the last, as the carrier has it. `middle` is that of the hair
    /// at rest, groom space; `world` has gravity and wind in the axes of the world.
    pub fn carry(
        &mut self,
        space: &Space,
        (clock, ticks): (&Clock, &Ticks),
        (dt, step): (f64, f64),
        middle: Vec3,
        world: &Field,
    ) -> Carried {
        let first = ticks.steps.first();
        let mode = first.map(|step| step.mode);
        // Of the first frame nothing is known that it could be compared with.
        let since = if self.before.is_some() { dt } else { 0.0 };
        let before = self.before.unwrap_or(*space);
        if mode == Some(Mode::Reset) {
            *self = Self { axes: space.rotation, rotation: space.rotation, ..Self::default() };
        }
        self.before = Some(*space);
        // A space that is suddenly turned takes the carrier's axes along.
        let turn = clock.teleport_angle * (dt / step).clamp(1.0, MAX_STEPS.into()) as f32;
        if self.rotation.angle_between(space.rotation) > f64::from(turn) {
            let still = self.axes == self.rotation;
            let turned = space.rotation * self.rotation.inverse() * self.axes;
            self.axes = if still { space.rotation } else { turned.normalize() };
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
            // Where hair is that the step moves, or where it has been put.
            let pose = match first.mode {
                Mode::Step => start.at(0.0).pose(&first.begin),
                Mode::Carry | Mode::Reset => start.at(1.0).pose(&first.end),
            };
            let strayed = pose.point(middle) - middle;
            if strayed.abs().max_element() > FAR {
                let turned = if first.mode == Mode::Step { self.rotation } else { space.rotation };
                shift = Some(self.move_origin(strayed.round(), turned, angular));
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
        let mut carried = Carried { passage, ..Carried::default() };
        let mut last: Option<Pose> = None;
        for tick in &ticks.steps {
            let (begin, to, part) = match tick.mode {
                Mode::Step => {
                    let begin = last.unwrap_or_else(|| passage.at(tick.from).pose(&tick.begin));
                    (begin, tick.to, f64::from(tick.to) - f64::from(tick.from))
                }
                // What is carried was where the origin had been.
                Mode::Carry => (start.at(0.0).pose(&tick.begin), 1.0, 0.0),
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
            if let Some(Shift { velocity, .. }) = shift.filter(|_| carried.fields.is_empty()) {
                field.kick += velocity;
            }
            carried.fields.push(field);
            carried.steps.push(Step { begin, end, ..*tick });
        }
        match ticks.steps.last() {
            Some(tick) if tick.mode == Mode::Step => {
                self.rotation = passage.turned(tick.to);
                self.origin = self.origin.lerp(origin, tick.to.into());
                let rest = if ticks.skipped > 0.0 { 1.0 } else { f64::from(tick.to) };
                self.velocity = self.velocity.map(|_| velocity + change * rest);
                carried.shift = shift;
            }
            Some(_) => (self.rotation, self.origin) = (space.rotation, origin),
            None => {}
        }
        carried
    }

    /// By how much faster this goes than another's, where both are known, m/s in its own axes.
    pub fn faster_than(&self, other: &Self) -> Vec3 {
        match (self.velocity, other.velocity) {
            (Some(own), Some(other)) => (self.axes.inverse() * (own - other)).as_vec3(),
            _ => Vec3::ZERO,
        }
    }

    /// From the space to the carrier as that is now.
    fn passage(&self, space: &Space) -> Passage {
        Passage { from: self.rotation, to: space.rotation, axes: self.axes, fixed: self.fixed }
    }

    /// Takes the origin `way` metres away, in its axes, in a space that is `turned` and turns by `angular`.
    fn move_origin(&mut self, way: Vec3, turned: DQuat, angular: DVec3) -> Shift {
        let there = relative(self.axes, turned).inverse() * way.as_dvec3();
        let faster = angular.cross(turned * there);
        self.fixed += there;
        self.origin += turned * there;
        self.velocity = self.velocity.map(|v| v + faster);
        Shift { way: -way, velocity: -(self.axes.inverse() * faster).as_vec3() }
    }

    /// The origin's velocity when the last step ended, and by how much it has changed in the frame, m/s.
    fn moves(&mut self, space: &Space, before: &Space, dt: f64, angular: DVec3) -> (DVec3, DVec3) {
        let known = self.velocity.unwrap_or_default();
        let tolerance = 4.0 * f64::EPSILON * space.at.abs().max(before.at.abs()) / dt;
        let now = match space.velocity {
            Some(velocity) => velocity.linear + angular.cross(space.rotation * self.fixed),
            None if dt > 0.0 => {
                let arm = space.rotation * self.fixed - before.rotation * self.fixed;
                let v = (space.at - before.at + arm) / dt;
                // What is left of rounding is no motion.
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

    /// What acts where the carrier has the velocity `v`, which has changed by `change` in the step, and is `at` a
    /// place of the world.
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
        let gravity = to_axes.turned(world.gravity);
        if space.carries_air {
            let own = map.turned(wind);
            let spin = to_axes.point(angular).as_vec3();
            return Field { spin, at: map.rotation * self.fixed, ..Field::of(gravity, own) };
        }
        let own = to_axes.turned(wind);
        let still = Field { at: to_axes.point(at), ..Field::of(gravity, own) };
        if v == DVec3::ZERO || v.length() > FASTEST {
            return still;
        }
        let felt = (own.as_dvec3() - to_axes.point(v)).as_vec3();
        // Slower air than a millimetre per second is calm.
        let felt = if felt.length() < 1e-3 { Vec3::ZERO } else { felt };
        Field { wind: felt, kick: -to_axes.point(change).as_vec3(), ..still }
    }
}

/// The rotation from what is turned by `b` to what is turned by `a`; exactly the identity where they are the same.
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
