//! One solve of a strand with twist: positions and the rotations of edge frames about their edges, together.

use super::{StepUniforms, Strand, outer};
use crate::{math::ldl::Factors4, strands::guide::TIP_PINNED};
use glam::{Mat3, Mat4, Vec3, Vec4};

/// Largest twist of a bend, radians.
const MOST_TWIST: f32 = 2.0;

/// Returns a matrix of four rows: three of a bend, one of a twist.
fn rows(bend: Mat3, bend_turn: Vec3, twist: Vec3, twist_turn: f32) -> Mat4 {
    Mat4::from_cols(
        bend.x_axis.extend(twist.x),
        bend.y_axis.extend(twist.y),
        bend.z_axis.extend(twist.z),
        bend_turn.extend(twist_turn),
    )
}

fn outer4(a: Vec4, b: Vec4) -> Mat4 {
    Mat4::from_cols(a * b.x, a * b.y, a * b.z, a * b.w)
}

/// Returns `m` extended to 4×4, acting on positions only.
fn wide(m: Mat3) -> Mat4 {
    rows(m, Vec3::ZERO, Vec3::ZERO, 0.0)
}

impl Strand {
    /// Returns the twist of each bend at which the rest pose is in equilibrium, although its bends carry weight.
    pub(super) fn resting_twist(&self, rate: impl Fn(usize) -> f32) -> Vec<f32> {
        let n = self.rest.len();
        let edge = |j: usize| self.rest[j + 1].position - self.rest[j].position;
        let mut resting = vec![0.0; n];
        let mut torque = Vec3::ZERO;
        for j in (1..n.max(2) - 1).rev() {
            let (e, target) = (edge(j), edge(j - 1) + self.shape[j].curvature);
            let unit = e.normalize_or_zero();
            let about = torque.dot(unit);
            resting[j] = about / (rate(j) * e.length_squared()).max(1e-12);
            torque = unit * about - target.cross(e - target) * rate(j);
        }
        resting
    }

