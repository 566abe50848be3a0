//! Which place of the skin each root belongs to.

use crate::{
    Error, Result,
    groom::{BoundStrands, Groom, TriMesh, mesh::Bvh},
};
use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Quat, Vec3};

/// The place of a guide's root, and how the skin is there at rest.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GuideRoot {
    /// Vertices of the triangle.
    pub triangle: [u32; 3],
    /// Share of its second corner.
    pub b: f32,
    /// Where the place is at rest, groom space, metres.
    pub rest_at: Vec3,
    /// Share of its third corner.
    pub c: f32,
    /// The rotation back from how the place is turned at rest.
    pub rest_back: Quat,
}

/// The place of a strand's root.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct StrandRoot {
    /// Vertices of the triangle.
    pub triangle: [u32; 3],
    /// Share of its second corner.
    pub b: f32,
    /// From the place to the root, as the place is turned, metres.
    pub offset: Vec3,
    /// Share of its third corner.
    pub c: f32,
}

/// How well roots lie on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RootReport {
    /// How many guides and strands there are.
    pub roots: u32,
    /// How far the farthest of them is from the surface, metres.
    pub farthest: f32,
    /// The mean, metres.
    pub mean: f32,
}

/// A place on the mesh at rest: its triangle, the shares of its second and third corner, where it is and how it is
/// turned. Twin of `roots::surface::skin`.
struct Place {
    triangle: [u32; 3],
    b: f32,
    c: f32,
    at: Vec3,
    rotation: Quat,
}

fn skin(mesh: &TriMesh, triangle: [u32; 3], b: f32, c: f32) -> Place {
    let [corner, second, third] = triangle.map(|i| mesh.positions[i as usize]);
    let (edge, other) = (second - corner, third - corner);
    let normal = |i: usize| mesh.normals.get(triangle[i] as usize).copied().unwrap_or_default();
    let up = (1.0 - b - c) * normal(0) + b * normal(1) + c * normal(2);
    let face = edge.cross(other);
    let smooth = up.length_squared() > 1e-6 && up.dot(face) > 0.0;
    let up = if smooth { up } else { face }.normalize_or(Vec3::Y);
    let x = (edge - up * up.dot(edge)).normalize_or(Vec3::X);
    let rotation = Quat::from_mat3(&Mat3::from_cols(x, up, x.cross(up))).normalize();
    Place { triangle, b, c, at: corner + b * edge + c * other, rotation }
}

/// The places of the roots of `groom`'s guides and of its strands as they are `arranged`, each the nearest on `mesh`,
/// at most `reach` metres away.
pub(super) fn bind(
    groom: &Groom,
    arranged: &BoundStrands,
    mesh: &TriMesh,
    reach: f32,
) -> Result<(Vec<GuideRoot>, Vec<StrandRoot>, RootReport)> {
    if mesh.triangles.iter().flatten().any(|i| *i as usize >= mesh.positions.len()) {
        return Err(Error::unusable("a triangle of the skin names a vertex that it does not have"));
    }
    let bvh = Bvh::new(mesh);
    if bvh.is_empty() {
        return Err(Error::unusable("the skin has no triangles for roots to lie on"));
    }
    let mut report = RootReport::default();
    let mut sum = 0.0f64;
    let mut find = |root: Vec3| -> Result<Place> {
        let closest =
            bvh.closest_point(root).ok_or_else(|| Error::unusable("a root is at no finite place"))?;
        if closest.distance > reach {
            return Err(Error::unusable(format!(
                "a root is {:.1} mm from the skin, more than the {:.1} mm allowed",
                1e3 * closest.distance,
                1e3 * reach
            )));
        }
        report.roots += 1;
        report.farthest = report.farthest.max(closest.distance);
        sum += f64::from(closest.distance);
        let [_, b, c] = closest.barycentric.to_array();
        Ok(skin(mesh, mesh.triangles[closest.triangle as usize], b, c))
    };
    let guides = (0..groom.guides.len()).map(|i| {
        let place = find(groom.guides.guide(i)[0])?;
        let Place { triangle, b, c, at, rotation } = place;
        Ok(GuideRoot { triangle, b, rest_at: at, c, rest_back: rotation.conjugate() })
    });
    let guides = guides.collect::<Result<Vec<_>>>()?;
    let strands = (0..arranged.len()).map(|i| {
        let root = arranged.rest_positions(i).next().unwrap_or_default();
        let place = find(root)?;
        let Place { triangle, b, c, at, rotation } = place;
        Ok(StrandRoot { triangle, b, offset: rotation.conjugate() * (root - at), c })
    });
    let strands = strands.collect::<Result<Vec<_>>>()?;
    report.mean = (sum / f64::from(report.roots.max(1))) as f32;
    Ok((guides, strands, report))
}
