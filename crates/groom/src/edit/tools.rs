//! The effect of each tool on one guide, before the [solve](super::solve).

use super::{
    Brush, BrushRegion, BrushTool, Falloff,
    roots::across,
    solve::{PressState, rotate_between, unit},
};
use crate::SdfGrid;
use glam::Vec3;

/// Distance from the skin below which the comb does not press, meters.
const SKIN: f32 = 5e-3;
/// Share of a turn towards the normal or the stroke per dab.
const RAISE: f32 = 0.15;
/// Part of a guide, from its root, that puff and lay turn.
const ROOT: f32 = 0.4;
/// Change of the length per dab.
const GROWTH: f32 = 0.03;
/// Share of the way to the line of the stroke per dab.
const PINCH: f32 = 0.2;
/// Way of blown hair per dab, radii.
const BLOW: f32 = 0.1;
/// Share of the way to the smooth shape per dab.
const SMOOTH: f32 = 0.5;
/// Rise of parted hair at its root, relative to its way along the skin.
const PART_RISE: f32 = 0.45;
/// Extent of a shell before and behind the brush, radii.
const BEFORE: f32 = 3.0;
const BEHIND: f32 = 1.5;

/// One application of a brush.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dab {
    /// Middle of the brush, meters.
    pub center: Vec3,
    /// Way of the brush since the last dab, meters.
    pub motion: Vec3,
    /// Direction of sight, unit; zero without a camera.
    pub view_direction: Vec3,
    /// Largest distance behind the middle at which hair is reached, meters.
    pub behind: f32,
    /// Radius, meters.
    pub radius: f32,
    /// Strength, 0 to 1.
    pub strength: f32,
}

impl Dab {
    /// Returns the same dab on the other side of the plane x = `mirror_x`.
    pub fn mirrored(&self, mirror_x: f32) -> Self {
        let flip = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let center = Vec3::new(2.0 * mirror_x - self.center.x, self.center.y, self.center.z);
        Self { center, motion: flip(self.motion), view_direction: flip(self.view_direction), ..*self }
    }

    /// Whether the dab acts along the sight, instead of in a ball.
    fn is_across(&self, region: BrushRegion) -> bool {
        region != BrushRegion::Ball && self.view_direction != Vec3::ZERO
    }

    /// Returns the function of a sphere that tells whether it may be in reach.
    pub fn overlap_test(&self, region: BrushRegion) -> impl Fn((Vec3, f32)) -> bool + use<> {
        let (off, own) = (self.off(region), self.radius);
        move |(center, radius)| off(center).length() <= own + radius
    }

    /// Returns the function from a place to its offset from the way of the brush, meters.
    fn off(&self, region: BrushRegion) -> impl Fn(Vec3) -> Vec3 + use<> {
        let (is_across, view_direction) = (self.is_across(region), self.view_direction);
        let across = move |v: Vec3| if is_across { v - view_direction * v.dot(view_direction) } else { v };
        let motion = across(self.motion);
        let (begin, length_squared) = (self.center - self.motion, motion.length_squared().max(1e-18));
        move |p| {
            let to = across(p - begin);
            to - motion * (to.dot(motion) / length_squared).clamp(0.0, 1.0)
        }
    }

    /// Returns the place where `line` enters the brush, in segments from the root; `None` if it does not, or begins
    /// there.
    pub fn entry(&self, line: &[Vec3], brush: &Brush) -> Option<f32> {
        let inside = |p: Vec3| self.near(p, &Brush { falloff: Falloff::Flat, ..*brush }) > 0.0;
        let first = line.iter().position(|p| inside(*p)).filter(|first| *first > 0)?;
        let (mut low, mut high) = (0.0f32, 1.0f32);
        for _ in 0..8 {
            let midpoint = 0.5 * (low + high);
            let is_in = inside(line[first - 1].lerp(line[first], midpoint));
            if is_in { high = midpoint } else { low = midpoint }
        }
        Some((first - 1) as f32 + high)
    }

    /// Returns the falloff of `brush` as a function of a place, 0 outside.
    pub fn falloff(&self, brush: &Brush) -> impl Fn(Vec3) -> f32 + use<> {
        let (off, radius, falloff) = (self.off(brush.region), self.radius, brush.falloff);
        let is_shell = brush.region == BrushRegion::Shell && self.is_across(BrushRegion::Shell);
        let depths = -BEFORE * radius..=self.behind.min(BEHIND * radius);
        let (center, view_direction) = (self.center, self.view_direction);
        move |p| {
            if is_shell && !depths.contains(&(p - center).dot(view_direction)) {
                return 0.0;
            }
            falloff.at(off(p).length() / radius)
        }
    }

