//! Outlines as lines: boxes of grids, surfaces of distance fields.

use super::{GridView, LinePoint};
use crate::{Pose, groom::SdfGrid};
use glam::{UVec3, Vec3};

/// Style of outlines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pen {
    /// Value that sets the color.
    pub value: f32,
    /// Width of lines, pixels.
    pub width: f32,
}

impl Pen {
    /// Adds a line through `points` (world space, meters) to `out`, not connected to earlier lines.
    pub fn line(self, out: &mut Vec<LinePoint>, points: impl IntoIterator<Item = Vec3>) {
        if let Some(last) = out.last() {
            out.push(LinePoint { alpha: -1.0, ..*last });
        }
        out.extend(points.into_iter().map(|position| LinePoint {
            position,
            value: self.value,
            width: self.width,
            alpha: 1.0,
            ..Default::default()
        }));
    }

    /// Adds the twelve edges of the box of `grid`.
    pub fn cuboid(self, out: &mut Vec<LinePoint>, grid: &GridView<'_>) {
        let corner = |i: usize| Vec3::from_array(std::array::from_fn(|axis| ((i >> axis) & 1) as f32));
        for i in 0..8 {
            for axis in (0..3).filter(|axis| i >> axis & 1 == 0) {
                self.line(out, [corner(i), corner(i | 1 << axis)].map(|c| grid.world(c)));
            }
        }
    }

    /// Adds lines where `field`, placed at `pose`, has the distance `level` (meters), in planes across `axis` (0 to 2)
    /// that lie `every` nodes apart. They show the surface that hair collides with, not the mesh. A level just above 0
    /// keeps the lines off the mesh.
    pub fn contours(
        self,
        out: &mut Vec<LinePoint>,
        field: &SdfGrid,
        pose: &Pose,
        level: f32,
        axis: usize,
        every: u32,
    ) {
        let (axis, n) = (axis.min(2), field.size);
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|axis| {
            let mut unit = UVec3::ZERO;
            unit[axis] = 1;
            (unit, n[axis])
        });
        let mut normal = UVec3::ZERO;
        normal[axis] = 1;
        let index = |node: UVec3| node.x + n.x * (node.y + n.y * node.z);
        for plane in (0..n[axis]).step_by(every.max(1) as usize) {
            for i in 0..u.1.saturating_sub(1) {
                for j in 0..v.1.saturating_sub(1) {
                    // Walk around a square of nodes and find edges on which the sign changes.
                    let base = normal * plane + u.0 * i + v.0 * j;
                    let corners = [base, base + u.0, base + u.0 + v.0, base + v.0]
                        .map(|node| (field.node(index(node)), field.distances[index(node) as usize] - level));
                    let crossings: Vec<_> = (0..4)
                        .filter_map(|k| {
                            let ((a, from), (b, to)) = (corners[k], corners[(k + 1) % 4]);
                            ((from < 0.0) != (to < 0.0)).then(|| a.lerp(b, from / (from - to)))
                        })
                        .collect();
                    for pair in crossings.as_chunks::<2>().0 {
                        self.line(out, pair.map(|p| pose.point(p)));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    const PEN: Pen = Pen { value: 0.0, width: 2.0 };

    fn pose() -> Pose {
        Pose { rotation: Quat::from_rotation_z(0.7), translation: Vec3::new(0.1, 0.2, 0.3) }
    }

    /// Returns the largest distance of the visible points from a surface, in the frame of [`pose`].
    fn off(points: &[LinePoint], distance: impl Fn(Vec3) -> f32) -> f32 {
        let shown = points.iter().filter(|p| p.alpha >= 0.0);
        shown.map(|p| distance(pose().inverse().point(p.position)).abs()).fold(0.0, f32::max)
    }

    /// Returns the length of the longest visible segment.
    fn longest(points: &[LinePoint]) -> f32 {
        let shown = points.windows(2).filter(|w| w[0].alpha >= 0.0 && w[1].alpha >= 0.0);
        shown.map(|w| w[0].position.distance(w[1].position)).fold(0.0, f32::max)
    }

    #[test]
    fn contours_follow_the_level() {
        let field = SdfGrid::from_fn(Vec3::splat(-0.2), Vec3::splat(0.2), 41, |p| p.length() - 0.09);
        for axis in 0..3 {
            let mut points = Vec::new();
            PEN.contours(&mut points, &field, &pose(), 0.01, axis, 5);
            assert!(off(&points, |p| p.length() - 0.1) < 5e-4 && longest(&points) < 0.015);
            assert!(off(&points, |p| p.length() - 0.11) > 5e-3);
            // Planes 5 cm apart: circles of radius 10 cm and twice √75 cm, and a point at each pole.
            let length: f32 = points
                .windows(2)
                .filter(|w| w[0].alpha >= 0.0 && w[1].alpha >= 0.0)
                .map(|w| w[0].position.distance(w[1].position))
                .sum();
            let expected = std::f32::consts::TAU * (0.1 + 2.0 * 0.0075f32.sqrt());
            assert!((length / expected - 1.0).abs() < 0.02, "{length} {expected}");
            for p in points.iter().filter(|p| p.alpha >= 0.0) {
                let along = pose().inverse().point(p.position)[axis] / 0.05;
                assert!((along - along.round()).abs() < 1e-4);
            }
        }
    }
}
