//! Clusters of points: weighted k-means, and merging by Ward's method.

use crate::{progress::in_parallel, random::Rng};

/// A point of `N` coordinates of comparable scale.
pub(super) type Point<const N: usize> = [f32; N];

/// Turns of Lloyd's algorithm.
const ITERATIONS: usize = 15;
/// Largest number of points that determine the clusters; the others join the nearest.
const SAMPLE: usize = 60_000;

fn distance<const N: usize>(a: &Point<N>, b: &Point<N>) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Returns the index of the nearest of `centers` and the squared distance to it.
fn nearest<const N: usize>(point: &Point<N>, centers: &[Point<N>]) -> (u32, f32) {
    let mut best = (0, f32::INFINITY);
    for (i, center) in (0..).zip(centers) {
        let d = distance(point, center);
        if d < best.1 {
            best = (i, d);
        }
    }
    best
}

/// Returns the cluster of each point, at most `count` of them, numbered from 0 without gaps. The weighted sum of
/// squared distances to the clusters' means is a local minimum (k-means++, Arthur and Vassilvitskii 2007; Lloyd 1982).
pub(super) fn cluster<const N: usize>(
    points: &[Point<N>],
    weights: &[f32],
    count: usize,
    seed: u32,
) -> Vec<u32> {
    let every = points.len().div_ceil(SAMPLE).max(1);
    let sample: Vec<Point<N>> = points.iter().step_by(every).copied().collect();
    let heavy: Vec<f32> = weights.iter().step_by(every).copied().collect();
    let mut centers = seeds(&sample, &heavy, count.min(sample.len()), seed);
    for _ in 0..ITERATIONS {
        let of = in_parallel(&sample, |point| nearest(point, &centers).0);
        centers = means(&sample, &heavy, &of, &centers);
    }
    numbered(&in_parallel(points, |point| nearest(point, &centers).0))
}

/// Returns the first centers: each with a probability proportional to the squared distance to the previous ones.
fn seeds<const N: usize>(points: &[Point<N>], weights: &[f32], count: usize, seed: u32) -> Vec<Point<N>> {
    let mut rng = Rng::new(seed, 0);
    let mut far = vec![f32::INFINITY; points.len()];
    let mut centers = Vec::with_capacity(count);
    for _ in 0..count {
        let chance = |i: usize| f64::from(weights[i] * if far[i].is_finite() { far[i] } else { 1.0 });
        let sum: f64 = (0..points.len()).map(chance).sum();
        if sum <= 0.0 {
            break;
        }
        let mut left = f64::from(rng.unit()) * sum;
        let selected = (0..points.len()).find(|i| {
            left -= chance(*i);
            left < 0.0
        });
        let center = points[selected.unwrap_or(points.len() - 1)];
        let closer = in_parallel(points, |point| distance(point, &center));
        far.iter_mut().zip(closer).for_each(|(far, d)| *far = far.min(d));
        centers.push(center);
    }
    centers
}

/// Returns the mean of each cluster; an empty one keeps its center.
fn means<const N: usize>(
    points: &[Point<N>],
    weights: &[f32],
    of: &[u32],
    centers: &[Point<N>],
) -> Vec<Point<N>> {
    let mut sums = vec![([0.0f64; N], 0.0f64); centers.len()];
    for ((point, weight), of) in points.iter().zip(weights).zip(of) {
        let (sum, total) = &mut sums[*of as usize];
        *total += f64::from(*weight);
        sum.iter_mut().zip(point).for_each(|(sum, x)| *sum += f64::from(*weight) * f64::from(*x));
    }
    let mean = |((sum, total), center): ((_, f64), &Point<N>)| -> Point<N> {
        let sum: [f64; N] = sum;
        if total > 0.0 { sum.map(|x| (x / total) as f32) } else { *center }
    };
    sums.into_iter().zip(centers).map(mean).collect()
}

/// Renumbers clusters by their first point.
fn numbered(of: &[u32]) -> Vec<u32> {
    let mut names = std::collections::HashMap::new();
    of.iter()
        .map(|old| {
            let next = names.len() as u32;
            *names.entry(*old).or_insert(next)
        })
        .collect()
}

