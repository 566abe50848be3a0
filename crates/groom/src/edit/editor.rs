//! The editor: applies strokes to a groom.

use super::{
    Brush, BrushTool, GroomDocument, Reach,
    carry::CarriedStrands,
    cuts::LengthChanges,
    solve::{PressState, Solver, unit},
    tools::{Dab, Surroundings, Weights},
};
use crate::{Error, Result, SdfGrid, hash::pcg, near::PointTree, progress::in_parallel};
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// Weight of the distance from a ray relative to the depth along it, when hair is picked.
const ASIDE: f32 = 3.0;
/// Largest distance from a ray at which hair is picked, meters.
const PICK: f32 = 0.02;
/// Depth below the skin to which a shell reaches, meters.
const SKIN: f32 = 0.02;
/// Distance between dabs, radii.
const STEP: f32 = 0.25;
/// Time between dabs of a brush that stands still, s.
const BEAT: f32 = 0.05;
/// Largest radius to which a brush grows where guides are sparse, meters.
const WIDEST: f32 = 0.06;
/// Passes of FABRIK: enough for 2 mm.
const PASSES: u32 = 6;
/// Distance of the nearest guide, relative to the distance at which one is picked, from which a brush is beside the hair.
const SPARSE: f32 = 2.0;
/// Distance of the eye from a cut without a camera, meters.
const FAR: f32 = 10.0;
/// Limits of the growth in one stroke.
const GROWTH: std::ops::RangeInclusive<f32> = 0.1..=5.0;
/// Distance from which a shape is another, meters.
const KEPT: f32 = 1e-4;
/// Largest number of dabs between two samples.
const MOST_DABS: u32 = 4000;
/// Parts of a line in which hair hides other hair.
const BINS: usize = 64;
/// Thickness of the hair on the near side, meters.
const CURTAIN: f32 = 0.06;
/// Number of neighbors.
const NEIGHBORS: usize = 6;
/// Number of guides from which several threads are faster.
const MANY: usize = 48;

/// A point of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeSample {
    /// The eye, or the middle of the brush without a camera; groom space, meters.
    pub origin: Vec3,
    /// Direction of sight through the pointer; zero without a camera.
    pub direction: Vec3,
    /// Pressure of the pen, 0 to 1; 1 without a pen.
    pub pressure: f32,
    /// Time since the press, s. Some tools also act while the brush stands still.
    pub time: f32,
}

impl StrokeSample {
    /// Creates a sample of a mouse: the ray from the eye through the pointer.
    pub fn ray(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction: unit(direction, Vec3::NEG_Z), pressure: 1.0, time: 0.0 }
    }

    /// Creates a sample without a camera: the middle of the brush.
    pub fn point(at: Vec3) -> Self {
        Self { origin: at, direction: Vec3::ZERO, pressure: 1.0, time: 0.0 }
    }

    fn at(&self, depth: f32) -> Vec3 {
        self.origin + self.direction * depth
    }

    fn lerp(&self, other: &Self, t: f32) -> Self {
        let direction = self.direction.lerp(other.direction, t);
        Self {
            origin: self.origin.lerp(other.origin, t),
            direction: unit(direction, Vec3::ZERO),
            pressure: self.pressure + (other.pressure - self.pressure) * t,
            time: other.time,
        }
    }
}

/// A stroke that has begun.
#[derive(Debug)]
struct ActiveStroke {
    brush: Brush,
    /// Radius, larger than the brush's where guides are sparse, meters.
    radius: f32,
    seed: u32,
    /// The last sample, and the way left to the next dab.
    last: StrokeSample,
    left: f32,
    /// Depth of the brush from the eye, meters.
    depth: f32,
    /// Time since the last dab, s.
    held: f32,
    pressed: Vec<Option<Arc<PressState>>>,
    /// Guides that have moved.
    touched: Vec<bool>,
    /// Changes of lengths.
    lengths: LengthChanges,
    /// The strands at the press, and those of each guide, if they are cut.
    strands: Option<(CarriedStrands, Vec<Vec<u32>>)>,
    /// The sample of the press.
    first: StrokeSample,
    /// What [`BrushTool::Grab`] holds, with the weights at the press.
    grabbed: Vec<(usize, Weights)>,
    begin: Vec3,
}

