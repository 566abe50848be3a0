//! Strokes on roots: planting, removing, refining, parting.

use super::{
    Brush, BrushTool, GroomDocument, GroomEditor, StrokeSample,
    editor::{ActiveStroke, sphere},
    ground::Ground,
    roots::{PartingPoint, RootChanges, RootStroke, across},
    solve::unit,
    tools::Dab,
};
use crate::{
    hash::{self, pcg},
    near::PointTree,
    progress::in_parallel,
};
use glam::Vec3;

/// Candidates per dab, relative to the places that the brush has for guides; and the most.
const TRIES: f32 = 3.0;
const MOST_TRIES: usize = 400;
/// Slope of new hair at its root: sine and cosine of the angle to the skin.
const SLOPE: (f32, f32) = (0.57, 0.82);
/// Length over which hanging hair bends down, meters.
const DROOP: f32 = 0.05;
/// Distance from the skin to which new hair rises within the length `RISE`, meters: of the lowest and the highest layer.
const LAYERS: (f32, f32) = (1.5e-3, 7e-3);
const RISE: f32 = 0.03;
/// Cosine of the largest angle between the brush's direction and the skin's normal.
const FACING: f32 = 0.1;
/// Distance of guides whose shapes new hair takes on, in distances between guides.
const BESIDE: f32 = 3.0;

impl GroomEditor {
    /// Returns the empty changes of a stroke with `brush`.
    pub(super) fn root_stroke(&self, brush: &Brush) -> RootStroke {
        let (spacing, reach) = (brush.spacing, brush.radius);
        let density = if brush.tool == BrushTool::Plant { brush.density * 1e4 } else { 0.0 };
        let group = brush.layer;
        let changes = RootChanges { spacing, density, reach, group, ..RootChanges::default() };
        let needs_roots = matches!(brush.tool, BrushTool::Remove | BrushTool::Refine);
        let roots = if needs_roots { self.strand_lines(|line| line[0]) } else { Vec::new() };
        let lines = match brush.tool.paints_strands() {
            true => self.strand_lines(|line| (sphere(line), line.to_vec())),
            false => Vec::new(),
        };
        RootStroke { changes, roots, lines }
    }

    /// Returns what `of` finds of each strand.
    fn strand_lines<T: Send>(&self, of: impl Fn(&[Vec3]) -> T + Sync) -> Vec<T> {
        let strands = self.document.unshaped();
        let all: Vec<usize> = (0..strands.base().strands.len()).collect();
        in_parallel(&all, |i| of(&strands.strand(*i).0))
    }

    /// Returns the new guides of the current stroke, and the roots of strands that it removes.
    pub fn root_marks(&self) -> (&[Vec<Vec3>], Vec<Vec3>) {
        let Some(stroke) = &self.stroke else { return (&[], Vec::new()) };
        let RootStroke { changes, roots, .. } = &stroke.roots;
        (&changes.planted, changes.removed.iter().filter_map(|i| roots.get(*i)).copied().collect())
    }

    /// Returns the depth of the skin under `sample`, meters.
    pub(super) fn skin_depth(&self, sample: &StrokeSample) -> Option<f32> {
        self.ground.trace(sample.origin, sample.direction)
    }

    /// Applies a tool for roots once.
    pub(super) fn dab_roots(&mut self, dabs: &[Dab]) {
        self.dab_count += 1;
        let Some(mut stroke) = self.stroke.take() else { return };
        match stroke.brush.tool {
            BrushTool::Plant => self.plant(&mut stroke, dabs),
            BrushTool::Refine => self.refine(&mut stroke, dabs),
            BrushTool::Remove => {
                let (brush, bindings) = (&stroke.brush, &self.base.strands.bindings);
                let goes = |(i, root): &(usize, &Vec3)| {
                    self.is_open(brush, bindings[*i].guides[0] as usize)
                        && stroke.takes(*i as u32)
                        && dabs.iter().any(|dab| dab.near(**root, brush) > 0.0)
                };
                let removed: Vec<usize> =
                    stroke.roots.roots.iter().enumerate().filter(goes).map(|(i, _)| i).collect();
                stroke.roots.changes.removed.extend(removed);
            }
            BrushTool::Part => {
                for dab in dabs.iter().filter(|dab| dab.motion != Vec3::ZERO) {
                    let Some((at, normal)) = self.ground.nearest(dab.center, dab.radius) else { continue };
                    let across = across(normal, dab.motion);
                    stroke.roots.changes.parting.push(PartingPoint { at, across });
                }
            }
            tool if tool.paints() => self.paint(&mut stroke, dabs),
            _ => {}
        }
        self.stroke = Some(stroke);
    }

    /// Ends a stroke on roots. Returns the version with its changes, if there are any and hair is left.
    pub(super) fn with_root_changes(&self, stroke: &ActiveStroke) -> Option<GroomDocument> {
        let changes = &stroke.roots.changes;
        if changes.is_empty() {
            return None;
        }
        // The guides of the editor are valid, so they can be filled.
        self.document.with_roots(changes, &self.ground).ok().flatten()
    }

