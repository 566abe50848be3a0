//! The skin that hair grows on.

use super::solve::unit;
use crate::{SdfGrid, TriMesh, mesh::Bvh};
use glam::Vec3;
use std::sync::Arc;

/// Largest number of steps along a ray, the distance at which one ends, and the largest distance, meters.
const TRACES: u32 = 256;
const TOUCH: f32 = 2e-4;
const FAR: f32 = 20.0;
/// Steps along the gradient of a distance field to its surface.
const STEPS: u32 = 4;

/// Surface of the body: its mesh if it is known, else where its distance field is zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Ground {
    pub field: Option<Arc<SdfGrid>>,
    pub mesh: Option<Arc<(TriMesh, Bvh)>>,
}

impl Ground {
    /// Returns the distance along a ray to the skin, meters. Sphere tracing on the mesh does not enter gaps that a
    /// distance field resolves, as between lips.
    pub fn trace(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let Some(mesh) = &self.mesh else {
            return self.field.as_deref()?.trace(origin, direction, 0.0);
        };
        let mut along = 0.0;
        for _ in 0..TRACES {
            let distance = mesh.1.closest_point_within(origin + direction * along, FAR)?.distance;
            if distance < TOUCH {
                return Some(along);
            }
            along += distance;
        }
        None
    }

    /// Returns the point of the skin nearest to `p` and its outward normal; `None` if there is no skin within
    /// `max_distance` meters.
    pub fn nearest(&self, p: Vec3, max_distance: f32) -> Option<(Vec3, Vec3)> {
        if let Some(mesh) = &self.mesh {
            let (mesh, bvh) = &**mesh;
            let closest = bvh.closest_point_within(p, max_distance)?;
            let [a, b, c] = mesh.triangles[closest.triangle as usize].map(|v| mesh.positions[v as usize]);
            let facet = unit((b - a).cross(c - a), Vec3::ZERO);
            // Normals of a field are smooth, and point outwards whatever the winding of the triangles.
            let smooth = self.field.as_deref().map(|field| field.normal(closest.point));
            return Some((closest.point, smooth.unwrap_or(facet)));
        }
        let field = self.field.as_deref()?;
        let mut point = p;
        for _ in 0..STEPS {
            point -= field.normal(point) * field.sample(point);
        }
        (point.distance(p) <= max_distance).then(|| (point, field.normal(point)))
    }
}
