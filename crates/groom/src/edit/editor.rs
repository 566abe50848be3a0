//! The editor: a groom under a brush, from version to version.

use super::{
    Brush, BrushTool, GroomDocument,
    ground::Ground,
    hair::EditedHair,
    painted_values::PaintedValues,
    sample::StrokeSample,
    solve::{PressState, Solver},
    stroke::ActiveStroke,
};
use crate::{Error, Result, SdfGrid, TriMesh, mesh::Bvh, progress::in_parallel};
use glam::Vec3;
use std::sync::Arc;

/// Distance from which a shape is another, meters.
const KEPT: f32 = 1e-4;

/// A groom under a brush.
#[derive(Debug)]
pub struct GroomEditor {
    hair: EditedHair,
    stroke: Option<ActiveStroke>,
}

impl GroomEditor {
    /// Opens `document`. `field` is the distance field of the whole body at rest: no hair enters it.
    pub fn new(document: GroomDocument, field: Option<Arc<SdfGrid>>) -> Self {
        Self { hair: EditedHair::new(document, Ground { field, mesh: None }), stroke: None }
    }

    /// Plants hair on `body`, the mesh of the distance field. Without it, roots lie where the field is zero.
    #[must_use]
    pub fn on_skin(mut self, body: &TriMesh) -> Self {
        self.hair.ground.mesh = Some(Arc::new((body.clone(), Bvh::new(body))));
        self
    }

    /// Returns the version before the current stroke.
    pub fn document(&self) -> &GroomDocument {
        &self.hair.document
    }

    /// Returns the distance field that no hair enters.
    pub fn field(&self) -> Option<&SdfGrid> {
        self.hair.field()
    }

    /// Returns the current positions of the guides, guide after guide.
    pub fn positions(&self) -> &[Vec3] {
        &self.hair.guides.positions
    }

