//! The surface of bodies in a picture: depth and normal per pixel, computed on the CPU from the vertices on the GPU.

use tresses::{
    glam::{Mat3, Mat4, Vec2, Vec3, Vec4},
    groom::TriMesh,
};

/// Surface in the middle of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// View-space depth, meters; infinite without a surface.
    pub depth: f32,
    /// Unit normal, world space; zero without a surface.
    pub normal: Vec3,
}

impl SurfaceSample {
    const NONE: Self = Self { depth: f32::INFINITY, normal: Vec3::ZERO };
}

/// A corner of a triangle: position in clip space, view-space depth and normal.
#[derive(Clone, Copy)]
struct Corner {
    clip: Vec4,
    depth: f32,
    normal: Vec3,
}

impl Corner {
    fn lerp(self, other: Self, t: f32) -> Self {
        Self {
            clip: self.clip.lerp(other.clip, t),
            depth: self.depth + (other.depth - self.depth) * t,
            normal: self.normal.lerp(other.normal, t),
        }
    }
}

/// Smallest clip coordinate w that is drawn.
const NEAR: f32 = 1e-3;

/// Returns the nearest surface of `meshes` (world space) in each pixel. Rows run from the top.
pub(super) fn rasterized(
    meshes: &[TriMesh],
    [view, projection]: [Mat4; 2],
    [width, height]: [u32; 2],
) -> Vec<SurfaceSample> {
    let mut samples = vec![SurfaceSample::NONE; width as usize * height as usize];
    let clip = projection * view;
    for mesh in meshes {
        let corner = |i: usize| Corner {
            clip: clip * mesh.positions[i].extend(1.0),
            depth: -view.transform_point3(mesh.positions[i]).z,
            normal: mesh.normals[i],
        };
        let corners: Vec<Corner> = (0..mesh.positions.len()).map(corner).collect();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| corners[i as usize]);
            let polygon = before_camera([a, b, c]);
            for k in 1..polygon.len().saturating_sub(1) {
                fill(&mut samples, [width, height], [polygon[0], polygon[k], polygon[k + 1]]);
            }
        }
    }
    samples
}

/// Cuts off the part of a triangle behind the camera.
fn before_camera(triangle: [Corner; 3]) -> Vec<Corner> {
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
        let [inside, next] = [from, to].map(|corner| corner.clip.w >= NEAR);
        polygon.extend(inside.then_some(from));
        if inside != next {
            polygon.push(from.lerp(to, (NEAR - from.clip.w) / (to.clip.w - from.clip.w)));
        }
    }
    polygon
}

/// Draws a triangle in front of the camera.
fn fill(samples: &mut [SurfaceSample], [width, height]: [u32; 2], triangle: [Corner; 3]) {
    let size = Vec2::new(width as f32, height as f32);
    let [a, b, c] = triangle.map(|corner| {
        let p = corner.clip.truncate().truncate() / corner.clip.w;
        Vec2::new(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y) * size
    });
    let area = (b - a).perp_dot(c - a);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    if !(area != 0.0 && low.is_finite() && high.is_finite()) {
        return;
    }
    // Pixels whose center lies in the bounding box.
    let pixels = |low: f32, high: f32, count: u32| {
        (low - 0.5).ceil().clamp(0.0, count as f32) as u32
            ..(high + 0.5).ceil().clamp(0.0, count as f32) as u32
    };
    for y in pixels(low.y, high.y, height) {
        for x in pixels(low.x, high.x, width) {
            let p = Vec2::new(x as f32, y as f32) + 0.5;
            let weights =
                Vec3::new((c - b).perp_dot(p - b), (a - c).perp_dot(p - c), (b - a).perp_dot(p - a)) / area;
            if weights.min_element() < 0.0 {
                continue;
            }
            // Weights in the picture become weights on the surface.
            let weights = weights / Vec3::from(triangle.map(|corner| corner.clip.w));
            let weights = weights / weights.element_sum();
            let depth = weights.dot(Vec3::from(triangle.map(|corner| corner.depth)));
            let sample = &mut samples[(y * width + x) as usize];
            if depth < sample.depth {
                let [a, b, c] = triangle.map(|corner| corner.normal);
                let normal = Mat3::from_cols(a, b, c) * weights;
                *sample = SurfaceSample { depth, normal: normal.normalize_or_zero() };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::{
        glam::camera::rh::{
            proj::directx::{orthographic, perspective_infinite_reverse},
            view::look_at_mat4,
        },
        groom::mesh::shapes,
    };

    #[test]
    fn sphere_has_its_depth_and_normals() {
        let mut mesh = shapes::sphere(0.5, 96);
        mesh.normals = mesh.positions.iter().map(|p| p.normalize_or_zero()).collect();
        let view = look_at_mat4(Vec3::Z * 2.0, Vec3::ZERO, Vec3::Y);
        let size = [61, 41];
        let aspect = 61.0 / 41.0;
        for projection in [
            perspective_infinite_reverse(0.8, aspect, 0.01),
            orthographic(-0.9 * aspect, 0.9 * aspect, -0.9, 0.9, 10.0, 0.01),
        ] {
            let samples = rasterized(std::slice::from_ref(&mesh), [view, projection], size);
            let middle = samples[20 * 61 + 30];
            assert!((middle.depth - 1.5).abs() < 2e-3 && middle.normal.z > 0.999, "{middle:?}");
            assert_eq!(samples[0], SurfaceSample::NONE);
            let hit = samples.iter().filter(|sample| sample.depth.is_finite());
            for sample in hit.clone() {
                // The normal of a sphere tells the place.
                assert!((sample.depth - (2.0 - 0.5 * sample.normal.z)).abs() < 3e-3, "{sample:?}");
            }
            // The area of the outline.
            let radius = match projection.w_axis.w {
                1.0 => 0.5 / 0.9,
                _ => (0.25f32).asin().tan() / (0.4f32).tan(),
            };
            let area = std::f32::consts::PI * (radius * 20.5).powi(2);
            assert!((hit.count() as f32 / area - 1.0).abs() < 0.03, "{area}");
        }
        // Right and up are positive x and y.
        let samples = rasterized(&[mesh], [view, perspective_infinite_reverse(0.8, aspect, 0.01)], size);
        assert!(samples[20 * 61 + 38].normal.x > 0.3 && samples[12 * 61 + 30].normal.y > 0.3);
    }

    #[test]
    fn triangles_behind_the_camera_are_cut() {
        let positions =
            vec![Vec3::new(-5.0, -1.0, -9.0), Vec3::new(5.0, -1.0, -9.0), Vec3::new(0.0, -1.0, 5.0)];
        let floor = TriMesh {
            normals: vec![Vec3::Y; 3],
            positions,
            triangles: vec![[0, 2, 1]],
            ..Default::default()
        };
        let projection = perspective_infinite_reverse(1.2, 1.0, 0.01);
        let samples = rasterized(&[floor], [Mat4::IDENTITY, projection], [32, 32]);
        for (i, sample) in samples.iter().enumerate().filter(|(_, sample)| sample.depth.is_finite()) {
            let down = ((i / 32) as f32 + 0.5) / 16.0 - 1.0;
            let depth = 1.0 / (down * 0.6f32.tan());
            assert!((sample.depth / depth - 1.0).abs() < 1e-3, "{i}: {sample:?} {depth}");
        }
        assert!(samples[31 * 32 + 16].depth.is_finite() && samples[16].depth.is_infinite());
    }
}