    /// Returns the falloff of `brush` at `p`.
    pub fn near(&self, p: Vec3, brush: &Brush) -> f32 {
        self.falloff(brush)(p)
    }
}

/// Weights of a guide's vertices.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    /// Share of the effect.
    pub weight: Vec<f32>,
    /// Falloff alone.
    pub near: Vec<f32>,
    /// Index of the dab that acts, where there are two.
    pub side: Vec<usize>,
    /// First vertex with a weight.
    pub first: usize,
}

impl Weights {
    /// Returns the weights of `guide` under `dabs`; `None` if no vertex besides the root has one.
    pub fn of(guide: &[Vec3], dabs: &[Dab], brush: &Brush) -> Option<Self> {
        let (n, last) = (guide.len(), (guide.len() - 1) as f32);
        let near: Vec<_> = dabs.iter().map(|dab| dab.falloff(brush)).collect();
        let (weight, side) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let mut weights = Self { weight, near: Vec::with_capacity(n), side, first: n };
        for (i, p) in guide.iter().enumerate() {
            let mut best = (0.0f32, 0);
            for (side, near) in near.iter().enumerate() {
                let near = near(*p);
                if near > best.0 {
                    best = (near, side);
                }
            }
            let weight = dabs[best.1].strength * best.0 * brush.along(i as f32 / last);
            if weight > 0.0 && i > 0 {
                weights.first = weights.first.min(i);
            }
            weights.weight.push(weight);
            weights.near.push(best.0);
            weights.side.push(best.1);
        }
        (weights.first < guide.len()).then_some(weights)
    }

    /// Returns the largest weight among the vertices near the root, and its side.
    fn at_root(&self) -> (f32, usize) {
        let count = (ROOT * (self.weight.len() - 1) as f32) as usize + 1;
        let all = self.weight.iter().copied().zip(self.side.iter().copied()).take(count + 1);
        all.fold((0.0, 0), |best, other| if other.0 > best.0 { other } else { best })
    }
}

/// Inputs of a tool besides the guide.
pub(super) struct Surroundings<'a> {
    pub brush: &'a Brush,
    pub dabs: &'a [Dab],
    pub press: &'a PressState,
    pub field: Option<&'a SdfGrid>,
    /// Normal of the skin at the root.
    pub normal: Vec3,
    /// Mean directions of the edges of neighbors; empty unless the tool needs them.
    pub along: &'a [Vec3],
}

