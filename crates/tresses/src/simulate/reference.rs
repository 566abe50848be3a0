//! CPU reference of `step.wesl` and, with twist, of `twist.wesl`: the same operations on one strand. Only the order
//! differs: the kernel sums the contacts of a vertex first.

mod twisting;

use super::params::{BRAKE, StepUniforms, bending_rate};
use crate::clock::Mode;
use crate::strands::{
    Guide, GuideForce, GuideRest, GuideShape,
    guide::{TIP_PINNED, pack_velocity, unpack_velocity},
};
use crate::{
    Pose,
    collide::{Collider, FieldVolume, Shape, shape},
    math::{
        ldl::Factors,
        rotation::{self, minimal_rotation},
    },
};
use glam::{Mat3, Quat, Vec3};

/// Contact stiffness: a vertex yields by 1/100 of the distance it would penetrate in a substep.
const CONTACT: f32 = 100.0;
/// Largest speed at which a penetrating vertex is pushed out, m/s.
const PUSH_OUT: f32 = 0.5;
/// Distance outside an obstacle up to which a contact persists, as a multiple of gravity times the squared substep.
const AHEAD: f32 = 2.0;
/// Largest ratio of tangential to normal stiffness of a sticking contact.
const STICK: f32 = 1e3;
/// Largest ratio of an edge's length to its rest length after a step. Compression has the same limit.
const MAX_STRAIN: f32 = 1.008;
/// Smallest edge length to divide by, as a fraction of the mean edge.
const LEAST_EDGE: f32 = 0.05;
/// Speed of a vertex, m/s, above which its strand is reset to rest.
const MAX_SPEED: f32 = 300.0;

/// One simulated strand.
#[derive(Clone, Debug)]
pub(crate) struct Strand {
    pub guide: Guide,
    pub rest: Vec<GuideRest>,
    pub shape: Vec<GuideShape>,
    pub previous: Vec<Vec3>,
    pub current: Vec<Vec3>,
    pub velocity: Vec<Vec3>,
    /// Twist of the frame of the edge after each vertex relative to the frame of the edge before it, radians.
    pub twisted: Vec<f32>,
    pub forces: Vec<GuideForce>,
}

/// Colliders of strands.
#[derive(Clone, Copy, Default)]
pub(crate) struct Obstacles<'a> {
    /// The colliders; the head's field first, if there is one.
    pub colliders: &'a [Collider],
    /// The fields that colliders refer to by `FieldId`.
    pub volumes: &'a [FieldVolume],
    /// The poses at all moments, collider fastest, in the order of `ColliderSet::moments`.
    pub places: &'a [Pose],
}

/// Rounds a velocity to its packed precision.
fn remembered(v: Vec3) -> Vec3 {
    unpack_velocity(pack_velocity(v))
}

fn nlerp(a: [f32; 4], b: [f32; 4], t: f32) -> Quat {
    rotation::nlerp(Quat::from_array(a), Quat::from_array(b), t)
}

/// Returns the displacement of `v` by the rotation `q`.
fn turned_by(q: Quat, v: Vec3) -> Vec3 {
    let axis = q.xyz();
    let t = 2.0 * axis.cross(v);
    q.w * t + axis.cross(t)
}

