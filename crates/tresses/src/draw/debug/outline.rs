//! Outlines as lines: boxes and capsules.

use super::{Grid, LinePoint};
use crate::{Pose, simulate::collider::Capsule};
use glam::{Quat, Vec3};

/// Points of a full circle.
const CIRCLE: u32 = 48;

/// How outlines are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// What its colour stands for.
    pub value: f32,
    /// Pixels.
    pub width: f32,
}

impl Pen {
    /// Adds a line through `points` to `out`, apart from what `out` already holds.
    fn line(self, out: &mut Vec<LinePoint>, points: impl IntoIterator<Item = Vec3>) {
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

    /// The twelve edges of the box of `grid`.
    pub fn cuboid(self, out: &mut Vec<LinePoint>, grid: &Grid<'_>) {
        let corner = |i: usize| Vec3::from_array(std::array::from_fn(|axis| ((i >> axis) & 1) as f32));
        for i in 0..8 {
            for axis in (0..3).filter(|axis| i >> axis & 1 == 0) {
                self.line(out, [corner(i), corner(i | 1 << axis)].map(|c| grid.world(c)));
            }
        }
    }

    /// A capsule: a circle around each end, two across its caps and four lines along it.
    pub fn capsule(self, out: &mut Vec<LinePoint>, capsule: &Capsule) {
        let along = (capsule.b - capsule.a).normalize_or(Vec3::Y);
        let turn = Quat::from_rotation_arc(Vec3::Y, along);
        let frame = |at| Pose { rotation: turn, translation: at };
        let arc = |at: Vec3, from: u32, to: u32, form: fn(f32, f32) -> Vec3| {
            let pose = frame(at);
            (from..=to).map(move |i| {
                let (sin, cos) = (i as f32 / CIRCLE as f32 * std::f32::consts::TAU).sin_cos();
                pose.point(form(sin, cos) * capsule.radius)
            })
        };
        for end in [capsule.a, capsule.b] {
            self.line(out, arc(end, 0, CIRCLE, |sin, cos| Vec3::new(cos, 0.0, sin)));
        }
        for form in [|sin: f32, cos: f32| Vec3::new(cos, sin, 0.0), |sin, cos| Vec3::new(0.0, sin, cos)] {
            // Over b, down the side, under a, up the other side.
            let (top, bottom) =
                (arc(capsule.b, 0, CIRCLE / 2, form), arc(capsule.a, CIRCLE / 2, CIRCLE, form));
            let close = arc(capsule.b, 0, 0, form);
            self.line(out, top.chain(bottom).chain(close));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest distance of the shown points from the surface of the capsule.
    fn off(points: &[LinePoint], capsule: &Capsule) -> f32 {
        let distance = |p: Vec3| {
            let axis = capsule.b - capsule.a;
            let t = ((p - capsule.a).dot(axis) / axis.length_squared().max(1e-12)).clamp(0.0, 1.0);
            ((p - capsule.a - t * axis).length() - capsule.radius).abs()
        };
        points.iter().filter(|p| p.alpha >= 0.0).map(|p| distance(p.position)).fold(0.0, f32::max)
    }

    #[test]
    fn a_capsules_outline_is_on_its_surface() {
        let pen = Pen { value: 0.0, width: 2.0 };
        let capsule = Capsule { a: Vec3::new(0.1, 0.2, 0.3), b: Vec3::new(-0.2, 0.1, 0.5), radius: 0.04 };
        for capsule in [capsule, Capsule { b: capsule.a, ..capsule }] {
            let mut points = Vec::new();
            pen.capsule(&mut points, &capsule);
            assert!(points.len() > 4 * CIRCLE as usize / 2);
            assert!(off(&points, &capsule) < 1e-6);
            assert!(off(&points, &Capsule { radius: 0.05, ..capsule }) > 5e-3);
            // Lines lie apart: no segment leads from one to the next.
            let segments = points.windows(2).filter(|w| w[0].alpha >= 0.0 && w[1].alpha >= 0.0);
            let longest = (capsule.b - capsule.a).length().max(0.01);
            assert!(segments.map(|w| w[0].position.distance(w[1].position)).all(|d| d <= longest + 1e-6));
        }
    }
}