impl ActiveStroke {
    /// Returns a random number of a guide or strand, 0 to 1, that stays the same during the stroke.
    fn chance(&self, i: u32) -> f32 {
        (pcg(i ^ self.seed) >> 8) as f32 / (1 << 24) as f32
    }

    /// Whether a cut takes strand `i`.
    fn takes(&self, i: u32) -> bool {
        self.brush.strength >= 1.0 || self.chance(i) < self.brush.strength
    }
}

/// A guide that a dab has moved, and as it was at the press.
struct MovedGuide {
    vertices: Vec<Vec3>,
    press: Arc<PressState>,
    /// Factor of its length.
    growth: f32,
}

/// A groom under a brush.
#[derive(Debug)]
pub struct GroomEditor {
    document: GroomDocument,
    field: Option<Arc<SdfGrid>>,
    /// Normal of the skin at each root.
    normals: Vec<Vec3>,
    /// Nearest roots of each guide.
    neighbors: OnceLock<Vec<Vec<u32>>>,
    /// Largest distance from a ray at which a guide is picked, meters.
    aside: f32,
    /// The guides as they move, guide after guide.
    positions: Vec<Vec3>,
    /// A sphere around each guide.
    spheres: Vec<(Vec3, f32)>,
    stroke: Option<ActiveStroke>,
    moved: bool,
    /// Number of dabs so far.
    dab_count: u64,
}

impl GroomEditor {
    /// Opens `document`. `field` is the distance field of the whole body at rest: no hair enters it.
    pub fn new(document: GroomDocument, field: Option<Arc<SdfGrid>>) -> Self {
        let positions = document.guides().positions();
        let n = document.vertex_count();
        let spheres = positions.chunks_exact(n).map(sphere).collect();
        let normal = |guide: &[Vec3]| match &field {
            Some(field) => field.normal(guide[0]),
            None => unit(guide[1] - guide[0], Vec3::Y),
        };
        let normals = document.original().guides().positions().chunks_exact(n).map(normal).collect();
        let roots: Vec<Vec3> = positions.chunks_exact(n).map(|guide| guide[0]).collect();
        let tree = PointTree::new(&roots);
        let mut found = Vec::new();
        let mut nearest: Vec<f32> = roots
            .iter()
            .filter_map(|root| {
                tree.nearest(*root, 2, 1.0, &mut found);
                found.get(1).map(|(square, _)| square.sqrt())
            })
            .collect();
        nearest.sort_by(f32::total_cmp);
        let spacing = nearest.get(nearest.len() / 2).copied().unwrap_or(PICK);
        let (neighbors, stroke) = (OnceLock::new(), None);
        let aside = (1.5 * spacing).clamp(5e-3, PICK);
        Self {
            document,
            field,
            normals,
            neighbors,
            aside,
            positions,
            spheres,
            stroke,
            moved: false,
            dab_count: 0,
        }
    }

    /// Returns the version before the current stroke.
    pub fn document(&self) -> &GroomDocument {
        &self.document
    }

    /// Returns the distance field that no hair enters.
    pub fn field(&self) -> Option<&SdfGrid> {
        self.field.as_deref()
    }

    /// Returns the guides as they are now, guide after guide.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Whether guides have moved since the last call.
    pub fn take_moved(&mut self) -> bool {
        std::mem::take(&mut self.moved)
    }

    /// Returns how often a brush has been applied so far.
    pub fn dab_count(&self) -> u64 {
        self.dab_count
    }

    /// Returns the sights of the press and of the pointer while a line is drawn.
    pub fn line(&self) -> Option<[StrokeSample; 2]> {
        let stroke = self.stroke.as_ref().filter(|stroke| stroke.brush.tool == BrushTool::Line)?;
        Some([stroke.first, stroke.last])
    }

    /// Whether a stroke has begun.
    pub fn is_active(&self) -> bool {
        self.stroke.is_some()
    }

    /// Returns the middle of the brush and its radius during a stroke, meters.
    pub fn brush_at(&self) -> Option<(Vec3, f32)> {
        self.stroke.as_ref().map(|stroke| (stroke.last.at(stroke.depth), stroke.radius))
    }

