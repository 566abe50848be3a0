//! Views from a light into its shadow map.
//!
//! A distant light has one view with parallel rays. A light that is farther from the middle of the focus than
//! [`CUBE_DISTANCE`] radii has one view with perspective. A nearer light, even one within the hair, has the six faces of
//! a cube, which share one map: the face towards the focus takes four of nine squares, the others one each.
//!
//! Depth is linear from the near to the far end of a view, in all of them. Only depth textures, which triangles are
//! drawn into, have perspective depth (`transmittance::body_visibility`).
//!
//! Views keep still while the focus moves a little, so that shadows do not crawl: a view with parallel rays moves by
//! whole texels, one with perspective turns and widens in steps.

use super::{
    light::{Light, LightShape},
    sphere::Sphere,
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};

/// Distance of a light below which it has the six faces of a cube, in radii of the focus.
const CUBE_DISTANCE: f32 = 1.25;
/// Distance from a light within which nothing casts shadows, meters.
const NEAREST: f32 = 0.005;
/// Tangent of half the angle of a cube's face. Neighbors overlap, so that filters stay within one face.
const FACE: f32 = 1.06;
/// Steps of the direction of a view with perspective, per half angle.
const DIRECTION_STEPS: f32 = 4.0;
/// Steps of its width per octave.
const WIDTH_STEPS: f32 = 4.0;
/// Widest cone of a spot light that has a single view, radians.
const WIDEST_CONE: f32 = 1.0;

/// A view from a light into its shadow map, as shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct MapView {
    /// World to clip space of the whole map, where depth is from 0 at the near end to 1 at the far end, and is not
    /// divided by w.
    pub matrix: Mat4,
    /// Center of the part of the map that the view covers, texture coordinates.
    pub center: [f32; 2],
    /// Half the width and height of that part.
    pub half: [f32; 2],
    /// Distance of the near end from the light, meters; 0 for parallel rays.
    pub near: f32,
    /// Distance between the ends, meters.
    pub range: f32,
    /// Meters per texture coordinate; at a distance of one meter if the view has perspective.
    pub width: f32,
    /// Number of the map.
    pub map: u32,
}

impl MapView {
    /// Creates the view with parallel rays from `direction` around `focus`. It moves with the focus in steps of `step`
    /// meters.
    pub fn parallel(direction: Vec3, focus: &Sphere, step: f32) -> Self {
        let [x, y, z] = axes(direction.normalize_or(Vec3::Y));
        let radius = focus.radius.max(1e-6);
        let snap = |v: f32| (v / step).round() * step;
        let at = Vec3::new(snap(focus.center.dot(x)), snap(focus.center.dot(y)), focus.center.dot(z));
        // Rows of the transform: the axes scaled to -1..1, and depth 0 at the sphere's end towards the light.
        let row = |axis: Vec3, scale: f32, offset: f32| (axis * scale).extend(offset);
        let matrix = Mat4::from_cols(
            row(x, 1.0 / radius, -at.x / radius),
            row(y, 1.0 / radius, -at.y / radius),
            row(z, -0.5 / radius, 0.5 + 0.5 * at.z / radius),
            Vec4::W,
        );
        Self {
            matrix: matrix.transpose(),
            center: [0.5; 2],
            half: [0.5; 2],
            near: 0.0,
            range: 2.0 * focus.radius,
            width: 2.0 * focus.radius,
            map: 0,
        }
    }

    /// Creates the view from `place` with the axes right, up and backward, whose half angle has the tangent `half_angle`,
    /// into the part of the map around `center`. The ends are at the distances `near` and `far`, meters.
    fn perspective(
        place: Vec3,
        [x, y, z]: [Vec3; 3],
        half_angle: f32,
        [near, far]: [f32; 2],
        (center, half): (Vec2, f32),
    ) -> Self {
        let row =
            |axis: Vec3, scale: f32, offset: f32| (axis * scale).extend(offset - scale * axis.dot(place));
        let range = far - near;
        let w = row(-z, 1.0, 0.0);
        let [x, y] = [x, y].map(|axis| row(axis, 2.0 * half / half_angle, 0.0));
        let off = 2.0 * (center - 0.5);
        let depth = row(-z, 1.0 / range, -near / range);
        let matrix = Mat4::from_cols(x + off.x * w, y - off.y * w, depth, w).transpose();
        Self { matrix, center: center.into(), half: [half; 2], near, range, width: half_angle / half, map: 0 }
    }