/// Merges the clusters `of` points until `count` are left, always the pair whose union adds least to the weighted sum
/// of squared distances (Ward 1963).
pub(super) fn merge<const N: usize>(
    points: &[Point<N>],
    weights: &[f32],
    of: &[u32],
    count: usize,
) -> Vec<u32> {
    let clusters = of.iter().max().map_or(0, |last| *last as usize + 1);
    let mut centers = means(points, weights, of, &vec![[0.0; N]; clusters]);
    let mut heavy = vec![0.0f32; clusters];
    of.iter().zip(weights).for_each(|(of, weight)| heavy[*of as usize] += weight);
    let mut into: Vec<u32> = (0..clusters as u32).collect();
    let mut alive = vec![true; clusters];
    let cost = |centers: &[Point<N>], heavy: &[f32], a: usize, b: usize| {
        heavy[a] * heavy[b] / (heavy[a] + heavy[b]).max(1e-12) * distance(&centers[a], &centers[b])
    };
    // The best partner of each cluster among those after it.
    let best = |centers: &[Point<N>], heavy: &[f32], alive: &[bool], a: usize| {
        let others = (a + 1..clusters).filter(|b| alive[*b]).map(|b| (cost(centers, heavy, a, b), b));
        others.fold((f32::INFINITY, a), |best, at| if at.0 < best.0 { at } else { best })
    };
    let mut partners: Vec<_> = (0..clusters).map(|a| best(&centers, &heavy, &alive, a)).collect();
    for _ in count.max(1)..clusters {
        let of_alive = (0..clusters).filter(|a| alive[*a]);
        let a = of_alive
            .fold(0, |found, a| if !alive[found] || partners[a].0 < partners[found].0 { a } else { found });
        let b = partners[a].1;
        if a == b {
            break;
        }
        let total = (heavy[a] + heavy[b]).max(1e-12);
        centers[a] = std::array::from_fn(|k| (heavy[a] * centers[a][k] + heavy[b] * centers[b][k]) / total);
        heavy[a] = total;
        alive[b] = false;
        into[b] = a as u32;
        for c in 0..clusters {
            if !alive[c] {
                continue;
            }
            let stale = c == a || partners[c].1 == a || partners[c].1 == b;
            if stale {
                partners[c] = best(&centers, &heavy, &alive, c);
            } else if c < a {
                let new = (cost(&centers, &heavy, c, a), a);
                if new.0 < partners[c].0 {
                    partners[c] = new;
                }
            }
        }
    }
    let root = |of: u32| {
        let mut at = of;
        while into[at as usize] != at {
            at = into[at as usize];
        }
        at
    };
    numbered(&of.iter().map(|of| root(*of)).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `count` points around each of the corners of a square of edge 1.
    fn corners(count: usize, spread: f32) -> Vec<Point<16>> {
        let mut rng = Rng::new(5, 1);
        (0..4 * count)
            .map(|i| {
                let mut point = [0.0; 16];
                point[0] = (i % 4 / 2) as f32 + spread * rng.bell();
                point[1] = (i % 2) as f32 + spread * rng.bell();
                point
            })
            .collect()
    }

    #[test]
    fn separate_groups_are_found() {
        let points = corners(50, 0.05);
        let found = cluster(&points, &vec![1.0; points.len()], 4, 1);
        assert_eq!(found, (0..points.len() as u32).map(|i| i % 4).collect::<Vec<_>>());
        assert_eq!(found, cluster(&points, &vec![1.0; points.len()], 4, 1));
    }

    #[test]
    fn no_more_clusters_than_distinct_points() {
        let points = vec![[1.0; 16]; 7];
        assert_eq!(cluster(&points, &[1.0; 7], 3, 1), vec![0; 7]);
        assert_eq!(cluster(&points[..1], &[1.0], 9, 1), vec![0]);
    }

    #[test]
    fn merging_joins_the_groups_that_belong_together() {
        let points = corners(60, 0.1);
        let weights = vec![1.0; points.len()];
        let fine = cluster(&points, &weights, 24, 1);
        let coarse = merge(&points, &weights, &fine, 4);
        assert_eq!(coarse, (0..points.len() as u32).map(|i| i % 4).collect::<Vec<_>>());
        // A coarse cluster is a union of fine ones.
        for (a, b) in fine.iter().zip(&coarse) {
            assert!(fine.iter().zip(&coarse).all(|(c, d)| a != c || b == d));
        }
        assert!(merge(&points, &weights, &fine, 1).iter().all(|of| *of == 0));
    }
}