    /// Shows another version of the same groom.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a version of another groom.
    pub fn go_to(&mut self, document: GroomDocument) -> Result<()> {
        if !document.is_version_of(&self.document) {
            return Err(Error::Unusable("the version belongs to another groom".into()));
        }
        self.cancel();
        if !document.is_pose_of(&self.document) {
            self.open(document);
            return Ok(());
        }
        let before = std::mem::replace(&mut self.document, document.clone());
        for i in document.guides().differing(before.guides()) {
            self.place(i, document.guide(i));
        }
        self.moved = true;
        Ok(())
    }

    /// Shows a version with other lengths.
    fn open(&mut self, document: GroomDocument) {
        let count = self.dab_count;
        *self = Self { dab_count: count, moved: true, ..Self::new(document, self.field.clone()) };
    }

    fn place(&mut self, i: usize, guide: &[Vec3]) {
        let n = guide.len();
        self.positions[i * n..(i + 1) * n].copy_from_slice(guide);
        self.spheres[i] = sphere(guide);
    }

    /// Returns the distance along the ray to the hair or skin under it, meters; `None` beside both.
    pub fn hit(&self, sample: &StrokeSample) -> Option<f32> {
        self.hit_within(sample, self.aside)
    }

    fn hit_within(&self, sample: &StrokeSample, aside: f32) -> Option<f32> {
        let (origin, direction) = (sample.origin, sample.direction);
        let skin = self.field.as_deref().and_then(|field| trace(field, origin, direction));
        let n = self.document.vertex_count();
        let last = skin.map_or(f32::MAX, |skin| skin + self.aside);
        let mut best = (f32::MAX, None);
        for (guide, (center, radius)) in self.positions.chunks_exact(n).zip(&self.spheres) {
            let depth = (*center - origin).dot(direction);
            let off = (*center - sample.at(depth)).length() - radius;
            if off > aside || depth - radius + ASIDE * off.max(0.0) > best.0 {
                continue;
            }
            for p in guide {
                let depth = (*p - origin).dot(direction);
                let off = (*p - sample.at(depth)).length();
                let score = depth + ASIDE * off;
                if off <= aside && depth > 0.0 && depth < last && score < best.0 {
                    best = (score, Some(depth));
                }
            }
        }
        best.1.or(skin)
    }

    /// Begins a stroke with `brush`. Returns `false`, and begins nothing, if there is neither hair nor skin under the
    /// sample.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a brush out of range, and for a sample that is not finite.
    pub fn press(&mut self, brush: &Brush, sample: &StrokeSample) -> Result<bool> {
        brush.check()?;
        check(sample)?;
        self.cancel();
        let depth = match self.hit(sample) {
            _ if sample.direction == Vec3::ZERO => 0.0,
            Some(depth) => depth,
            // A line may begin beside the hair.
            None if brush.tool == BrushTool::Line => 0.0,
            None => return Ok(false),
        };
        let begin = sample.at(depth);
        let nearest = self.positions.iter().map(|p| p.distance(begin)).fold(f32::MAX, f32::min);
        // A brush between sparse guides reaches the nearest; one beside the hair does not grow.
        let sparse = nearest > brush.radius && nearest < SPARSE * self.aside;
        let radius = if sparse { (2.0 * nearest).min(WIDEST) } else { brush.radius };
        let words = begin.to_array().into_iter().chain(sample.direction.to_array());
        let seed = words.fold(1, |seed, word| pcg(seed ^ word.to_bits()));
        let guides = self.spheres.len();
        let mut stroke = ActiveStroke {
            brush: *brush,
            radius,
            seed,
            last: *sample,
            left: STEP * radius,
            depth,
            held: 0.0,
            pressed: vec![None; guides],
            touched: vec![false; guides],
            lengths: LengthChanges::default(),
            strands: (brush.tool == BrushTool::Cut).then(|| self.strands()),
            first: *sample,
            grabbed: Vec::new(),
            begin,
        };
        if brush.tool == BrushTool::Grab {
            let dabs = self.dabs(&stroke, begin, Vec3::ZERO, sample);
            let weights = |i: &usize| Weights::of(self.guide(*i), &dabs, brush).map(|weights| (*i, weights));
            stroke.grabbed = self.under(&stroke, &dabs).iter().filter_map(weights).collect();
        }
        self.stroke = Some(stroke);
        if brush.tool.acts_in_place() {
            self.dab(sample, Vec3::ZERO);
        }
        Ok(true)
    }

