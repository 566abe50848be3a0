//! Evidence for up and front from roots, strands and a head's surface.
//!
//! Each feature is a vector in the file's frame that should point up, down, forward or back. The score of a candidate
//! frame is its agreement with all features, plus a small bonus for frames that common programs write.

use std::collections::HashMap;

use glam::Vec3;

use super::{FittedSphere, frame::Frame, likeness};
use crate::{Strands, TriMesh, mesh::bvh::Bvh};

/// Least mean direction of the roots on a head: 0.5 on a hemisphere, 0 all around.
const ONE_SIDED: f32 = 0.3;
/// Distance from their sphere, in radii, that four in five roots on a head keep.
const OFF_SPHERE: f32 = 0.4;

/// Features of hair.
#[derive(Clone, Debug)]
pub(super) struct HairFacts {
    /// Up to a few thousand roots, in the file's unit.
    pub roots: Vec<Vec3>,
    /// Sphere fitted to the roots.
    pub sphere: FittedSphere,
    /// Mean direction from the sphere's center to the roots. It points up and back, since faces have no hair.
    pub mean: Vec3,
    /// Mean direction from root to tip. It points down.
    pub fall: Vec3,
}

impl HairFacts {
    /// Returns `None` if no strand has a finite root and tip, or if the roots coincide.
    pub fn of(strands: &Strands) -> Option<Self> {
        let step = (strands.len() / 4000).max(1);
        let ends: Vec<(Vec3, Vec3)> = strands
            .iter()
            .step_by(step)
            .filter_map(|s| Some((*s.first()?, *s.last()?)))
            .filter(|(root, tip)| root.is_finite() && tip.is_finite())
            .collect();
        let roots: Vec<Vec3> = ends.iter().map(|e| e.0).collect();
        let n = roots.len() as f32;
        let centroid = roots.iter().sum::<Vec3>() / n;
        let spread = (roots.iter().map(|p| p.distance_squared(centroid)).sum::<f32>() / n).sqrt();
        let sphere = FittedSphere::fit(&roots).filter(|s| s.radius < 10.0 * spread);
        let sphere = sphere.unwrap_or(FittedSphere { center: centroid, radius: spread });
        if roots.is_empty() || !sphere.radius.is_finite() || sphere.radius <= 0.0 {
            return None;
        }
        let mean = roots.iter().map(|p| (*p - sphere.center) / sphere.radius).sum::<Vec3>() / n;
        let fall = ends.iter().map(|(root, tip)| (*tip - *root).normalize_or_zero()).sum::<Vec3>() / n;
        Some(Self { roots, sphere, mean, fall })
    }

    /// Returns the agreement with a frame.
    pub fn score(&self, frame: Frame) -> f32 {
        let (up, front) = (frame.up.vector(), frame.front.vector());
        let side = up.cross(front);
        self.mean.dot(up)
            - 0.5 * self.fall.dot(up)
            - 0.8 * self.mean.dot(front)
            - 0.5 * self.mean.dot(side).abs()
    }

