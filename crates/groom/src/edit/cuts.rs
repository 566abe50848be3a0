//! Lengths of an edited groom: how much is left of each strand, and by how much guides have grown.
//!
//! A cut is a share of a strand's length, not a surface in space: hair that is combed later is not cut again. Guides
//! end a little after the longest strand that follows them.

use crate::{
    BoundStrands, Groom,
    bound::{Influence, PackedRest, StrandBinding},
    curve,
    progress::in_parallel,
};
use glam::Vec3;
use std::collections::BTreeMap;

/// Length of a guide beyond the longest strand that follows it, meters.
const EXTRA_LENGTH: f32 = 3e-3;
/// Shortest share of a strand and of a guide that a cut leaves.
const SHORTEST: f32 = 0.005;
/// Change of a guide's share below which it stays.
const SMALL: f32 = 0.02;

/// Changes of a stroke, as factors.
#[derive(Clone, Debug, Default)]
pub(super) struct LengthChanges {
    /// Share that is left of a strand, by index.
    pub strands: BTreeMap<usize, f32>,
    /// Factor of the length of a guide and the hair around it, by index.
    pub guides: BTreeMap<usize, f32>,
}

impl LengthChanges {
    /// Leaves a share of each of these strands, or less.
    pub fn shorten(&mut self, strands: Vec<(usize, f32)>) {
        for (i, fraction) in strands {
            let left = self.strands.entry(i).or_insert(1.0);
            *left = left.min(fraction);
        }
    }
}

/// Lengths relative to the groom before the first stroke.
#[derive(Clone, Debug)]
pub(super) struct Cuts {
    /// Share of each strand that is left.
    strands: Vec<f32>,
    /// Share of each guide that is left.
    guides: Vec<f32>,
    /// Factor by which each guide has grown, before it is cut.
    growth: Vec<f32>,
}

/// Returns the point at `x`, in segments, on a polyline.
fn at(points: &[Vec3], x: f32) -> Vec3 {
    let k = (x as usize).min(points.len() - 2);
    points[k].lerp(points[k + 1], x - k as f32)
}

/// Returns the first `fraction` of a polyline, with as many points.
fn shortened(points: &[Vec3], fraction: f32) -> Vec<Vec3> {
    (0..points.len()).map(|i| at(points, fraction * i as f32)).collect()
}

impl Cuts {
    /// Returns lengths without changes.
    pub fn none(groom: &Groom) -> Self {
        let guides = vec![1.0; groom.guides.len()];
        Self { strands: vec![1.0; groom.strands.len()], growth: guides.clone(), guides }
    }

    /// Returns these lengths of `source` after `changes`.
    pub fn changed(&self, source: &Groom, changes: &LengthChanges) -> Self {
        let mut after = self.clone();
        for (i, fraction) in &changes.strands {
            after.strands[*i] = (self.strands[*i] * fraction).clamp(SHORTEST, 1.0);
        }
        for (i, factor) in &changes.guides {
            after.growth[*i] *= factor;
        }
        // Guides of hair whose length is another.
        let mut is_touched = vec![false; self.guides.len()];
        changes.guides.keys().for_each(|guide| is_touched[*guide] = true);
        for i in changes.strands.keys() {
            for (guide, _) in source.strands.bindings[*i].weighted() {
                is_touched[guide] = true;
            }
        }
        // The longest strand that follows each guide, as a share of the guide.
        let mut longest = vec![0.0f32; self.guides.len()];
        for (binding, keep) in source.strands.bindings.iter().zip(&after.strands) {
            for Influence { guide, scale, .. } in binding.influences() {
                let longest = &mut longest[guide as usize];
                *longest = longest.max(keep * scale);
            }
        }
        for i in (0..is_touched.len()).filter(|i| is_touched[*i] && longest[*i] > 0.0) {
            let length = curve::length(source.guides.guide(i)) * after.growth[i];
            let fraction = (longest[i] + EXTRA_LENGTH / length.max(1e-6)).clamp(SHORTEST, 1.0);
            if (fraction - self.guides[i]).abs() > SMALL {
                after.guides[i] = fraction;
            }
        }
        after
    }

    /// Returns guide `i`, which is `vertices` with these lengths, with the lengths `after`; `None` if it is the same.
    pub fn guide_to(&self, after: &Self, i: usize, vertices: &[Vec3]) -> Option<Vec<Vec3>> {
        let factor = after.growth[i] / self.growth[i];
        let fraction = after.guides[i] / self.guides[i];
        if factor == 1.0 && fraction == 1.0 {
            return None;
        }
        // A guide that gets its end back continues straight.
        let root = vertices[0];
        let last = vertices.len() - 1;
        let end = vertices[last] - vertices[last - 1];
        let point = |x: f32| match x > last as f32 {
            true => vertices[last] + end * (x - last as f32),
            false => at(vertices, x),
        };
        Some((0..=last).map(|k| root + (point(fraction * k as f32) - root) * factor).collect())
    }

    /// Returns `source` with these lengths.
    pub fn apply(&self, source: &Groom) -> Groom {
        let mut groom = source.clone();
        let n = source.guides.vertex_count as usize;
        let none = Self::none(source);
        for (i, guide) in groom.guides.positions.chunks_exact_mut(n).enumerate() {
            if let Some(changed) = none.guide_to(self, i, source.guides.guide(i)) {
                guide.copy_from_slice(&changed);
            }
        }
        let is_changed = |i: &usize| {
            let binding = &source.strands.bindings[*i];
            let guide = |(guide, _): (usize, f32)| self.guides[guide] != 1.0 || self.growth[guide] != 1.0;
            self.strands[*i] != 1.0 || binding.weighted().any(guide)
        };
        let changed: Vec<usize> = (0..source.strands.len()).filter(is_changed).collect();
        let strands = in_parallel(&changed, |i| self.strand(&source.strands, *i));
        let m = source.strands.vertex_count as usize;
        for (i, (binding, rest)) in changed.into_iter().zip(strands) {
            groom.strands.bindings[i] = binding;
            groom.strands.rest[i * m..(i + 1) * m].copy_from_slice(&rest);
        }
        groom
    }

    /// Returns binding and vertices of strand `i` with these lengths.
    fn strand(&self, strands: &BoundStrands, i: usize) -> (StrandBinding, Vec<PackedRest>) {
        let (m, mut binding, keep) = (strands.vertex_count as usize, strands.bindings[i], self.strands[i]);
        let (line, radii) = strands.vertices(i);
        let growth: f32 = binding.weighted().map(|(guide, weight)| weight * self.growth[guide]).sum();
        let line: Vec<Vec3> =
            shortened(&line, keep).into_iter().map(|p| line[0] + (p - line[0]) * growth).collect();
        let guides = binding.guides;
        for (scale, guide) in binding.scale.iter_mut().zip(guides) {
            *scale *= keep / self.guides[guide as usize];
        }
        binding.cover(&line);
        let radius = |k: usize| {
            let x = keep * k as f32;
            let at = (x as usize).min(m - 2);
            radii[at] + (radii[at + 1] - radii[at]) * (x - at as f32)
        };
        let packed =
            line.iter().enumerate().map(|(k, p)| PackedRest::pack(*p, radius(k), &binding)).collect();
        (binding, packed)
    }

    /// Returns all numbers.
    pub fn numbers(&self) -> impl Iterator<Item = f32> {
        self.strands.iter().chain(&self.guides).chain(&self.growth).copied()
    }

    /// Returns the size of the numbers, bytes.
    pub fn bytes(&self) -> usize {
        4 * (self.strands.len() + self.guides.len() + self.growth.len())
    }
}
