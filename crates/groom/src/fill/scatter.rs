//! Root placement: scatters new roots evenly, as densely as the input roots or as a map specifies.
//!
//! The method is dart throwing on the triangles between the input roots, with more darts where roots are denser. A dart
//! too close to an input root or a new root is rejected. The minimum distance follows the density and shrinks each
//! round until the requested count is reached. The result is even everywhere (blue noise) and keeps its distance from
//! the input roots.

use super::surface::{Surface, area_of};
use crate::{
    Progress,
    random::Rng,
    scalp::{ScalpMap, scalp_uv},
};
use glam::{IVec3, Vec3};
use std::{collections::HashMap, f32::consts::TAU};

/// Root of a new strand before projection onto the head.
#[derive(Clone, Copy, Debug)]
pub(super) struct RootPoint {
    /// Position on the triangle between the input roots.
    pub(super) root: Vec3,
    /// Sites around the root; an isolated site three times.
    pub(super) sites: [u32; 3],
    /// Barycentric weight of each site.
    pub(super) weights: [f32; 3],
}

/// Minimum distance in the first round, relative to the spacing of a triangular grid of the same density.
const CLOSE: f32 = 0.74;

/// Maximum random displacement of roots at the rim of the hair, meters.
const FRAYED: f32 = 0.007;

/// Factor on the minimum distance per round.
const SHRINK: f32 = 0.86;

/// Rounds after which any place is accepted.
const ROUNDS: usize = 16;

/// Generator of random root positions (darts).
pub(super) struct Thrower<'a> {
    surface: &'a Surface,
    map: Option<(&'a ScalpMap, Vec3)>,
    seed: u32,
    /// Cumulative weights of the triangles, then of the isolated sites.
    sums: Vec<f64>,
    /// Maximum density within each triangle, for rejection sampling.
    peaks: Vec<f32>,
}

impl<'a> Thrower<'a> {
    /// `map` is a density over the scalp and the center of the skull that it is projected from.
    pub(super) fn new(surface: &'a Surface, map: Option<(&'a ScalpMap, Vec3)>, seed: u32) -> Self {
        let mut sums = Vec::with_capacity(surface.triangles.len() + surface.isolated.len());
        let mut peaks = Vec::with_capacity(surface.triangles.len());
        let mut sum = 0.0;
        for &t in &surface.triangles {
            let peak = t.map(|site| surface.density[site as usize]).into_iter().fold(0.0, f32::max);
            sum += f64::from(peak * area_of(surface.corners(t)));
            peaks.push(peak);
            sums.push(sum);
        }
        for &(site, _) in &surface.isolated {
            sum += surface.strands(site).len() as f64;
            sums.push(sum);
        }
        Self { surface, map, seed, sums, peaks }
    }

    /// Returns the fraction of the hair that the map keeps at `root`.
    fn painted(&self, root: Vec3) -> f32 {
        self.map.map_or(1.0, |(map, skull)| map.sample(scalp_uv(root - skull)).min(1.0))
    }

    /// Estimates the fraction of the hair that the map keeps from `tries` darts.
    pub(super) fn kept_fraction(&self, tries: u32) -> f32 {
        if self.map.is_none() {
            return 1.0;
        }
        let darts = (0..tries).filter_map(|i| self.throw(i ^ 0x5a5a_0000));
        let (count, sum) = darts
            .fold((0u32, 0.0f32), |(count, sum), (point, ..)| (count + 1, sum + self.painted(point.root)));
        if count > 0 { sum / count as f32 } else { 0.0 }
    }

    /// Throws the `i`-th dart. Returns its place and the density there (strands per m², before the map), or `None` if
    /// the dart is rejected.
    pub(super) fn throw(&self, i: u32) -> Option<(RootPoint, f32, Rng)> {
        let mut rng = Rng::new(self.seed ^ 0xda27, i);
        let total = *self.sums.last()?;
        // 48 bits, because there can be many triangles.
        let chance = (f64::from(rng.bits() >> 8) + f64::from(rng.bits() >> 8) / 16_777_216.0) / 16_777_216.0;
        let at = self.sums.partition_point(|sum| *sum <= chance * total).min(self.sums.len() - 1);
        let surface = self.surface;
        if let Some(&sites) = surface.triangles.get(at) {
            let (x, y) = (rng.unit().sqrt(), rng.unit());
            let weights = [1.0 - x, x * (1.0 - y), x * y];
            let density: f32 = (0..3).map(|k| weights[k] * surface.density[sites[k] as usize]).sum();
            if rng.unit() * self.peaks[at] > density {
                return None;
            }
            let corners = surface.corners(sites);
            let mut root = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
            // Displace roots at the rim, so that the hairline has no straight edges.
            let rim: f32 = (0..3).filter(|k| surface.rim[sites[*k] as usize]).map(|k| weights[k]).sum();
            if rim > 0.5 {
                let near = sites[(0..3).fold(0, |m, k| if weights[k] > weights[m] { k } else { m })] as usize;
                let (u, away) = (surface.normals[near].any_orthonormal_vector(), rng.unit() * TAU);
                let displacement = FRAYED.min(0.4 * surface.spacing[near]) * (2.0 * rim - 1.0) * rng.unit();
                root += (u * away.cos() + surface.normals[near].cross(u) * away.sin()) * displacement;
            }
            return Some((RootPoint { root, sites, weights }, density, rng));
        }
        let (site, radius) = surface.isolated[at - surface.triangles.len()];
        let normal = surface.normals[site as usize];
        let u = normal.any_orthonormal_vector();
        let (sin, cos) = (rng.unit() * TAU).sin_cos();
        let away = (u * cos + normal.cross(u) * sin) * (radius * rng.unit().sqrt());
        let point = RootPoint {
            root: surface.sites[site as usize] + away,
            sites: [site; 3],
            weights: [1.0, 0.0, 0.0],
        };
        Some((point, surface.density[site as usize], rng))
    }

    /// Returns `count` places, or fewer if the map leaves no room. `times` is the density of all strands relative to
    /// the input strands where the map removes none.
    pub(super) async fn scatter(
        &self,
        count: usize,
        times: f32,
        progress: &impl Progress,
        task: &'static str,
    ) -> Vec<RootPoint> {
        let mut points: Vec<RootPoint> = Vec::with_capacity(count);
        // Spacing of a triangular grid of this density.
        let spacing = |density: f32| (2.0 / (3f32.sqrt() * density * times)).sqrt();
        let mut occupied = RootGrids::new(&self.surface.density, spacing, self.map.is_some());
        for (i, root) in (0u32..).zip(&self.surface.sites) {
            // Skip input roots at random where the map removes hair, to make room for new ones.
            if Rng::new(self.seed ^ 0x9a9, i).unit() < self.painted(*root) {
                occupied.add(*root);
            }
        }
        let mut factor = CLOSE;
        let mut dart = 0u32;
        for round in 0..=ROUNDS {
            let tries = (3 * (count - points.len()) + 64) as u32;
            // The last round accepts any distance; a map may still reject darts.
            let tries = if round == ROUNDS { tries.saturating_mul(64) } else { tries };
            for k in 0..tries {
                if points.len() == count {
                    break;
                }
                if k % 1024 == 0 {
                    progress.step(task, 0.5 * points.len() as f32 / count as f32).await;
                }
                let Some((point, density, mut rng)) = self.throw(dart.wrapping_add(k)) else { continue };
                let painted = self.painted(point.root);
                if rng.unit() >= painted {
                    continue;
                }
                let radius = factor * spacing(density * painted.max(1e-3));
                if round < ROUNDS && occupied.near(point.root, radius) {
                    continue;
                }
                occupied.add(point.root);
                points.push(point);
            }
            dart = dart.wrapping_add(tries);
            if points.len() == count {
                break;
            }
            factor *= SHRINK;
        }
        points
    }
}

