//! Strands as cards see them: smooth paths, widths, and weights.

use super::cluster::Point;
pub(super) use crate::fill::curves::PATH_POINTS;
use crate::{
    Strands,
    bound::covering_radius,
    fill::curves::{Curves, Smoothing},
};
use glam::Vec3;

/// Distance in a cluster's space between strands of different groups, meters.
const GROUP_DISTANCE: f32 = 10.0;
/// Scale of the root's coordinates in a cluster's space.
const ROOT: f32 = 0.6;

/// Strands with their paths, widths and weights.
pub(super) struct Lines<'a> {
    pub(super) strands: &'a Strands,
    /// Radius of each vertex, meters.
    pub(super) radii: Vec<f32>,
    /// Importance of each strand.
    pub(super) weights: Vec<f32>,
    curves: Curves,
}

impl<'a> Lines<'a> {
    /// Prepares strands of at least two vertices each.
    pub(super) fn new(strands: &'a Strands) -> Self {
        let curves = Curves::new(strands, None, Smoothing::WEAK);
        let radii = match strands.radii.len() == strands.positions.len() {
            true => strands.radii.clone(),
            false => vec![covering_radius(strands.len()); strands.positions.len()],
        };
        Self { strands, radii, weights: vec![1.0; strands.len()], curves }
    }

    /// Sets the weights from the visible area of each strand: hidden strands have a fifth of the mean weight.
    pub(super) fn weigh(&mut self, visible_samples: &[u32]) {
        let mean = visible_samples.iter().map(|count| *count as f32).sum::<f32>()
            / visible_samples.len().max(1) as f32;
        self.weights =
            visible_samples.iter().map(|count| (*count as f32).max(0.2 * mean).max(1e-3)).collect();
    }

    /// Length of strand `i`, meters.
    pub(super) fn length(&self, i: u32) -> f32 {
        self.curves.length[i as usize]
    }

    /// Some points of the path of strand `i`.
    pub(super) fn path_points(&self, i: u32) -> &[Vec3] {
        self.curves.path_points(i)
    }

    /// Returns `count` points of the path of strand `i` at equal fractions of its length.
    pub(super) fn path(&self, i: u32, count: usize) -> impl Iterator<Item = Vec3> {
        let mut from = 0;
        (0..count).map(move |k| self.curves.path_at(i, k as f32 / (count - 1) as f32, &mut from))
    }

    /// Vertices of strand `i` and their radii.
    pub(super) fn strand(&self, i: u32) -> (&[Vec3], &[f32]) {
        let range = self.strands.range(i as usize);
        (&self.strands.positions[range.clone()], &self.radii[range])
    }

    /// Returns the coordinates of each strand for clustering: five points of its path, and its group.
    pub(super) fn points(&self) -> Vec<Point<16>> {
        let group = |i: usize| self.strands.marks.get(i).map_or(0, |mark| mark.group);
        (0..self.strands.len())
            .map(|i| {
                let path = self.path_points(i as u32);
                let mut point = [0.0; 16];
                for k in 0..5 {
                    let at = path[2 * k] * if k == 0 { ROOT } else { 1.0 };
                    point[3 * k..3 * k + 3].copy_from_slice(&at.to_array());
                }
                point[15] = GROUP_DISTANCE * group(i) as f32;
                point
            })
            .collect()
    }
}
