//! Chains of bones that carry cards: for spring bones of engines, and for motion that was simulated.
//!
//! A chain follows one strand in the middle of its hair. A card follows the two chains nearest to it, all its vertices
//! with the same weights, so that it does not tear; along a card, the bones take over from each other by the distance
//! from the root.

use super::{
    cluster::cluster,
    lines::{Lines, PATH_POINTS},
    mesh::CardMesh,
};
use crate::{
    Strands,
    fill::curves::{Curves, Smoothing},
    progress::in_parallel,
};
use glam::Vec3;

/// Bones of a chain.
pub const BONES: usize = 4;
/// Share of the strands of a cluster that are shorter than those a chain may follow.
const SHORTER: f32 = 0.6;
/// Distance to a chain that counts as none, meters.
const NEAR: f32 = 0.003;
// Bones end at knots.
const _: () = assert!((PATH_POINTS - 1).is_multiple_of(BONES));

/// Chains of [`BONES`] bones each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardChains {
    /// Strand that each chain follows, as an index of the input.
    pub strands: Vec<u32>,
    /// Ends of the bones at rest, meters: [`BONES`] + 1 for each chain, from the root.
    pub joints: Vec<Vec3>,
}

/// The bones that a vertex follows: `chain * BONES + bone`, and their weights, the largest first. The sum is 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CardBind {
    /// Indices of the bones. Those with weight 0 are unused.
    pub bones: [u16; 4],
    /// Weights, none negative.
    pub weights: [f32; 4],
}

impl CardChains {
    /// Forms at most `count` chains. `kept` has the strands' indices in the input.
    pub(super) fn new(lines: &Lines<'_>, kept: &[u32], count: usize, seed: u32) -> Self {
        if count == 0 {
            return Self::default();
        }
        let points = lines.points();
        let of = cluster(&points, &lines.weights, count, seed);
        let groups = of.iter().max().map_or(0, |last| *last as usize + 1);
        let mut members = vec![Vec::new(); groups];
        of.iter().zip(0u32..).for_each(|(of, strand)| members[*of as usize].push(strand));
        let mut chains = Self::default();
        for members in members.iter_mut().filter(|members| !members.is_empty()) {
            members.sort_by(|a, b| lines.length(*a).total_cmp(&lines.length(*b)));
            let total: f32 = members.iter().map(|i| lines.weights[*i as usize]).sum();
            let mut mean = [0.0; 16];
            for i in members.iter() {
                let weight = lines.weights[*i as usize] / total.max(1e-12);
                mean.iter_mut().zip(points[*i as usize]).for_each(|(sum, x)| *sum += weight * x);
            }
            let far =
                |i: u32| -> f32 { points[i as usize].iter().zip(&mean).map(|(a, b)| (a - b).powi(2)).sum() };
            let long = &members[((members.len() as f32 * SHORTER) as usize).min(members.len() - 1)..];
            let strand =
                long.iter().copied().min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(members[0]);
            chains.strands.push(kept[strand as usize]);
            chains.joints.extend(lines.path_points(strand).iter().step_by(PATH_POINTS / BONES));
        }
        chains
    }

    /// Returns the ends of the bones, as in [`joints`](Self::joints), where `strands`, the moved input, are now.
    ///
    /// # Panics
    /// If `strands` has fewer strands than the input.
    #[must_use]
    pub fn followed(&self, strands: &Strands) -> Vec<Vec3> {
        let mut own = Strands::default();
        self.strands.iter().for_each(|i| own.push(strands.strand(*i as usize)));
        let curves = Curves::new(&own, None, Smoothing::WEAK);
        (0..self.len() as u32)
            .flat_map(|i| curves.path_points(i).iter().copied().step_by(PATH_POINTS / BONES))
            .collect()
    }

    /// Number of chains.
    pub fn len(&self) -> usize {
        self.strands.len()
    }

    /// Whether there are no chains, so that cards follow the body alone.
    pub fn is_empty(&self) -> bool {
        self.strands.is_empty()
    }

    /// Returns the ends of the bones of a chain at rest.
    pub fn chain(&self, chain: usize) -> &[Vec3] {
        &self.joints[chain * (BONES + 1)..(chain + 1) * (BONES + 1)]
    }

    fn length(&self, chain: usize) -> f32 {
        self.chain(chain).windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f32>().max(1e-6)
    }

    /// Returns what each vertex of `mesh` follows; nothing without chains.
    pub(super) fn binds(&self, mesh: &CardMesh) -> Vec<CardBind> {
        if self.is_empty() {
            return Vec::new();
        }
        let count = mesh.positions.len();
        let lengths: Vec<f32> = (0..self.len()).map(|chain| self.length(chain)).collect();
        // The vertices of a helmet follow chains of their own.
        let ranges: Vec<_> = match mesh.starts.is_empty() {
            true => (0..count).map(|v| v..v + 1).collect(),
            false => (0..mesh.starts.len()).map(|card| mesh.range(card)).collect(),
        };
        let found = in_parallel(&ranges, |range| {
            let far = |chain: usize| {
                let ends = self.chain(chain);
                let sum: f32 = range
                    .clone()
                    .map(|v| {
                        let at = (mesh.along[v] / lengths[chain]).clamp(0.0, 1.0) * BONES as f32;
                        let bone = (at as usize).min(BONES - 1);
                        mesh.positions[v].distance(ends[bone].lerp(ends[bone + 1], at - bone as f32))
                    })
                    .sum();
                sum / range.len().max(1) as f32
            };
            let mut nearest: Vec<(f32, usize)> = (0..self.len()).map(|chain| (far(chain), chain)).collect();
            nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
            nearest.truncate(2);
            let weigh = |far: f32| 1.0 / (far * far + NEAR * NEAR);
            let total: f32 = nearest.iter().map(|(far, _)| weigh(*far)).sum();
            let bind = |v: usize| {
                let chains = nearest.iter().map(|(far, chain)| (*chain, weigh(*far) / total));
                bind(chains, |chain| mesh.along[v] / lengths[chain])
            };
            range.clone().map(bind).collect::<Vec<_>>()
        });
        found.into_iter().flatten().collect()
    }
}

/// Returns the bones at the fraction `at` of chains that have weights.
fn bind(chains: impl Iterator<Item = (usize, f32)>, at: impl Fn(usize) -> f32) -> CardBind {
    let mut all = Vec::new();
    for (chain, weight) in chains {
        // From the middle of a bone to the middle of the next one.
        let coordinate = (at(chain) * BONES as f32 - 0.5).clamp(0.0, BONES as f32 - 1.0);
        let bone = (coordinate as usize).min(BONES - 2);
        let fraction = coordinate - bone as f32;
        all.push((chain * BONES + bone, weight * (1.0 - fraction)));
        all.push((chain * BONES + bone + 1, weight * fraction));
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut bind = CardBind::default();
    for (i, (bone, weight)) in all.into_iter().enumerate().filter(|(_, (_, weight))| *weight > 0.0) {
        (bind.bones[i], bind.weights[i]) = (bone as u16, weight);
    }
    bind
}
