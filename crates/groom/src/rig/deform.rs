//! What a pose does to vertices: the reference that the GPU's kernel is compared with.
//!
//! ```text
//! p' = p + Σ weight · Δp        n' = n + Σ weight · Δn        over targets
//! M  = Σ weight · palette                                     over the vertex's joints
//! position = M · p'             normal = ± cofactor(M) · n', normalised
//! ```
//!
//! The cofactors of M's 3 × 3 are its inverse transpose up to the determinant, whose sign is the ±, and
//! they exist where M flattens.

use glam::{Mat4, Vec3};

use super::{Bind, Rig, RigPose};
use crate::TriMesh;

impl Rig {
    /// Writes the positions and normals of the mesh in a pose, in the groom's space. Its vertices are those
    /// of the rig, in its order; what it has beyond them stays.
    pub fn deform(&self, pose: &RigPose, mesh: &mut TriMesh) {
        self.shape(&pose.weights, mesh);
        let vertices = mesh.positions.iter_mut().zip(&mut mesh.normals);
        for ((p, n), bind) in vertices.zip(&self.vertices) {
            let by = blend(&pose.palette, bind);
            *p = by.transform_point3(*p);
            *n = turn(&by, *n);
        }
    }

    /// Writes the positions and normals that shapes with these weights give the mesh before joints carry it, in the space of
    /// the file's mesh.
    pub(crate) fn shape(&self, weights: &[f32], mesh: &mut TriMesh) {
        mesh.normals.resize(mesh.positions.len(), Vec3::Y);
        let vertices = mesh.positions.iter_mut().zip(&mut mesh.normals);
        for ((p, n), bind) in vertices.zip(&self.vertices) {
            (*p, *n) = (bind.position, bind.normal);
        }
        for (target, weight) in self.targets.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            for delta in &target.deltas {
                let vertex = delta.vertex as usize;
                if let (Some(p), Some(n)) = (mesh.positions.get_mut(vertex), mesh.normals.get_mut(vertex)) {
                    *p += delta.position * *weight;
                    *n += delta.normal * *weight;
                }
            }
        }
    }

    /// Takes the normals that a mesh in the rest pose has, where the file has none.
    pub(crate) fn take_normals(&mut self, mesh: &TriMesh) {
        let pose = self.rest_pose();
        for (bind, normal) in self.vertices.iter_mut().zip(&mesh.normals) {
            // The inverse of what `turn` does, up to length.
            let by = blend(&pose.palette, bind);
            let axes = [by.x_axis, by.y_axis, by.z_axis].map(|a| a.truncate().dot(*normal));
            bind.normal = Vec3::from(axes).normalize_or(Vec3::Y);
        }
    }

    /// Whether a pose turns the space around a vertex inside out.
    #[cfg(feature = "gltf")]
    pub(crate) fn mirrors(&self, pose: &RigPose, vertex: u32) -> bool {
        self.vertices.get(vertex as usize).is_some_and(|v| blend(&pose.palette, v).determinant() < 0.0)
    }
}

/// What a vertex follows, as one matrix.
fn blend(palette: &[Mat4], bind: &Bind) -> Mat4 {
    let shares = bind.joints.iter().zip(bind.weights).filter(|(_, weight)| *weight != 0.0);
    shares.fold(Mat4::ZERO, |sum, (joint, weight)| {
        sum + palette.get(*joint as usize).copied().unwrap_or_default() * weight
    })
}

/// A normal after a map: still perpendicular, unit, and outside if it was.
fn turn(by: &Mat4, normal: Vec3) -> Vec3 {
    let [x, y, z] = [by.x_axis, by.y_axis, by.z_axis].map(|a| a.truncate());
    let cofactors = [y.cross(z), z.cross(x), x.cross(y)];
    let sign = if x.dot(cofactors[0]) < 0.0 { -1.0 } else { 1.0 };
    let turned = cofactors[0] * normal.x + cofactors[1] * normal.y + cofactors[2] * normal.z;
    (turned * sign).normalize_or(Vec3::Y)
}
