//! The scalar twin of `step.wesl`: the same operations in the same order, on one strand.

use super::{
    collider::{CapsuleMotion, FieldVolume},
    params::{MAX_BENDING_RATE, Mode, StepUniforms},
};
use crate::strands::{Guide, GuideRest, GuideShape, guide::TIP_PINNED};
use glam::{Mat3, Quat, Vec3};

/// Contact stiffness: a vertex gives way by 1/30 of what would pass through in a substep.
const CONTACT: f32 = 30.0;
/// The fastest that a vertex is pushed out of an obstacle it is in, m/s.
const PUSH_OUT: f32 = 0.5;
/// Slip per substep below which friction is proportional to it, metres.
const STICK: f32 = 1e-6;
/// No edge is longer than this times its rest length after a step.
const MAX_STRAIN: f32 = 1.008;
/// A strand of which a vertex is faster than this, m/s, is put back to rest.
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
}

/// What strands collide with.
#[derive(Clone, Copy, Default)]
pub(crate) struct Obstacles<'a> {
    pub field: Option<&'a FieldVolume>,
    pub capsules: &'a [CapsuleMotion],
}

fn nlerp(a: [f32; 4], b: [f32; 4], t: f32) -> Quat {
    let (a, b) = (Quat::from_array(a), Quat::from_array(b));
    let b = if a.dot(b) < 0.0 { -b } else { b };
    (a * (1.0 - t) + b * t).normalize()
}

/// The smallest rotation from the direction of `a` to that of `b`.
fn minimal_rotation(a: Vec3, b: Vec3) -> Quat {
    let scale = (a.length_squared() * b.length_squared()).sqrt();
    let w = scale + a.dot(b);
    // Opposite directions have no smallest rotation: the frame is kept.
    if w < 1e-3 * scale || scale < 1e-20 {
        return Quat::IDENTITY;
    }
    let c = a.cross(b);
    Quat::from_xyzw(c.x, c.y, c.z, w).normalize()
}

