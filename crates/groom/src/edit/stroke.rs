//! A stroke: moves the brush from dab to dab, and collects what these change.

use super::{
    Brush, BrushTool, StrokeSample,
    cuts::LengthChanges,
    deform::DeformedStrands,
    hair::EditedHair,
    line::{CutPath, SKIN},
    paint::PaintStroke,
    plant::RootStroke,
    scissors, slide,
    solve::{BEND, PressState, Solver, fabrik_targets, unit},
    tools::{Dab, Surroundings, Weights},
};
use crate::hash::pcg;
use glam::Vec3;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

/// Distance between dabs, radii.
const STEP: f32 = 0.25;
/// Time between dabs of a brush that stands still, s.
const BEAT: f32 = 0.05;
/// Largest radius to which a brush grows where guides are sparse, meters.
const WIDEST: f32 = 0.06;
/// Distance of the nearest guide, relative to the distance at which one is picked, from which a brush is beside the
/// hair.
const SPARSE: f32 = 2.0;
/// Limits of the growth in one stroke.
const GROWTH: std::ops::RangeInclusive<f32> = 0.1..=5.0;
/// Largest number of dabs between two samples.
const MAX_DABS: u32 = 4000;
/// Largest number of corners of an outline.
const MAX_CORNERS: usize = 96;

/// A stroke that has begun.
#[derive(Debug)]
pub(super) struct ActiveStroke {
    /// The brush; its radius is larger where guides are sparse.
    pub brush: Brush,
    pub seed: u32,
    /// Center of the brush at the press.
    begin: Vec3,
    /// The last sample, and the distance from it to the next dab.
    pub last: StrokeSample,
    left: f32,
    /// Depth of the brush from the eye, meters.
    depth: f32,
    /// Time since the last dab, s.
    held: f32,
    /// Samples from the press on; for tools that draw.
    pub outline: Vec<StrokeSample>,
    /// Guides that [`BrushTool::Grab`] holds, with the weights at the press.
    grabbed: BTreeMap<usize, Weights>,
    lengths: LengthChanges,
    pub roots: RootStroke,
    pub paint: Option<PaintStroke>,
    /// For [`BrushTool::Cut`]: the strands at the press.
    strands: Option<DeformedStrands>,
}

impl ActiveStroke {
    /// Begins a stroke; `None` if there is neither hair nor skin under the sample.
    pub fn begin(hair: &mut EditedHair, brush: &Brush, sample: &StrokeSample) -> Option<Self> {
        let (tool, pick) = (brush.tool, hair.guides.pick);
        let depth = match hair.depth(tool, sample, pick) {
            _ if sample.direction == Vec3::ZERO => 0.0,
            // A line may begin beside the hair.
            None if tool.draws() => 0.0,
            depth => depth?,
        };
        let begin = sample.at(depth);
        let nearest = hair.guides.positions.iter().map(|p| p.distance(begin)).fold(f32::MAX, f32::min);
        // A brush between sparse guides reaches the nearest; one beside the hair does not grow.
        let sparse = !tool.acts_on_roots() && nearest > brush.radius && nearest < SPARSE * pick;
        let radius = if sparse { (2.0 * nearest).min(WIDEST) } else { brush.radius };
        let words = begin.to_array().into_iter().chain(sample.direction.to_array());
        hair.pressed.fill(None);
        let mut stroke = Self {
            brush: Brush { radius, ..*brush },
            seed: words.fold(1, |seed, word| pcg(seed ^ word.to_bits())),
            begin,
            last: *sample,
            left: STEP * radius,
            depth,
            held: 0.0,
            outline: vec![*sample],
            grabbed: BTreeMap::new(),
            lengths: LengthChanges::default(),
            roots: RootStroke::new(brush, hair),
            paint: tool.paints().then(|| PaintStroke::new(brush, hair)),
            strands: (tool == BrushTool::Cut).then(|| hair.document.unshaped()),
        };
        if tool == BrushTool::Grab {
            let dabs = stroke.dabs(hair, begin, Vec3::ZERO);
            let weights = |i: usize| Some((i, Weights::of(hair.guides.guide(i), &dabs, brush)?));
            stroke.grabbed =
                hair.affected(brush, stroke.seed, &dabs).into_iter().filter_map(weights).collect();
        }
        if tool.acts_while_still() || tool.acts_on_roots() || tool.paints() {
            stroke.dab(hair, Vec3::ZERO);
        }
        Some(stroke)
    }

