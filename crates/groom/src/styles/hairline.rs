//! Hairline: the irregular border of the region of the scalp where hair grows.

use crate::random::{noise, smoothstep};
use crate::scalp::Scalp;
use glam::Vec3;

/// Line from the forehead over the temple, around the ear and down to the nape, on both sides.
#[derive(Clone, Debug)]
pub struct Hairline {
    skull: Vec3,
    seed: u32,
    irregularity: f32,
    /// Elevation of the line, radians, at equal steps of the azimuth from 0 (front) to pi (back).
    line: Vec<f32>,
}

/// Steps of the table of elevations.
const STEPS: usize = 90;

/// Knots of the line: azimuth in degrees from the front (the ear is at 90), reference landmark, and height above it in
/// centimeters.
const CONTROL_POINTS: [(f32, Mark, f32); 17] = [
    (0.0, Mark::Brow, 5.7),
    (14.0, Mark::Brow, 5.9),
    (26.0, Mark::Brow, 6.1),
    (36.0, Mark::Brow, 5.5),
    (44.0, Mark::Brow, 3.9),
    (52.0, Mark::Brow, 2.2),
    (62.0, Mark::Brow, 0.9),
    (70.0, Mark::Ear, 1.2),
    (76.0, Mark::Ear, -0.4),
    (81.0, Mark::Ear, 0.6),
    (87.0, Mark::Ear, 3.5),
    (96.0, Mark::Ear, 4.2),
    (106.0, Mark::Ear, 3.2),
    (116.0, Mark::Ear, -0.6),
    (128.0, Mark::Ear, -3.2),
    (150.0, Mark::Nape, -0.2),
    (180.0, Mark::Nape, -0.6),
];

#[derive(Clone, Copy, Debug)]
enum Mark {
    Brow,
    Ear,
    Nape,
}

/// Returns the direction from the skull at an azimuth (from the front toward +x) and an elevation, radians.
fn direction(azimuth: f32, elevation: f32) -> Vec3 {
    Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
}

impl Hairline {
    /// Creates the hairline on `scalp`, moved up (positive) or down by `raise` meters, with random deviations of about
    /// `irregularity` meters.
    pub fn new(scalp: &dyn Scalp, raise: f32, irregularity: f32, seed: u32) -> Self {
        let marks = scalp.landmarks();
        let ear_azimuth = (marks.ear.x).atan2(marks.ear.z - marks.skull.z).to_degrees();
        let control_points = CONTROL_POINTS.map(|(azimuth, mark, height)| {
            let base = match mark {
                Mark::Brow => marks.brow.y,
                Mark::Ear => marks.ear.y,
                Mark::Nape => marks.nape.y,
            };
            // Knots are relative to the mannequin's ear: shift them to this head's ear, but keep front and back.
            let shift = (ear_azimuth - 90.0) * (1.0 - (azimuth - 90.0).abs() / 90.0);
            (azimuth + shift, base + height * 0.01 + raise)
        });
        let line = (0..=STEPS)
            .map(|i| {
                let azimuth = 180.0 * i as f32 / STEPS as f32;
                let at = control_points[1..control_points.len() - 1].partition_point(|k| k.0 < azimuth);
                let ((a0, y0), (a1, y1)) = (control_points[at], control_points[at + 1]);
                let y = y0
                    + (y1 - y0)
                        * smoothstep(a0, a1, azimuth)
                            .mul_add(0.5, 0.5 * ((azimuth - a0) / (a1 - a0)).clamp(0.0, 1.0));
                elevation_at_height(scalp, azimuth.to_radians(), y)
            })
            .collect();
        Self { skull: marks.skull, seed, irregularity, line }
    }

    /// Returns the distance from the line along the scalp at the direction of `p` from the skull, meters, positive
    /// where hair grows. Near the line, it is accurate to a few tenths of its value.
    pub fn inside(&self, p: Vec3) -> f32 {
        let v = p - self.skull;
        let r = v.length();
        let elevation = (v.y / r.max(1e-6)).clamp(-1.0, 1.0).asin();
        let x = v.x.atan2(v.z).abs() / std::f32::consts::PI * STEPS as f32;
        let i = (x as usize).min(STEPS - 1);
        let line = self.line[i] + (self.line[i + 1] - self.line[i]) * (x - i as f32);
        let next = (i + 3).min(STEPS);
        let previous = i.saturating_sub(2);
        let step = std::f32::consts::PI / STEPS as f32 * elevation.cos().max(0.2);
        let slope = (self.line[next] - self.line[previous]) / (step * (next - previous) as f32);
        let wander = noise(p * 130.0, self.seed) * 0.6 + noise(p * 300.0, self.seed ^ 5) * 0.4;
        (elevation - line) * r / (1.0 + slope * slope).sqrt() + wander * self.irregularity
    }

    /// Returns the direction from the skull to the line at an azimuth (radians, from the front toward +x).
    pub fn edge(&self, azimuth: f32) -> Vec3 {
        let x = azimuth.abs() / std::f32::consts::PI * STEPS as f32;
        let i = (x as usize).min(STEPS - 1);
        direction(azimuth, self.line[i] + (self.line[i + 1] - self.line[i]) * (x - i as f32).min(1.0))
    }
}

/// Returns the elevation at which the scalp at `azimuth` has the height `y`. Bisection works because the height of the
/// scalp rises with the elevation.
fn elevation_at_height(scalp: &dyn Scalp, azimuth: f32, y: f32) -> f32 {
    let (mut lo, mut hi) = (-1.2f32, 1.4f32);
    for _ in 0..18 {
        let midpoint = 0.5 * (lo + hi);
        if scalp.point(direction(azimuth, midpoint)).y < y {
            lo = midpoint;
        } else {
            hi = midpoint;
        }
    }
    0.5 * (lo + hi)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalp::GridScalp;

    #[test]
    fn hairline_excludes_face_ears_and_neck() {
        let head = GridScalp::mannequin(96);
        let line = Hairline::new(&head, 0.0, 0.002, 3);
        let marks = head.landmarks();
        let up = head.point(Vec3::Y);
        assert!(line.inside(up) > 0.05);
        for bare in [marks.brow, marks.chin, marks.ear, head.point(Vec3::new(0.0, -0.9, -0.5))] {
            assert!(line.inside(bare) < 0.0, "{bare}");
        }
        // Points just inside and outside of the line.
        for i in 0..60 {
            let edge = line.edge(i as f32 * 0.1 - 3.0);
            let (above, below) = (head.point(edge + Vec3::Y * 0.12), head.point(edge - Vec3::Y * 0.12));
            assert!(line.inside(above) > 0.0 && line.inside(below) < 0.0, "{i}");
        }
    }
}