    /// Moves the brush to `sample`. Does nothing without a stroke.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a sample that is not finite.
    pub fn drag(&mut self, sample: &StrokeSample) -> Result<()> {
        check(sample)?;
        let Some(stroke) = &self.stroke else { return Ok(()) };
        self.hold(sample.time - stroke.last.time);
        let Some(stroke) = &mut self.stroke else { return Ok(()) };
        if stroke.brush.tool == BrushTool::Grab {
            stroke.last = *sample;
            self.pull();
            return Ok(());
        }
        if stroke.brush.tool == BrushTool::Line {
            stroke.last = *sample;
            return Ok(());
        }
        let (from, mut t) = (stroke.last, 0.0);
        for dab in 0.. {
            let Some(stroke) = &mut self.stroke else { break };
            let here = from.lerp(sample, t);
            let way = sample.at(stroke.depth) - here.at(stroke.depth);
            let length = way.length();
            // A pointer that far away has jumped.
            if length < stroke.left || length <= 1e-7 || dab == MOST_DABS {
                stroke.left = (stroke.left - length).max(0.0);
                stroke.last = *sample;
                break;
            }
            t += (1.0 - t) * (stroke.left / length);
            let next = from.lerp(sample, t);
            let motion = unit(way, Vec3::ZERO) * (STEP * stroke.radius);
            (stroke.last, stroke.held) = (next, 0.0);
            stroke.left = STEP * stroke.radius;
            self.dab(&next, motion);
            self.follow(&next);
        }
        Ok(())
    }

    /// Lets `seconds` pass at the last sample.
    fn hold(&mut self, seconds: f32) {
        let Some(stroke) = &mut self.stroke else { return };
        if !stroke.brush.tool.acts_in_place() {
            return;
        }
        stroke.held += seconds.clamp(0.0, 1.0);
        while let Some(stroke) = &mut self.stroke
            && stroke.held >= BEAT
        {
            stroke.held -= BEAT;
            let sample = stroke.last;
            self.dab(&sample, Vec3::ZERO);
        }
    }

    /// Ends the stroke. Returns the new version, or `None` if nothing has moved.
    pub fn release(&mut self) -> Option<GroomDocument> {
        if self.stroke.as_ref()?.brush.tool == BrushTool::Line {
            self.cut_line();
        }
        let stroke = self.stroke.take()?;
        let moved = |i: &usize| stroke.touched[*i] && self.guide(*i) != self.document.guide(*i);
        let moved: Vec<_> = (0..stroke.touched.len()).filter(moved).map(|i| (i, self.guide(i))).collect();
        let lengths = &stroke.lengths;
        if lengths.strands.is_empty() && lengths.guides.is_empty() {
            if moved.is_empty() {
                return None;
            }
            self.document = self.document.with(moved);
        } else {
            let document = self.document.with_lengths(lengths).with(moved);
            self.open(document);
        }
        Some(self.document.clone())
    }

    /// Gives the guides the shapes of `positions` (groom space, meters, guide after guide), for example of simulated hair.
    /// Roots and lengths stay, and nothing enters the head. Returns the new version, or `None` if no vertex is farther
    /// than a tenth of a millimeter from it.
    ///
    /// # Errors
    /// [`Error::Unusable`] for another number of positions, or for one that is not finite.
    pub fn keep(&mut self, positions: &[Vec3]) -> Result<Option<GroomDocument>> {
        self.cancel();
        let n = self.document.vertex_count();
        if positions.len() != self.positions.len() || !positions.iter().all(|p| p.is_finite()) {
            return Err(Error::Unusable("the positions do not belong to the guides of this groom".into()));
        }
        let differ = |i: &usize| {
            let pairs = self.guide(*i).iter().zip(&positions[i * n..(i + 1) * n]);
            pairs.skip(1).any(|(now, kept)| now.distance(*kept) > KEPT)
        };
        let changed: Vec<usize> = (0..self.spheres.len()).filter(differ).collect();
        let field = self.field.as_deref();
        let solver = Solver { field, keep_shape: 0.0, keep_volume: 0.0 };
        let near = vec![1.0; n];
        let solved = self.changed(&changed, |i| {
            let press = PressState::new(self.guide(i), field);
            let target = &positions[i * n..(i + 1) * n];
            let vertices = solver.solve(self.guide(i), target, &near, 1, &press);
            Some(MovedGuide { vertices, press: press.into(), growth: 1.0 })
        });
        let moved = solved.iter().map(|(i, guide)| (*i, &guide.vertices[..]));
        let document = self.document.with(moved);
        if document == self.document {
            return Ok(None);
        }
        self.go_to(document)?;
        Ok(Some(self.document.clone()))
    }