    /// Whether guides have moved since the last call.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.hair.guides.changed)
    }

    /// Returns how often a brush has been applied so far.
    pub fn dab_count(&self) -> u64 {
        self.hair.dab_count
    }

    /// Returns the sights of the line or outline that is being drawn; empty without one.
    pub fn drawn(&self) -> Vec<StrokeSample> {
        match self.stroke.as_ref().map(|stroke| (stroke, stroke.brush.tool)) {
            Some((stroke, BrushTool::Line)) => vec![stroke.outline[0], stroke.last],
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
        self.stroke.as_ref().map(|stroke| (stroke.center(), stroke.brush.radius))
    }

    /// Returns the new guides of the current stroke, and the roots of strands that it removes.
    pub fn root_marks(&self) -> (&[Vec<Vec3>], Vec<Vec3>) {
        self.stroke.as_ref().map_or((&[], Vec::new()), |stroke| stroke.roots.marks())
    }

    /// Returns the painted values, with the changes of the current stroke.
    fn painted_values(&self) -> &PaintedValues {
        let painted = self.stroke.as_ref().and_then(|stroke| stroke.paint.as_ref());
        painted.map_or(&self.hair.painted_values, |paint| &paint.painted_values)
    }

    /// Returns root, normal of the skin and stiffness of each guide. The last is relative to that before the first
    /// stroke.
    pub fn stiffness(&self) -> Vec<(Vec3, Vec3, f32)> {
        let pairs = self.painted_values().stiffness.iter().zip(&self.hair.base.guides.stiffness);
        self.hair.guides.at_roots(pairs.map(|(now, first)| now / first.max(1e-6))).collect()
    }

    /// Returns root and normal of the skin of each guide, and whether it is held.
    pub fn held(&self) -> impl Iterator<Item = (Vec3, Vec3, bool)> {
        self.hair.guides.at_roots(self.painted_values().held.iter().copied())
    }

    /// Returns root and normal of the skin of each guide, and how much of the effect of `tool` its hair has, 0 to 1.
    pub fn amounts(&self, tool: BrushTool) -> Vec<(Vec3, Vec3, f32)> {
        let mut sums = vec![(0.0, 0.0f32); self.hair.guides.len()];
        for (shape, binding) in self.painted_values().shapes.iter().zip(&self.hair.base.strands.bindings) {
            let amount = match tool {
                BrushTool::Clump => shape.clump,
                BrushTool::Curl => shape.curl,
                _ => shape.frizz,
            };
            let sum = &mut sums[binding.guides[0] as usize];
            *sum = (sum.0 + f32::from(amount) / 255.0, sum.1 + 1.0);
        }
        let means = sums.into_iter().map(|(sum, count)| sum / count.max(1.0));
        self.hair.guides.at_roots(means).collect()
    }

    /// Returns the distance along the ray to what `tool` acts on under it, hair or skin, meters; `None` beside both.
    pub fn hit(&self, tool: BrushTool, sample: &StrokeSample) -> Option<f32> {
        self.hair.depth(tool, sample, self.hair.guides.pick)
    }

    /// Shows another version of the same groom.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a version of another groom.
    pub fn go_to(&mut self, document: GroomDocument) -> Result<()> {
        if !document.is_version_of(&self.hair.document) {
            return Err(Error::Unusable("the version belongs to another groom".into()));
        }
        self.cancel();
        self.hair.go_to(document);
        Ok(())
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
        self.stroke = ActiveStroke::begin(&mut self.hair, brush, sample);
        Ok(self.is_active())
    }

    /// Moves the brush to `sample`. Does nothing without a stroke.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a sample that is not finite.
    pub fn drag(&mut self, sample: &StrokeSample) -> Result<()> {
        sample.check()?;
        if let Some(stroke) = &mut self.stroke {
            stroke.drag(&mut self.hair, sample);
        }
        Ok(())
    }

    /// Ends the stroke. Returns the new version, or `None` if nothing has moved.
    pub fn release(&mut self) -> Option<GroomDocument> {
        self.stroke.take()?.release(&mut self.hair).then(|| self.hair.document.clone())
    }

    /// Ends the stroke and takes it back.
    pub fn cancel(&mut self) {
        if self.stroke.take().is_some() {
            self.hair.restore();
        }
    }

    /// Gives the guides the shapes of `positions` (groom space, meters, guide after guide), for example of simulated
    /// hair. Roots and lengths stay, and nothing enters the head. Returns the new version, or `None` if no vertex is
    /// farther than a tenth of a millimeter from it.
    ///
    /// # Errors
    /// [`Error::Unusable`] for another number of positions, or for one that is not finite.
    pub fn keep(&mut self, positions: &[Vec3]) -> Result<Option<GroomDocument>> {
        self.cancel();
        let (hair, n) = (&self.hair, self.hair.document.vertex_count());
        if positions.len() != self.positions().len() || !positions.iter().all(|p| p.is_finite()) {
            return Err(Error::Unusable("the positions do not belong to the guides of this groom".into()));
        }
        let kept = |i: usize| &positions[i * n..][..n];
        let differ = |i: &usize| {
            let mut pairs = hair.guides.guide(*i).iter().zip(kept(*i)).skip(1);
            pairs.any(|(now, kept)| now.distance(*kept) > KEPT)
        };
        let changed: Vec<usize> = (0..hair.guides.len()).filter(differ).collect();
        let solver = Solver { field: hair.field(), keep_shape: 0.0, keep_volume: 0.0, bend: None };
        let near = vec![1.0; n];
        let solved = in_parallel(&changed, |i| {
            let guide = hair.guides.guide(*i);
            solver.solve(guide, kept(*i), &near, 1, &PressState::new(guide, hair.field()))
        });
        let document = hair.document.with(changed.into_iter().zip(solved.iter().map(Vec::as_slice)));
        if document == hair.document {
            return Ok(None);
        }
        self.hair.go_to(document.clone());
        Ok(Some(document))
    }
}
