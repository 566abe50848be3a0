//! Retargeting: a groom that was made on one head, on another.
//!
//! ```text
//! head ─ warp ─► other head: a place on the skin of one is a place on the skin of the other
//! roots        ─► their places there, with the turn of the skin around them, smoothed over neighbors
//! strands      ─► turned about their roots: lengths, curls and clumps stay
//! distance fields ─► pushed out of the other head, from root to tip
//! ```
//!
//! Heads of one topology (SMPL-X, FLAME, MetaHuman) correspond by their vertices. Others are matched by their landmarks
//! and by nearest points in both directions, and the head is warped, coarse to fine (`warp`).
//!
//! **Why rigid per strand?** A warp of space changes lengths by 13 % in the mean (AMD's head to ICT-FaceKit's), and
//! bends curls. A rigid motion changes neither; turns that are smoothed over 24 neighbors keep these together.

mod warp;

pub use warp::Landmark;

use crate::{
    Error, Result, SdfGrid, Strands, TriMesh,
    mesh::{Bvh, SdfOptions, sdf, triangle::mean},
    near::PointTree,
    progress::in_parallel,
    rotation::nearest_rotation,
};
use glam::{Quat, Vec3};

/// Number of roots whose turns are averaged, and the distance at which a turn counts 1/e, meters.
const NEIGHBORS: usize = 24;
const SMOOTHING_RADIUS: f32 = 0.03;
/// Number of vertices of the skin around a root whose motion gives the turn, and the largest distance, meters.
const SKIN_VERTICES: usize = 96;
const SKIN_RADIUS: f32 = 0.05;
/// Largest distance from the skin that strands keep, meters.
const CLEARANCE: f32 = 4e-3;
/// Rounds in which a vertex is pushed out.
const ROUNDS: u32 = 3;
/// Depth that counts as inside, meters.
const INSIDE: f32 = 1e-3;

/// Quality of a retargeting.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RetargetReport {
    /// Whether the heads have the same triangles, so that their vertices correspond.
    pub has_same_topology: bool,
    /// Mean distance of the warped head from the other, near the roots, meters.
    pub skin_error: f32,
    /// Share of vertices that are deeper than 1 mm inside the other head, before and after.
    pub inside: [f32; 2],
    /// Mean change of the angle between two segments, radians.
    pub bend: f32,
    /// Mean change of the distance between the middles of neighboring strands, meters.
    pub spacing_change: f32,
}

/// A place on the skin of a head: a triangle, barycentric weights, and height above it.
struct SkinPoint {
    triangle: u32,
    barycentric: Vec3,
    height: f32,
}