    /// Returns the views of `light` around `focus`. `step` is that of [`parallel`](Self::parallel).
    pub fn of(light: &Light, focus: &Sphere, step: f32) -> Vec<Self> {
        let Some(place) = light.center() else {
            let LightShape::Distant { direction } = light.shape else { return Vec::new() };
            return vec![Self::parallel(direction, focus, step)];
        };
        let whole = (Vec2::splat(0.5), 0.5);
        let offset = focus.center - place;
        let distance = offset.length();
        let far = distance + focus.radius;
        if let LightShape::Spot { direction, outer, .. } = light.shape
            && outer < WIDEST_CONE
            && distance < 3.0 * focus.radius
        {
            return vec![Self::perspective(
                place,
                axes(-direction.normalize_or(Vec3::NEG_Y)),
                outer.tan().max(1e-3),
                [(distance - focus.radius).max(NEAREST), far],
                whole,
            )];
        }
        let towards = offset.normalize_or(Vec3::NEG_Y);
        let steps = (DIRECTION_STEPS * (distance / focus.radius).max(1.0)).log2().ceil().exp2();
        let forward = (towards * steps).round().normalize_or(towards);
        if distance > CUBE_DISTANCE * focus.radius {
            let angle = (focus.radius / distance).asin() + forward.angle_between(towards);
            let half_angle = ((angle.tan().log2() * WIDTH_STEPS).ceil() / WIDTH_STEPS).exp2();
            // The near end is a plane, and must not cut the sphere.
            let ends = [(distance - focus.radius) * angle.cos(), far];
            return vec![Self::perspective(
                place,
                axes(-forward),
                half_angle,
                ends.map(|end| end.max(NEAREST)),
                whole,
            )];
        }
        let [x, y, z] = axes(-forward);
        let square =
            |column: usize, row: usize| (Vec2::new(column as f32 + 0.5, row as f32 + 0.5) / 3.0, 1.0 / 6.0);
        // The first face looks forward.
        let faces = [
            ([x, y, z], (Vec2::splat(1.0 / 3.0), 1.0 / 3.0)),
            ([-x, y, -z], square(2, 0)),
            ([z, y, -x], square(2, 1)),
            ([-z, y, x], square(2, 2)),
            ([x, z, -y], square(0, 2)),
            ([x, -z, y], square(1, 2)),
        ];
        let ends = [NEAREST, far.max(2.0 * NEAREST)];
        faces.map(|(axes, part)| Self::perspective(place, axes, FACE, ends, part)).to_vec()
    }

    /// Returns the world to clip space transform of the view's own part of the map, with linear depth.
    pub fn local(&self) -> Mat4 {
        if self.near == 0.0 {
            return self.matrix;
        }
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| self.matrix.row(i));
        let off = 2.0 * (Vec2::from(self.center) - 0.5);
        let scale = 0.5 / Vec2::from(self.half);
        let rows = [(x - off.x * w) * scale.x, (y + off.y * w) * scale.y, z, w];
        Mat4::from_cols_array_2d(&rows.map(|row| row.to_array())).transpose()
    }

    /// Returns the world to clip space transform for triangles, in the view's own part of the map: depth has
    /// perspective.
    pub fn raster(&self) -> Mat4 {
        match self.near > 0.0 {
            true => Mat4::from_scale(Vec3::new(1.0, 1.0, self.near + self.range)) * self.local(),
            false => self.matrix,
        }
    }

    /// Returns the position of a light whose rays are not parallel, meters.
    pub fn place(&self) -> Option<Vec3> {
        // The light is where x, y and w of the clip space are 0.
        let [x, y, _, w] = [0, 1, 2, 3].map(|i| self.matrix.row(i));
        let rows = glam::Mat3::from_cols(x.truncate(), y.truncate(), w.truncate()).transpose();
        (self.near > 0.0).then(|| rows.inverse() * -Vec3::new(x.w, y.w, w.w))
    }

    /// Returns the view's part of a map of `edge`² texels: left, top, width and height, texels.
    pub fn viewport(&self, edge: u32) -> [f32; 4] {
        let edge = edge as f32;
        let low = (Vec2::from(self.center) - Vec2::from(self.half)) * edge;
        [low.x, low.y, 2.0 * self.half[0] * edge, 2.0 * self.half[1] * edge]
    }
}

