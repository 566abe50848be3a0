//! Creating, validating and editing whole meshes.

use glam::{Affine3A, Quat, Vec3};
use std::sync::Arc;

use super::{Paint, TriMesh, parts};
use crate::{Error, Result};

impl TriMesh {
    /// Checks that the mesh is usable: all indices are in range, all numbers are finite, and there are as many normals
    /// and colors as positions, or none.
    pub fn validate(&self) -> Result<()> {
        let count = self.positions.len();
        for (name, values, optional) in [
            ("positions", &self.positions, false),
            ("normals", &self.normals, true),
            ("colors", &self.colors, true),
        ] {
            if values.len() != count && !(optional && values.is_empty()) {
                return Err(Error::Unusable(format!(
                    "the mesh has {} {name} for {count} vertices",
                    values.len()
                )));
            }
            if let Some(i) = values.iter().position(|v| !v.is_finite()) {
                return Err(Error::Unusable(format!(
                    "vertex {i} of the mesh has {name} that are not finite"
                )));
            }
        }
        if let Some(i) = self.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= count)) {
            return Err(Error::Unusable(format!(
                "triangle {i} of the mesh has the corners {:?}, but there are {count} vertices",
                self.triangles[i]
            )));
        }
        if self.paint.as_ref().is_some_and(|paint| !paint.fits(count)) {
            return Err(Error::Unusable(format!(
                "the textures of the mesh do not match its {count} vertices"
            )));
        }
        Ok(())
    }

    /// Computes the normals from the triangles, each weighted by its angle at the vertex, so that they do not depend on
    /// the triangulation of a flat face. Vertices at the same position share one normal: seams of texture coordinates
    /// stay invisible, but hard edges become smooth too. The normal of a vertex without triangles points up. Triangles
    /// with an index out of range are ignored.
    pub fn compute_normals(&mut self) {
        let weld = parts::weld_map(&self.positions);
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for t in self.triangles.iter().filter(|t| t.iter().all(|&v| (v as usize) < weld.len())) {
            let corners = t.map(|v| self.positions[v as usize]);
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for i in 0..3 {
                let (to, from) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
                let angle = to.cross(from).length().atan2(to.dot(from));
                sums[weld[t[i] as usize] as usize] += normal * angle;
            }
        }
        self.normals = weld.iter().map(|&p| sums[p as usize].normalize_or(Vec3::Y)).collect();
    }

    /// Merges `meshes` into one. Normals and colors are kept if every mesh with vertices has them, and dropped
    /// otherwise.
    pub fn merge(meshes: &[Self]) -> Self {
        let filled = || meshes.iter().filter(|m| !m.positions.is_empty());
        let normals = filled().all(|m| m.normals.len() == m.positions.len());
        let colors = filled().all(|m| m.colors.len() == m.positions.len());
        let mut all = Self::default();
        for mesh in meshes {
            let first = all.positions.len() as u32;
            let [own, more] = [&all, mesh].map(|mesh| mesh.positions.len());
            all.paint = Paint::join(all.paint.as_deref(), own, mesh.paint.as_deref(), more).map(Arc::new);
            all.positions.extend(&mesh.positions);
            if normals {
                all.normals.extend(&mesh.normals);
            }
            if colors {
                all.colors.extend(&mesh.colors);
            }
            all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        all
    }

    /// Scales the mesh about the origin, then rotates it, then moves it (meters). A negative scale mirrors the mesh and
    /// flips its triangles, so that they still face outward.
    pub fn transform(&mut self, scale: f32, rotation: Quat, translation: Vec3) {
        let by = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), rotation, translation);
        self.transform_affine(by);
    }

    /// Transforms the mesh by any invertible affine map: swapped axes, mirroring or shear. Normals stay perpendicular.
    /// If the map mirrors, triangles are flipped, so that they still face outward.
    pub fn transform_affine(&mut self, by: Affine3A) {
        self.positions.iter_mut().for_each(|p| *p = by.transform_point3(*p));
        let mirrors = by.matrix3.determinant() < 0.0;
        // Inverse transpose up to a positive factor.
        let sign = if mirrors { -1.0 } else { 1.0 };
        let [x, y, z] = [by.matrix3.x_axis, by.matrix3.y_axis, by.matrix3.z_axis];
        let cofactors = [y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign].map(Vec3::from);
        for n in &mut self.normals {
            let transformed = cofactors[0] * n.x + cofactors[1] * n.y + cofactors[2] * n.z;
            *n = transformed.normalize_or(Vec3::Y);
        }
        if mirrors {
            self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes;
    use super::*;

    #[test]
    fn validation_names_the_invalid_element() {
        let good = shapes::cuboid(Vec3::ONE);
        assert!(good.validate().is_ok());
        let mut bad = good.clone();
        bad.triangles[3][1] = 8;
        assert!(bad.validate().unwrap_err().to_string().contains("triangle 3"));
        bad = good.clone();
        bad.positions[5].y = f32::INFINITY;
        assert!(bad.validate().unwrap_err().to_string().contains("vertex 5"));
        bad = good;
        bad.normals.push(Vec3::Y);
        assert!(bad.validate().unwrap_err().to_string().contains("normals"));
    }

    #[test]
    fn computed_normals_match_cuboid_and_sphere() {
        let mut mesh = shapes::cuboid(Vec3::new(1.0, 2.0, 3.0));
        mesh.compute_normals();
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(n.distance(p.signum() / 3f32.sqrt()) < 1e-6);
        }
        let mut mesh = shapes::sphere(0.1, 24);
        mesh.compute_normals();
        // Also across the seam, where vertices have different indices but the same position.
        assert!(mesh.positions.iter().zip(&mesh.normals).all(|(p, n)| n.dot(p.normalize()) > 0.999));
        assert!(mesh.validate().is_ok());
    }

    #[test]
    fn merge_offsets_indices_and_keeps_common_attributes() {
        let mut a = shapes::cuboid(Vec3::ONE);
        a.compute_normals();
        let mut b = shapes::torus(3.0, 1.0, 8);
        b.compute_normals();
        b.colors = vec![Vec3::ONE; b.positions.len()];
        let all = TriMesh::merge(&[a.clone(), TriMesh::default(), b.clone()]);
        assert!(all.validate().is_ok());
        assert_eq!(all.triangles.len(), a.triangles.len() + b.triangles.len());
        assert_eq!(all.triangles[a.triangles.len()], b.triangles[0].map(|v| v + 8));
        assert!(all.normals.len() == all.positions.len() && all.colors.is_empty());
    }

    #[test]
    fn transforms_keep_triangles_facing_outward() {
        for (scale, turn) in [(0.01, Quat::from_rotation_x(1.3)), (-2.0, Quat::from_rotation_z(0.4))] {
            let mut mesh = shapes::sphere(1.0, 12);
            mesh.compute_normals();
            mesh.transform(scale, turn, Vec3::X);
            let moved = mesh.normals.clone();
            mesh.compute_normals();
            for ((p, n), m) in mesh.positions.iter().zip(&mesh.normals).zip(&moved) {
                assert!(((*p - Vec3::X).length() - scale.abs()).abs() < 1e-5);
                assert!(n.dot(*p - Vec3::X) > 0.0 && n.distance(*m) < 1e-3, "{n} {m}");
            }
        }
    }

    #[test]
    fn normal_of_cube_corner_is_its_diagonal() {
        // Three faces meet at the corner in the origin, one of them cut in two: weights by area or count would tilt the
        // normal.
        let p = |x, y, z| Vec3::new(x, y, z);
        let positions =
            vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.), p(0., 1., 1.), p(0., 0., 0.)];
        let triangles = [[0, 1, 3], [5, 2, 1], [0, 3, 4], [0, 4, 2]];
        let mut mesh = TriMesh { positions, triangles: triangles.to_vec(), ..Default::default() };
        mesh.compute_normals();
        let normals = mesh.normals;
        let expected = p(-1., -1., -1.).normalize();
        assert!((normals[0].abs() - expected.abs()).length() < 1e-6, "{}", normals[0]);
        assert_eq!(normals[0], normals[5], "the same place, the same normal");
    }
}
