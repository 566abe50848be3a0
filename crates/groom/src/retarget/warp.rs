//! The skin of a head, warped onto another head of other triangles.
//!
//! A similarity first: the landmarks of both heads, then nearest points in both directions. With one direction only,
//! heads shrink: every point of the one has a near point on the other. Then sums of Gaussians move the skin, with radii
//! that fall.

use crate::{
    Error, Result, TriMesh, head::HeadShape, mesh::Bvh, near::PointTree, progress::in_parallel,
    rotation::nearest_rotation,
};
use glam::{Quat, Vec3};

/// Points of each head that are matched, and rounds of matching.
const SAMPLES: usize = 3000;
const MATCHES: u32 = 40;
/// Sites of the warp, and the radii of its Gaussians, meters.
const SITES: usize = 500;
const RADII: [f32; 5] = [0.12, 0.08, 0.05, 0.03, 0.02];
/// Weight of smoothness in a warp.
const SMOOTH: f32 = 0.05;
/// Largest distance and angle (cosine) of normals between points that correspond.
const FAR: f32 = 0.05;
const MIN_NORMAL_COSINE: f32 = 0.5;
/// Weight of a landmark among sites.
const LANDMARK: f32 = 20.0;
/// Distance from the roots to which the skin is matched, meters.
const AROUND: f32 = 0.12;
/// Fewest pairs that a match needs.
const FEWEST: usize = 50;

/// A point of a head and the point of another that corresponds, meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmark {
    /// Point of the head that the groom was made on.
    pub from: Vec3,
    /// Point of the other head.
    pub to: Vec3,
}

/// A rotation, a scale and a translation.
#[derive(Clone, Copy, Debug)]
struct Similarity {
    scale: f32,
    rotation: Quat,
    translation: Vec3,
}

impl Similarity {
    fn point(&self, p: Vec3) -> Vec3 {
        self.rotation * (p * self.scale) + self.translation
    }

    /// Returns the similarity that moves the first points of `pairs` closest to the second.
    fn fit(pairs: &[(Vec3, Vec3)]) -> Self {
        let count = pairs.len().max(1) as f32;
        let from = pairs.iter().map(|(a, _)| *a).sum::<Vec3>() / count;
        let to = pairs.iter().map(|(_, b)| *b).sum::<Vec3>() / count;
        let centered = || pairs.iter().map(|(a, b)| (*a - from, *b - to));
        let rotation = nearest_rotation(centered());
        let along: f32 = centered().map(|(a, b)| (rotation * a).dot(b)).sum();
        let size: f32 = centered().map(|(a, _)| a.length_squared()).sum();
        let scale = if size > 0.0 && along > 0.0 { along / size } else { 1.0 };
        Self { scale, rotation, translation: to - rotation * (from * scale) }
    }
}