    /// Ends the stroke and takes it back.
    pub fn cancel(&mut self) {
        let Some(stroke) = self.stroke.take() else { return };
        let document = self.document.clone();
        for i in (0..stroke.touched.len()).filter(|i| stroke.touched[*i]) {
            self.place(i, document.guide(i));
            self.moved = true;
        }
    }

    fn guide(&self, i: usize) -> &[Vec3] {
        let n = self.document.vertex_count();
        &self.positions[i * n..(i + 1) * n]
    }

    /// Returns the dab at `center`, and its mirror image if the brush is symmetric.
    fn dabs(&self, stroke: &ActiveStroke, center: Vec3, motion: Vec3, sample: &StrokeSample) -> Vec<Dab> {
        let sight = sample.direction;
        let mut behind = f32::MAX;
        if let Some(field) = self.field.as_deref().filter(|_| sight != Vec3::ZERO) {
            let before = 3.0 * stroke.radius;
            behind = trace(field, center - sight * before, sight).map_or(behind, |skin| skin - before + SKIN);
        }
        let strength = stroke.brush.strength * sample.pressure.clamp(0.0, 1.0);
        let dab = Dab { center, motion, sight, behind, radius: stroke.radius, strength };
        match stroke.brush.mirror {
            true => vec![dab, dab.mirrored(self.document.middle())],
            false => vec![dab],
        }
    }

    /// Returns the guides that `dabs` may reach and that take part.
    fn under(&self, stroke: &ActiveStroke, dabs: &[Dab]) -> Vec<usize> {
        let brush = &stroke.brush;
        let pinned = &self.document.base().guides.tip_pinned;
        let takes_part = |i: &usize| {
            !pinned[*i]
                && (brush.share >= 1.0 || stroke.chance(*i as u32) < brush.share)
                && dabs.iter().any(|dab| dab.meets(self.spheres[*i], brush.reach))
        };
        (0..self.spheres.len()).filter(takes_part).collect()
    }

    /// Applies the brush once.
    fn dab(&mut self, sample: &StrokeSample, motion: Vec3) {
        let Some(stroke) = &self.stroke else { return };
        let dabs = self.dabs(stroke, sample.at(stroke.depth), motion, sample);
        let field = self.field.as_deref();
        let brush = &stroke.brush;
        let solver = Solver { field, keep_shape: brush.keep_shape, keep_volume: brush.keep_volume };
        let even = brush.acts() == BrushTool::Smooth && brush.neighbors > 0.0;
        if brush.tool == BrushTool::Cut {
            let cut = self.cut(stroke, &dabs);
            return self.shorten(cut);
        }
        let moved = self.changed(&self.under(stroke, &dabs), |i| {
            let guide = self.guide(i);
            let weights = Weights::of(guide, &dabs, brush)?;
            let along = if even { self.mean_edges(i) } else { Vec::new() };
            let press = self.pressed(stroke, i);
            let (normal, along) = (self.normals[i], &along[..]);
            let around = Surroundings { brush, dabs: &dabs, press: &press, field, normal, along };
            let (target, first) = around.target(guide, &weights)?;
            let growth = if brush.tool == BrushTool::Length { around.growth(&weights) } else { 1.0 };
            let sum = growth * stroke.lengths.guides.get(&i).copied().unwrap_or(1.0);
            if !GROWTH.contains(&sum) {
                return None;
            }
            let press = if growth == 1.0 { press } else { Arc::new(press.grown(growth)) };
            // Tools that turn edges have decided the shape.
            let near =
                if matches!(brush.acts(), BrushTool::Comb) { weights.near } else { vec![1.0; guide.len()] };
            Some(MovedGuide { vertices: solver.solve(guide, &target, &near, first, &press), press, growth })
        });
        self.take(moved);
    }

    /// Returns the strands at the press, and those of each guide.
    fn strands(&self) -> (CarriedStrands, Vec<Vec<u32>>) {
        let strands = self.document.carried();
        let mut followers = vec![Vec::new(); self.spheres.len()];
        for (i, binding) in (0u32..).zip(&strands.base().strands.bindings) {
            followers[binding.guides[0] as usize].push(i);
        }
        (strands, followers)
    }