fn outer(a: Vec3, b: Vec3) -> Mat3 {
    Mat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Adds the contact of a vertex at `y` with an obstacle `d` away in direction `n`; `slip` is the
/// way of the vertex relative to the obstacle in this substep.
#[allow(clippy::too_many_arguments)]
fn contact(d: f32, n: Vec3, clearance: f32, slip: Vec3, h: f32, friction: f32, m: &mut Mat3, f: &mut Vec3) {
    let depth = clearance - d;
    if depth <= 0.0 {
        return;
    }
    let k = CONTACT / (h * h);
    let along = n.dot(slip);
    let push = depth.min((-along).max(0.0) + PUSH_OUT * h);
    let tangential = slip - n * along;
    let kt = friction * k * push / (tangential.length() + STICK);
    *m += outer(n, n) * (k - kt) + Mat3::from_diagonal(Vec3::splat(kt));
    *f += n * (k * push) - tangential * kt;
}

impl Strand {
    /// At rest in the pose of `guide`'s rest vertices, head upright.
    pub fn at_rest(guide: Guide, rest: Vec<GuideRest>, shape: Vec<GuideShape>) -> Self {
        let current: Vec<_> = rest.iter().map(|r| r.position).collect();
        Self {
            guide,
            rest,
            shape,
            previous: current.clone(),
            velocity: vec![Vec3::ZERO; current.len()],
            current,
        }
    }

    /// One fixed step.
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
                self.velocity[i] = turn * self.velocity[i];
            }
            self.previous.copy_from_slice(&self.current);
            return;
        }
        let origin = self.current[0];
        let edge = self.guide.length / (n.max(2) - 1) as f32;
        let inverse_edge = 1.0 / edge.max(1e-6);
        let square = inverse_edge * inverse_edge;
        let stretch = u.stretch * self.guide.length * square;
        let tip_pinned = self.guide.flags & TIP_PINNED != 0;
        let h = u.h;
        let mut p: Vec<Vec3> = self.current.iter().map(|c| *c - origin).collect();
        let mut v = self.velocity.clone();
        let mut bad = false;
        let mut solved = vec![(Mat3::ZERO, Mat3::ZERO, Vec3::ZERO); n];
        for sub in 0..u.substeps {
            let t = (sub + 1) as f32 / u.substeps as f32;
            let head = nlerp(u.head_begin, u.head_end, t);
            let head_at = u.head_begin_at.lerp(u.head_end_at, t) - origin;
            let (mut d0, mut d1, mut d2) = (Mat3::ZERO, Mat3::ZERO, Mat3::ZERO);
            let (mut u0, mut u1, mut c0) = (Mat3::ZERO, Mat3::ZERO, Mat3::ZERO);
            let (mut g0, mut g1, mut g2) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
            let mut q = head;
            let mut kept = p[0];
            for i in 0..2.min(n) {
                let target = head * self.rest[i].position + head_at;
                v[i] = (target - p[i]) / h;
                kept = p[i];
                p[i] = target;
            }
            let mut e = p[1] - p[0];
            let mut w = v[1] - v[0];
            let mut rest_e = self.rest[1].position - self.rest[0].position;
            for j in 1..n - 1 {
                // Predict the next vertex.
                let i = j + 1;
                let tip = i == n - 1;
                let pinned = tip && tip_pinned;
                let goal = head * self.rest[i].position + head_at;
                let old = kept + self.guard(j, p[i] - kept);
                v[i] += (old - p[i]) / h;
                kept = old;
                if pinned {
                    v[i] = (goal - old) / h;
                }
                let y = if pinned { goal } else { old + v[i] * h };
                p[i] = y;
                // What acts on the vertex alone, per unit of weight.
                let arc = j as f32 * edge;
                let fade = (arc * u.bending_falloff).min(1.0);
                let goal_fade = ((arc + edge) * u.goal_falloff).min(1.0);
                let kg = self.guide.stiffness * (u.goal_root + (u.goal_tip - u.goal_root) * goal_fade);
                let mut m = Mat3::from_diagonal(Vec3::splat(1.0 / (h * h) + u.drag / h + kg));
                let mut f = u.gravity + (u.wind - v[i]) * u.drag + (goal - y) * kg;
                self.contacts(u, obstacles, i, t, origin, old, y, &mut m, &mut f);
                let weight = if tip { 0.5 } else { 1.0 };
                d2 = m * weight;
                g2 = f * weight;
                // The edge as a spring.
                let e_next = y - p[j];
                let w_next = v[i] - v[j];
                let length = e_next.length();
                let dir = e_next / length.max(1e-9);
                let l0 = self.shape[j].length;
                let tension = stretch * (length - l0);
                let slack = (tension / length.max(1e-9)).max(0.0);
                let k = outer(dir, dir) * (stretch - slack) + Mat3::from_diagonal(Vec3::splat(slack));
                d1 += k;
                d2 += k;
                u1 = -k;
                g1 += dir * tension;
                g2 -= dir * tension;
                // The bend between the two edges: s = e_next - t, where t follows e.
                let rest_next = self.rest[i].position - self.rest[j].position;
                let target = q * (rest_e + self.shape[j].curvature);
                let bend = u.bending_root + (u.bending_tip - u.bending_root) * fade;
                let mut kb = (self.guide.stiffness * bend * square * square).min(MAX_BENDING_RATE);
                if j == 1 {
                    kb *= 2.0;
                }
                let inverse = 1.0 / e.length_squared().max(1e-18);
                let a =
                    Mat3::from_diagonal(Vec3::splat(e.dot(target) * inverse)) - outer(e * inverse, target);
                let s = e_next - target + (w_next - a * w) * u.bending_damping;
                let km = kb * (1.0 + u.bending_damping / h);
                let at = a.transpose();
                let ata = at * a;
                let ats = at * s;
                d0 += ata * km;
                u0 -= (at + ata) * km;
                c0 = at * km;
                d1 += (Mat3::IDENTITY + a + at + ata) * km;
                u1 -= (Mat3::IDENTITY + at) * km;
                d2 += Mat3::from_diagonal(Vec3::splat(km));
                g0 -= ats * kb;
                g1 += (s + ats) * kb;
                g2 -= s * kb;
                q = (minimal_rotation(q * rest_next, e_next) * q).normalize();
                // Eliminate the row before.
                if j > 2 {
                    let inv = d0.inverse();
                    let (x, z, r) = (inv * u0, inv * c0, inv * g0);
                    solved[j - 1] = (x, z, r);
                    let u0t = u0.transpose();
                    let c0t = c0.transpose();
                    d1 -= u0t * x;
                    u1 -= u0t * z;
                    d2 -= c0t * z;
                    g1 -= u0t * r;
                    g2 -= c0t * r;
                }
                (d0, d1) = (d1, d2);
                u0 = u1;
                (g0, g1) = (g1, g2);
                (e, w, rest_e) = (e_next, w_next, rest_next);
            }
            // Rows n - 2 and n - 1 remain.
            if n < 3 {
                continue;
            }
            let (mut x, mut r) = (Mat3::ZERO, Vec3::ZERO);
            if n > 3 {
                let inv = d0.inverse();
                (x, r) = (inv * u0, inv * g0);
                d1 -= u0.transpose() * x;
                g1 -= u0.transpose() * r;
            }
            let mut after = Vec3::ZERO;
            let mut next = if tip_pinned { Vec3::ZERO } else { d1.inverse() * g1 };
            for i in (2..n).rev() {
                if i < n - 1 {
                    let (z, here);
                    if i == n - 2 {
                        (z, here) = (Mat3::ZERO, r);
                    } else {
                        (x, z, here) = solved[i];
                    }
                    let delta = here - x * next - z * after;
                    after = next;
                    next = delta;
                }
                p[i] += next;
                v[i] += next / h;
                let size = v[i].length_squared();
                bad |= size.to_bits() & 0x7fff_ffff > (MAX_SPEED * MAX_SPEED).to_bits();
            }
        }
        if bad {
            return self.reset(u);
        }
        let mut kept = p[0];
        for i in 0..n {
            let mut at = p[i];
            if i >= 2 && !(tip_pinned && i == n - 1) {
                at = kept + self.guard(i - 1, p[i] - kept);
                v[i] += (at - p[i]) / h;
            }
            kept = at;
            self.current[i] = origin + at;
            self.velocity[i] = v[i];
        }
    }

    /// The edge from vertex `j`, shortened when it is too long.
    fn guard(&self, j: usize, e: Vec3) -> Vec3 {
        let most = MAX_STRAIN * self.shape[j].length;
        let length = e.length();
        if length > most { e * (most / length) } else { e }
    }

    fn reset(&mut self, u: &StepUniforms) {
        for (i, rest) in self.rest.iter().enumerate() {
            self.current[i] = Quat::from_array(u.head_end) * rest.position + u.head_end_at;
            self.previous[i] = self.current[i];
            self.velocity[i] = Vec3::ZERO;
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn contacts(
        &self,
        u: &StepUniforms,
        obstacles: &Obstacles,
        i: usize,
        t: f32,
        origin: Vec3,
        old: Vec3,
        y: Vec3,
        m: &mut Mat3,
        f: &mut Vec3,
    ) {
        let clearance = self.rest[i].contact;
        let step = 1.0 / u.substeps as f32;
        if let (1, Some(field)) = (u.has_field, obstacles.field) {
            let q = nlerp(u.field_begin, u.field_end, t);
            let at = u.field_begin_at.lerp(u.field_end_at, t) - origin;
            let local = q.conjugate() * (y - at);
            let c = local * u.field_scale + u.field_bias;
            if c.min_element() >= 0.0 && c.max_element() <= 1.0 {
                let sample = field.sample(c);
                if sample.w < clearance {
                    let before = nlerp(u.field_begin, u.field_end, t - step);
                    let before_at = u.field_begin_at.lerp(u.field_end_at, t - step) - origin;
                    let carried = q * (before.conjugate() * (old - before_at)) + at;
                    let n = q * sample.truncate().normalize_or(Vec3::Y);
                    contact(sample.w, n, clearance, y - carried, u.h, u.friction, m, f);
                }
            }
        }
        for capsule in obstacles.capsules.iter().take(u.capsule_count as usize) {
            let time = |t: f32| u.capsules_from + (u.capsules_to - u.capsules_from) * t;
            let (now, then) = (time(t), time(t - step));
            let a = capsule.a_begin.lerp(capsule.a_end, now) - origin;
            let b = capsule.b_begin.lerp(capsule.b_end, now) - origin;
            let axis = b - a;
            let s = ((y - a).dot(axis) / axis.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let way = y - (a + axis * s);
            let d = way.length() - capsule.radius;
            if d < clearance {
                let a_then = capsule.a_begin.lerp(capsule.a_end, then) - origin;
                let b_then = capsule.b_begin.lerp(capsule.b_end, then) - origin;
                let moved = (a - a_then).lerp(b - b_then, s);
                let n = way / way.length().max(1e-9);
                contact(d, n, clearance, y - old - moved, u.h, u.friction, m, f);
            }
        }
    }
}