/// Returns the mesh `head` with its vertices on the skin of `other`, at least around `roots`.
pub(super) fn warped(
    head: &TriMesh,
    other: &TriMesh,
    roots: &[Vec3],
    landmarks: &[Landmark],
) -> Result<TriMesh> {
    let near = near_roots(head, roots);
    let mut mesh = head.clone();
    let start = beginning(head, other, landmarks);
    mesh.positions.iter_mut().for_each(|p| *p = start.point(*p));
    mesh.compute_normals();
    let mut marks: Vec<Vec3> = landmarks.iter().map(|mark| start.point(mark.from)).collect();
    let target = Skin::new(other);
    for _ in 0..MATCHES {
        let mut pairs = matches(&mesh, &near, &target);
        // The other way round: points of the other head, to theirs on this one.
        let own = Skin::new(&mesh);
        let near_bounds = bounds(near.iter().map(|i| mesh.positions[*i as usize]));
        let back = spread(other.positions.len(), SAMPLES, |i| inside(other.positions[i], near_bounds));
        let back = in_parallel(&back, |i: &u32| {
            own.closest(other.positions[*i as usize], other.normals.get(*i as usize))
        });
        pairs.extend(
            back.into_iter().flatten().map(|(target_point, source_point)| (source_point, target_point)),
        );
        if pairs.len() < FEWEST {
            return Err(Error::Unusable(
                "the heads do not resemble each other: too few places of their skin match".into(),
            ));
        }
        for (mark, landmark) in marks.iter().zip(landmarks) {
            pairs.extend(std::iter::repeat_n((*mark, landmark.to), pairs.len() / (4 * landmarks.len()) + 1));
        }
        let step = Similarity::fit(&pairs);
        mesh.positions.iter_mut().chain(&mut marks).for_each(|p| *p = step.point(*p));
        mesh.compute_normals();
        let still = (step.scale - 1.0).abs() < 1e-4
            && step.translation.length() + step.rotation.xyz().length() < 2e-4;
        if still {
            break;
        }
    }
    let sites = select_sites(&near, &mesh);
    for radius in RADII {
        let mut pairs: Vec<(Vec3, Vec3, f32)> = in_parallel(&sites, |i: &u32| {
            let p = mesh.positions[*i as usize];
            target.closest(p, mesh.normals.get(*i as usize))
        })
        .into_iter()
        .flatten()
        .map(|(from, to)| (from, to, 1.0))
        .collect();
        pairs.extend(marks.iter().zip(landmarks).map(|(mark, landmark)| (*mark, landmark.to, LANDMARK)));
        let warp = Gaussians::new(&pairs, radius);
        mesh.positions = in_parallel(&mesh.positions, |p: &Vec3| warp.point(*p));
        marks.iter_mut().for_each(|p| *p = warp.point(*p));
        mesh.compute_normals();
    }
    Ok(mesh)
}

/// Returns a first similarity: by landmarks, else by the heads' own, else by their boxes.
fn beginning(head: &TriMesh, other: &TriMesh, landmarks: &[Landmark]) -> Similarity {
    if landmarks.len() >= 3 {
        return Similarity::fit(&landmarks.iter().map(|mark| (mark.from, mark.to)).collect::<Vec<_>>());
    }
    let shapes = [head, other].map(HeadShape::of);
    if let [Ok(from), Ok(to)] = shapes {
        let scale = to.size() / from.size();
        let translation = to.landmarks.skull - from.landmarks.skull * scale;
        return Similarity { scale, rotation: Quat::IDENTITY, translation };
    }
    let top = |mesh: &TriMesh| {
        let (low, high) = mesh.bounds().unwrap_or_default();
        Vec3::new(0.5 * (low.x + high.x), high.y, 0.5 * (low.z + high.z))
    };
    Similarity { scale: 1.0, rotation: Quat::IDENTITY, translation: top(other) - top(head) }
}

/// A mesh to look up nearest points on.
struct Skin<'a> {
    mesh: &'a TriMesh,
    bvh: Bvh,
}

impl<'a> Skin<'a> {
    fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh, bvh: Bvh::new(mesh) }
    }

    /// Returns `p` and the nearest point, if it is near and the skin there faces alike.
    fn closest(&self, p: Vec3, normal: Option<&Vec3>) -> Option<(Vec3, Vec3)> {
        let closest = self.bvh.closest_point_within(p, FAR)?;
        let target_normal = super::normal_at(self.mesh, closest.triangle, closest.barycentric);
        normal
            .is_none_or(|normal| normal.dot(target_normal) > MIN_NORMAL_COSINE)
            .then_some((p, closest.point))
    }
}

/// Returns the vertices of `mesh` near roots: the scalp and the skin around it.
fn near_roots(mesh: &TriMesh, roots: &[Vec3]) -> Vec<u32> {
    let tree = PointTree::new(roots);
    let all: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let is_near = |i: &u32| {
        let mut found = Vec::new();
        tree.nearest(mesh.positions[*i as usize], 1, AROUND, &mut found);
        !found.is_empty()
    };
    all.iter().zip(in_parallel(&all, is_near)).filter(|(_, near)| *near).map(|(i, _)| *i).collect()
}

fn matches(mesh: &TriMesh, near: &[u32], target: &Skin<'_>) -> Vec<(Vec3, Vec3)> {
    let some = spread(near.len(), SAMPLES, |_| true);
    let of = |k: &u32| {
        let i = near[*k as usize] as usize;
        target.closest(mesh.positions[i], mesh.normals.get(i))
    };
    in_parallel(&some, of).into_iter().flatten().collect()
}

