//! Blend shapes and skinning on the CPU: the reference for the GPU's kernel.
//!
//! ```text
//! p' = p + Σ weight · Δp        n' = n + Σ weight · Δn        over targets
//! M  = Σ weight · palette                                     over the vertex's joints
//! position = M · p'             normal = ± cofactor(M) · n', normalized
//! ```
//!
//! The cofactors of the 3 × 3 part of M are its inverse transpose up to the determinant, whose sign is the ±. They
//! exist even where M is singular.

use glam::{Mat4, Vec3};

use super::{Bind, Rig, RigPose};
use crate::TriMesh;

impl Rig {
    /// Writes the positions and normals of the mesh in a pose, in groom space. Its vertices are those of the rig, in
    /// its order; further vertices of the mesh do not change.
    pub fn deform(&self, pose: &RigPose, mesh: &mut TriMesh) {
        self.shape(&pose.weights, mesh);
        let vertices = mesh.positions.iter_mut().zip(&mut mesh.normals);
        for ((p, n), bind) in vertices.zip(&self.vertices) {
            let by = blend(&pose.palette, bind);
            *p = by.transform_point3(*p);
            *n = transform_normal(&by, *n);
        }
    }

    /// Writes the positions and normals after blend shapes with these weights and before skinning, in the space of the
    /// file's mesh.
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

    /// Takes the normals of a mesh in the rest pose, for a file that has none.
    pub(crate) fn take_normals(&mut self, mesh: &TriMesh) {
        let pose = self.rest_pose();
        for (bind, normal) in self.vertices.iter_mut().zip(&mesh.normals) {
            // The inverse of `rotation`, up to length.
            let by = blend(&pose.palette, bind);
            let axes = [by.x_axis, by.y_axis, by.z_axis].map(|a| a.truncate().dot(*normal));
            bind.normal = Vec3::from(axes).normalize_or(Vec3::Y);
        }
    }

    /// Returns whether a pose mirrors the space around a vertex.
    #[cfg(feature = "gltf")]
    pub(crate) fn mirrors(&self, pose: &RigPose, vertex: u32) -> bool {
        self.vertices.get(vertex as usize).is_some_and(|v| blend(&pose.palette, v).determinant() < 0.0)
    }
}

/// Returns the weighted sum of a vertex's palette entries.
fn blend(palette: &[Mat4], bind: &Bind) -> Mat4 {
    let influences = bind.joints.iter().zip(bind.weights).filter(|(_, weight)| *weight != 0.0);
    influences.fold(Mat4::ZERO, |sum, (joint, weight)| {
        sum + palette.get(*joint as usize).copied().unwrap_or_default() * weight
    })
}

/// Transforms a normal, so that it stays perpendicular, of unit length, and on the same side.
fn transform_normal(by: &Mat4, normal: Vec3) -> Vec3 {
    let [x, y, z] = [by.x_axis, by.y_axis, by.z_axis].map(|a| a.truncate());
    let cofactors = [y.cross(z), z.cross(x), x.cross(y)];
    let sign = if x.dot(cofactors[0]) < 0.0 { -1.0 } else { 1.0 };
    let transformed = cofactors[0] * normal.x + cofactors[1] * normal.y + cofactors[2] * normal.z;
    (transformed * sign).normalize_or(Vec3::Y)
}