    /// Moves the brush to `sample`.
    pub fn drag(&mut self, hair: &mut EditedHair, sample: &StrokeSample) {
        self.hold(hair, sample.time - self.last.time);
        if self.brush.tool == BrushTool::Grab {
            self.last = *sample;
            return self.pull(hair);
        }
        if self.brush.tool.draws() {
            self.last = *sample;
            return self.draw(sample);
        }
        let (from, mut t) = (self.last, 0.0);
        for dab in 0.. {
            let start = from.lerp(sample, t);
            let offset = sample.at(self.depth) - start.at(self.depth);
            let length = offset.length();
            // A pointer that far away has jumped.
            if length < self.left || length <= 1e-7 || dab == MAX_DABS {
                self.left = (self.left - length).max(0.0);
                break;
            }
            t += (1.0 - t) * (self.left / length);
            self.last = from.lerp(sample, t);
            (self.left, self.held) = (STEP * self.brush.radius, 0.0);
            self.dab(hair, unit(offset, Vec3::ZERO) * self.left);
            self.follow(hair);
        }
        self.last = *sample;
    }

    /// Adds a corner to the outline.
    fn draw(&mut self, sample: &StrokeSample) {
        if self.outline.last().is_some_and(|last| last.differs_from(sample)) {
            self.outline.push(*sample);
            if self.outline.len() > MAX_CORNERS {
                self.outline = self.outline.iter().step_by(2).copied().collect();
            }
        }
    }

    /// Lets `seconds` pass at the last sample.
    fn hold(&mut self, hair: &mut EditedHair, seconds: f32) {
        if !self.brush.tool.acts_while_still() {
            return;
        }
        self.held += seconds.clamp(0.0, 1.0);
        while self.held >= BEAT {
            self.held -= BEAT;
            self.dab(hair, Vec3::ZERO);
        }
    }

    /// Lets the brush follow the hair and the head in depth.
    fn follow(&mut self, hair: &EditedHair) {
        if self.last.direction == Vec3::ZERO {
            return;
        }
        let tool = self.brush.tool;
        let fraction = if tool.acts_on_roots() { 1.0 } else { 0.5 };
        let max_offset = hair.guides.pick.max(0.5 * self.brush.radius);
        if let Some(depth) = hair.depth(tool, &self.last, max_offset) {
            self.depth += fraction * (depth - self.depth);
        }
    }

    /// Returns the middle of the brush, meters.
    pub fn center(&self) -> Vec3 {
        self.last.at(self.depth)
    }

    /// Returns the dab at `center`, and its mirror image if the brush is symmetric.
    fn dabs(&self, hair: &EditedHair, center: Vec3, motion: Vec3) -> Vec<Dab> {
        let (brush, view_direction) = (&self.brush, self.last.direction);
        let mut behind = f32::MAX;
        if let Some(field) = hair.field().filter(|_| view_direction != Vec3::ZERO) {
            let before = 3.0 * brush.radius;
            behind = field
                .trace(center - view_direction * before, view_direction, 0.0)
                .map_or(behind, |skin| skin - before + SKIN);
        }
        let strength = brush.strength * self.last.pressure.clamp(0.0, 1.0);
        let dab = Dab { center, motion, view_direction, behind, radius: brush.radius, strength };
        match brush.mirror {
            true => vec![dab, dab.mirrored(hair.document.mirror_x())],
            false => vec![dab],
        }
    }

    /// Applies the brush once.
    fn dab(&mut self, hair: &mut EditedHair, motion: Vec3) {
        let dabs = self.dabs(hair, self.center(), motion);
        let Self { brush, seed, .. } = *self;
        if brush.tool == BrushTool::Slide {
            return slide::slide(hair, &brush, seed, &dabs);
        }
        if let Some(strands) = &self.strands {
            hair.dab_count += 1;
            return self.lengths.shorten(scissors::by_brush(hair, strands, &brush, seed, &dabs));
        }
        if let Some(paint) = &mut self.paint {
            hair.dab_count += 1;
            return paint.dab(hair, &brush, seed, &dabs);
        }
        if brush.tool.acts_on_roots() {
            hair.dab_count += 1;
            self.roots.dab(hair, &brush, seed, &dabs);
            if brush.tool != BrushTool::Part {
                return;
            }
        }
        hair.dab(&hair.affected(&brush, seed, &dabs), |hair, i| {
            let guide = hair.guides.guide(i);
            self.shaped(hair, &dabs, i, guide, &Weights::of(guide, &dabs, &brush)?)
        });
    }

