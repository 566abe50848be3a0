//! Parting: the line from which hair falls to both sides.

use super::recipe::Recipe;
use crate::random::noise;
use crate::scalp::Scalp;
use glam::Vec3;

/// A parting: a line over the scalp from the forehead to the crown, visible as a narrow strip of skin.
#[derive(Clone, Debug)]
pub struct Parting {
    /// Points on the scalp from the front to the crown, meters.
    pub line: Vec<Vec3>,
    /// Half the width of the bare strip, meters.
    pub half_width: f32,
}

impl Parting {
    /// Creates a parting at the distance `x` (meters, positive to the head's left) from the middle. It runs from the
    /// hairline of the forehead back to the crown, where it turns toward the middle. `recipe` defines its width and its
    /// irregularity.
    pub fn new(scalp: &dyn Scalp, x: f32, recipe: &Recipe) -> Self {
        // Degrees above the horizon; a fringe is combed from farther back.
        let front = if recipe.fringe { 66.0 } else { 22.0 };
        let line = (0..=48)
            .map(|i| {
                let t = i as f32 / 48.0;
                let angle = (front + (102.0 - front) * t).to_radians();
                let astray = recipe.parting_wander * noise(Vec3::new(t * 9.0, 0.5, 0.5), recipe.seed);
                let lateral = x * (1.0 - 0.35 * t * t) + astray;
                let dir = Vec3::new(lateral / 0.085, angle.sin(), angle.cos());
                scalp.point(dir)
            })
            .collect();
        Self { line, half_width: recipe.parting_half_width }
    }

    /// Returns the point of the parting nearest to `p`.
    pub fn nearest(&self, p: Vec3) -> Vec3 {
        let mut best = (f32::INFINITY, p);
        for w in self.line.windows(2) {
            let edge = w[1] - w[0];
            let t = ((p - w[0]).dot(edge) / edge.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let q = w[0] + edge * t;
            let d = q.distance_squared(p);
            if d < best.0 {
                best = (d, q);
            }
        }
        best.1
    }

    /// Returns whether the parting runs between the scalp points `a` and `b`.
    pub fn separates(&self, a: Vec3, b: Vec3) -> bool {
        let (midpoint, radius) = (0.5 * (a + b), 0.55 * a.distance(b));
        let q = self.nearest(midpoint);
        q.distance_squared(midpoint) < radius * radius && self.side(a) != self.side(b)
    }

    /// Returns the side of `p`, -1 or 1: the sign of its x relative to the parting.
    pub fn side(&self, p: Vec3) -> f32 {
        if p.x >= self.nearest(p).x { 1.0 } else { -1.0 }
    }

    /// Returns the end of the parting at the crown.
    pub fn end(&self) -> Vec3 {
        self.line.last().copied().unwrap_or(Vec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Style;
    use super::*;
    use crate::scalp::GridScalp;

    #[test]
    fn a_parting_lies_on_the_scalp_and_has_two_sides() {
        let head = GridScalp::mannequin(96);
        let parting = Parting::new(&head, 0.02, &Style::default().recipe());
        for p in &parting.line {
            assert!(head.distance(*p).abs() < 1e-3);
        }
        let p = parting.line[20];
        assert!(parting.nearest(p).distance(p) < 1e-5);
        for i in 0..200 {
            let p = head.point(crate::scalp::spread_direction(i, glam::Vec2::ZERO));
            let brute = parting.line.iter().map(|q| q.distance(p)).fold(f32::INFINITY, f32::min);
            assert!(parting.nearest(p).distance(p) < brute + 1e-6);
        }
        assert!(parting.separates(p + Vec3::X * 0.01, p - Vec3::X * 0.01));
        assert!(!parting.separates(p + Vec3::X * 0.01, p + Vec3::X * 0.03));
        assert_eq!(parting.side(p + Vec3::X * 0.01), 1.0);
        assert_eq!(parting.side(p - Vec3::X * 0.01), -1.0);
    }
}