    /// Returns the strands that `dabs` cut, with the share that is left of each.
    fn cut(&self, stroke: &ActiveStroke, dabs: &[Dab]) -> Vec<(usize, f32)> {
        let Some((strands, followers)) = &stroke.strands else { return Vec::new() };
        let under = self.under(stroke, dabs);
        let of = |guide: &usize| {
            let cut = |i: &u32| {
                let line = strands.strand(*i as usize).0;
                let entry = |dab: &Dab| dab.entry(&line, &stroke.brush);
                let entry = dabs.iter().filter_map(entry).reduce(f32::min)?;
                stroke.takes(*i).then_some((*i as usize, entry / (line.len() - 1) as f32))
            };
            followers[*guide].iter().filter_map(cut).collect::<Vec<_>>()
        };
        in_parallel(&under, of).concat()
    }

    /// Cuts the hair that crosses the line of the stroke.
    fn cut_line(&mut self) {
        let Some(stroke) = &self.stroke else { return };
        let line = CutLine::new(&stroke.first, &stroke.last);
        let mut lines = vec![line];
        if stroke.brush.mirror {
            lines.push(line.mirrored(self.document.middle()));
        }
        let (strands, _) = self.strands();
        let all: Vec<usize> = (0..strands.base().strands.len()).filter(|i| stroke.takes(*i as u32)).collect();
        let crossings = |line: &CutLine| {
            in_parallel(&all, |i| line.crossings(&strands.strand(*i).0).collect::<Vec<Crossing>>())
        };
        let through = stroke.brush.reach == Reach::Through;
        let mut cut = vec![f32::MAX; all.len()];
        for line in &lines {
            let crossings = crossings(line);
            let front = line.front(crossings.iter().flatten(), self.field.as_deref());
            for (cut, crossings) in cut.iter_mut().zip(&crossings) {
                let is_cut = |crossing: &&Crossing| through || crossing.depth <= front[crossing.bin()];
                if let Some(first) = crossings.iter().find(is_cut) {
                    *cut = cut.min(first.at);
                }
            }
        }
        let last = (strands.base().strands.vertex_count - 1) as f32;
        let cut = all.into_iter().zip(cut).filter(|(_, at)| *at < f32::MAX).map(|(i, at)| (i, at / last));
        self.shorten(cut.collect());
    }

    fn shorten(&mut self, cut: Vec<(usize, f32)>) {
        self.dab_count += 1;
        let Some(stroke) = &mut self.stroke else { return };
        for (i, share) in cut {
            let left = stroke.lengths.strands.entry(i).or_insert(1.0);
            *left = left.min(share);
        }
    }

    /// Moves the hair that is held: always from the press, so that the way does not matter.
    fn pull(&mut self) {
        let Some(stroke) = &self.stroke else { return };
        let by = stroke.last.at(stroke.depth) - stroke.begin;
        let dabs = self.dabs(stroke, stroke.begin, by, &stroke.last);
        let brush = &stroke.brush;
        let field = self.field.as_deref();
        let solver = Solver { field, keep_shape: brush.keep_shape, keep_volume: brush.keep_volume };
        let held: Vec<usize> = (0..stroke.grabbed.len()).collect();
        let moved = self.changed(&held, |k| {
            let (i, weights) = &stroke.grabbed[k];
            let guide = self.document.guide(*i);
            let press = self.pressed(stroke, *i);
            let normal = self.normals[*i];
            let around = Surroundings { brush, dabs: &dabs, press: &press, field, normal, along: &[] };
            let (target, _) = around.target(guide, weights)?;
            let (target, near) = reached(guide, target, weights, &press.lengths);
            Some(MovedGuide { vertices: solver.solve(guide, &target, &near, 1, &press), press, growth: 1.0 })
        });
        let moved = moved.into_iter().map(|(k, solved)| (stroke.grabbed[k].0, solved)).collect();
        self.take(moved);
    }

    /// Returns `of` for each of `guides` that it changes, in order.
    fn changed(
        &self,
        guides: &[usize],
        of: impl Fn(usize) -> Option<MovedGuide> + Sync,
    ) -> Vec<(usize, MovedGuide)> {
        let each = |i: &usize| of(*i).map(|solved| (*i, solved));
        match guides.len() < MANY {
            true => guides.iter().filter_map(each).collect(),
            false => in_parallel(guides, each).into_iter().flatten().collect(),
        }
    }