fn outer(a: Vec3, b: Vec3) -> Mat3 {
    Mat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Adds the contact of a vertex at depth `depth` in an obstacle with normal `n`. `slip` is the vertex's displacement
/// relative to the obstacle in this substep.
fn contact(u: &StepUniforms, depth: f32, n: Vec3, slip: Vec3, friction: f32, m: &mut Mat3, f: &mut Vec3) {
    let h = u.h;
    let k = CONTACT / (h * h);
    let along = n.dot(slip);
    let push = depth.min((-along).max(0.0) + PUSH_OUT * h);
    let tangential = slip - n * along;
    let kt = k * (friction * push.max(0.0) / (tangential.length() + u.slip).max(1e-15)).min(STICK);
    *m += outer(n, n) * (k - kt) + Mat3::from_diagonal(Vec3::splat(kt));
    *f += n * (k * push) - tangential * kt;
}

/// Returns the deviation of the bend at vertex `j` from its target `t`, damping included, and the target's derivative
/// with respect to the edge before. The square of that edge's length counts as at least `least`.
fn bend(p: &[Vec3], v: &[Vec3], j: usize, t: Vec3, least: f32, damping: f32) -> (Vec3, Mat3) {
    let e = p[j] - p[j - 1];
    let inverse = 1.0 / e.length_squared().max(least);
    let a = Mat3::from_diagonal(Vec3::splat(e.dot(t) * inverse)) - outer(e * inverse, t);
    (p[j + 1] - p[j] - t + (v[j + 1] - v[j] - a * (v[j] - v[j - 1])) * damping, a)
}

/// Compares bits, so that NaN counts as too fast.
fn too_fast(v: Vec3) -> bool {
    v.length_squared().to_bits() & 0x7fff_ffff > (MAX_SPEED * MAX_SPEED).to_bits()
}

impl Strand {
    /// Returns a strand at rest in the pose of its rest vertices, head upright.
    pub fn at_rest(guide: Guide, rest: Vec<GuideRest>, shape: Vec<GuideShape>) -> Self {
        let current: Vec<_> = rest.iter().map(|r| r.position).collect();
        Self {
            guide,
            rest,
            shape,
            previous: current.clone(),
            velocity: vec![Vec3::ZERO; current.len()],
            twisted: vec![0.0; current.len()],
            forces: vec![GuideForce::default(); current.len()],
            current,
        }
    }

    /// Simulates one fixed step.
    pub fn step(&mut self, u: &StepUniforms, obstacles: &Obstacles) {
        let n = self.rest.len();
        self.previous.copy_from_slice(&self.current);
        let head_end = Quat::from_array(u.head_end);
        if u.mode == Mode::Reset as u32 {
            return self.reset(u);
        }
        if u.mode == Mode::Carry as u32 {
            let turn = (head_end * Quat::from_array(u.head_begin).conjugate()).normalize();
            for i in 0..n {
                self.current[i] = u.head_end_at + turn * (self.current[i] - u.head_begin_at);
                self.velocity[i] = remembered(turn * self.velocity[i]);
            }
            self.previous.copy_from_slice(&self.current);
            return;
        }
        let origin = self.current[0];
        let edge = self.guide.length / (n.max(2) - 1) as f32;
        let inverse_edge = 1.0 / edge.max(1e-6);
        let square = inverse_edge * inverse_edge;
        let least = LEAST_EDGE * LEAST_EDGE * edge * edge;
        let stretch = u.stretch * self.guide.length * square;
        let tip_pinned = self.guide.flags & TIP_PINNED != 0;
        let h = u.h;
        let mut p: Vec<Vec3> = self.current.iter().map(|c| *c - origin).collect();
        let mut v = self.velocity.clone();
        let mut twisted = self.twisted.clone();
        let rate = |j: usize| {
            let fade = (j as f32 * edge * u.bending_falloff).min(1.0);
            let bare = self.guide.stiffness * (u.bending_root + (u.bending_tip - u.bending_root) * fade);
            let rest_e = self.rest[j].position - self.rest[j - 1].position;
            let rest_next = self.rest[j + 1].position - self.rest[j].position;
            bending_rate(bare * square * square, j, rest_e, rest_next, if u.twist > 0.0 { 0.0 } else { h })
        };
        let resting = if u.twist > 0.0 { self.resting_twist(rate) } else { Vec::new() };
        let mut bad = false;
        let mut twist = vec![0f32; n];
        let mut target = vec![Vec3::ZERO; n];
        let mut carried = vec![Vec3::ZERO; n];
        let mut rows = vec![(Mat3::ZERO, Mat3::ZERO, Vec3::ZERO); n];
        for sub in 0..u.substeps {
            let t = (sub + 1) as f32 / u.substeps as f32;
            let moment = (u.moment + sub + 1) as usize;
            let head = nlerp(u.head_begin, u.head_end, t);
            let head_at = u.head_begin_at.lerp(u.head_end_at, t) - origin;
            // Root to tip: predict, and carry the frames along the strand.
            let mut kept = p[0];
            let mut q = head;
            let mut rest_e = Vec3::ZERO;
            for i in 0..n {
                let follows = i < 2 || (tip_pinned && i == n - 1);
                let old = if follows { p[i] } else { kept + self.guard(i - 1, p[i] - kept) };
                kept = old;
                if follows {
                    let y = head * self.rest[i].position + head_at;
                    v[i] = (y - old) / h;
                    p[i] = y;
                } else {
                    v[i] += (old - p[i]) / h;
                    p[i] = old + v[i] * h;
                }
                if i == 0 {
                    continue;
                }
                let rest_next = self.rest[i].position - self.rest[i - 1].position;
                if i > 1 {
                    let j = i - 1;
                    target[j] = q * (rest_e + self.shape[j].curvature);
                    carried[j] = q * rest_next / rest_next.length().max(1e-9);
                    q = (minimal_rotation(carried[j], p[i] - p[j]) * q).normalize();
                    if u.twist > 0.0 {
                        let axis = (p[i] - p[j]).normalize_or_zero();
                        q = Quat::from_axis_angle(axis, twisted[j]) * q;
                    }
                }
                rest_e = rest_next;
            }
            let load = |i: usize, y: Vec3, v: Vec3| {
                self.load(u, obstacles, i, moment, origin, (head, head_at), y, v, edge)
            };
            if u.twist > 0.0 {
                let frames = [&target[..], &carried];
                self.solve_twisting(u, &mut p, &mut v, &mut twisted, &resting, frames, &load, &rate);
                bad |= v.iter().any(|v| too_fast(*v));
                continue;
            }
            // Tip to root: the torque of the bends below about each edge.
            let mut torque = Vec3::ZERO;
            for j in (1..n - 1).rev() {
                let e_next = p[j + 1] - p[j];
                let unit = e_next / e_next.length().max(1e-9);
                let sum = 1.0 / (1.0 + carried[j].dot(unit)).max(0.1);
                twist[j] = torque.dot(unit) * sum;
                let (s, _) = bend(&p, &v, j, target[j], least, u.bending_damping);
                torque = (carried[j] + unit) * twist[j] - target[j].cross(s) * rate(j);
            }
            // Root to tip: assemble and eliminate.
            let (mut d0, mut d1, mut u0) = (Mat3::ZERO, Mat3::ZERO, Mat3::ZERO);
            let (mut g0, mut g1) = (Vec3::ZERO, Vec3::ZERO);
            for j in 1..n - 1 {
                let i = j + 1;
                let tip = i == n - 1;
                let y = p[i];
                // The load on the vertex alone, per unit of weight.
                let (m, f) = load(i, y, v[i]);
                let weight = if tip { 0.5 } else { 1.0 };
                // The edge as a spring.
                let e_next = y - p[j];
                let length = e_next.length().max(1e-9);
                let unit = e_next / length;
                let tension = stretch * (length - self.shape[j].length);
                let slack = (tension / length).max(0.0);
                let k = outer(unit, unit) * (stretch - slack) + Mat3::from_diagonal(Vec3::splat(slack));
                // The bend between the two edges: s = e_next - t, where t follows e.
                let e = p[j] - p[j - 1];
                let inverse = 1.0 / e.length_squared().max(least);
                let t_j = target[j];
                let kb = rate(j);
                let (s, a) = bend(&p, &v, j, t_j, least, u.bending_damping);
                let km = kb * (1.0 + u.bending_damping / h);
                let at = a.transpose();
                let ata = at * a;
                let ats = at * s;
                let sine = e.cross(t_j).length_squared() * inverse / t_j.length_squared().max(1e-18);
                let brake = Mat3::from_diagonal(Vec3::splat(BRAKE * km * sine));
                // The torque from below, which turns the frames above.
                let from_e = (carried[j] + unit).cross(e) * (twist[j] * inverse);
                let from_next = carried[j].cross(unit) * (-twist[j] / length.max(least.sqrt()));
                d0 += ata * km + brake;
                u0 -= (at + ata) * km + brake;
                let c0 = at * km;
                d1 += k + (Mat3::IDENTITY + a + at + ata) * km + brake;
                let mut u1 = (k + (Mat3::IDENTITY + at) * km) * -1.0;
                let mut d2 = m * weight + k + Mat3::from_diagonal(Vec3::splat(km));
                g0 += from_e - ats * kb;
                g1 += unit * tension + (s + ats) * kb + from_next - from_e;
                let mut g2 = f * weight - unit * tension - s * kb - from_next;
                // Eliminate the row before.
                if j > 2 {
                    let inv = Factors::new(d0);
                    let (x, z, r) = (inv.solve_columns(u0), inv.solve_columns(c0), inv.solve(g0));
                    rows[j - 1] = (x, z, r);
                    let (u0t, c0t) = (u0.transpose(), c0.transpose());
                    d1 -= u0t * x;
                    u1 -= u0t * z;
                    d2 -= c0t * z;
                    g1 -= u0t * r;
                    g2 -= c0t * r;
                }
                (d0, d1, u0) = (d1, d2, u1);
                (g0, g1) = (g1, g2);
            }
            if n < 3 {
                continue;
            }
            // Rows n - 2 and n - 1 remain.
            if n > 3 {
                let inv = Factors::new(d0);
                let (x, r) = (inv.solve_columns(u0), inv.solve(g0));
                rows[n - 2] = (x, Mat3::ZERO, r);
                d1 -= u0.transpose() * x;
                g1 -= u0.transpose() * r;
            }
            let mut after = Vec3::ZERO;
            let mut next = if tip_pinned { Vec3::ZERO } else { Factors::new(d1).solve(g1) };
            for i in (2..n).rev() {
                if i < n - 1 {
                    let (x, z, r) = rows[i];
                    let delta = r - x * next - z * after;
                    after = next;
                    next = delta;
                }
                p[i] += next;
                v[i] += next / h;
                bad |= too_fast(v[i]);
            }
        }
        if bad {
            return self.reset(u);
        }
        self.twisted = twisted;
        let mut kept = p[0];
        for i in 0..n {
            let free = p[i];
            if i >= 2 && !(tip_pinned && i == n - 1) {
                p[i] = kept + self.guard(i - 1, free - kept);
            }
            kept = p[i];
            self.current[i] = origin + p[i];
            self.velocity[i] = remembered(v[i] + (p[i] - free) / h);
        }
    }

    /// Returns the load of vertex `i` alone, per unit of weight: stiffness and force.
    #[allow(clippy::too_many_arguments)]
    fn load(
        &self,
        u: &StepUniforms,
        obstacles: &Obstacles,
        i: usize,
        moment: usize,
        origin: Vec3,
        (head, head_at): (Quat, Vec3),
        y: Vec3,
        v: Vec3,
        edge: f32,
    ) -> (Mat3, Vec3) {
        let h = u.h;
        let goal_fade = (i as f32 * edge * u.goal_falloff).min(1.0);
        let kg = self.guide.stiffness * (u.goal_root + (u.goal_tip - u.goal_root) * goal_fade);
        let goal = head * self.rest[i].position + head_at;
        let mut m = Mat3::from_diagonal(Vec3::splat(1.0 / (h * h) + u.drag / h + kg));
        let mut f = u.gravity + (u.wind - v) * u.drag + (goal - y) * kg;
        self.contacts(u, obstacles, i, moment, origin, v * h, y, &mut m, &mut f);
        if u.forced == 1 {
            let force = self.forces[i].unpack();
            let tangent = force.tangent;
            m += Mat3::from_diagonal(Vec3::splat(force.rate / h))
                + outer(tangent, tangent) * (force.along / h);
            f += force.acceleration - v * force.rate - tangent * (force.along * tangent.dot(v));
        }
        (m, f)
    }

    /// Clamps the length of edge `e` from vertex `j` to its allowed range around the rest length.
    fn guard(&self, j: usize, e: Vec3) -> Vec3 {
        let l0 = self.shape[j].length;
        let length = e.length();
        let right = length.max((2.0 - MAX_STRAIN) * l0).min(MAX_STRAIN * l0);
        if right != length && length > 1e-9 { e * (right / length) } else { e }
    }

    fn reset(&mut self, u: &StepUniforms) {
        for (i, rest) in self.rest.iter().enumerate() {
            self.current[i] = Quat::from_array(u.head_end) * rest.position + u.head_end_at;
            self.previous[i] = self.current[i];
            self.velocity[i] = Vec3::ZERO;
            self.twisted[i] = 0.0;
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn contacts(
        &self,
        u: &StepUniforms,
        obstacles: &Obstacles,
        i: usize,
        moment: usize,
        origin: Vec3,
        way: Vec3,
        y: Vec3,
        m: &mut Mat3,
        f: &mut Vec3,
    ) {
        let clearance = self.rest[i].contact;
        for (c, collider) in obstacles.colliders.iter().enumerate() {
            let now = obstacles.places[moment * obstacles.colliders.len() + c];
            let now_at = now.translation - origin;
            let local = now.rotation.conjugate() * (y - now_at);
            let found = match collider.shape {
                Shape::Capsule { half_length, radius } => shape::capsule(local, radius, half_length),
                Shape::Ellipsoid { radii } => shape::ellipsoid(local, radii),
                Shape::Field(id) => shape::field(local, &obstacles.volumes[id.0 as usize]),
            };
            let before = obstacles.places[(moment - 1) * obstacles.colliders.len() + c];
            let still = now.rotation == before.rotation;
            let turn = if still { Quat::IDENTITY } else { now.rotation * before.rotation.conjugate() };
            let arm = y - way - (before.translation - origin);
            let slip = way - (now.translation - before.translation) - turned_by(turn, arm);
            let n = now.rotation * found.truncate();
            let depth = clearance - found.w;
            let ahead = if u.slip > 0.0 { 0.0 } else { AHEAD * u.h * u.h * u.gravity.length() };
            if depth > 0.0 || (depth + n.dot(slip)).min(depth + ahead) > 0.0 {
                contact(u, depth, n, slip, u.friction * collider.friction, m, f);
            }
        }
    }
}
