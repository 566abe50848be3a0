//! Which strands may be mixed: hair runs together, or it runs apart.

use super::curves::{Curves, KNOTS};
use super::surface::Surface;
use crate::{SdfGrid, random::lerp};

/// Strands of which one is longer than the other by this factor are of different cuts.
const CUT: f32 = 2.0;

/// How much deeper than its parents the middle between two strands may lie in the head, metres.
const INSIDE: f32 = 0.005;

/// Neighbours whose distance shrinks below this part of what it is at the roots are of one clump.
const TOGETHER: f32 = 0.5;

/// Points of the profile by which strands of a clump come together.
const PROFILE: usize = KNOTS;

/// What strands are to each other.
pub(super) struct Kin {
    pub(super) curves: Curves,
    /// The cosine of the angle from which on strands run apart.
    apart: f32,
    pinned: Vec<bool>,
    /// Whether each strand has neighbours that it meets.
    clumped: Vec<bool>,
    /// How the distance to the neighbours changes along each strand, as a factor of that at the root.
    spread: Vec<[f32; PROFILE]>,
}

impl Kin {
    pub(super) fn new(curves: Curves, pinned: Vec<bool>, surface: &Surface, parting: f32) -> Self {
        let n = curves.length.len();
        let mut kin = Self {
            apart: parting.cos(),
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
                let meet = kin.meet(&ratios);
                for i in [a as usize, b as usize] {
                    kin.clumped[i] |= meet;
                    // Those that meet say how a clump comes together, whatever others do.
                    let weight = if meet { 16.0 } else { 1.0 };
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

    /// The distance between two strands along them, as a factor of that at the root.
    fn ratios(&self, a: u32, b: u32) -> [f32; PROFILE] {
        let (p, q) = (self.curves.knots(a), self.curves.knots(b));
        let first = p[0].distance(q[0]).max(1e-4);
        std::array::from_fn(|k| p[k].distance(q[k]) / first)
    }

    fn meet(&self, ratios: &[f32; PROFILE]) -> bool {
        ratios[KNOTS / 2..].iter().any(|ratio| *ratio < TOGETHER)
    }

    /// Whether two strands run together, so that hair may grow between them: neither apart as at a parting
    /// nor around the head, of one cut, and both with tips of one kind.
    pub(super) fn runs_with(&self, a: u32, b: u32) -> bool {
        if a == b {
            return true;
        }
        let (i, j) = (a as usize, b as usize);
        let (la, lb) = (self.curves.length[i], self.curves.length[j]);
        if self.pinned[i] != self.pinned[j] || la > CUT * lb || lb > CUT * la {
            return false;
        }
        let (p, q) = (self.curves.knots(a), self.curves.knots(b));
        let roots = p[0].distance(q[0]);
        for k in 1..KNOTS {
            let arc = 0.5 * (la + lb) * k as f32 / (KNOTS - 1) as f32;
            // Near their roots strands that meet go towards each other.
            if arc < 2.0 * roots && k + 1 < KNOTS {
                continue;
            }
            let (u, v) = ((p[k] - p[0]).normalize_or_zero(), (q[k] - q[0]).normalize_or_zero());
            if u.dot(v) < self.apart {
                return false;
            }
        }
        true
    }

    /// Whether the middle between two strands lies in the head though they do not.
    fn around_the_head(&self, a: u32, b: u32, field: &SdfGrid) -> bool {
        let clear = &self.curves.clear;
        (1..KNOTS).any(|k| {
            let (i, j) = (a as usize * KNOTS + k, b as usize * KNOTS + k);
            let middle = 0.5 * (self.curves.knots[i] + self.curves.knots[j]);
            field.sample(middle) < clear[i].min(clear[j]).min(0.0) - INSIDE
        })
    }

    /// Whether hair between two strands is a mean of both.
    pub(super) fn mixes(&self, a: u32, b: u32, field: Option<&SdfGrid>) -> bool {
        if !self.runs_with(a, b) || field.is_some_and(|field| self.around_the_head(a, b, field)) {
            return false;
        }
        let either = self.clumped[a as usize] || self.clumped[b as usize];
        a == b || !either || self.meet(&self.ratios(a, b))
    }

    /// How far apart strands that go with strand `a` lie at the fraction `s`, as a factor of their distance
    /// at the root.
    pub(super) fn spread(&self, a: u32, s: f32) -> f32 {
        let x = s.clamp(0.0, 1.0) * (PROFILE - 1) as f32;
        let k = (x as usize).min(PROFILE - 2);
        let profile = &self.spread[a as usize];
        lerp(profile[k], profile[k + 1], x - k as f32)
    }

    /// The distance of strand `a` from the head at the fraction `s`, metres; far without a head.
    pub(super) fn clear(&self, a: u32, s: f32) -> f32 {
        let x = s.clamp(0.0, 1.0) * (KNOTS - 1) as f32;
        let k = (x as usize).min(KNOTS - 2);
        let at = |k: usize| self.curves.clear.get(a as usize * KNOTS + k).copied().unwrap_or(f32::INFINITY);
        lerp(at(k), at(k + 1), x - k as f32)
    }
}