    #[allow(clippy::too_many_arguments)]
    pub(super) fn solve_twisting(
        &self,
        u: &StepUniforms,
        p: &mut [Vec3],
        v: &mut [Vec3],
        twisted: &mut [f32],
        resting: &[f32],
        [target, carried]: [&[Vec3]; 2],
        load: &impl Fn(usize, Vec3, Vec3) -> (Mat3, Vec3),
        rate: &impl Fn(usize) -> f32,
    ) {
        let n = p.len();
        if n < 3 {
            return;
        }
        let (h, edge) = (u.h, self.guide.length / (n - 1) as f32);
        let least = (super::LEAST_EDGE * edge).powi(2);
        let stretch = u.stretch * self.guide.length / (edge * edge).max(1e-12);
        let tip_pinned = self.guide.flags & TIP_PINNED != 0;
        let mut solved = vec![(Mat4::ZERO, Mat4::ZERO, Vec4::ZERO); n];
        // Derivatives of each twist with respect to the edge before, the edge after, and the turn of the edge before.
        let mut turning = vec![(Vec3::ZERO, Vec3::ZERO, 0.0); n];
        let (mut d0, mut d1, mut u0) = (Mat4::ZERO, Mat4::ZERO, Mat4::ZERO);
        let (mut g0, mut g1) = (Vec4::ZERO, Vec4::ZERO);
        let mut spin = 0.0;
        for j in 1..n - 1 {
            let i = j + 1;
            let load = load(i, p[i], v[i]);
            let weight = if i == n - 1 { 0.5 } else { 1.0 };
            let (e, e_next) = (p[j] - p[j - 1], p[i] - p[j]);
            let length = e_next.length().max(1e-9);
            let unit = e_next / length;
            let tension = stretch * (length - self.shape[j].length);
            let slack = (tension / length).max(0.0);
            let k = outer(unit, unit) * (stretch - slack) + Mat3::from_diagonal(Vec3::splat(slack));
            // The bend: its target turns with the edge before and about it.
            let (t, carried) = (target[j], carried[j]);
            let kb = rate(j);
            let km = kb * (1.0 + u.bending_damping / h);
            let inverse = 1.0 / e.length_squared().max(least);
            let axis = e * inverse.sqrt();
            let about = axis.cross(t) / edge;
            let (s, a) = super::bend(p, v, j, t, least, u.bending_damping);
            let s = s - about * (edge * spin * u.bending_damping);
            // The twist: a minimal rotation has no component about the sum of both directions.
            let sum = 1.0 / (1.0 + carried.dot(unit)).max(0.1);
            let after = carried.cross(unit) * (sum / length.max(least.sqrt()));
            let before = (carried + unit).cross(axis) * (sum * inverse.sqrt());
            let pass = (carried + unit).dot(axis) * sum;
            turning[j] = (before, after, pass);
            // Angular velocity about the next edge, due to the motion of the vertices.
            spin = pass * spin + before.dot(v[j] - v[j - 1]) - after.dot(v[i] - v[j]);
            let rest_edge = self.rest[i].position - self.rest[j].position;
            let kt = kb * rest_edge.length_squared().max(least);
            // So far twist is as stiff as bending. The difference acts about the tangent at the vertex; `q` is the
            // derivative of that rotation.
            let tangent = (carried + axis).normalize_or_zero();
            let across = tangent.cross(carried) / rest_edge.length().max(least.sqrt());
            let straight = tangent.dot(carried);
            let more = kt * (u.twist - 1.0);
            let off = straight * twisted[j] + across.dot(e_next);
            let lever = across.cross(e_next);
            let swing = lever.cross(axis) * inverse.sqrt();
            let q0 = (before * straight - swing).extend(0.0);
            let q1 = (swing - across - (before + after) * straight)
                .extend((lever.dot(axis) - straight * pass) / edge);
            let q2 = (across + after * straight).extend(straight / edge);
            let j0 = rows(a, Vec3::ZERO, before, 0.0);
            let j1 = rows(-(Mat3::IDENTITY + a), -about, -(before + after), -pass / edge);
            let j2 = rows(Mat3::IDENTITY, Vec3::ZERO, after, 1.0 / edge);
            let stiff = Mat4::from_diagonal(Vec4::new(km, km, km, kt));
            let force = (s * kb).extend(kt * (twisted[j] - resting[j]));
            let pull = more * off;
            d0 += j0.transpose() * stiff * j0 + outer4(q0, q0 * more);
            u0 += j0.transpose() * stiff * j1 + outer4(q0, q1 * more);
            let c0 = j0.transpose() * stiff * j2 + outer4(q0, q2 * more);
            d1 += j1.transpose() * stiff * j1 + outer4(q1, q1 * more) + wide(k);
            let mut u1 = j1.transpose() * stiff * j2 + outer4(q1, q2 * more) - wide(k);
            let mut d2 = j2.transpose() * stiff * j2 + outer4(q2, q2 * more) + wide(load.0 * weight + k);
            g0 -= j0.transpose() * force + q0 * pull;
            g1 += (unit * tension).extend(0.0) - j1.transpose() * force - q1 * pull;
            let mut g2 = (load.1 * weight - unit * tension).extend(0.0) - j2.transpose() * force - q2 * pull;
            if j > 2 {
                let f = Factors4::new(d0);
                let (x, z, r) = (f.solve_columns(u0), f.solve_columns(c0), f.solve(g0));
                solved[j - 1] = (x, z, r);
                d1 -= u0.transpose() * x;
                u1 -= u0.transpose() * z;
                d2 -= c0.transpose() * z;
                g1 -= u0.transpose() * r;
                g2 -= c0.transpose() * r;
            }
            (d0, d1, u0) = (d1, d2, u1);
            (g0, g1) = (g1, g2);
        }
        if n > 3 {
            let f = Factors4::new(d0);
            let (x, r) = (f.solve_columns(u0), f.solve(g0));
            solved[n - 2] = (x, Mat4::ZERO, r);
            d1 -= u0.transpose() * x;
            g1 -= u0.transpose() * r;
        }
        let mut delta = vec![Vec4::ZERO; n];
        delta[n - 1] = if tip_pinned { Vec4::W * (g1.w / d1.w_axis.w) } else { Factors4::new(d1).solve(g1) };
        for i in (2..n - 1).rev() {
            let (x, z, r) = solved[i];
            delta[i] = r - x * delta[i + 1] - z * delta.get(i + 2).copied().unwrap_or_default();
        }
        for i in 2..n {
            p[i] += delta[i].truncate();
            v[i] += delta[i].truncate() / h;
        }
        for j in 1..n - 1 {
            let (before, after, pass) = turning[j];
            let step = |i: usize| delta[i].truncate();
            let turn = (delta[j + 1].w - pass * delta[j].w) / edge + after.dot(step(j + 1) - step(j))
                - before.dot(step(j) - step(j - 1));
            twisted[j] = (twisted[j] + turn).clamp(-MOST_TWIST, MOST_TWIST);
        }
    }
}
