//! Binding of each root to a point on the skin.

use crate::{
    Error, Result,
    groom::{TriMesh, mesh::Bvh},
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Quat, Vec3};

/// Skin point of a guide's root, with its position and rotation at rest.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct GuideRoot {
    /// Vertices of the triangle.
    pub triangle: [u32; 3],
    /// Barycentric coordinate of the second corner.
    pub b: f32,
    /// Position of the skin point at rest, groom space, meters.
    pub rest_at: Vec3,
    /// Barycentric coordinate of the third corner.
    pub c: f32,
    /// Inverse of the skin point's rotation at rest.
    pub rest_back: Quat,
}

/// Skin point of a strand's root.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct StrandRoot {
    /// Vertices of the triangle.
    pub triangle: [u32; 3],
    /// Barycentric coordinate of the second corner.
    pub b: f32,
    /// Offset from the skin point to the root, in the skin point's frame, meters.
    pub offset: Vec3,
    /// Barycentric coordinate of the third corner.
    pub c: f32,
}

/// Distances of roots from a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RootReport {
    /// Number of guides and strands.
    pub roots: u32,
    /// Largest distance of a root from the surface, meters.
    pub max_distance: f32,
    /// Mean distance, meters.
    pub mean_distance: f32,
}

/// A point of the mesh at rest: its triangle, the barycentric coordinates of the second and third corner, position and
/// rotation. Computed like `roots::surface::skin`.
struct SurfacePoint {
    triangle: [u32; 3],
    b: f32,
    c: f32,
    at: Vec3,
    rotation: Quat,
}

fn skin(mesh: &TriMesh, triangle: [u32; 3], b: f32, c: f32) -> SurfacePoint {
    let [corner, second, third] = triangle.map(|i| mesh.positions[i as usize]);
    let (edge, other) = (second - corner, third - corner);
    let normal = |i: usize| mesh.normals.get(triangle[i] as usize).copied().unwrap_or_default();
    let up = (1.0 - b - c) * normal(0) + b * normal(1) + c * normal(2);
    let face = edge.cross(other);
    let smooth = up.length_squared() > 1e-6 && up.dot(face) > 0.0;
    let up = if smooth { up } else { face }.normalize_or(Vec3::Y);
    let x = (edge - up * up.dot(edge)).normalize_or(Vec3::X);
    let rotation = Quat::from_mat3(&Mat3::from_cols(x, up, x.cross(up))).normalize();
    SurfacePoint { triangle, b, c, at: corner + b * edge + c * other, rotation }
}

/// Binds the roots of guides and of strands to the nearest point on `mesh`, at most `max_distance` meters away.
pub(super) fn bind(
    [guides, strands]: [&[Vec3]; 2],
    mesh: &TriMesh,
    max_distance: f32,
) -> Result<(Vec<GuideRoot>, Vec<StrandRoot>, RootReport)> {
    if mesh.triangles.iter().flatten().any(|i| *i as usize >= mesh.positions.len()) {
        return Err(Error::unusable("a triangle of the mesh refers to a missing vertex"));
    }
    if mesh.triangles.is_empty() {
        return Err(Error::unusable("the mesh has no triangles to attach roots to"));
    }
    let near = near(mesh, guides.iter().chain(strands).copied(), max_distance);
    let bvh = Bvh::new(&near);
    let mut report = RootReport::default();
    let mut sum = 0.0f64;
    let mut find = |root: Vec3| -> Result<SurfacePoint> {
        let Some(closest) = bvh.closest_point(root).filter(|closest| closest.distance <= max_distance) else {
            // Search all of the skin for the distance in the error message.
            let closest = Bvh::new(mesh).closest_point(root);
            let closest = closest.ok_or_else(|| Error::unusable("the position of a root is not finite"))?;
            return Err(Error::unusable(format!(
                "a root is {:.1} mm from the mesh, more than the {:.1} mm allowed",
                1e3 * closest.distance,
                1e3 * max_distance
            )));
        };
        report.roots += 1;
        report.max_distance = report.max_distance.max(closest.distance);
        sum += f64::from(closest.distance);
        let [_, b, c] = closest.barycentric.to_array();
        Ok(skin(mesh, near.triangles[closest.triangle as usize], b, c))
    };
    let guides = guides.iter().map(|root| {
        let SurfacePoint { triangle, b, c, at, rotation } = find(*root)?;
        Ok(GuideRoot { triangle, b, rest_at: at, c, rest_back: rotation.conjugate() })
    });
    let guides = guides.collect::<Result<Vec<_>>>()?;
    let strands = strands.iter().map(|root| {
        let SurfacePoint { triangle, b, c, at, rotation } = find(*root)?;
        Ok(StrandRoot { triangle, b, offset: rotation.conjugate() * (*root - at), c })
    });
    let strands = strands.collect::<Result<Vec<_>>>()?;
    report.mean_distance = (sum / f64::from(report.roots.max(1))) as f32;
    Ok((guides, strands, report))
}

/// Returns the triangles of `mesh` that may be within `max_distance` of any root, so that binding brows does not build
/// a search tree over a whole body.
fn near(mesh: &TriMesh, roots: impl Iterator<Item = Vec3>, max_distance: f32) -> TriMesh {
    let (low, high) = roots.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let (low, high) = (low - max_distance, high + max_distance);
    let touches = |triangle: &&[u32; 3]| {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        lo.cmple(high).all() && hi.cmpge(low).all()
    };
    let triangles = mesh.triangles.iter().filter(touches).copied().collect();
    TriMesh { positions: mesh.positions.clone(), triangles, ..TriMesh::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::groom::mesh::shapes;

    #[test]
    fn near_triangles_contain_closest_points() {
        let mesh = shapes::sphere(0.1, 32);
        let root =
            |i: usize| 0.103 * Vec3::new(0.2 + 0.01 * i as f32, 0.9, 0.1 * (i as f32).sin()).normalize();
        let some = near(&mesh, (0..40).map(root), 0.01);
        assert!((1..mesh.triangles.len() / 4).contains(&some.triangles.len()), "{}", some.triangles.len());
        let far = |mesh: &TriMesh, p| Bvh::new(mesh).closest_point(p).unwrap().distance;
        for i in 0..40 {
            assert_eq!(far(&mesh, root(i)), far(&some, root(i)));
        }
        // Triangles near other roots do not contain the closest points.
        let others = near(&mesh, (0..40).map(|i| -root(i)), 0.01);
        assert!(far(&others, root(0)) > far(&mesh, root(0)));
    }
}
