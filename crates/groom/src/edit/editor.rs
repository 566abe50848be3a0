//! The editor: applies strokes to a groom.

use super::{
    Brush, BrushTool, GroomDocument,
    carry::CarriedStrands,
    cuts::LengthChanges,
    ground::Ground,
    line::SKIN,
    looks::StrandLooks,
    roots::RootStroke,
    sample::StrokeSample,
    solve::{BEND, PressState, Solver, reached, unit},
    tools::{Dab, Surroundings, Weights},
};
use crate::{
    Error, Groom, Result, SdfGrid, TriMesh,
    hash::{self, pcg},
    mesh::Bvh,
    near::PointTree,
    progress::in_parallel,
};
use glam::Vec3;
use std::{
    collections::BTreeSet,
    sync::{Arc, OnceLock},
};

/// Weight of the distance from a ray relative to the depth along it, when hair is picked.
const ASIDE: f32 = 3.0;
/// Largest distance from a ray at which hair is picked, meters.
const PICK: f32 = 0.02;
/// Distance between dabs, radii.
const STEP: f32 = 0.25;
/// Time between dabs of a brush that stands still, s.
const BEAT: f32 = 0.05;
/// Largest radius to which a brush grows where guides are sparse, meters.
const WIDEST: f32 = 0.06;
/// Distance of the nearest guide, relative to the distance at which one is picked, from which a brush is beside the hair.
const SPARSE: f32 = 2.0;
/// Limits of the growth in one stroke.
const GROWTH: std::ops::RangeInclusive<f32> = 0.1..=5.0;
/// Distance from which a shape is another, meters.
const KEPT: f32 = 1e-4;
/// Largest number of dabs between two samples.
const MOST_DABS: u32 = 4000;
/// Largest number of corners of an outline.
const MOST_CORNERS: usize = 96;
/// Number of neighbors.
const NEIGHBORS: usize = 6;
/// Number of guides from which several threads are faster.
const MANY: usize = 48;

/// A stroke that has begun.
#[derive(Debug)]
pub(super) struct ActiveStroke {
    pub brush: Brush,
    /// Radius, larger than the brush's where guides are sparse, meters.
    pub radius: f32,
    pub seed: u32,
    /// The last sample, and the way left to the next dab.
    pub last: StrokeSample,
    left: f32,
    /// Depth of the brush from the eye, meters.
    depth: f32,
    /// Time since the last dab, s.
    held: f32,
    pressed: Vec<Option<Arc<PressState>>>,
    /// Guides that have moved.
    touched: Vec<bool>,
    /// Changes of roots.
    pub roots: RootStroke,
    /// Painted values, and whether they differ from those before.
    pub looks: Option<StrandLooks>,
    pub painted: bool,
    /// Changes of lengths.
    pub lengths: LengthChanges,
    /// For cuts and refining: the strands at the press, and the followers of each guide.
    pub strands: Option<(CarriedStrands, Vec<Vec<u32>>)>,
    /// The sample of the press.
    pub first: StrokeSample,
    /// The outline of [`BrushTool::Lasso`].
    pub outline: Vec<StrokeSample>,
    /// Guides that [`BrushTool::Grab`] holds, with the weights at the press.
    grabbed: Vec<(usize, Weights)>,
    begin: Vec3,
}

impl ActiveStroke {
    /// Returns a random number of a guide or strand, 0 to 1, that stays the same during the stroke.
    fn chance(&self, i: u32) -> f32 {
        hash::unit(pcg(i ^ self.seed))
    }

    /// Whether a tool that takes a share of the strands takes strand `i`.
    pub fn takes(&self, i: u32) -> bool {
        self.brush.strength >= 1.0 || self.chance(i) < self.brush.strength
    }
}

/// A guide that a dab has moved, and its state at the press.
pub(super) struct MovedGuide {
    pub vertices: Vec<Vec3>,
    pub press: Arc<PressState>,
    /// Factor of its length.
    pub growth: f32,
}

