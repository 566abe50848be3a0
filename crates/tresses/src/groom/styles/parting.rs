//! The line from which hair falls to both sides.

use super::random::noise;
use super::scalp::Scalp;
use glam::Vec3;

/// A parting: a line over the scalp from the forehead to the crown, seen as a narrow strip of skin.
#[derive(Clone, Debug)]
pub struct Parting {
    /// Points on the scalp from the front to the crown, metres.
    pub line: Vec<Vec3>,
    /// Half the width of the bare strip, metres.
    pub half_width: f32,
}

impl Parting {
    /// A parting at the distance `x` (metres, positive to the head's left) from the middle, from the
    /// forehead's hairline at `front` back to the crown, where it turns towards the middle.
    pub fn new(scalp: &dyn Scalp, x: f32, half_width: f32, seed: u32) -> Self {
        let line = (0..=48)
            .map(|i| {
                let t = i as f32 / 48.0;
                // From 20 degrees above the horizon at the front to 30 degrees behind the top.
                let angle = (22.0 + 98.0 * t).to_radians();
                let wander = 0.0012 * noise(Vec3::new(t * 9.0, 0.5, 0.5), seed);
                let aside = x * (1.0 - 0.35 * t * t) + wander;
                let dir = Vec3::new(aside / 0.085, angle.sin(), angle.cos());
                scalp.point(dir)
            })
            .collect();
        Self { line, half_width }
    }

    /// The point of the parting that is nearest to `p`.
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

    /// The side of `p`: -1 or 1, by the sign of its x beyond the parting.
    pub fn side(&self, p: Vec3) -> f32 {
        if p.x >= self.nearest(p).x { 1.0 } else { -1.0 }
    }

    /// Where the parting ends, at the crown.
    pub fn end(&self) -> Vec3 {
        self.line.last().copied().unwrap_or(Vec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::super::GridScalp;
    use super::*;

    #[test]
    fn a_parting_lies_on_the_scalp_and_has_two_sides() {
        let head = GridScalp::mannequin(96);
        let parting = Parting::new(&head, 0.02, 0.0015, 1);
        for p in &parting.line {
            assert!(head.distance(*p).abs() < 1e-3);
        }
        let p = parting.line[20];
        assert!(parting.nearest(p).distance(p) < 1e-5);
        assert_eq!(parting.side(p + Vec3::X * 0.01), 1.0);
        assert_eq!(parting.side(p - Vec3::X * 0.01), -1.0);
    }
}
