//! Strokes on roots: planting, removing, refining, parting.

use super::{
    Brush, BrushTool, GroomDocument,
    ground::Ground,
    hair::EditedHair,
    roots::{PartingPoint, RootChanges, across},
    solve::unit,
    tools::Dab,
};
use crate::{
    hash::{self, pcg},
    near::PointTree,
};
use glam::Vec3;

/// Candidates per dab, relative to the places that the brush has for guides; and the most.
const TRIES: f32 = 3.0;
const MAX_TRIES: usize = 400;
/// Slope of new hair at its root: sine and cosine of the angle to the skin.
const SLOPE: (f32, f32) = (0.57, 0.82);
/// Length over which hanging hair bends down, meters.
const DROOP: f32 = 0.05;
/// Distance from the skin to which new hair rises within the length `RISE`, meters: of the lowest and the highest
/// layer.
const LAYERS: (f32, f32) = (1.5e-3, 7e-3);
const RISE: f32 = 0.03;
/// Cosine of the largest angle between the brush's direction and the skin's normal.
const FACING: f32 = 0.1;
/// Distance of guides whose shapes new hair takes on, in distances between guides.
const NEIGHBOR_DISTANCE: f32 = 3.0;

/// Changes of roots in a stroke.
#[derive(Debug)]
pub(super) struct RootStroke {
    changes: RootChanges,
    /// Each strand at the press; empty unless the tool needs them.
    lines: Vec<Vec<Vec3>>,
}

impl RootStroke {
    pub fn new(brush: &Brush, hair: &EditedHair) -> Self {
        let (spacing, rebind_distance, group) = (brush.spacing, brush.radius, brush.layer);
        let density = if brush.tool == BrushTool::Plant { brush.density * 1e4 } else { 0.0 };
        let changes = RootChanges { spacing, density, rebind_distance, group, ..RootChanges::default() };
        let needs_lines = matches!(brush.tool, BrushTool::Remove | BrushTool::Refine);
        let lines = if needs_lines { hair.map_strands(<[Vec3]>::to_vec) } else { Vec::new() };
        Self { changes, lines }
    }

    /// Returns the new guides, and the roots of strands that go.
    pub fn marks(&self) -> (&[Vec<Vec3>], Vec<Vec3>) {
        (&self.changes.planted, self.changes.removed.iter().map(|i| self.lines[*i][0]).collect())
    }

    /// Applies a tool for roots once.
    pub fn dab(&mut self, hair: &EditedHair, brush: &Brush, seed: u32, dabs: &[Dab]) {
        match brush.tool {
            BrushTool::Plant => self.plant(hair, brush, seed, dabs),
            BrushTool::Refine => self.refine(hair, brush, dabs),
            BrushTool::Remove => {
                let bindings = &hair.base.strands.bindings;
                let goes = |(i, line): &(usize, &Vec<Vec3>)| {
                    hair.is_open(brush, bindings[*i].guides[0] as usize)
                        && brush.takes(seed, *i as u32)
                        && dabs.iter().any(|dab| dab.near(line[0], brush) > 0.0)
                };
                self.changes.removed.extend(self.lines.iter().enumerate().filter(goes).map(|(i, _)| i));
            }
            BrushTool::Part => {
                for dab in dabs.iter().filter(|dab| dab.motion != Vec3::ZERO) {
                    let Some((at, normal)) = hair.ground.nearest(dab.center, dab.radius) else { continue };
                    let across = across(normal, dab.motion);
                    self.changes.parting.push(PartingPoint { at, across });
                }
            }
            _ => {}
        }
    }

    /// Returns the version with its changes, if there are any and hair is left.
    pub fn applied(&self, hair: &EditedHair) -> Option<GroomDocument> {
        if self.changes.is_empty() {
            return None;
        }
        // The guides of the editor are valid, so they can be filled.
        hair.document.with_roots(&self.changes, &hair.ground).ok().flatten()
    }

    /// Plants guides on the skin under `dabs`.
    fn plant(&mut self, hair: &EditedHair, brush: &Brush, seed: u32, dabs: &[Dab]) {
        let (ground, n) = (&hair.ground, hair.document.vertex_count());
        let ratio = brush.radius / brush.spacing;
        let tries = ((TRIES * ratio * ratio) as usize).clamp(1, MAX_TRIES);
        let centers: Vec<_> = dabs.iter().map(|dab| ground.nearest(dab.center, dab.radius)).collect();
        for k in 0..tries {
            let random = pcg(seed ^ pcg(hair.dab_count as u32) ^ pcg(k as u32));
            // The first candidate is in the middle: a click plants there.
            let disc_point = if k == 0 { [0.0; 2] } else { in_disc(random) };
            for (side, dab) in dabs.iter().enumerate() {
                let Some((center, normal)) = centers[side] else { continue };
                let right = unit(normal.cross(Vec3::Y), Vec3::X);
                let up = right.cross(normal);
                // A mirror image turns the other way round.
                let (u, v) = (disc_point[0] * dab.radius, disc_point[1] * dab.radius);
                let u = if side == 1 { -u } else { u };
                let Some((root, normal)) = ground.nearest(center + right * u + up * v, dab.radius) else {
                    continue;
                };
                let faces = dab.view_direction == Vec3::ZERO || normal.dot(dab.view_direction) < -FACING;
                let planted = self.changes.planted.iter().map(Vec::as_slice);
                let lines = || hair.guides.lines().chain(planted.clone());
                let near = |line: &[Vec3]| line[0].distance_squared(root) < brush.spacing * brush.spacing;
                if !faces || dab.near(root, brush) <= 0.0 || lines().any(near) {
                    continue;
                }
                let layer = hash::unit(pcg(random ^ 0x51ed));
                let fallen = fallen(ground, root, normal, hair.document.mirror_x(), brush, layer, n);
                let line = match brush.neighbors > 0.0 {
                    true => like_neighbors(fallen, lines(), brush),
                    false => fallen,
                };
                self.changes.planted.push(line);
            }
        }
    }

