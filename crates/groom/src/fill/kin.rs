//! Compatibility of strands: whether a new strand may be a mean of two input strands.

use super::curves::{Curves, PATH_POINTS};
use super::surface::Surface;
use crate::{SdfGrid, random::lerp};

/// Length ratio above which two strands belong to different cuts.
const CUT: f32 = 2.0;

/// How much deeper inside the head than its parents the midpoint of two strands may lie, meters.
const INSIDE: f32 = 0.005;

/// Neighbors belong to one clump if their distance shrinks below this fraction of the distance at the roots.
const TOGETHER: f32 = 0.5;

/// Points of the profile that describes how the strands of a clump converge.
const PROFILE: usize = PATH_POINTS;

/// Relations between the input strands.
pub(super) struct Kin {
    pub(super) curves: Curves,
    /// Cosine of the angle above which strands run apart.
    parting_cosine: f32,
    pinned: Vec<bool>,
    /// Whether each strand converges with a neighbor.
    clumped: Vec<bool>,
    /// Distance to the neighbors along each strand, relative to the distance at the root.
    spread: Vec<[f32; PROFILE]>,
}

impl Kin {
    pub(super) fn new(curves: Curves, pinned: Vec<bool>, surface: &Surface, parting: f32) -> Self {
        let n = curves.length.len();
        let mut kin = Self {
            parting_cosine: parting.cos(),
            pinned,
            clumped: vec![false; n],
            spread: vec![[1.0; PROFILE]; n],
            curves,
        };
        let mut sums = vec![([0.0f32; PROFILE], 0.0f32); n];
        for t in &surface.triangles {
            for k in 0..3 {
                let [a, b] = [t[k], t[(k + 1) % 3]].map(|site| surface.strands(site)[0]);
                if !kin.runs_with(a, b) {
                    continue;
                }
                let ratios = kin.ratios(a, b);
                let converges = kin.converges(&ratios);
                for i in [a as usize, b as usize] {
                    kin.clumped[i] |= converges;
                    // Converging neighbors dominate, because they show how the clump converges.
                    let weight = if converges { 16.0 } else { 1.0 };
                    sums[i].1 += weight;
                    sums[i].0.iter_mut().zip(ratios).for_each(|(sum, ratio)| *sum += weight * ratio.min(2.0));
                }
            }
        }
        for (spread, (sum, weight)) in kin.spread.iter_mut().zip(sums) {
            if weight > 0.0 {
                *spread = sum.map(|sum| sum / weight);
            }
        }
        kin
    }

    /// Returns the distance between two strands along them, relative to the distance at the root.
    fn ratios(&self, a: u32, b: u32) -> [f32; PROFILE] {
        let (p, q) = (self.curves.path_points(a), self.curves.path_points(b));
        let first = p[0].distance(q[0]).max(1e-4);
        std::array::from_fn(|k| p[k].distance(q[k]) / first)
    }

    fn converges(&self, ratios: &[f32; PROFILE]) -> bool {
        ratios[PATH_POINTS / 2..].iter().any(|ratio| *ratio < TOGETHER)
    }

    /// Returns whether two strands run together, so that hair may grow between them. They must not diverge as at a
    /// parting, must have similar lengths, and must have both pinned or both free tips.
    pub(super) fn runs_with(&self, a: u32, b: u32) -> bool {
        if a == b {
            return true;
        }
        let (i, j) = (a as usize, b as usize);
        let (la, lb) = (self.curves.length[i], self.curves.length[j]);
        if self.pinned[i] != self.pinned[j] || la > CUT * lb || lb > CUT * la {
            return false;
        }
        let (p, q) = (self.curves.path_points(a), self.curves.path_points(b));
        let roots = p[0].distance(q[0]);
        for k in 1..PATH_POINTS {
            let arc = 0.5 * (la + lb) * k as f32 / (PATH_POINTS - 1) as f32;
            // Skip points near the roots, where converging strands point toward each other.
            if arc < 2.0 * roots && k + 1 < PATH_POINTS {
                continue;
            }
            let (u, v) = ((p[k] - p[0]).normalize_or_zero(), (q[k] - q[0]).normalize_or_zero());
            if u.dot(v) < self.parting_cosine {
                return false;
            }
        }
        true
    }

    /// Returns whether the midpoint between two strands lies inside the head although the strands do not.
    fn is_separated_by_head(&self, a: u32, b: u32, field: &SdfGrid) -> bool {
        let clear = &self.curves.clear;
        (1..PATH_POINTS).any(|k| {
            let (i, j) = (a as usize * PATH_POINTS + k, b as usize * PATH_POINTS + k);
            let midpoint = 0.5 * (self.curves.path_points[i] + self.curves.path_points[j]);
            field.sample(midpoint) < clear[i].min(clear[j]).min(0.0) - INSIDE
        })
    }

    /// Returns whether hair between two strands may be a mean of both.
    pub(super) fn mixes(&self, a: u32, b: u32, field: Option<&SdfGrid>) -> bool {
        if !self.runs_with(a, b) || field.is_some_and(|field| self.is_separated_by_head(a, b, field)) {
            return false;
        }
        let either = self.clumped[a as usize] || self.clumped[b as usize];
        a == b || !either || self.converges(&self.ratios(a, b))
    }

    /// Returns the distance between strands beside strand `a` at the fraction `s`, relative to their distance at the
    /// root.
    pub(super) fn spread(&self, a: u32, s: f32) -> f32 {
        let x = s.clamp(0.0, 1.0) * (PROFILE - 1) as f32;
        let k = (x as usize).min(PROFILE - 2);
        let profile = &self.spread[a as usize];
        lerp(profile[k], profile[k + 1], x - k as f32)
    }

    /// Returns the distance of strand `a` from the head at the fraction `s`, meters; infinite without a head.
    pub(super) fn clear(&self, a: u32, s: f32) -> f32 {
        let x = s.clamp(0.0, 1.0) * (PATH_POINTS - 1) as f32;
        let k = (x as usize).min(PATH_POINTS - 2);
        let at =
            |k: usize| self.curves.clear.get(a as usize * PATH_POINTS + k).copied().unwrap_or(f32::INFINITY);
        lerp(at(k), at(k + 1), x - k as f32)
    }
}