/// A groom under a brush.
#[derive(Debug)]
pub struct GroomEditor {
    pub(super) document: GroomDocument,
    /// The groom before the first stroke, with its current lengths: held, because every dab reads it.
    pub(super) base: Arc<Groom>,
    pub(super) ground: Ground,
    /// Normal of the skin at each root.
    pub(super) normals: Vec<Vec3>,
    /// Whether each guide is held.
    pub(super) held: Vec<bool>,
    /// Nearest roots of each guide.
    neighbors: OnceLock<Vec<Vec<u32>>>,
    /// Largest distance from a ray at which a guide is picked, meters.
    aside: f32,
    /// The guides as they move, guide after guide.
    positions: Vec<Vec3>,
    /// A sphere around each guide.
    pub(super) spheres: Vec<(Vec3, f32)>,
    pub(super) stroke: Option<ActiveStroke>,
    moved: bool,
    /// Number of dabs so far.
    pub(super) dab_count: u64,
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
        let normals = positions.chunks_exact(n).map(normal).collect();
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
            base: document.base(),
            held: document.held(),
            document,
            ground: Ground { field, mesh: None },
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

    /// Plants hair on `body`, the mesh of the distance field. Without it, roots lie where the field is zero.
    #[must_use]
    pub fn on_skin(mut self, body: &TriMesh) -> Self {
        self.ground.mesh = Some(Arc::new((body.clone(), Bvh::new(body))));
        self
    }

    /// Returns the version before the current stroke.
    pub fn document(&self) -> &GroomDocument {
        &self.document
    }

    /// Returns the distance field that no hair enters.
    pub fn field(&self) -> Option<&SdfGrid> {
        self.ground.field.as_deref()
    }

    /// Returns the current positions of the guides, guide after guide.
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

    /// Returns the sights of the line or outline that is being drawn; empty without one.
    pub fn drawn(&self) -> Vec<StrokeSample> {
        match self.stroke.as_ref().map(|stroke| (stroke, stroke.brush.tool)) {
            Some((stroke, BrushTool::Line)) => vec![stroke.first, stroke.last],
            Some((stroke, BrushTool::Lasso)) => stroke.outline.clone(),
            _ => Vec::new(),
        }
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
        let ground = std::mem::take(&mut self.ground);
        let new = Self::new(document, ground.field.clone());
        *self = Self { dab_count: count, moved: true, ground, ..new };
    }

    fn place(&mut self, i: usize, guide: &[Vec3]) {
        let n = guide.len();
        if let Some(field) = self.ground.field.as_deref().filter(|_| self.positions[i * n] != guide[0]) {
            self.normals[i] = field.normal(guide[0]);
        }
        self.positions[i * n..(i + 1) * n].copy_from_slice(guide);
        self.spheres[i] = sphere(guide);
    }

    /// Returns the distance along the ray to what `tool` acts on under it, hair or skin, meters; `None` beside both.
    pub fn hit(&self, tool: BrushTool, sample: &StrokeSample) -> Option<f32> {
        match tool.acts_on_roots() {
            true => self.skin_depth(sample),
            false => self.hit_within(sample, self.aside),
        }
    }

