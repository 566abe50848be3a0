//! Order in which cards are blended: found for all directions together, since a file has one order.

use super::{
    mesh::CardMesh,
    picture::{Layer, Pyramid, Studio},
};
use std::collections::HashMap;

/// Most rounds of moves.
const ROUNDS: u32 = 12;

/// How well an order of cards serves 14 pictures from all sides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Blending {
    /// Mean difference of the brightness between cards in their order and cards sorted by depth, as a fraction of
    /// white.
    pub(super) error: f32,
    /// Mean number of triangles over each pixel that has any.
    pub(super) overdraw: f32,
}

/// How much pictures change where a card is drawn before another one that it hides, by the two cards.
type Conflicts = HashMap<(u32, u32), f32>;

/// Returns an order of the cards of `mesh`, as indices, in which few cards are drawn before others behind them.
pub(super) fn ordered(studio: &Studio, mesh: &CardMesh, alpha: &Pyramid, tones: &[f32]) -> Vec<u32> {
    let mut conflicts = Conflicts::new();
    for found in studio.layered(mesh, alpha, tones, add_conflicts) {
        for (cards, weight) in found {
            *conflicts.entry(cards).or_default() += weight;
        }
    }
    let count = mesh.starts.len();
    // For each card, the others that it meets: the cost of being drawn before them and after them.
    let mut overlaps = vec![Vec::new(); count];
    for (&(front, back), &weight) in &conflicts {
        overlaps[front as usize].push((back, weight, 0.0));
        overlaps[back as usize].push((front, 0.0, weight));
    }
    let mut order: Vec<u32> = (0..count as u32).collect();
    let mut ranks: Vec<usize> = (0..count).collect();
    for _ in 0..ROUNDS {
        let mut changed = false;
        for card in 0..count {
            let card_overlaps = &mut overlaps[card];
            card_overlaps
                .sort_unstable_by_key(|(other, before, _)| (ranks[*other as usize], before.to_bits()));
            // The cost relative to that before all others, after each of them.
            let (mut cost, mut best, mut now) = (0.0f32, (0.0f32, None), 0.0);
            for (other, before, after) in card_overlaps.iter() {
                let at = ranks[*other as usize];
                cost += after - before;
                if at < ranks[card] {
                    now = cost;
                }
                if cost < best.0 {
                    best = (cost, Some(at));
                }
            }
            if best.0 < now - 1e-3 * now.abs() - 1e-6 {
                let from = ranks[card];
                order.remove(from);
                let to = match best.1 {
                    None => 0,
                    Some(at) if at > from => at,
                    Some(at) => at + 1,
                };
                order.insert(to, card as u32);
                let (low, high) = (from.min(to), from.max(to));
                (low..=high).for_each(|k| ranks[order[k] as usize] = k);
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    order
}

/// Adds how much a sample changes if two of its layers, which are sorted from the front, are drawn in the wrong order.
fn add_conflicts(conflicts: &mut Conflicts, layers: &[Layer]) {
    let mut transmittance = 1.0;
    for (i, front) in layers.iter().enumerate() {
        let mut passes = transmittance;
        for back in &layers[i + 1..] {
            let weight = passes * front.alpha * back.alpha * (0.02 + (front.tone - back.tone).abs());
            if weight > 1e-3 && front.card != back.card {
                *conflicts.entry((front.card, back.card)).or_default() += weight;
            }
            passes *= 1.0 - back.alpha;
        }
        transmittance *= 1.0 - front.alpha;
    }
}

/// Sums over the samples of a picture.
#[derive(Default)]
struct Sums {
    samples: u32,
    layers: usize,
    error: f32,
}

impl Blending {
    /// Measures the cards of `mesh` in the order that they have.
    pub(super) fn new(studio: &Studio, mesh: &CardMesh, alpha: &Pyramid, tones: &[f32]) -> Self {
        let mut all = Sums::default();
        for sums in studio.layered(mesh, alpha, tones, add_errors) {
            all.samples += sums.samples;
            all.layers += sums.layers;
            all.error += sums.error;
        }
        let samples = all.samples.max(1) as f32;
        Self { error: all.error / samples, overdraw: all.layers as f32 / samples }
    }
}

fn add_errors(sums: &mut Sums, layers: &[Layer]) {
    let over = |below: f32, layer: &Layer| below + layer.alpha * (layer.tone - below);
    let sorted = layers.iter().rev().fold(0.0, over);
    let mut drawn = layers.to_vec();
    drawn.sort_by_key(|layer| layer.triangle);
    sums.samples += 1;
    sums.layers += layers.len();
    sums.error += (drawn.iter().fold(0.0, over) - sorted).abs();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cards::CardMesh;
    use glam::{Vec2, Vec3};

    /// Parallel squares, one after the other away from the eye, with a mirror image behind them.
    fn squares(distances: &[f32]) -> CardMesh {
        let mut mesh = CardMesh::default();
        for z in distances {
            let first = mesh.positions.len() as u32;
            mesh.starts.push(first);
            for [x, y] in [[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
                let p = 0.05 * Vec3::new(x, y, 0.0) + *z * Vec3::Z;
                mesh.positions.push(p);
                mesh.normals.push(Vec3::Z);
                mesh.tangents.push(Vec3::X);
                mesh.uvs.push(0.5 * Vec2::new(x, -y) + 0.5);
                mesh.light.push(z.abs() * 10.0);
                mesh.roots.push(p);
                mesh.along.push(0.0);
            }
            mesh.triangles.extend([[0, 2, 1], [1, 2, 3]].map(|t: [u32; 3]| t.map(|v| v + first)));
        }
        mesh
    }

    #[test]
    fn squares_around_a_head_are_drawn_from_the_inside() {
        // The head is an opaque plate between the squares on both sides.
        let mut head = crate::TriMesh::default();
        for [x, y] in [[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
            head.positions.push(Vec3::new(x, y, 0.0));
        }
        head.triangles = vec![[0, 2, 1], [1, 2, 3]];
        let bounds = (Vec3::splat(-0.1), Vec3::splat(0.1));
        let studio = Studio::new(bounds, [32, 1], Some(&head));
        let (alpha, tones) = (Pyramid::new(4, vec![0.5; 16]), vec![1.0; 16]);
        let mesh = squares(&[0.09, -0.06, 0.03, -0.09, 0.06, -0.03]);
        let before = Blending::new(&studio, &mesh, &alpha, &tones);
        let sorted = mesh.reordered(&ordered(&studio, &mesh, &alpha, &tones));
        let after = Blending::new(&studio, &sorted, &alpha, &tones);
        assert!(before.error > 0.02 && after.error < 1e-6, "{before:?} {after:?}");
        assert_eq!(before.overdraw, after.overdraw);
        let depths: Vec<f32> = sorted.starts.iter().map(|v| sorted.positions[*v as usize].z).collect();
        for side in [1.0, -1.0] {
            let along: Vec<f32> = depths.iter().copied().filter(|z| z * side > 0.0).map(f32::abs).collect();
            assert_eq!(along, [0.03, 0.06, 0.09], "{depths:?}");
        }
    }
}