/// Returns axes to the right, up, and along `z`, a unit vector.
fn axes(z: Vec3) -> [Vec3; 3] {
    let x = (if z.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y }).cross(z).normalize();
    [x, z.cross(x), z]
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOCUS: Sphere = Sphere { center: Vec3::new(0.3, 1.5, -0.2), radius: 0.25 };

    /// Texture coordinates, and linear depth, of a point in a view.
    fn project(view: &MapView, point: Vec3) -> (Vec2, f32) {
        let clip = view.matrix * point.extend(1.0);
        (Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5, clip.z)
    }

    fn is_inside(view: &MapView, point: Vec3) -> bool {
        let (at, depth) = project(view, point);
        let w = (view.matrix * point.extend(1.0)).w;
        let off = (at - Vec2::from(view.center)).abs();
        w > 0.0 && (0.0..1.0).contains(&depth) && off.cmplt(Vec2::from(view.half)).all()
    }

    /// Directions spread over a sphere.
    fn directions() -> impl Iterator<Item = Vec3> {
        (0..200).map(|i| {
            let (y, angle) = (1.0 - (2.0 * i as f32 + 1.0) / 200.0, 2.399_963_2 * i as f32);
            let flat = (1.0 - y * y).sqrt();
            Vec3::new(flat * angle.cos(), y, flat * angle.sin())
        })
    }

    #[test]
    fn parallel_view_fits_the_focus() {
        for direction in [Vec3::Y, Vec3::new(0.3, 0.5, 0.8), Vec3::NEG_Y] {
            let matrix = MapView::parallel(direction, &FOCUS, 0.5 / 1024.0).matrix;
            let unit = direction.normalize();
            let center = matrix.project_point3(FOCUS.center);
            assert!((center - Vec3::new(0.0, 0.0, 0.5)).length() < 3e-3, "{center}");
            let near = matrix.project_point3(FOCUS.center + unit * 0.25);
            assert!(near.z.abs() < 2e-3, "{near}");
        }
    }

    #[test]
    fn parallel_view_moves_in_whole_texels() {
        // Along z the map may move freely, since depth has no texels.
        let at = |x: f32| {
            let focus = Sphere { center: Vec3::new(x, 1.5, 0.0), radius: 0.25 };
            let view = MapView::parallel(Vec3::new(0.2, 0.6, 0.7), &focus, 0.5 / 1024.0);
            view.matrix.project_point3(Vec3::ZERO).truncate() * 512.0
        };
        for i in 0..50 {
            let moved = at(0.0) - at(i as f32 * 1.3e-4);
            assert!((moved - moved.round()).length() < 0.02, "{moved}");
        }
    }

    #[test]
    fn views_of_near_lights_cover_the_focus() {
        for distance in [0.0, 0.1, 0.24, 0.3, 0.4, 1.0, 5.0] {
            for to_light in directions().step_by(7) {
                let place = FOCUS.center + to_light * distance;
                let views = MapView::of(&Light::point(place, Vec3::ONE), &FOCUS, 1e-3);
                assert_eq!(views.len(), if distance > 0.3125 { 1 } else { 6 });
                for direction in directions() {
                    let point = FOCUS.center + 0.999 * FOCUS.radius * direction;
                    if point.distance(place) < 2.0 * NEAREST {
                        continue;
                    }
                    let found = views.iter().filter(|view| is_inside(view, point)).count();
                    assert!(found > 0, "{point} from {place}");
                    // The face whose axis is nearest is one of them.
                    let w = |view: &&MapView| (view.matrix * point.extend(1.0)).w;
                    let main = views.iter().max_by(|a, b| w(a).total_cmp(&w(b))).unwrap();
                    assert!(is_inside(main, point), "{point} from {place}: {:?}", project(main, point));
                }
            }
        }
    }

    #[test]
    fn faces_of_a_cube_share_a_map() {
        let views = MapView::of(&Light::point(FOCUS.center, Vec3::ONE), &FOCUS, 1e-3);
        let area: f32 = views.iter().map(|view| 4.0 * view.half[0] * view.half[1]).sum();
        assert!((area - 1.0).abs() < 1e-5, "{area}");
        for (i, a) in views.iter().enumerate() {
            for b in &views[..i] {
                let gap = (Vec2::from(a.center) - Vec2::from(b.center)).abs().max_element();
                assert!(gap > a.half[0] + b.half[0] - 1e-5, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn triangles_have_the_depth_that_shaders_compare() {
        let place = FOCUS.center + Vec3::X * 0.6;
        for view in MapView::of(&Light::point(place, Vec3::ONE), &FOCUS, 1e-3).into_iter().chain(MapView::of(
            &Light::point(FOCUS.center, Vec3::ONE),
            &FOCUS,
            1e-3,
        )) {
            for direction in directions() {
                let point = FOCUS.center + 0.2 * direction;
                if !is_inside(&view, point) {
                    continue;
                }
                let (at, linear) = project(&view, point);
                let drawn = view.raster().project_point3(point);
                let far = view.near + view.range;
                let expected = linear * far / (view.near + linear * view.range);
                assert!((drawn.z - expected).abs() < 1e-4, "{} {expected}", drawn.z);
                let local = (at - Vec2::from(view.center)) / Vec2::from(view.half);
                assert!((Vec2::new(drawn.x, -drawn.y) - local).length() < 1e-3, "{drawn} {local}");
            }
        }
    }

    #[test]
    fn near_views_know_their_light() {
        for distance in [0.1, 2.0] {
            let place = FOCUS.center + distance * Vec3::new(0.6, 0.0, 0.8);
            for view in MapView::of(&Light::point(place, Vec3::ONE), &FOCUS, 1e-3) {
                assert!(view.place().unwrap().distance(place) < 1e-3, "{:?} {place}", view.place());
            }
        }
        assert_eq!(MapView::of(&Light::distant(Vec3::X, Vec3::ONE), &FOCUS, 1e-3)[0].place(), None);
    }

    #[test]
    fn views_keep_still_while_the_head_moves() {
        let light = Light::point(Vec3::new(1.0, 2.0, 0.5), Vec3::ONE);
        let rows = |x: f32| {
            let focus = Sphere { center: Vec3::new(x, 1.5, 0.0), radius: 0.25 };
            let view = MapView::of(&light, &focus, 1e-3)[0];
            [0, 1, 3].map(|i| view.matrix.row(i))
        };
        let changes = (1..50).filter(|i| rows(*i as f32 * 1e-3) != rows((*i - 1) as f32 * 1e-3)).count();
        assert!(changes < 5, "{changes} of 49");
    }
}
