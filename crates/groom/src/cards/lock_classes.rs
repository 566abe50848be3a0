//! Classes of locks that look alike and share a tile.

use super::{
    cluster::{Point, cluster},
    lines::Lines,
    tile::Lock,
};
use crate::progress::in_parallel;

/// Texels of the picture by which locks are compared.
const ACROSS: usize = 6;
const ALONG: usize = 8;
/// Coordinates for the comparison: opacities, length and width.
const FEATURES: usize = ACROSS * ALONG + 2;
/// Weights of the logarithms of length and width against opacities.
const LENGTH: f32 = 0.5;
const WIDTH: f32 = 0.3;
/// Factor on the widths of strands in the pictures.
const WIDENING: f32 = 2.0;

/// Which lock is drawn for each lock, and whether its picture is mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Likeness {
    pub(super) lock: u32,
    pub(super) mirrored: bool,
}

/// Returns for each lock the lock whose tile it uses; at most `count` different ones.
pub(super) fn alike(lines: &Lines<'_>, locks: &[Lock], count: usize, seed: u32) -> Vec<Likeness> {
    let features: Vec<(Point<FEATURES>, bool)> = in_parallel(locks, |lock| look(lines, lock));
    let points: Vec<_> = features.iter().map(|(point, _)| *point).collect();
    let weights: Vec<f32> = locks.iter().map(|lock| lock.ribbon.half() * lock.ribbon.length).collect();
    let of = cluster(&points, &weights, count, seed);
    let classes = of.iter().max().map_or(0, |last| *last as usize + 1);
    let medoids: Vec<u32> = (0..classes as u32).map(|class| medoid(&points, &weights, &of, class)).collect();
    let like = |i: usize| {
        let lock = medoids[of[i] as usize];
        Likeness { lock, mirrored: features[i].1 != features[lock as usize].1 }
    };
    (0..locks.len()).map(like).collect()
}

/// Returns how a lock looks with its heavier half on the left, and whether that needed mirroring.
fn look(lines: &Lines<'_>, lock: &Lock) -> (Point<FEATURES>, bool) {
    let tile = lock.draw(lines, [ACROSS, ALONG], WIDENING);
    let at = |x: usize, y: usize| tile.texels[y * ACROSS + x].coverage;
    let lean: f32 = (0..ALONG)
        .flat_map(|y| (0..ACROSS).map(move |x| (x, y)))
        .map(|(x, y)| at(x, y) * (2.0 * x as f32 + 1.0 - ACROSS as f32))
        .sum();
    let mirrored = lean > 0.0;
    let mut point = [0.0; FEATURES];
    for y in 0..ALONG {
        for x in 0..ACROSS {
            point[y * ACROSS + x] = at(if mirrored { ACROSS - 1 - x } else { x }, y);
        }
    }
    // Ratios of sizes count like opacities over a part of the picture.
    point[FEATURES - 2] = LENGTH * (ALONG as f32) * lock.ribbon.length.max(1e-6).ln();
    point[FEATURES - 1] = WIDTH * (ALONG as f32) * lock.ribbon.half().max(1e-6).ln();
    (point, mirrored)
}

/// Returns the member of `class` nearest to its mean.
fn medoid(points: &[Point<FEATURES>], weights: &[f32], of: &[u32], class: u32) -> u32 {
    let members: Vec<usize> = (0..points.len()).filter(|i| of[*i] == class).collect();
    let total: f32 = members.iter().map(|i| weights[*i]).sum();
    let mut mean = [0.0; FEATURES];
    for i in &members {
        mean.iter_mut().zip(points[*i]).for_each(|(sum, x)| *sum += weights[*i] * x / total.max(1e-12));
    }
    let far = |i: usize| -> f32 { points[i].iter().zip(&mean).map(|(a, b)| (a - b).powi(2)).sum() };
    members.into_iter().min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(0) as u32
}
