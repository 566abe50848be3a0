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
    if mesh.triangles.is_empty() {
        return Err(Error::unusable("the skin has no triangles for roots to lie on"));
    }
    let near = near(mesh, roots(groom, arranged), reach);
    let bvh = Bvh::new(&near);
    let mut report = RootReport::default();
    let mut sum = 0.0f64;
    let mut find = |root: Vec3| -> Result<Place> {
        let Some(closest) = bvh.closest_point(root).filter(|closest| closest.distance <= reach) else {
            // How far it is, all of the skin knows.
            let closest = Bvh::new(mesh).closest_point(root);
            let closest = closest.ok_or_else(|| Error::unusable("a root is at no finite place"))?;
            return Err(Error::unusable(format!(
                "a root is {:.1} mm from the skin, more than the {:.1} mm allowed",
                1e3 * closest.distance,
                1e3 * reach
            )));
        };
        report.roots += 1;
        report.farthest = report.farthest.max(closest.distance);
        sum += f64::from(closest.distance);
        let [_, b, c] = closest.barycentric.to_array();
        Ok(skin(mesh, near.triangles[closest.triangle as usize], b, c))
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

/// Where guides and strands begin.
fn roots<'a>(groom: &'a Groom, arranged: &'a BoundStrands) -> impl Iterator<Item = Vec3> + 'a {
    let guides = (0..groom.guides.len()).map(|i| groom.guides.guide(i)[0]);
    guides.chain((0..arranged.len()).map(|i| arranged.rest_positions(i).next().unwrap_or_default()))
}

/// The triangles of `mesh` that may be within `reach` of any of the roots: brows need no tree over a body.
fn near(mesh: &TriMesh, roots: impl Iterator<Item = Vec3>, reach: f32) -> TriMesh {
    let (low, high) = roots.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let (low, high) = (low - reach, high + reach);
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
    fn what_is_near_the_roots_is_all_that_they_need() {
        let mesh = shapes::sphere(0.1, 32);
        let root =
            |i: usize| 0.103 * Vec3::new(0.2 + 0.01 * i as f32, 0.9, 0.1 * (i as f32).sin()).normalize();
        let some = near(&mesh, (0..40).map(root), 0.01);
        assert!((1..mesh.triangles.len() / 4).contains(&some.triangles.len()), "{}", some.triangles.len());
        let far = |mesh: &TriMesh, p| Bvh::new(mesh).closest_point(p).unwrap().distance;
        for i in 0..40 {
            assert_eq!(far(&mesh, root(i)), far(&some, root(i)));
        }
        // What is near others is not.
        let others = near(&mesh, (0..40).map(|i| -root(i)), 0.01);
        assert!(far(&others, root(0)) > far(&mesh, root(0)));
    }
}
