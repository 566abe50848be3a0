//! The guides as a stroke moves them, and their neighbors.

use super::{GroomDocument, StrokeSample, solve::unit};
use crate::{SdfGrid, near::PointTree};
use glam::Vec3;
use std::sync::OnceLock;

/// Weight of the distance from a ray relative to the depth along it, when hair is picked.
const OFFSET_WEIGHT: f32 = 3.0;
/// Largest distance from a ray at which hair is picked, meters.
const PICK: f32 = 0.02;
/// Number of neighbors.
const NEIGHBORS: usize = 6;

/// The current vertices of all guides, with a sphere and a normal for each.
#[derive(Debug)]
pub(super) struct PosedGuides {
    vertex_count: usize,
    /// The vertices, guide after guide, meters.
    pub positions: Vec<Vec3>,
    /// A sphere around each guide.
    pub spheres: Vec<(Vec3, f32)>,
    /// Normal of the skin at each root.
    pub normals: Vec<Vec3>,
    /// Nearest roots of each guide.
    neighbors: OnceLock<Vec<Vec<u32>>>,
    /// Largest distance from a ray at which a guide is picked, meters.
    pub pick: f32,
    /// Whether guides have moved since the caller last asked.
    pub changed: bool,
}

impl PosedGuides {
    pub fn new(document: &GroomDocument, field: Option<&SdfGrid>) -> Self {
        let guides = document.guides();
        let lines = || (0..guides.len()).map(|i| guides.guide(i));
        let normal = |guide: &[Vec3]| match field {
            Some(field) => field.normal(guide[0]),
            None => unit(guide[1] - guide[0], Vec3::Y),
        };
        let roots: Vec<Vec3> = lines().map(|guide| guide[0]).collect();
        let tree = PointTree::new(&roots);
        let mut found = Vec::new();
        let mut nearest: Vec<f32> = roots
            .iter()
            .filter_map(|root| {
                tree.nearest(*root, 2, 1.0, &mut found);
                found.get(1).map(|(square, _)| square.sqrt())
            })
            .collect();
        nearest.sort_by(f32::total_cmp);
        let spacing = nearest.get(nearest.len() / 2).copied().unwrap_or(PICK);
        Self {
            vertex_count: document.vertex_count(),
            spheres: lines().map(sphere).collect(),
            normals: lines().map(normal).collect(),
            positions: guides.positions(),
            neighbors: OnceLock::new(),
            pick: (1.5 * spacing).clamp(5e-3, PICK),
            changed: false,
        }
    }

    pub fn len(&self) -> usize {
        self.spheres.len()
    }

    /// Returns the vertices of guide `i`.
    pub fn guide(&self, i: usize) -> &[Vec3] {
        &self.positions[i * self.vertex_count..][..self.vertex_count]
    }

    /// Returns the vertices of each guide.
    pub fn lines(&self) -> impl Iterator<Item = &[Vec3]> {
        self.positions.chunks_exact(self.vertex_count)
    }

    /// Returns the root of each guide.
    pub fn roots(&self) -> Vec<Vec3> {
        self.lines().map(|guide| guide[0]).collect()
    }

    /// Returns root and normal of the skin of each guide, with its value.
    pub fn at_roots<T>(&self, values: impl Iterator<Item = T>) -> impl Iterator<Item = (Vec3, Vec3, T)> {
        let roots = self.lines().zip(&self.normals);
        roots.zip(values).map(|((guide, normal), value)| (guide[0], *normal, value))
    }

    /// Gives guide `i` other vertices.
    pub fn set(&mut self, i: usize, guide: &[Vec3], field: Option<&SdfGrid>) {
        let start = i * guide.len();
        if let Some(field) = field.filter(|_| self.positions[start] != guide[0]) {
            self.normals[i] = field.normal(guide[0]);
        }
        self.positions[start..start + guide.len()].copy_from_slice(guide);
        self.spheres[i] = sphere(guide);
        self.changed = true;
    }

    /// Returns the depth, less than `last`, of the hair that a ray meets within the distance `max_offset`, meters.
    pub fn depth(&self, sample: &StrokeSample, max_offset: f32, last: f32) -> Option<f32> {
        let (origin, direction) = (sample.origin, sample.direction);
        let mut best = (f32::MAX, None);
        for (guide, (center, radius)) in self.lines().zip(&self.spheres) {
            let depth = (*center - origin).dot(direction);
            let off = (*center - sample.at(depth)).length() - radius;
            if off > max_offset || depth - radius + OFFSET_WEIGHT * off.max(0.0) > best.0 {
                continue;
            }
            for p in guide {
                let depth = (*p - origin).dot(direction);
                let off = (*p - sample.at(depth)).length();
                let score = depth + OFFSET_WEIGHT * off;
                if off <= max_offset && depth > 0.0 && depth < last && score < best.0 {
                    best = (score, Some(depth));
                }
            }
        }
        best.1
    }

    /// Returns the mean directions of the edges of the neighbors of guide `i` that run with it, zero without any.
    pub fn mean_edges(&self, i: usize) -> Vec<Vec3> {
        let n = self.vertex_count;
        let chord = |guide: &[Vec3]| unit(guide[n - 1] - guide[0], Vec3::ZERO);
        let own = chord(self.guide(i));
        let mut sums = vec![Vec3::ZERO; n - 1];
        for other in &self.neighbors()[i] {
            let guide = self.guide(*other as usize);
            if chord(guide).dot(own) > 0.5 {
                for (sum, edge) in sums.iter_mut().zip(guide.windows(2)) {
                    *sum += unit(edge[1] - edge[0], Vec3::ZERO);
                }
            }
        }
        sums.into_iter().map(|sum| unit(sum, Vec3::ZERO)).collect()
    }

    fn neighbors(&self) -> &[Vec<u32>] {
        self.neighbors.get_or_init(|| {
            let roots = self.roots();
            let (tree, mut found) = (PointTree::new(&roots), Vec::new());
            let mut of = |(i, root): (usize, &Vec3)| {
                tree.nearest(*root, NEIGHBORS + 1, 0.1, &mut found);
                found.iter().map(|(_, j)| *j).filter(|j| *j as usize != i).take(NEIGHBORS).collect()
            };
            roots.iter().enumerate().map(&mut of).collect()
        })
    }
}

/// Returns a sphere around `line`.
pub(super) fn sphere(line: &[Vec3]) -> (Vec3, f32) {
    let (lo, hi) = line.iter().fold((line[0], line[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    (0.5 * (lo + hi), 0.5 * (hi - lo).length())
}