    fn take(&mut self, moved: Vec<(usize, MovedGuide)>) {
        self.dab_count += 1;
        for (i, MovedGuide { vertices, press, growth }) in moved {
            self.place(i, &vertices);
            self.moved = true;
            if let Some(stroke) = &mut self.stroke {
                stroke.touched[i] = true;
                stroke.pressed[i] = Some(press);
                if growth != 1.0 {
                    *stroke.lengths.guides.entry(i).or_insert(1.0) *= growth;
                }
            }
        }
    }

    /// Returns guide `i` as it was at the press.
    fn pressed(&self, stroke: &ActiveStroke, i: usize) -> Arc<PressState> {
        let new = || Arc::new(PressState::new(self.document.guide(i), self.field.as_deref()));
        stroke.pressed[i].clone().unwrap_or_else(new)
    }

    /// Lets the brush follow the hair and the head in depth.
    fn follow(&mut self, sample: &StrokeSample) {
        let Some(radius) = self.stroke.as_ref().map(|stroke| stroke.radius) else { return };
        if sample.direction == Vec3::ZERO {
            return;
        }
        let hit = self.hit_within(sample, self.aside.max(0.5 * radius));
        if let (Some(stroke), Some(hit)) = (&mut self.stroke, hit) {
            stroke.depth += 0.5 * (hit - stroke.depth);
        }
    }

    /// Returns the mean directions of the edges of the neighbors of guide `i` that run with it, zero without any.
    fn mean_edges(&self, i: usize) -> Vec<Vec3> {
        let n = self.document.vertex_count();
        let chord = |guide: &[Vec3]| unit(guide[n - 1] - guide[0], Vec3::ZERO);
        let own = chord(self.guide(i));
        let mut sums = vec![Vec3::ZERO; n - 1];
        for other in &self.neighbors()[i] {
            let guide = self.guide(*other as usize);
            if chord(guide).dot(own) > 0.5 {
                for (sum, edge) in sums.iter_mut().zip(guide.windows(2)) {
                    *sum += unit(edge[1] - edge[0], Vec3::ZERO);
                }
            }
        }
        sums.into_iter().map(|sum| unit(sum, Vec3::ZERO)).collect()
    }

    fn neighbors(&self) -> &[Vec<u32>] {
        self.neighbors.get_or_init(|| {
            let roots: Vec<Vec3> = (0..self.spheres.len()).map(|i| self.guide(i)[0]).collect();
            let (tree, mut found) = (PointTree::new(&roots), Vec::new());
            let mut of = |(i, root): (usize, &Vec3)| {
                tree.nearest(*root, NEIGHBORS + 1, 0.1, &mut found);
                found.iter().map(|(_, j)| *j).filter(|j| *j as usize != i).take(NEIGHBORS).collect()
            };
            roots.iter().enumerate().map(&mut of).collect()
        })
    }
}

/// Returns the targets of held hair after some passes of FABRIK (Aristidou and Lasenby 2011), so that the vertex that is
/// held most reaches its target if the hair is long enough; and the falloff, 1 up to that vertex.
fn reached(
    guide: &[Vec3],
    mut target: Vec<Vec3>,
    weights: &Weights,
    lengths: &[f32],
) -> (Vec<Vec3>, Vec<f32>) {
    let most =
        (1..guide.len()).fold(1, |most, i| if weights.weight[i] >= weights.weight[most] { i } else { most });
    let goal = target[most];
    for _ in 0..PASSES {
        target[most] = goal;
        for i in (1..most).rev() {
            target[i] = target[i + 1] + unit(target[i] - target[i + 1], Vec3::Y) * lengths[i];
        }
        target[0] = guide[0];
        for i in 0..most {
            target[i + 1] = target[i] + unit(target[i + 1] - target[i], Vec3::Y) * lengths[i];
        }
    }
    let near = |(i, near): (usize, &f32)| if i <= most { 1.0 } else { *near };
    let near = weights.near.iter().enumerate().map(near).collect();
    (target, near)
}

