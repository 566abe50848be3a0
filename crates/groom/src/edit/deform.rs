//! Strands carried by guides, as the shaders of `tresses` carry them (`interpolate`, `tessellate`).
//!
//! A vertex with the original position `p` is at `Σ w_k (g_k(t) + R_k(t) (p - ḡ_k(t)))`, see
//! [`bound::binding`](crate::bound::binding). Edges keep their lengths.

use super::guide_blocks::GuideBlocks;
use crate::{
    Groom, Guides,
    bound::{Influence, StrandBinding},
    curve::spline_at,
    progress::in_parallel,
    rotation::{minimal_rotation, nlerp},
};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// A point of a guide: position, rotation since the original pose, original position.
#[derive(Clone, Copy, Debug)]
struct GuidePoint {
    at: Vec3,
    rotation: Quat,
    from: Vec3,
}

impl GuidePoint {
    fn transform_point(&self, p: Vec3) -> Vec3 {
        self.at + self.rotation * (p - self.from)
    }
}

/// A guide that has moved.
#[derive(Debug)]
struct GuideDeformation {
    now: Vec<Vec3>,
    from: Vec<Vec3>,
    /// Rotation of each edge: minimal rotations from edge to edge.
    rotations: Vec<Quat>,
    /// Points at equal steps, if strands blend between them.
    samples: Vec<GuidePoint>,
}

impl GuideDeformation {
    fn new(from: &[Vec3], now: &[Vec3], samples: usize) -> Self {
        let mut rotation = Quat::IDENTITY;
        let rotations = from.windows(2).zip(now.windows(2)).map(|(from, now)| {
            rotation =
                (minimal_rotation(rotation * (from[1] - from[0]), now[1] - now[0]) * rotation).normalize();
            rotation
        });
        let rotations = rotations.collect();
        let mut guide = Self { now: now.to_vec(), from: from.to_vec(), rotations, samples: Vec::new() };
        let span = (now.len() - 1) as f32 / (samples.max(2) - 1) as f32;
        guide.samples = (0..samples).map(|i| guide.on_spline(i as f32 * span)).collect();
        guide
    }

    /// Returns the point at `x`, in segments from the root.
    fn on_spline(&self, x: f32) -> GuidePoint {
        let last = self.rotations.len() - 1;
        let k = (x as usize).min(last);
        let u = (x - k as f32).min(1.0);
        let (before, current, after) =
            (self.rotations[k.saturating_sub(1)], self.rotations[k], self.rotations[(k + 1).min(last)]);
        let rotation = if u > 0.5 { nlerp(current, after, u - 0.5) } else { nlerp(before, current, u + 0.5) };
        GuidePoint { at: spline_at(&self.now, x), rotation, from: spline_at(&self.from, x) }
    }

    /// Returns the point at the fraction `t` of the guide.
    fn at(&self, t: f32) -> GuidePoint {
        let t = t.min(1.0);
        if self.samples.is_empty() {
            return self.on_spline(t * self.rotations.len() as f32);
        }
        let x = t * (self.samples.len() - 1) as f32;
        let k = (x as usize).min(self.samples.len() - 2);
        let (a, b, f) = (self.samples[k], self.samples[k + 1], x - k as f32);
        GuidePoint {
            at: a.at.lerp(b.at, f),
            rotation: nlerp(a.rotation, b.rotation, f),
            from: a.from.lerp(b.from, f),
        }
    }
}

/// The strands of a groom, carried by guides that have moved.
#[derive(Debug)]
pub(super) struct DeformedStrands {
    base: Arc<Groom>,
    deformations: Vec<Option<GuideDeformation>>,
}

impl DeformedStrands {
    /// Carries the strands of `base` by its guides, from `from` to `now`.
    pub fn new(base: Arc<Groom>, now: &GuideBlocks, from: &GuideBlocks) -> Self {
        let strands = &base.strands;
        let single = |binding: &StrandBinding| binding.weight_b == 0.0 && binding.weight_c == 0.0;
        let follows = base.guides.len() >= strands.len() && strands.bindings.iter().all(single);
        let samples = if follows { 0 } else { base.guides.vertex_count.max(strands.vertex_count) as usize };
        let mut deformations: Vec<Option<GuideDeformation>> = (0..now.len()).map(|_| None).collect();
        for i in now.differing(from).filter(|i| now.guide(*i) != from.guide(*i)) {
            deformations[i] = Some(GuideDeformation::new(from.guide(i), now.guide(i), samples));
        }
        Self { base, deformations }
    }

    /// Returns the groom of the strands.
    pub fn base(&self) -> &Groom {
        &self.base
    }

    /// Whether strand `i` has moved.
    fn is_deformed(&self, i: usize) -> bool {
        self.base.strands.bindings[i].weighted().any(|(guide, _)| self.deformations[guide].is_some())
    }

    /// Returns the vertices of strand `i`, and their radii.
    pub fn strand(&self, i: usize) -> (Vec<Vec3>, Vec<f32>) {
        let strands = &self.base.strands;
        let (n, binding) = (strands.vertex_count as usize, &strands.bindings[i]);
        let rest = strands.vertices(i);
        if !self.is_deformed(i) {
            return rest;
        }
        let step = 1.0 / (n - 1) as f32;
        let target = |j: usize| {
            let (p, s) = (rest.0[j], j as f32 * step);
            let weighted_position = |Influence { guide, weight, scale }: Influence| {
                let deformation = self.deformations[guide as usize].as_ref();
                weight * deformation.map_or(p, |guide| guide.at(s * scale).transform_point(p))
            };
            binding.influences().map(weighted_position).sum::<Vec3>()
        };
        let mut line = Vec::with_capacity(n);
        let mut before = target(0);
        line.push(before);
        for j in 1..n {
            let next = target(j);
            let length = rest.0[j].distance(rest.0[j - 1]);
            line.push(line[j - 1] + (next - before) / (next - before).length().max(1e-12) * length);
            before = next;
        }
        (line, rest.1)
    }

    /// Returns the groom with the guides `now`. Strands of guides that have not moved are bit-identical.
    pub fn groom(&self, now: &GuideBlocks) -> Groom {
        let strands = &self.base.strands;
        let deformed: Vec<usize> = (0..strands.len()).filter(|i| self.is_deformed(*i)).collect();
        let lines = in_parallel(&deformed, |i| self.strand(*i));
        let mut all = strands.clone();
        for (i, (line, radii)) in deformed.into_iter().zip(lines) {
            all.reshape(i, &line, &radii);
        }
        let guides = Guides { positions: now.positions(), ..self.base.guides.clone() };
        Groom { guides, strands: all }
    }
}
