//! Resemblance of a mesh, in a given frame, to a human head.
//!
//! Human heads have similar profiles. In slices of 0.3 skull radii from the crown down, the foremost and hindmost
//! points in the middle and the half breadth deviate by at most a tenth of a radius from a common curve, whether a head
//! is scanned, modeled or drawn.

use glam::Vec3;

use super::frame::Frame;

/// Number of slices, from crown to mouth; below the mouth, chins and necks differ.
const SLICES: usize = 9;
/// Height of a slice, skull radii.
const SLICE: f32 = 0.3;
/// Front, back and half breadth of each slice, skull radii: the mean of five heads.
const HEAD: [[f32; 3]; SLICES] = [
    [0.68, 0.81, 0.65],
    [0.97, 0.99, 0.81],
    [1.09, 1.10, 0.88],
    [1.13, 1.14, 0.90],
    [1.17, 1.12, 1.03],
    [1.26, 1.05, 1.01],
    [1.27, 0.88, 0.92],
    [1.18, 0.80, 0.75],
    [1.07, 0.82, 0.62],
];
/// Maximum difference of one value, and the difference of a missing slice.
const WORST: f32 = 0.5;

/// Returns the mean difference to a head, skull radii, from 0 to [`WORST`].
pub(super) fn difference(points: &[Vec3], frame: Frame) -> f32 {
    let (up, front) = (frame.up.vector(), frame.front.vector());
    let side = up.cross(front);
    let mut points: Vec<Vec3> =
        points.iter().map(|p| Vec3::new(p.dot(side), p.dot(up), p.dot(front))).collect();
    points.sort_unstable_by(|a, b| b.y.total_cmp(&a.y));
    let Some((radius, crown, center)) = skull(&points) else { return WORST };
    let mut slices = [[f32::MIN; 3]; SLICES];
    for p in &points {
        let slice = ((crown - p.y) / (SLICE * radius)) as usize;
        let Some([front, back, breadth]) = slices.get_mut(slice) else { break };
        let q = (*p - center) / radius;
        *breadth = breadth.max(q.x.abs());
        if q.x.abs() < 0.35 {
            *front = front.max(q.z);
            *back = back.max(-q.z);
        }
    }
    let pairs = slices.as_flattened().iter().zip(HEAD.as_flattened());
    pairs.map(|(is, should)| (is - should).abs().min(WORST)).sum::<f32>() / (3 * SLICES) as f32
}

/// Returns radius of the skull, height of the crown and center of the skull, from points sorted from the top down. It
/// uses that a ball's half breadth at a depth of its radius equals that depth.
fn skull(points: &[Vec3]) -> Option<(f32, f32, Vec3)> {
    let crown = points.first()?.y;
    let (mut lo, mut hi) = (Vec3::MAX, Vec3::MIN);
    for p in points {
        lo = lo.min(*p);
        hi = hi.max(*p);
        let (depth, half) = (crown - p.y, 0.25 * ((hi.x - lo.x) + (hi.z - lo.z)));
        if depth > 0.0 && depth >= half && half > 0.0 {
            return Some((depth, crown, 0.5 * (lo + hi)));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orient::Axis;

    #[test]
    fn mean_head_matches_only_upright() {
        let mut points = vec![Vec3::new(0.0, 1.0, 0.0)];
        for (i, [front, back, breadth]) in HEAD.iter().enumerate() {
            let y = 1.0 - (i as f32 + 0.5) * SLICE;
            points.extend([
                Vec3::new(0.0, y, *front),
                Vec3::new(0.0, y, -back),
                Vec3::new(*breadth, y, 0.0),
                Vec3::new(-breadth, y, 0.0),
            ]);
        }
        let upright = difference(&points, Frame { up: Axis::Y, front: Axis::Z });
        assert!(upright < 0.12, "{upright}");
        for frame in Frame::all().filter(|f| *f != Frame { up: Axis::Y, front: Axis::Z }) {
            assert!(difference(&points, frame) > upright + 0.02, "{frame:?}");
        }
    }
}
