//! Strands of known shape.

use tresses::glam::{Quat, Vec3};

/// Strands with equal numbers of vertices.
#[derive(Clone)]
pub struct Groom {
    pub vertices: usize,
    pub points: Vec<Vec3>,
    /// Radius at the root, meters. Between root and tip the radius is linear in the vertex index.
    pub root_radius: f32,
    pub tip_radius: f32,
}

impl Groom {
    /// Creates wavy strands of `radius` at the root that leave a ball of radius 8 cm and fall, dense at the top and
    /// sparse below.
    pub fn on_a_ball(count: usize, radius: f32) -> Self {
        let vertices = 16;
        let mut points = Vec::new();
        for i in 0..count {
            let z = 1.0 - (i as f32 + 0.5) / count as f32 * 0.9;
            let around = i as f32 * 2.399_963;
            let r = (1.0 - z * z).sqrt();
            let normal = Vec3::new(r * around.cos(), z, r * around.sin());
            let side = normal.cross(Vec3::Y).normalize_or(Vec3::X);
            points.extend((0..vertices).map(|k| {
                let s = k as f32 / (vertices - 1) as f32;
                let out = normal * (0.08 + 0.03 * s * (1.0 - 0.6 * s)) + Vec3::Y * (-0.09 * s * s);
                out + side * 0.006 * (9.0 * s + 0.7 * (i % 40) as f32).sin() * s
            }));
        }
        Self { vertices, points, root_radius: radius, tip_radius: 0.4 * radius }
    }

    pub fn count(&self) -> usize {
        self.points.len() / self.vertices
    }

    /// Returns the unit tangent at vertex `i`, counted over all strands.
    pub fn tangent(&self, i: usize) -> Vec3 {
        let k = i % self.vertices;
        let before = self.points[i - usize::from(k > 0)];
        let after = self.points[i + usize::from(k + 1 < self.vertices)];
        (after - before).normalize()
    }

    /// Returns the radius at vertex `i`, counted over all strands, meters.
    pub fn radius(&self, i: usize) -> f32 {
        let s = (i % self.vertices) as f32 / (self.vertices - 1) as f32;
        self.root_radius + (self.tip_radius - self.root_radius) * s
    }

    /// Returns the strands rotated about the vertical axis.
    pub fn turned(&self, radians: f32) -> Self {
        let turn = Quat::from_rotation_y(radians);
        Self { points: self.points.iter().map(|p| turn * *p).collect(), ..self.clone() }
    }
}