/// Returns `strands`, which grow on `head`, on `other`. Both are in meters, Y up, the face towards +Z. `landmarks` are
/// points of both heads that correspond.
///
/// # Errors
/// [`Error::Unusable`] without strands, for a mesh without triangles or volume, and for heads that do not resemble each
/// other.
pub fn retarget(
    strands: &Strands,
    head: &TriMesh,
    other: &TriMesh,
    landmarks: &[Landmark],
) -> Result<(Strands, RetargetReport)> {
    if strands.is_empty() {
        return Err(Error::Unusable("there are no strands to retarget".into()));
    }
    let options = SdfOptions::default();
    let (field, target) = (sdf::build(head, &options)?, sdf::build(other, &options)?);
    let roots: Vec<Vec3> = strands.iter().map(|strand| strand.first().copied().unwrap_or_default()).collect();
    let bvh = Bvh::new(head);
    let on_skin = |root: &Vec3| bvh.closest_point(*root);
    let found: Option<Vec<_>> = in_parallel(&roots, on_skin).into_iter().collect();
    let found = found.ok_or_else(|| Error::Unusable("the head has no triangles".into()))?;
    let same_topology = head.triangles == other.triangles && head.positions.len() == other.positions.len();
    let warped = match same_topology {
        true => other.clone(),
        false => warp::warped(head, other, &roots, landmarks)?,
    };
    let skin_points: Vec<SkinPoint> = roots
        .iter()
        .zip(&found)
        .map(|(root, closest)| {
            let (triangle, barycentric) = (closest.triangle, closest.barycentric);
            let height = (*root - closest.point).dot(normal_at(head, triangle, barycentric));
            SkinPoint { triangle, barycentric, height }
        })
        .collect();
    let skin = Bvh::new(other);
    let settled = |skin_point: &SkinPoint| {
        let on = point_at(&warped, skin_point);
        let closest = skin.closest_point(on);
        let (point, error) = closest.map_or((on, 0.0), |closest| (closest.point, closest.distance));
        let normal = target.normal(point);
        (point + normal * skin_point.height, error)
    };
    let settled = in_parallel(&skin_points, settled);
    let vertices = PointTree::new(&head.positions);
    let skin_rotation = |root: &Vec3| {
        let mut found = Vec::new();
        vertices.nearest(*root, SKIN_VERTICES, SKIN_RADIUS, &mut found);
        let of = |mesh: &TriMesh| -> Vec<Vec3> {
            let points: Vec<Vec3> = found.iter().map(|(_, i)| mesh.positions[*i as usize]).collect();
            let center = points.iter().sum::<Vec3>() / points.len().max(1) as f32;
            points.into_iter().map(|p| p - center).collect()
        };
        nearest_rotation(of(head).into_iter().zip(of(&warped)))
    };
    let skin_rotations: Vec<Quat> = in_parallel(&roots, skin_rotation);
    let tree = PointTree::new(&roots);
    let smooth = |root: &Vec3| {
        let mut found = Vec::new();
        tree.nearest(*root, NEIGHBORS, 4.0 * SMOOTHING_RADIUS, &mut found);
        mean_rotation(found.iter().map(|(squared, i)| {
            (skin_rotations[*i as usize], (-squared / (SMOOTHING_RADIUS * SMOOTHING_RADIUS)).exp())
        }))
    };
    let rotations = in_parallel(&roots, smooth);
    let numbers: Vec<usize> = (0..strands.len()).collect();
    let transformed = in_parallel(&numbers, |i: &usize| {
        let (root, rotation) = (settled[*i].0, rotations[*i]);
        let line: Vec<Vec3> = strands.strand(*i).iter().map(|p| root + rotation * (*p - roots[*i])).collect();
        let out = pushed(strands.strand(*i), &line, &field, &target);
        (line, out)
    });
    let is_in = |line: &[Vec3]| line.iter().skip(1).filter(|p| target.sample(**p) < -INSIDE).count() as f32;
    let count: f32 = strands.iter().map(|strand| strand.len().saturating_sub(1) as f32).sum::<f32>().max(1.0);
    let inside = [
        transformed.iter().map(|(line, _)| is_in(line)).sum::<f32>() / count,
        transformed.iter().map(|(_, out)| is_in(out)).sum::<f32>() / count,
    ];
    let positions: Vec<Vec3> = transformed.into_iter().flat_map(|(_, out)| out).collect();
    let out = Strands { positions, ..strands.clone() };
    let report = RetargetReport {
        has_same_topology: same_topology,
        skin_error: settled.iter().map(|(_, error)| error).sum::<f32>() / settled.len() as f32,
        inside,
        bend: bend(strands, &out),
        spacing_change: spacing_change(strands, &out, &tree, &roots),
    };
    Ok((out, report))
}

fn point_at(mesh: &TriMesh, skin_point: &SkinPoint) -> Vec3 {
    let [a, b, c] = corners(mesh, skin_point.triangle);
    mean([a, b, c], skin_point.barycentric)
}

fn corners(mesh: &TriMesh, triangle: u32) -> [Vec3; 3] {
    mesh.triangles[triangle as usize].map(|vertex| mesh.positions[vertex as usize])
}

