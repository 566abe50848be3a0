//! A body whose vertices the host deforms.

use crate::{
    Error, Pose, Result,
    body::Body,
    groom::{TriMesh, rig::anatomy::Anatomy},
};
use glam::Vec3;
use std::sync::Arc;

/// Vertices that a host has deformed, and the poses of the parts of the body that follow from them.
#[derive(Clone, Debug)]
pub(super) struct HostSkin {
    rest: Arc<TriMesh>,
    now: TriMesh,
    /// Vertices of the head, then of each solid.
    owned: Arc<[Vec<u32>]>,
    /// Motion of the head from its rest pose, then of each solid.
    poses: Vec<Pose>,
    /// Whether vertices have moved since the last upload.
    is_new: bool,
}

impl HostSkin {
    pub fn new(mesh: &Arc<TriMesh>, anatomy: &Anatomy) -> Self {
        let (owned, poses) = (anatomy.owned().into(), Vec::new());
        Self { rest: mesh.clone(), now: TriMesh::clone(mesh), owned, poses, is_new: true }
    }

    /// Sets the vertices, and the motion of the head and of each solid. Without `poses`, each is the rigid motion nearest to
    /// the motion of its vertices.
    pub fn set(&mut self, positions: &[Vec3], poses: Option<Vec<Pose>>) -> Result<()> {
        let count = self.rest.positions.len();
        if positions.len() != count {
            let problem = format!("the skin has {} vertices, but the mesh has {count}", positions.len());
            return Err(Error::unusable(problem));
        }
        if let Some(at) = positions.iter().position(|p| !p.is_finite()) {
            return Err(Error::unusable(format!("vertex {at} of the skin is not finite")));
        }
        if self.now.positions != positions {
            self.now.positions.copy_from_slice(positions);
            self.now.compute_normals();
            self.is_new = true;
        }
        let fit = |owned: &Vec<u32>| {
            let of = |mesh: &TriMesh| -> Vec<Vec3> {
                owned.iter().map(|vertex| mesh.positions[*vertex as usize]).collect()
            };
            Pose::fit(&of(&self.rest), &of(&self.now))
        };
        self.poses = poses.unwrap_or_else(|| self.owned.iter().map(fit).collect());
        Ok(())
    }

    /// Uploads the vertices to `body` if they have moved. Returns whether they have.
    pub fn upload(&mut self, body: &mut Body) -> bool {
        let is_new = std::mem::take(&mut self.is_new);
        if is_new {
            body.move_to(&self.now);
            if let Some((low, high)) = self.now.bounds() {
                body.set_bounds([low, high]);
            }
        }
        is_new
    }

    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }
}
