//! Vertex counts of short hair and fur.
//!
//! Fur has tens of thousands of strands of few vertices. They are drawn with as many vertices as the curve through the
//! given ones needs, and not with as many as long hair.

use crate::{Strands, curve};
use glam::Vec3;

/// Largest number of given vertices, and largest median length in meters, of short hair.
const MAX_GIVEN: u32 = 8;
const MAX_MEDIAN_LENGTH: f32 = 0.05;
/// Numbers of drawn vertices. More than the last show no finer curve at the width of fur.
const DRAWN: std::ops::RangeInclusive<u32> = 4..=8;
/// Vertices of a guide.
pub(super) const GUIDE: u32 = 8;
/// Largest distance of a drawn strand from its curve relative to its length, and the share of strands that keep it.
const MAX_ERROR: f32 = 0.01;
const MIN_FRACTION: f32 = 0.95;
/// Number of strands that are measured, and of points on each.
const SAMPLES: usize = 400;
const POINTS: usize = 31;

/// Returns the number of vertices with which to draw the first `given` of `strands`, if they are short hair of about
/// `typical` vertices.
pub(super) fn drawn_vertices(strands: &Strands, given: usize, typical: u32) -> Option<u32> {
    if typical > MAX_GIVEN {
        return None;
    }
    let step = given.div_ceil(SAMPLES).max(1);
    let sample: Vec<&[Vec3]> = (0..given).step_by(step).map(|i| strands.strand(i)).collect();
    let mut lengths: Vec<f32> = sample.iter().map(|strand| curve::length(strand)).collect();
    lengths.sort_by(f32::total_cmp);
    if lengths[lengths.len() / 2] > MAX_MEDIAN_LENGTH {
        return None;
    }
    let is_near = |strand: &&&[Vec3], vertices: u32| {
        let fine = curve::subdivide(strand, POINTS);
        let coarse = curve::subdivide(strand, vertices as usize);
        let max_error = MAX_ERROR * curve::length(strand);
        fine.iter().all(|p| coarse.windows(2).any(|edge| distance(*p, edge) <= max_error))
    };
    let enough = DRAWN.into_iter().find(|vertices| {
        let near = sample.iter().filter(|strand| is_near(strand, *vertices)).count();
        near as f32 >= MIN_FRACTION * sample.len() as f32
    });
    Some(enough.unwrap_or(*DRAWN.end()))
}

/// Returns the distance of `p` from an edge.
fn distance(p: Vec3, edge: &[Vec3]) -> f32 {
    let delta = edge[1] - edge[0];
    let t = (p - edge[0]).dot(delta) / delta.length_squared().max(1e-18);
    p.distance(edge[0] + delta * t.clamp(0.0, 1.0))
}
