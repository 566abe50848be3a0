//! Roots of the guides: points spread evenly over the region inside the hairline.

use super::hairline::Hairline;
use super::parting::Parting;
use crate::random::Rng;
use crate::scalp::{Scalp, spread_direction};
use glam::{Vec2, Vec3, Vec4};

/// Sample points of the region per root.
const SAMPLES_PER_ROOT: usize = 45;

/// Rounds of relaxation.
const ROUNDS: usize = 14;

/// Returns `count` points on `scalp` inside the hairline and beside the parting, relaxed by Lloyd's method: each moves
/// to the mean of the samples nearest to it. Samples near an edge weigh more, so that the outermost roots lie close to
/// it.
pub(crate) fn guide_roots(
    scalp: &dyn Scalp,
    hairline: &Hairline,
    parting: Option<&Parting>,
    count: usize,
    seed: u32,
) -> Vec<Vec3> {
    let mut rng = Rng::new(seed, 0x0700);
    let start = Vec2::new(rng.unit(), rng.unit());
    // The fourth coordinate moves the two sides of the parting apart, so that no root covers both.
    let embed = |p: Vec3| match parting {
        Some(parting) => {
            let near = 1.0 - (parting.nearest(p).distance(p) / 0.03).min(1.0);
            p.extend(parting.side(p) * 0.03 * near)
        }
        None => p.extend(0.0),
    };
    let mut samples: Vec<(Vec4, f32)> = Vec::new();
    let mut i = 0;
    while samples.len() < count * SAMPLES_PER_ROOT && i < 4_000_000 {
        let p = scalp.point(spread_direction(i, start));
        i += 1;
        let inside = hairline.inside(p);
        let parting_distance = parting.map_or(1.0, |line| line.nearest(p).distance(p) - line.half_width);
        if inside < 0.001 || parting_distance < 0.001 {
            continue;
        }
        let edge = inside.min(parting_distance);
        samples.push((embed(p), if edge < 0.006 { 3.0 } else { 1.0 }));
    }
    // The samples are an evenly spread sequence, so any run of them is a good start.
    let mut roots: Vec<Vec4> = samples.iter().take(count).map(|sample| sample.0).collect();
    let mut sums = vec![(Vec4::ZERO, 0.0f32); roots.len()];
    for _ in 0..ROUNDS {
        sums.fill((Vec4::ZERO, 0.0));
        for &(p, weight) in &samples {
            let sum = &mut sums[nearest(&roots, p)];
            sum.0 += p * weight;
            sum.1 += weight;
        }
        for (root, (sum, weight)) in roots.iter_mut().zip(&sums) {
            if *weight > 0.0 {
                *root = *sum / *weight;
            }
        }
    }
    let skull = scalp.landmarks().skull;
    let settle = |root: &Vec4| {
        let p = scalp.point(root.truncate() - skull);
        let is_bald = hairline.inside(p) < 0.0005
            || parting.is_some_and(|line| line.nearest(p).distance(p) < line.half_width + 0.0005);
        // A mean can fall outside of a concave region; its nearest sample does not.
        if is_bald { samples[nearest_sample(&samples, *root)].0.truncate() } else { p }
    };
    roots.iter().map(settle).collect()
}

fn nearest(roots: &[Vec4], p: Vec4) -> usize {
    let mut best = (f32::INFINITY, 0);
    for (i, root) in roots.iter().enumerate() {
        let d = root.distance_squared(p);
        if d < best.0 {
            best = (d, i);
        }
    }
    best.1
}

fn nearest_sample(samples: &[(Vec4, f32)], p: Vec4) -> usize {
    let mut best = (f32::INFINITY, 0);
    for (i, sample) in samples.iter().enumerate() {
        let d = sample.0.distance_squared(p);
        if d < best.0 {
            best = (d, i);
        }
    }
    best.1
}
