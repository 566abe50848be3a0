//! The hair under the brush.

use super::{
    Brush, BrushTool, GroomDocument, StrokeSample, brush::chance, ground::Ground,
    painted_values::PaintedValues, posed_guides::PosedGuides, solve::PressState, tools::Dab,
};
use crate::{Groom, SdfGrid, progress::in_parallel};
use glam::Vec3;
use std::sync::Arc;

/// Number of guides from which several threads are faster.
const MANY: usize = 48;

/// A version of a groom, and its guides as a stroke moves them.
#[derive(Debug)]
pub(super) struct EditedHair {
    /// The version before the stroke.
    pub document: GroomDocument,
    /// The groom before the first stroke, with its current lengths: held, because every dab reads it.
    pub base: Arc<Groom>,
    pub ground: Ground,
    /// Painted values before the stroke.
    pub painted_values: PaintedValues,
    pub guides: PosedGuides,
    /// State at the press of each guide that the last stroke has moved.
    pub pressed: Vec<Option<Arc<PressState>>>,
    /// Number of dabs so far, also in other versions.
    pub dab_count: u64,
}

impl EditedHair {
    pub fn new(document: GroomDocument, ground: Ground) -> Self {
        Self {
            base: document.base(),
            painted_values: document.painted_values(),
            pressed: vec![None; document.guides().len()],
            guides: PosedGuides::new(&document, ground.field.as_deref()),
            document,
            ground,
            dab_count: 0,
        }
    }

    /// Shows another version.
    pub fn go_to(&mut self, document: GroomDocument) {
        if document.is_pose_of(&self.document) {
            let before = std::mem::replace(&mut self.document, document);
            for i in self.document.guides().differing(before.guides()) {
                self.guides.set(i, self.document.guide(i), self.ground.field.as_deref());
            }
        } else {
            let (ground, dab_count) = (std::mem::take(&mut self.ground), self.dab_count);
            *self = Self { dab_count, ..Self::new(document, ground) };
        }
        self.guides.changed = true;
    }

    pub fn field(&self) -> Option<&SdfGrid> {
        self.ground.field.as_deref()
    }

    /// Returns the state of guide `i` at the press.
    pub fn pressed(&self, i: usize) -> Arc<PressState> {
        let new = || Arc::new(PressState::new(self.document.guide(i), self.field()));
        self.pressed[i].clone().unwrap_or_else(new)
    }

    /// Gives each of `guides` the vertices that `of` returns, and the state at the press.
    pub fn dab<F>(&mut self, guides: &[usize], of: F)
    where
        F: Fn(&Self, usize) -> Option<(Vec<Vec3>, Arc<PressState>)> + Sync,
    {
        self.dab_count += 1;
        let each = |i: &usize| of(self, *i);
        let changes = match guides.len() < MANY {
            true => guides.iter().map(each).collect(),
            false => in_parallel(guides, each),
        };
        for (&i, (vertices, press)) in guides.iter().zip(changes).filter_map(|(i, it)| Some((i, it?))) {
            self.guides.set(i, &vertices, self.ground.field.as_deref());
            self.pressed[i] = Some(press);
        }
    }

    /// Returns the guides that the stroke has moved.
    pub fn touched(&self) -> Vec<usize> {
        (0..self.pressed.len()).filter(|i| self.pressed[*i].is_some()).collect()
    }

    /// Gives guides that the stroke has moved the shapes of the document.
    pub fn restore(&mut self) {
        for i in self.touched() {
            self.guides.set(i, self.document.guide(i), self.ground.field.as_deref());
        }
    }

    /// Returns `of` for each strand before the stroke.
    pub fn map_strands<T: Send>(&self, of: impl Fn(&[Vec3]) -> T + Sync) -> Vec<T> {
        let strands = self.document.unshaped();
        let all: Vec<usize> = (0..strands.base().strands.len()).collect();
        in_parallel(&all, |i| of(&strands.strand(*i).0))
    }

    /// Returns the distance along the ray to what `tool` acts on under it, hair or skin, meters; `None` beside both.
    /// Hair is up to `max_offset` meters from the ray.
    pub fn depth(&self, tool: BrushTool, sample: &StrokeSample, max_offset: f32) -> Option<f32> {
        let (origin, direction) = (sample.origin, sample.direction);
        if tool.acts_on_roots() {
            return self.ground.trace(origin, direction);
        }
        let skin = self.field().and_then(|field| field.trace(origin, direction, 0.0));
        self.guides.depth(sample, max_offset, skin.map_or(f32::MAX, |skin| skin + self.guides.pick)).or(skin)
    }

    /// Whether `brush` acts on guide `i` and the strands that follow it most: they are of its layer, and not held.
    pub fn is_open(&self, brush: &Brush, i: usize) -> bool {
        let group = || self.base.guides.groups.get(i).copied().unwrap_or_default();
        let held = self.painted_values.held[i] && brush.tool != BrushTool::Hold;
        !held && brush.layer.is_none_or(|layer| group() == layer)
    }

    /// Returns the guides that `dabs` may reach and that take part in the stroke with `seed`.
    pub fn affected(&self, brush: &Brush, seed: u32, dabs: &[Dab]) -> Vec<usize> {
        let pinned = &self.base.guides.tip_pinned;
        let overlap_tests: Vec<_> = dabs.iter().map(|dab| dab.overlap_test(brush.region)).collect();
        let takes_part = |i: &usize| {
            !pinned[*i]
                && self.is_open(brush, *i)
                && (brush.guide_fraction >= 1.0 || chance(seed, *i as u32) < brush.guide_fraction)
                && overlap_tests.iter().any(|overlaps| overlaps(self.guides.spheres[*i]))
        };
        (0..self.guides.len()).filter(takes_part).collect()
    }
}