    /// Moves the hair that is held: always from the press, so that the way does not matter.
    fn pull(&self, hair: &mut EditedHair) {
        let dabs = self.dabs(hair, self.begin, self.center() - self.begin);
        let held: Vec<usize> = self.grabbed.keys().copied().collect();
        hair.dab(&held, |hair, i| self.shaped(hair, &dabs, i, hair.document.guide(i), &self.grabbed[&i]));
    }

    /// Returns the vertices to which the tool moves guide `i` from `guide`, and its state at the press; `None` if it
    /// stays.
    fn shaped(
        &self,
        hair: &EditedHair,
        dabs: &[Dab],
        i: usize,
        guide: &[Vec3],
        weights: &Weights,
    ) -> Option<(Vec<Vec3>, Arc<PressState>)> {
        let (brush, field, mut press) = (&self.brush, hair.field(), hair.pressed(i));
        let even = brush.acts() == BrushTool::Smooth && brush.neighbors > 0.0;
        let along = if even { hair.guides.mean_edges(i) } else { Vec::new() };
        let (normal, along) = (hair.guides.normals[i], &along[..]);
        let around = Surroundings { brush, dabs, press: &press, field, normal, along };
        let (mut target, mut first) = around.target(guide, weights)?;
        // Tools that turn edges have decided the shape.
        let mut near = vec![1.0; guide.len()];
        match brush.acts() {
            BrushTool::Comb => near.clone_from(&weights.near),
            BrushTool::Grab => {
                (target, near) =
                    fabrik_targets(guide, target, (&weights.weight, &weights.near), &press.lengths);
                first = 1;
            }
            BrushTool::Length => {
                press = Arc::new(press.scaled(around.growth(weights)));
                if !GROWTH.contains(&press.growth) {
                    return None;
                }
            }
            _ => {}
        }
        let Brush { keep_shape, keep_volume, .. } = *brush;
        let solver = Solver { field, keep_shape, keep_volume, bend: Some(BEND) };
        Some((solver.solve(guide, &target, &near, first, &press), press))
    }

    /// Returns the path along which the stroke cuts.
    fn path(&self) -> Option<CutPath> {
        match self.brush.tool {
            BrushTool::Line => Some(CutPath::line(&self.outline[0], &self.last)),
            BrushTool::Lasso => CutPath::outline(&self.outline),
            _ => None,
        }
    }

    /// Ends the stroke. `hair` shows the new version. Returns whether there is one.
    pub fn release(mut self, hair: &mut EditedHair) -> bool {
        if let Some(path) = self.path() {
            hair.dab_count += 1;
            self.lengths.shorten(scissors::along_path(hair, path, &self.brush, self.seed));
        }
        let touched = hair.touched();
        let growth = touched.iter().map(|i| (*i, hair.pressed(*i).growth));
        self.lengths.guides.extend(growth.filter(|(_, growth)| *growth != 1.0));
        let paint = || self.paint.as_ref().and_then(|paint| paint.applied(&hair.document));
        let replanted = self.roots.applied(hair).or_else(paint);
        let changed_guides = touched.iter().map(|i| (*i, hair.guides.guide(*i)));
        let changed_guides: Vec<_> =
            changed_guides.filter(|(i, guide)| *guide != hair.document.guide(*i)).collect();
        let document = if let Some(document) = replanted {
            // Guides that a parting has moved are the same guides.
            document.with(changed_guides)
        } else if !(self.lengths.strands.is_empty() && self.lengths.guides.is_empty()) {
            hair.document.with_lengths(&self.lengths).with(changed_guides)
        } else if changed_guides.is_empty() {
            return false;
        } else if self.brush.tool == BrushTool::Slide {
            let guides: BTreeSet<usize> = changed_guides.iter().map(|(i, _)| *i).collect();
            hair.document.with(changed_guides).rooted(&guides, &hair.ground)
        } else {
            hair.document = hair.document.with(changed_guides);
            return true;
        };
        hair.go_to(document);
        true
    }
}