    /// Plants guides on the skin under `dabs`.
    fn plant(&self, stroke: &mut ActiveStroke, dabs: &[Dab]) {
        let (brush, n) = (stroke.brush, self.document.vertex_count());
        let ratio = stroke.radius / brush.spacing;
        let tries = ((TRIES * ratio * ratio) as usize).clamp(1, MOST_TRIES);
        let middles: Vec<_> = dabs.iter().map(|dab| self.ground.nearest(dab.center, dab.radius)).collect();
        for k in 0..tries {
            let random = pcg(stroke.seed ^ pcg(self.dab_count as u32) ^ pcg(k as u32));
            // The first candidate is in the middle: a click plants there.
            let place = if k == 0 { [0.0; 2] } else { in_disc(random) };
            for (side, dab) in dabs.iter().enumerate() {
                let Some((middle, normal)) = middles[side] else { continue };
                let right = unit(normal.cross(Vec3::Y), Vec3::X);
                let up = right.cross(normal);
                // A mirror image turns the other way round.
                let (u, v) = (place[0] * dab.radius, place[1] * dab.radius);
                let u = if side == 1 { -u } else { u };
                let Some((root, normal)) = self.ground.nearest(middle + right * u + up * v, dab.radius)
                else {
                    continue;
                };
                let faces = dab.sight == Vec3::ZERO || normal.dot(dab.sight) < -FACING;
                let planted = &stroke.roots.changes.planted;
                let lines =
                    || (0..self.spheres.len()).map(|i| self.guide(i)).chain(planted.iter().map(|p| &p[..]));
                let near = |line: &[Vec3]| line[0].distance_squared(root) < brush.spacing * brush.spacing;
                if !faces || dab.near(root, &brush) <= 0.0 || lines().any(near) {
                    continue;
                }
                let layer = hash::unit(pcg(random ^ 0x51ed));
                let fallen = fallen(&self.ground, root, normal, self.document.middle(), &brush, layer, n);
                let line = match brush.neighbors > 0.0 {
                    true => self.like_neighbors(fallen, lines(), &brush),
                    false => fallen,
                };
                stroke.roots.changes.planted.push(line);
            }
        }
    }

    /// Returns `line` with edges that are a mean of its edges and of the edges of guides beside it.
    fn like_neighbors<'a>(
        &self,
        line: Vec<Vec3>,
        others: impl Iterator<Item = &'a [Vec3]>,
        brush: &Brush,
    ) -> Vec<Vec3> {
        let reach = BESIDE * brush.spacing;
        let mut sums = vec![Vec3::ZERO; line.len() - 1];
        for other in others.filter(|other| other[0].distance(line[0]) < reach) {
            let weight = 1.0 - other[0].distance(line[0]) / reach;
            for (sum, edge) in sums.iter_mut().zip(other.windows(2)) {
                *sum += unit(edge[1] - edge[0], Vec3::ZERO) * weight;
            }
        }
        let mut mixed = vec![line[0]];
        for (k, (edge, sum)) in line.windows(2).zip(sums).enumerate() {
            let edge = edge[1] - edge[0];
            let (length, own) = (edge.length(), unit(edge, Vec3::Y));
            let way = unit(own * (1.0 - brush.neighbors) + unit(sum, own) * brush.neighbors, own);
            mixed.push(mixed[k] + way * length);
        }
        mixed
    }

    /// Makes guides of strands under `dabs`, where guides are farther apart than the brush asks.
    fn refine(&self, stroke: &mut ActiveStroke, dabs: &[Dab]) {
        let (brush, n) = (stroke.brush, self.document.vertex_count());
        let Some((strands, _)) = &stroke.strands else { return };
        let guides: Vec<Vec3> = (0..self.spheres.len()).map(|i| self.guide(i)[0]).collect();
        let (tree, mut found) = (PointTree::new(&guides), Vec::new());
        let RootStroke { changes, roots, .. } = &mut stroke.roots;
        for (i, root) in roots.iter().enumerate() {
            if !dabs.iter().any(|dab| dab.near(*root, &brush) > 0.0) {
                continue;
            }
            tree.nearest(*root, 1, brush.spacing, &mut found);
            let near = |line: &Vec<Vec3>| line[0].distance_squared(*root) < brush.spacing * brush.spacing;
            if found.is_empty() && !changes.planted.iter().any(near) {
                changes.planted.push(crate::curve::resample_chords(&strands.strand(i).0, n));
            }
        }
    }
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

/// Returns hair of `n` vertices that leaves the skin at `root`, falls, and lies on the head. `layer`, 0 to 1, is its place
/// among hair that lies over other hair.
fn fallen(
    ground: &Ground,
    root: Vec3,
    normal: Vec3,
    middle: f32,
    brush: &Brush,
    layer: f32,
    n: usize,
) -> Vec<Vec3> {
    let flat = |v: Vec3| v - normal * v.dot(normal);
    // On top of the head, down is nowhere along the skin: hair falls to the sides there.
    let side = Vec3::new(root.x - middle, 0.0, 0.0);
    let flow = unit(flat(Vec3::NEG_Y + unit(side, Vec3::ZERO) * 0.3), unit(flat(Vec3::Z), Vec3::X));
    let mut way = unit(normal * SLOPE.0 + flow * SLOPE.1, normal);
    let step = brush.length / (n - 1) as f32;
    let mut line = vec![root];
    for k in 1..n {
        let along = step * k as f32;
        let turn = (step / DROOP).min(1.0);
        way = unit(way * (1.0 - turn) + Vec3::NEG_Y * turn, way);
        let start = line[k - 1];
        let mut p = start + way * step;
        if let Some(field) = ground.field.as_deref() {
            let wish = (LAYERS.0 + (LAYERS.1 - LAYERS.0) * layer) * (along / RISE).min(1.0);
            for _ in 0..3 {
                let depth = wish - field.sample(p);
                if depth <= 0.0 {
                    break;
                }
                way = unit(p + field.normal(p) * depth - start, way);
                p = start + way * step;
            }
        }
        line.push(p);
    }
    line
}