    /// Returns the length of the body, in the file's unit, if the roots lie all around it, as fur does, or on no
    /// sphere; `None` if they lie on one side of a sphere, as on a head.
    pub fn body(&self) -> Option<f32> {
        let FittedSphere { center, radius } = self.sphere;
        let mut off: Vec<f32> =
            self.roots.iter().map(|root| (root.distance(center) / radius - 1.0).abs()).collect();
        off.sort_unstable_by(f32::total_cmp);
        let is_round = off[(off.len() - 1) * 4 / 5] < OFF_SPHERE;

        let (lo, hi) = self.roots.iter().fold((Vec3::MAX, Vec3::MIN), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        (self.mean.length() < ONE_SIDED || !is_round).then_some((hi - lo).max_element())
    }

    /// Returns half the breadth of the rooted area along `side`, without the outermost 2 % at both ends.
    pub fn half_breadth(&self, side: Vec3) -> f32 {
        let mut along: Vec<f32> = self.roots.iter().map(|p| p.dot(side)).collect();
        along.sort_unstable_by(f32::total_cmp);
        let at = |fraction: f32| along[((along.len() - 1) as f32 * fraction) as usize];
        0.5 * (at(0.98) - at(0.02))
    }
}

/// Maximum mean difference, skull radii, of a mesh that resembles a human head; real heads have at most 0.1.
const ALIKE: f32 = 0.12;
/// Weight of the resemblance to a head.
const LIKENESS: f32 = 6.0;

/// Features of a head's surface.
#[derive(Clone, Debug)]
pub(super) struct MeshFacts {
    /// Distance between the mesh and its mirror image per axis, normalized to a sum of 1.
    asymmetry: Vec3,
    /// From the center of the surface to the center of the vertices. It points to the face, where modelers spend
    /// vertices.
    detail: Vec3,
    /// From the center to the mean boundary edge, mostly the cut through the neck. It points down.
    cut: Vec3,
    /// Difference to a head in every frame, in the order of [`Frame::all`]; empty if the mesh resembles a head in none.
    differences: Vec<(Frame, f32)>,
}

impl MeshFacts {
    /// Returns the features of a mesh; `bvh` is the mesh's tree.
    pub fn of(mesh: &TriMesh, bvh: &Bvh) -> Self {
        let (lo, hi) = mesh.bounds().unwrap_or_default();
        let (center, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
        let size = half.max_element().max(f32::MIN_POSITIVE);
        let mut asymmetry = Vec3::ZERO;
        for axis in 0..3 {
            for p in mesh.positions.iter().step_by((mesh.positions.len() / 400).max(1)) {
                let mut q = *p;
                q[axis] = 2.0 * center[axis] - q[axis];
                asymmetry[axis] += bvh.closest_point(q).map_or(0.0, |c| c.distance);
            }
        }
        let total = asymmetry.element_sum();
        let asymmetry = if total > 0.0 { asymmetry / total } else { Vec3::splat(1.0 / 3.0) };
        let vertices = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len().max(1) as f32;
        let (mut surface, mut area) = (Vec3::ZERO, 0.0);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let twice = (b - a).cross(c - a).length();
            surface += (a + b + c) / 3.0 * twice;
            area += twice;
        }
        let detail = if area > 0.0 { (vertices - surface / area) / size } else { Vec3::ZERO };
        let step = (mesh.positions.len() / 6000).max(1);
        let sample: Vec<Vec3> = mesh.positions.iter().copied().step_by(step).collect();
        let mut differences: Vec<_> = Frame::all().map(|f| (f, likeness::difference(&sample, f))).collect();
        if !differences.iter().any(|d| d.1 < ALIKE) {
            differences.clear();
        }
        Self { asymmetry, detail, cut: cut(mesh).map_or(Vec3::ZERO, |c| (c - center) / size), differences }
    }

    /// Returns the agreement with a frame.
    pub fn score(&self, frame: Frame) -> f32 {
        let (up, front) = (frame.up.vector(), frame.front.vector());
        let side = up.cross(front).abs();
        let difference = self.differences.iter().find(|d| d.0 == frame).map_or(0.0, |d| d.1);
        1.5 * self.detail.dot(front) + 0.5 * self.detail.dot(up)
            - self.asymmetry.dot(side)
            - 0.2 * self.cut.dot(up)
            - LIKENESS * difference
    }
}

/// Returns the mean of the boundary edges, which belong to one triangle only, weighted by length.
fn cut(mesh: &TriMesh) -> Option<Vec3> {
    // Vertices at one position count as one, so that texture seams are not boundaries.
    let mut position_ids = HashMap::with_capacity(mesh.positions.len());
    let weld: Vec<u32> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = position_ids.len() as u32;
            *position_ids.entry(p.to_array().map(f32::to_bits)).or_insert(next)
        })
        .collect();
    let mut edges: HashMap<(u32, u32), (u32, [u32; 2])> = HashMap::with_capacity(mesh.triangles.len() * 2);
    for t in &mesh.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let (x, y) = (weld[a as usize], weld[b as usize]);
            edges.entry((x.min(y), x.max(y))).or_insert((0, [a, b])).0 += 1;
        }
    }
    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
    for (_, ends) in edges.values().filter(|e| e.0 == 1) {
        let [a, b] = ends.map(|i| mesh.positions[i as usize]);
        sum += (a + b) * (0.5 * a.distance(b));
        total += a.distance(b);
    }
    (total > 0.0).then(|| sum / total)
}