fn normal_at(mesh: &TriMesh, triangle: u32, barycentric: Vec3) -> Vec3 {
    let [a, b, c] = mesh.triangles[triangle as usize].map(|v| mesh.normals.get(v as usize).copied());
    let flat = || {
        let [a, b, c] = corners(mesh, triangle);
        (b - a).cross(c - a)
    };
    let smooth = a.zip(b).zip(c).map(|((a, b), c)| mean([a, b, c], barycentric));
    smooth.unwrap_or_else(flat).normalize_or(Vec3::Y)
}

/// Returns the weighted mean of rotations that are near each other.
fn mean_rotation(rotations: impl Iterator<Item = (Quat, f32)>) -> Quat {
    let mut sum: Option<Quat> = None;
    for (rotation, weight) in rotations {
        sum = Some(match sum {
            None => rotation * weight,
            Some(sum) => sum + if sum.dot(rotation) < 0.0 { rotation * -weight } else { rotation * weight },
        });
    }
    sum.filter(|sum| sum.length_squared() > 1e-12).map_or(Quat::IDENTITY, Quat::normalize)
}

/// Returns `line` out of the head of the field `target`: each vertex is at least as far from it as the vertex of
/// `before` was from its own head, up to [`CLEARANCE`]. Edges keep their lengths in `before`.
fn pushed(before: &[Vec3], line: &[Vec3], field: &SdfGrid, target: &SdfGrid) -> Vec<Vec3> {
    let Some(first) = line.first() else { return Vec::new() };
    let mut out = vec![*first];
    for i in 1..line.len() {
        let length = before[i].distance(before[i - 1]);
        let start = out[i - 1];
        let edge = (line[i] - line[i - 1]).normalize_or(Vec3::Y);
        let clear = field.sample(before[i]).clamp(0.0, CLEARANCE);
        let mut p = start + edge * length;
        for _ in 0..ROUNDS {
            let depth = clear - target.sample(p);
            if depth <= 0.0 {
                break;
            }
            let displaced = p + target.normal(p) * depth;
            p = start + (displaced - start).normalize_or(edge) * length;
        }
        out.push(p);
    }
    out
}

/// Returns the mean change of the angles between segments, radians.
fn bend(before: &Strands, after: &Strands) -> f32 {
    let angles = |strand: &[Vec3]| -> Vec<f32> {
        let bent = |w: &[Vec3]| (w[1] - w[0]).angle_between(w[2] - w[1]);
        strand.windows(3).map(bent).map(|angle| if angle.is_finite() { angle } else { 0.0 }).collect()
    };
    let (mut sum, mut count) = (0.0, 0);
    for (a, b) in before.iter().zip(after.iter()) {
        for (a, b) in angles(a).iter().zip(angles(b)) {
            sum += (a - b).abs();
            count += 1;
        }
    }
    sum / count.max(1) as f32
}

/// Returns the mean change of the distance between the middles of strands with neighboring roots, meters.
fn spacing_change(before: &Strands, after: &Strands, tree: &PointTree<'_>, roots: &[Vec3]) -> f32 {
    let midpoint = |strands: &Strands, i: usize| strands.strand(i).get(strands.strand(i).len() / 2).copied();
    let (mut sum, mut count, mut found) = (0.0, 0, Vec::new());
    for (i, root) in roots.iter().enumerate() {
        tree.nearest(*root, 4, 1.0, &mut found);
        for (_, j) in found.iter().filter(|(_, j)| *j as usize != i) {
            let away =
                |strands: &Strands| Some(midpoint(strands, i)?.distance(midpoint(strands, *j as usize)?));
            if let (Some(a), Some(b)) = (away(before), away(after)) {
                sum += (a - b).abs();
                count += 1;
            }
        }
    }
    sum / count.max(1) as f32
}

#[cfg(test)]
mod tests;