/// Occupied positions in hash grids, one grid for each power of two of the root distances.
struct RootGrids {
    /// Size of the smallest cells, meters.
    finest: f32,
    grids: Vec<HashMap<IVec3, Vec<Vec3>, Hasher>>,
}

impl RootGrids {
    fn new(densities: &[f32], spacing: impl Fn(f32) -> f32, painted: bool) -> Self {
        let (lo, hi) = densities
            .iter()
            .map(|d| spacing(*d))
            .fold((f32::INFINITY, 0.0f32), |(lo, hi), r| (lo.min(r), hi.max(r)));
        let finest = lo.max(1e-6);
        // Where a map thins hair out, roots are farther apart than anywhere without it.
        let levels = ((hi / finest).log2().ceil() as usize + if painted { 4 } else { 1 }).min(8);
        Self { finest, grids: vec![HashMap::default(); levels] }
    }

    fn size(&self, level: usize) -> f32 {
        self.finest * (1u32 << level) as f32
    }

    fn add(&mut self, root: Vec3) {
        for level in 0..self.grids.len() {
            let cell = (root / self.size(level)).floor().as_ivec3();
            self.grids[level].entry(cell).or_default().push(root);
        }
    }

    /// Returns whether a root lies nearer than `radius`.
    fn near(&self, root: Vec3, radius: f32) -> bool {
        let level = (0..self.grids.len()).find(|l| self.size(*l) >= radius).unwrap_or(self.grids.len() - 1);
        let size = self.size(level);
        let radius = radius.min(size);
        let (lo, hi) = ((root - radius) / size, (root + radius) / size);
        let (lo, hi) = (lo.floor().as_ivec3(), hi.floor().as_ivec3());
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                for x in lo.x..=hi.x {
                    let cell_roots = self.grids[level].get(&IVec3::new(x, y, z));
                    if cell_roots.into_iter().flatten().any(|q| q.distance_squared(root) < radius * radius) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// Fast hasher for grid cells, without protection against crafted keys.
#[derive(Clone, Copy, Default)]
struct Hasher;

impl std::hash::BuildHasher for Hasher {
    type Hasher = Mix;
    fn build_hasher(&self) -> Mix {
        Mix(0)
    }
}

struct Mix(u64);

impl std::hash::Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 29
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|b| self.write_i32(i32::from(*b)));
    }
    fn write_i32(&mut self, value: i32) {
        self.0 = (self.0.rotate_left(23) ^ value as u32 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}