impl Surroundings<'_> {
    /// Returns where the tool moves the vertices of `guide`, and the first that moves; `None` if none does.
    pub fn target(&self, guide: &[Vec3], weights: &Weights) -> Option<(Vec<Vec3>, usize)> {
        match self.brush.acts() {
            BrushTool::Comb => Some((self.combed(guide, weights), weights.first)),
            BrushTool::Grab => {
                let by = |i: usize| self.dabs[weights.side[i]].motion * weights.weight[i];
                Some((guide.iter().enumerate().map(|(i, p)| *p + by(i)).collect(), weights.first))
            }
            BrushTool::Pinch => Some((self.pinched(guide, weights, -PINCH), weights.first)),
            BrushTool::Spread => Some((self.pinched(guide, weights, PINCH), weights.first)),
            BrushTool::Blow => Some((self.blown(guide, weights), weights.first)),
            BrushTool::Smooth => Some((self.smoothed(guide, weights), weights.first)),
            BrushTool::Puff => self.raised(guide, weights, self.normal),
            BrushTool::Lay => {
                let motion = self.dabs[weights.at_root().1].motion;
                let along = motion - self.normal * motion.dot(self.normal);
                (along.length() > 1e-9).then(|| self.raised(guide, weights, unit(along, motion)))?
            }
            BrushTool::Length => {
                let factor = self.growth(weights);
                let root = guide[0];
                (factor != 1.0).then(|| (guide.iter().map(|p| root + (*p - root) * factor).collect(), 1))
            }
            BrushTool::Part => {
                let dab = &self.dabs[weights.side[0]];
                let across = across(self.normal, dab.motion);
                let side = if (guide[0] - dab.center).dot(across) < 0.0 { -across } else { across };
                let to = unit(side + self.normal * PART_RISE, side);
                (across != Vec3::ZERO).then(|| self.rotate_root(guide, weights.weight[0], to))?
            }
            // These change no shapes before the stroke ends.
            _ => None,
        }
    }

    /// Returns the factor of [`BrushTool::Length`].
    pub fn growth(&self, weights: &Weights) -> f32 {
        let weight = weights.weight.iter().copied().fold(0.0, f32::max);
        1.0 + GROWTH * if self.brush.inverted { -weight } else { weight }
    }

    fn combed(&self, guide: &[Vec3], weights: &Weights) -> Vec<Vec3> {
        let displaced = |(i, p): (usize, &Vec3)| {
            let mut by = self.dabs[weights.side[i]].motion * weights.weight[i];
            let near = |field: &&SdfGrid| !self.press.is_clear(i, *p, SKIN) && field.sample(*p) < SKIN;
            if let Some(field) = self.field.filter(|_| by != Vec3::ZERO).filter(near) {
                let normal = field.normal(*p);
                by -= normal * by.dot(normal).min(0.0);
            }
            *p + by
        };
        guide.iter().enumerate().map(displaced).collect()
    }

    fn pinched(&self, guide: &[Vec3], weights: &Weights, fraction: f32) -> Vec<Vec3> {
        let displaced = |(i, p): (usize, &Vec3)| {
            let dab = &self.dabs[weights.side[i]];
            let along = unit(dab.motion, Vec3::ZERO);
            let off = *p - dab.center;
            // Depth is no distance from the line that is drawn.
            let off = off - dab.view_direction * off.dot(dab.view_direction);
            *p + (off - along * off.dot(along)) * (fraction * weights.weight[i])
        };
        guide.iter().enumerate().map(displaced).collect()
    }

    /// Pushes vertices away from the middle of the brush and along the sight.
    fn blown(&self, guide: &[Vec3], weights: &Weights) -> Vec<Vec3> {
        let sign = if self.brush.inverted { -BLOW } else { BLOW };
        let displaced = |(i, p): (usize, &Vec3)| {
            let dab = &self.dabs[weights.side[i]];
            let off = *p - dab.center;
            let off = off - dab.view_direction * off.dot(dab.view_direction);
            let direction = unit(off + dab.view_direction * dab.radius, Vec3::ZERO);
            *p + direction * (sign * dab.radius * weights.weight[i])
        };
        guide.iter().enumerate().map(displaced).collect()
    }

    fn smoothed(&self, guide: &[Vec3], weights: &Weights) -> Vec<Vec3> {
        let n = guide.len();
        let (own, others) = (1.0 - self.brush.neighbors, self.brush.neighbors);
        let even = |i: usize| match i {
            0 => guide[0],
            i if i + 1 == n => guide[i],
            i => guide[i].lerp(0.5 * (guide[i - 1] + guide[i + 1]), SMOOTH * own * weights.weight[i]),
        };
        let even: Vec<Vec3> = (0..n).map(even).collect();
        let mut line = vec![guide[0]];
        for i in 0..n - 1 {
            let (edge, mean) = (even[i + 1] - even[i], self.along.get(i).copied().unwrap_or(Vec3::ZERO));
            let fraction = if mean == Vec3::ZERO { 0.0 } else { SMOOTH * others * weights.weight[i + 1] };
            let length = edge.length();
            line.push(line[i] + unit(edge * (1.0 - fraction) + mean * (length * fraction), edge) * length);
        }
        line
    }

    /// Turns the root towards `towards` by the weight near it.
    fn raised(&self, guide: &[Vec3], weights: &Weights, towards: Vec3) -> Option<(Vec<Vec3>, usize)> {
        self.rotate_root(guide, weights.at_root().0, towards)
    }

    /// Turns the root towards `towards`, and less the part after it.
    fn rotate_root(&self, guide: &[Vec3], weight: f32, towards: Vec3) -> Option<(Vec<Vec3>, usize)> {
        let root = unit(guide[1] - guide[0], towards);
        let to = unit(root * (1.0 - RAISE * weight) + towards * (RAISE * weight), root);
        if weight <= 0.0 || to == root {
            return None;
        }
        let last = (guide.len() - 1) as f32;
        let mut line = vec![guide[0]];
        for (i, edge) in guide.windows(2).enumerate() {
            let (edge, fraction) = (edge[1] - edge[0], (1.0 - i as f32 / last / ROOT).max(0.0));
            let direction = unit(edge * (1.0 - fraction) + rotate_between(edge, root, to) * fraction, edge);
            line.push(line[i] + direction * edge.length());
        }
        Some((line, 1))
    }
}