    fn hit_within(&self, sample: &StrokeSample, aside: f32) -> Option<f32> {
        let (origin, direction) = (sample.origin, sample.direction);
        let skin = self.ground.field.as_deref().and_then(|field| field.trace(origin, direction, 0.0));
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
        sample.check()?;
        self.cancel();
        let on_roots = brush.tool.acts_on_roots();
        let depth = match self.hit(brush.tool, sample) {
            _ if sample.direction == Vec3::ZERO => 0.0,
            Some(depth) => depth,
            // A line may begin beside the hair.
            None if brush.tool.draws() => 0.0,
            None => return Ok(false),
        };
        let begin = sample.at(depth);
        let nearest = self.positions.iter().map(|p| p.distance(begin)).fold(f32::MAX, f32::min);
        // A brush between sparse guides reaches the nearest; one beside the hair does not grow.
        let sparse = !on_roots && nearest > brush.radius && nearest < SPARSE * self.aside;
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
            roots: self.root_stroke(brush),
            looks: None,
            painted: false,
            lengths: LengthChanges::default(),
            strands: matches!(brush.tool, BrushTool::Cut | BrushTool::Refine).then(|| self.strands()),
            first: *sample,
            outline: vec![*sample],
            grabbed: Vec::new(),
            begin,
        };
        if brush.tool == BrushTool::Grab {
            let dabs = self.dabs(&stroke, begin, Vec3::ZERO, sample);
            let weights = |i: &usize| Weights::of(self.guide(*i), &dabs, brush).map(|weights| (*i, weights));
            stroke.grabbed = self.under(&stroke, &dabs).iter().filter_map(weights).collect();
        }
        self.stroke = Some(stroke);
        if brush.tool.acts_in_place() || on_roots || brush.tool.paints() {
            self.dab(sample, Vec3::ZERO);
        }
        Ok(true)
    }

    /// Moves the brush to `sample`. Does nothing without a stroke.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a sample that is not finite.
    pub fn drag(&mut self, sample: &StrokeSample) -> Result<()> {
        sample.check()?;
        let Some(stroke) = &self.stroke else { return Ok(()) };
        self.hold(sample.time - stroke.last.time);
        let Some(stroke) = &mut self.stroke else { return Ok(()) };
        if stroke.brush.tool == BrushTool::Grab {
            stroke.last = *sample;
            self.pull();
            return Ok(());
        }
        if stroke.brush.tool.draws() {
            stroke.last = *sample;
            if stroke.outline.last().is_some_and(|last| last.is_apart(sample)) {
                stroke.outline.push(*sample);
                if stroke.outline.len() > MOST_CORNERS {
                    let mut index = 0;
                    stroke.outline.retain(|_| {
                        index += 1;
                        index % 2 == 1
                    });
                }
            }
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
        if self.stroke.as_ref()?.brush.tool.draws() {
            self.cut_path();
        }
        let stroke = self.stroke.take()?;
        let replanted = self.with_root_changes(&stroke).or_else(|| self.with_paint(&stroke));
        let moved = |i: &usize| stroke.touched[*i] && self.guide(*i) != self.document.guide(*i);
        let moved: Vec<_> = (0..stroke.touched.len()).filter(moved).map(|i| (i, self.guide(i))).collect();
        let lengths = &stroke.lengths;
        if let Some(document) = replanted {
            // Guides that a parting has moved are the same guides.
            let document = document.with(moved);
            self.open(document);
        } else if lengths.strands.is_empty() && lengths.guides.is_empty() {
            if moved.is_empty() {
                return None;
            }
            let guides: BTreeSet<usize> = moved.iter().map(|(i, _)| *i).collect();
            let document = self.document.with(moved);
            match stroke.brush.tool {
                BrushTool::Slide => self.open(document.rooted(&guides, &self.ground)),
                _ => self.document = document,
            }
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
        let field = self.ground.field.as_deref();
        let solver = Solver { field, keep_shape: 0.0, keep_volume: 0.0, bend: None };
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

    pub(super) fn guide(&self, i: usize) -> &[Vec3] {
        let n = self.document.vertex_count();
        &self.positions[i * n..(i + 1) * n]
    }

    /// Returns the dab at `center`, and its mirror image if the brush is symmetric.
    fn dabs(&self, stroke: &ActiveStroke, center: Vec3, motion: Vec3, sample: &StrokeSample) -> Vec<Dab> {
        let sight = sample.direction;
        let mut behind = f32::MAX;
        if let Some(field) = self.ground.field.as_deref().filter(|_| sight != Vec3::ZERO) {
            let before = 3.0 * stroke.radius;
            behind =
                field.trace(center - sight * before, sight, 0.0).map_or(behind, |skin| skin - before + SKIN);
        }
        let strength = stroke.brush.strength * sample.pressure.clamp(0.0, 1.0);
        let dab = Dab { center, motion, sight, behind, radius: stroke.radius, strength };
        match stroke.brush.mirror {
            true => vec![dab, dab.mirrored(self.document.middle())],
            false => vec![dab],
        }
    }

    /// Returns the guides that `dabs` may reach and that take part.
    pub(super) fn under(&self, stroke: &ActiveStroke, dabs: &[Dab]) -> Vec<usize> {
        let brush = &stroke.brush;
        let pinned = &self.base.guides.tip_pinned;
        let meets: Vec<_> = dabs.iter().map(|dab| dab.meets(brush.reach)).collect();
        let takes_part = |i: &usize| {
            !pinned[*i]
                && self.is_open(brush, *i)
                && (brush.share >= 1.0 || stroke.chance(*i as u32) < brush.share)
                && meets.iter().any(|meets| meets(self.spheres[*i]))
        };
        (0..self.spheres.len()).filter(takes_part).collect()
    }

    /// Whether `brush` acts on guide `i` and the strands that follow it most: they are of its layer, and not held.
    pub(super) fn is_open(&self, brush: &Brush, i: usize) -> bool {
        let group = || self.base.guides.groups.get(i).copied().unwrap_or_default();
        let held = self.held[i] && brush.tool != BrushTool::Hold;
        !held && brush.layer.is_none_or(|layer| group() == layer)
    }

    /// Applies the brush once.
    fn dab(&mut self, sample: &StrokeSample, motion: Vec3) {
        let Some(stroke) = &self.stroke else { return };
        let dabs = self.dabs(stroke, sample.at(stroke.depth), motion, sample);
        if stroke.brush.tool == BrushTool::Slide {
            return self.slide(&dabs);
        }
        if stroke.brush.tool.acts_on_roots() || stroke.brush.tool.paints() {
            let turns = stroke.brush.tool == BrushTool::Part;
            self.dab_roots(&dabs);
            if !turns {
                return;
            }
        }
        let Some(stroke) = &self.stroke else { return };
        let field = self.ground.field.as_deref();
        let brush = &stroke.brush;
        let solver =
            Solver { field, keep_shape: brush.keep_shape, keep_volume: brush.keep_volume, bend: Some(BEND) };
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

    /// Moves the hair that is held: always from the press, so that the way does not matter.
    fn pull(&mut self) {
        let Some(stroke) = &self.stroke else { return };
        let by = stroke.last.at(stroke.depth) - stroke.begin;
        let dabs = self.dabs(stroke, stroke.begin, by, &stroke.last);
        let brush = &stroke.brush;
        let field = self.ground.field.as_deref();
        let solver =
            Solver { field, keep_shape: brush.keep_shape, keep_volume: brush.keep_volume, bend: Some(BEND) };
        let held: Vec<usize> = (0..stroke.grabbed.len()).collect();
        let moved = self.changed(&held, |k| {
            let (i, weights) = &stroke.grabbed[k];
            let guide = self.document.guide(*i);
            let press = self.pressed(stroke, *i);
            let normal = self.normals[*i];
            let around = Surroundings { brush, dabs: &dabs, press: &press, field, normal, along: &[] };
            let (target, _) = around.target(guide, weights)?;
            let (target, near) = reached(guide, target, (&weights.weight, &weights.near), &press.lengths);
            Some(MovedGuide { vertices: solver.solve(guide, &target, &near, 1, &press), press, growth: 1.0 })
        });
        let moved = moved.into_iter().map(|(k, solved)| (stroke.grabbed[k].0, solved)).collect();
        self.take(moved);
    }

    /// Returns `of` for each of `guides` that it changes, in order.
    pub(super) fn changed(
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

    pub(super) fn take(&mut self, moved: Vec<(usize, MovedGuide)>) {
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

    /// Returns the state of guide `i` at the press.
    pub(super) fn pressed(&self, stroke: &ActiveStroke, i: usize) -> Arc<PressState> {
        let new = || Arc::new(PressState::new(self.document.guide(i), self.ground.field.as_deref()));
        stroke.pressed[i].clone().unwrap_or_else(new)
    }

    /// Lets the brush follow the hair and the head in depth.
    fn follow(&mut self, sample: &StrokeSample) {
        let Some(radius) = self.stroke.as_ref().map(|stroke| stroke.radius) else { return };
        if sample.direction == Vec3::ZERO {
            return;
        }
        let on_roots = self.stroke.as_ref().is_some_and(|stroke| stroke.brush.tool.acts_on_roots());
        let (hit, share) = match on_roots {
            true => (self.skin_depth(sample), 1.0),
            false => (self.hit_within(sample, self.aside.max(0.5 * radius)), 0.5),
        };
        if let (Some(stroke), Some(hit)) = (&mut self.stroke, hit) {
            stroke.depth += share * (hit - stroke.depth);
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

/// Returns a sphere around `line`.
pub(super) fn sphere(line: &[Vec3]) -> (Vec3, f32) {
    let (lo, hi) = line.iter().fold((line[0], line[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    (0.5 * (lo + hi), 0.5 * (hi - lo).length())
}