fn check(sample: &StrokeSample) -> Result<()> {
    let StrokeSample { origin, direction, pressure, time } = sample;
    let is_finite = origin.is_finite() && direction.is_finite() && (pressure + time).is_finite();
    if is_finite && origin.abs().max_element() < 1e3 {
        return Ok(());
    }
    Err(Error::Parameter { name: "the stroke", value: format!("{sample:?}"), range: "within a kilometer" })
}

/// A straight cut between two rays from one eye.
#[derive(Clone, Copy)]
struct CutLine {
    eye: Vec3,
    from: Vec3,
    to: Vec3,
}

impl CutLine {
    /// Creates the cut between the sights of two samples; without a camera, between points seen from far along z.
    fn new(first: &StrokeSample, last: &StrokeSample) -> Self {
        match first.direction == Vec3::ZERO {
            true => {
                let eye = 0.5 * (first.origin + last.origin) + Vec3::Z * FAR;
                Self { eye, from: first.origin - eye, to: last.origin - eye }
            }
            false => Self { eye: last.origin, from: first.direction, to: last.direction },
        }
    }

    fn mirrored(&self, middle: f32) -> Self {
        let flip = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let eye = Vec3::new(2.0 * middle - self.eye.x, self.eye.y, self.eye.z);
        Self { eye, from: flip(self.from), to: flip(self.to) }
    }

    /// Returns the places where a polyline crosses the cut, from its first point.
    fn crossings(self, points: &[Vec3]) -> impl Iterator<Item = Crossing> {
        let normal = self.from.cross(self.to);
        let crossing = move |(i, edge): (usize, &[Vec3])| {
            let [a, b] = [edge[0], edge[1]].map(|p| (p - self.eye).dot(normal));
            let t = a / (a - b);
            let way = edge[0].lerp(edge[1], t) - self.eye;
            let (left, right) = (self.from.cross(way).dot(normal), way.cross(self.to).dot(normal));
            let crosses = a * b <= 0.0 && a != b && left >= 0.0 && right >= 0.0 && left + right > 0.0;
            crosses.then(|| Crossing { at: i as f32 + t, along: left / (left + right), depth: way.length() })
        };
        points.windows(2).enumerate().filter_map(crossing)
    }

    /// Returns for each part of the line the depth down to which hair is on the near side: a little more than the
    /// nearest hair, and not far below the skin.
    fn front<'a>(&self, crossings: impl Iterator<Item = &'a Crossing>, field: Option<&SdfGrid>) -> Vec<f32> {
        let mut nearest = vec![f32::MAX; BINS];
        for crossing in crossings {
            let nearest = &mut nearest[crossing.bin()];
            *nearest = nearest.min(crossing.depth);
        }
        let depth = |i: usize| {
            let around = i.saturating_sub(1)..=(i + 1).min(BINS - 1);
            let hair = around.map(|i| nearest[i]).fold(f32::MAX, f32::min) + CURTAIN;
            let sight = unit(self.from.lerp(self.to, (i as f32 + 0.5) / BINS as f32), Vec3::NEG_Z);
            let skin = field.and_then(|field| trace(field, self.eye, sight));
            skin.map_or(hair, |skin| hair.min(skin + SKIN))
        };
        (0..BINS).map(depth).collect()
    }
}

/// A place where a strand crosses a cut.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Segments from the root.
    at: f32,
    /// Share of the line.
    along: f32,
    /// Distance from the eye, meters.
    depth: f32,
}

impl Crossing {
    /// Returns the part of the line.
    fn bin(&self) -> usize {
        ((self.along * BINS as f32) as usize).min(BINS - 1)
    }
}

fn sphere_corners<'a>(points: impl Iterator<Item = &'a Vec3>) -> (Vec3, Vec3) {
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
}

fn sphere(guide: &[Vec3]) -> (Vec3, f32) {
    let (lo, hi) = sphere_corners(guide.iter());
    (0.5 * (lo + hi), 0.5 * (hi - lo).length())
}

/// Returns the distance along a ray (`direction` unit) to the skin, meters.
pub(super) fn trace(field: &SdfGrid, origin: Vec3, direction: Vec3) -> Option<f32> {
    let mut t = 0.0;
    for _ in 0..200 {
        let distance = field.sample(origin + direction * t);
        if distance < 5e-4 {
            return Some(t);
        }
        t += distance;
        if t > 20.0 {
            break;
        }
    }
    None
}
