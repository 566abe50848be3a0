//! Skin under the roots.

use crate::{TriMesh, mesh::Bvh};
use glam::Vec3;

/// Roots farther than this from the mesh grow on something else (a hair band, a cap), meters.
const NEAR: f32 = 0.012;

/// Margin around the roots within which mesh triangles are used, meters.
const MARGIN: f32 = 0.03;

/// The part of a head mesh that hair grows on.
pub(super) struct Skin {
    bvh: Bvh,
    /// Whether each input strand grows on it.
    on: Vec<bool>,
}

impl Skin {
    /// Extracts the skin of `mesh` around `roots`. Returns `None` if no root is near it.
    pub(super) fn new(mesh: &TriMesh, roots: &[Vec3]) -> Option<Self> {
        let (lo, hi) = roots.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| {
            (lo.min(*p - MARGIN), hi.max(*p + MARGIN))
        });
        let touches = |t: &[u32; 3]| {
            let p = t.map(|v| mesh.positions[v as usize]);
            let (a, b) = (p[0].min(p[1]).min(p[2]), p[0].max(p[1]).max(p[2]));
            b.cmpge(lo).all() && a.cmple(hi).all()
        };
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().copied().filter(touches).collect();
        let bvh = Bvh::new(&TriMesh { positions: mesh.positions.clone(), triangles, ..TriMesh::default() });
        let on: Vec<bool> = roots.iter().map(|p| bvh.closest_point_within(*p, NEAR).is_some()).collect();
        on.contains(&true).then_some(Self { bvh, on })
    }

    /// Returns the point of the skin nearest to `root` if all `parents` grow on it.
    pub(super) fn at(&self, root: Vec3, mut parents: impl Iterator<Item = u32>) -> Option<Vec3> {
        let found =
            parents.all(|i| self.on[i as usize]).then(|| self.bvh.closest_point_within(root, 2.0 * NEAR));
        found.flatten().map(|closest| closest.point)
    }
}