/// Returns about `count` of the indices below `all` that `takes` accepts, evenly.
fn spread(all: usize, count: usize, takes: impl Fn(usize) -> bool) -> Vec<u32> {
    let accepted: Vec<u32> = (0..all).filter(|i| takes(*i)).map(|i| i as u32).collect();
    let step = (accepted.len() / count).max(1);
    accepted.into_iter().step_by(step).collect()
}

fn bounds(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

fn inside(p: Vec3, (low, high): (Vec3, Vec3)) -> bool {
    p.cmpge(low).all() && p.cmple(high).all()
}

/// Returns vertices that are far from each other: each the farthest from those before.
fn select_sites(near: &[u32], mesh: &TriMesh) -> Vec<u32> {
    let Some(first) = near.first() else { return Vec::new() };
    let mut away: Vec<f32> = vec![f32::MAX; near.len()];
    let (mut sites, mut last) = (vec![*first], mesh.positions[*first as usize]);
    while sites.len() < SITES.min(near.len()) {
        let mut best = (0.0, 0);
        for (k, i) in near.iter().enumerate() {
            away[k] = away[k].min(mesh.positions[*i as usize].distance_squared(last));
            if away[k] > best.0 {
                best = (away[k], k);
            }
        }
        if best.0 <= 0.0 {
            break;
        }
        sites.push(near[best.1]);
        last = mesh.positions[near[best.1] as usize];
    }
    sites
}

/// A sum of Gaussians.
struct Gaussians {
    sites: Vec<Vec3>,
    weights: Vec<Vec3>,
    radius: f32,
}

impl Gaussians {
    /// Fits displacements of `pairs` (from, to, weight) by regularized least squares: conjugate gradients on
    /// `K W K + smooth K`, with `K` the kernel between sites.
    fn new(pairs: &[(Vec3, Vec3, f32)], radius: f32) -> Self {
        let sites: Vec<Vec3> = pairs.iter().map(|(from, ..)| *from).collect();
        let kernel: Vec<Vec<f32>> =
            in_parallel(&sites, |a: &Vec3| sites.iter().map(|b| gauss(*a, *b, radius)).collect());
        let apply = |x: &[Vec3]| -> Vec<Vec3> {
            kernel.iter().map(|row| row.iter().zip(x).map(|(k, x)| *x * *k).sum()).collect()
        };
        // (K + smooth / weight) x = displacement: symmetric and positive.
        let system = |x: &[Vec3]| -> Vec<Vec3> {
            let mut out = apply(x);
            for ((out, x), (.., weight)) in out.iter_mut().zip(x).zip(pairs) {
                *out += *x * (SMOOTH / weight);
            }
            out
        };
        let displacements: Vec<Vec3> = pairs.iter().map(|(from, to, _)| *to - *from).collect();
        let mut x = vec![Vec3::ZERO; sites.len()];
        let (mut rest, mut direction) = (displacements.clone(), displacements);
        let dot =
            |a: &[Vec3], b: &[Vec3]| -> f64 { a.iter().zip(b).map(|(a, b)| f64::from(a.dot(*b))).sum() };
        let mut size = dot(&rest, &rest);
        let end = 1e-8 * size;
        for _ in 0..300 {
            if size <= end || size == 0.0 {
                break;
            }
            let product = system(&direction);
            let step = (size / dot(&direction, &product).max(1e-30)) as f32;
            for i in 0..x.len() {
                x[i] += direction[i] * step;
                rest[i] -= product[i] * step;
            }
            let next = dot(&rest, &rest);
            let keep = (next / size) as f32;
            direction
                .iter_mut()
                .zip(&rest)
                .for_each(|(component, rest)| *component = *rest + *component * keep);
            size = next;
        }
        Self { sites, weights: x, radius }
    }

    fn point(&self, p: Vec3) -> Vec3 {
        let add = |(site, weight): (&Vec3, &Vec3)| *weight * gauss(p, *site, self.radius);
        p + self.sites.iter().zip(&self.weights).map(add).sum::<Vec3>()
    }
}

fn gauss(a: Vec3, b: Vec3, radius: f32) -> f32 {
    (-a.distance_squared(b) / (radius * radius)).exp()
}