    /// Makes guides of strands under `dabs`, where guides are farther apart than the brush asks.
    fn refine(&mut self, hair: &EditedHair, brush: &Brush, dabs: &[Dab]) {
        let guides = hair.guides.roots();
        let (tree, mut found) = (PointTree::new(&guides), Vec::new());
        for line in &self.lines {
            let root = line[0];
            if !dabs.iter().any(|dab| dab.near(root, brush) > 0.0) {
                continue;
            }
            tree.nearest(root, 1, brush.spacing, &mut found);
            let near = |line: &Vec<Vec3>| line[0].distance_squared(root) < brush.spacing * brush.spacing;
            if found.is_empty() && !self.changes.planted.iter().any(near) {
                let n = hair.document.vertex_count();
                self.changes.planted.push(crate::curve::resample_chords(line, n));
            }
        }
    }
}

/// Returns `line` with edges that are a mean of its edges and of the edges of guides beside it.
fn like_neighbors<'a>(line: Vec<Vec3>, others: impl Iterator<Item = &'a [Vec3]>, brush: &Brush) -> Vec<Vec3> {
    let radius = NEIGHBOR_DISTANCE * brush.spacing;
    let mut sums = vec![Vec3::ZERO; line.len() - 1];
    for other in others.filter(|other| other[0].distance(line[0]) < radius) {
        let weight = 1.0 - other[0].distance(line[0]) / radius;
        for (sum, edge) in sums.iter_mut().zip(other.windows(2)) {
            *sum += unit(edge[1] - edge[0], Vec3::ZERO) * weight;
        }
    }
    let mut mixed = vec![line[0]];
    for (k, (edge, sum)) in line.windows(2).zip(sums).enumerate() {
        let edge = edge[1] - edge[0];
        let (length, own) = (edge.length(), unit(edge, Vec3::Y));
        let direction = unit(own * (1.0 - brush.neighbors) + unit(sum, own) * brush.neighbors, own);
        mixed.push(mixed[k] + direction * length);
    }
    mixed
}

/// Returns a point in the unit disc.
fn in_disc(seed: u32) -> [f32; 2] {
    let mut bits = seed;
    loop {
        let [u, v] = [0, 1].map(|_| {
            bits = pcg(bits);
            2.0 * hash::unit(bits) - 1.0
        });
        if u * u + v * v <= 1.0 {
            return [u, v];
        }
    }
}

/// Returns hair of `n` vertices that leaves the skin at `root`, falls, and lies on the head. `layer`, 0 to 1, is its
/// place among hair that lies over other hair.
fn fallen(
    ground: &Ground,
    root: Vec3,
    normal: Vec3,
    mirror_x: f32,
    brush: &Brush,
    layer: f32,
    n: usize,
) -> Vec<Vec3> {
    let flat = |v: Vec3| v - normal * v.dot(normal);
    // On top of the head, down is nowhere along the skin: hair falls to the sides there.
    let side = Vec3::new(root.x - mirror_x, 0.0, 0.0);
    let flow = unit(flat(Vec3::NEG_Y + unit(side, Vec3::ZERO) * 0.3), unit(flat(Vec3::Z), Vec3::X));
    let mut direction = unit(normal * SLOPE.0 + flow * SLOPE.1, normal);
    let step = brush.length / (n - 1) as f32;
    let mut line = vec![root];
    for k in 1..n {
        let along = step * k as f32;
        let blend = (step / DROOP).min(1.0);
        direction = unit(direction * (1.0 - blend) + Vec3::NEG_Y * blend, direction);
        let start = line[k - 1];
        let mut p = start + direction * step;
        if let Some(field) = ground.field.as_deref() {
            let wish = (LAYERS.0 + (LAYERS.1 - LAYERS.0) * layer) * (along / RISE).min(1.0);
            for _ in 0..3 {
                let depth = wish - field.sample(p);
                if depth <= 0.0 {
                    break;
                }
                direction = unit(p + field.normal(p) * depth - start, direction);
                p = start + direction * step;
            }
        }
        line.push(p);
    }
    line
}
