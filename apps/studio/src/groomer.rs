//! Grooming: the brushes of the window, and the groom under them.

use anyhow::Result;
use tresses::glam::Vec3;
use tresses::groom::edit::{
    Brush, BrushTool, GroomDocument, GroomEditor, ScriptStep, StrokeSample, StrokeScript,
};
use web_time::Instant;

/// Time after a stroke until the hair is made anew from it, s.
pub const SETTLE: f32 = 0.3;
/// Range of a brush's radius in the window, meters.
pub const RADII: std::ops::RangeInclusive<f32> = 1e-3..=0.15;

/// A brush for each tool. They share radius, reach, symmetry and layer.
#[derive(Clone, Debug)]
pub struct BrushKit([Brush; BrushTool::ALL.len()]);

impl Default for BrushKit {
    fn default() -> Self {
        Self(BrushTool::ALL.map(|(tool, _)| Brush::of(tool)))
    }
}

impl BrushKit {
    /// Returns the brush of `tool`.
    pub fn brush(&self, tool: BrushTool) -> Brush {
        self.0.iter().find(|brush| brush.tool == tool).copied().unwrap_or_default()
    }

    /// Sets the brush of its tool.
    pub fn set(&mut self, changed: Brush) {
        for brush in &mut self.0 {
            if brush.tool == changed.tool {
                *brush = changed;
            }
            (brush.radius, brush.region, brush.mirror, brush.layer) =
                (changed.radius, changed.region, changed.mirror, changed.layer);
        }
    }

    /// Multiplies the radius of all brushes.
    pub fn scale(&mut self, factor: f32) {
        let radius = (self.0[0].radius * factor).clamp(*RADII.start(), *RADII.end());
        self.0.iter_mut().for_each(|brush| brush.radius = radius);
    }

    /// Returns the brush that acts: with Shift it smooths, with Ctrl it acts the other way round.
    pub fn acting(&self, tool: BrushTool, shift: bool, ctrl: bool) -> Brush {
        let tool = if shift { BrushTool::Smooth } else { tool };
        Brush { inverted: ctrl, ..self.brush(tool) }
    }
}

/// A stroke that has ended, with the hashes of the versions before and after it: versions take memory.
#[derive(Debug)]
struct Step {
    before: u64,
    after: u64,
    stroke: ScriptStep,
}

/// The groom under the brush.
#[derive(Debug)]
pub struct Groomer {
    editor: GroomEditor,
    steps: Vec<Step>,
    /// The current stroke: its beginning, brush and samples.
    started: Instant,
    brush: Brush,
    samples: Vec<StrokeSample>,
    /// End of the last stroke or undo.
    ended: Instant,
    /// Hash of the document.
    hash: u64,
    /// Whether the guides must be put into the hair on the screen again, although they have not moved.
    pub pose_due: bool,
    /// Duration of the last frame's dabs, milliseconds.
    pub milliseconds: f32,
}

impl Groomer {
    /// Opens a groom.
    pub fn new(editor: GroomEditor) -> Self {
        let now = Instant::now();
        Self {
            hash: editor.document().hash(),
            editor,
            steps: Vec::new(),
            started: now,
            brush: Brush::default(),
            samples: Vec::new(),
            ended: now,
            pose_due: true,
            milliseconds: 0.0,
        }
    }

    /// Returns the version before the current stroke.
    pub fn document(&self) -> &GroomDocument {
        self.editor.document()
    }

    /// Returns the groups of hair, in order.
    pub fn groups(&self) -> Vec<i32> {
        let mut groups = self.document().base().guides.groups.clone();
        groups.sort_unstable();
        groups.dedup();
        if groups.is_empty() { vec![0] } else { groups }
    }

    /// Returns the editor.
    pub fn editor(&self) -> &GroomEditor {
        &self.editor
    }

    /// Returns the hash of the guides.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Whether the guides must be put into the hair on the screen since the last call.
    pub fn take_pose_due(&mut self) -> bool {
        self.editor.take_changed() | std::mem::take(&mut self.pose_due)
    }

    /// Whether the hair on the screen, made from `shown`, is to be made anew. Returns how long to wait, s.
    pub fn settles(&self, shown: Option<&GroomDocument>) -> Option<f32> {
        let is_old = shown.is_none_or(|shown| shown != self.document());
        // Guides show shapes at once, but not lengths.
        let wait = if shown.is_some_and(|shown| shown.is_pose_of(self.document())) { SETTLE } else { 0.0 };
        (is_old && !self.editor.is_active()).then(|| (wait - self.ended.elapsed().as_secs_f32()).max(0.0))
    }

    /// Begins a stroke; `false` if there is nothing under the sample.
    ///
    /// # Errors
    /// As [`GroomEditor::press`].
    pub fn press(&mut self, brush: &Brush, sample: &StrokeSample) -> Result<bool> {
        let begins = self.editor.press(brush, sample)?;
        if begins {
            (self.started, self.brush, self.samples) = (Instant::now(), *brush, vec![*sample]);
        }
        Ok(begins)
    }

    /// Moves the brush.
    ///
    /// # Errors
    /// As [`GroomEditor::drag`].
    pub fn drag(&mut self, sample: StrokeSample) -> Result<()> {
        let sample = StrokeSample { time: self.started.elapsed().as_secs_f32(), ..sample };
        self.samples.push(sample);
        Ok(self.editor.drag(&sample)?)
    }

    /// Ends the stroke. Returns the new version and the name of the tool, if anything has moved.
    pub fn release(&mut self) -> Option<(GroomDocument, String)> {
        let after = self.editor.release()?;
        let samples = std::mem::take(&mut self.samples);
        self.step(ScriptStep::Stroke { brush: self.brush, samples });
        Some((after, title(self.brush.tool)))
    }

    /// Records what led to the current version.
    fn step(&mut self, stroke: ScriptStep) {
        let (before, after) = (self.hash, self.document().hash());
        self.steps.push(Step { before, after, stroke });
        (self.ended, self.hash) = (Instant::now(), after);
    }

    /// Gives the guides the shapes of simulated ones. Returns the new version if any differs.
    ///
    /// # Errors
    /// As [`GroomEditor::keep`].
    pub fn keep(&mut self, positions: &[Vec3]) -> Result<Option<GroomDocument>> {
        let before = self.document().clone();
        let Some(after) = self.editor.keep(positions)? else { return Ok(None) };
        let changed = after.guides().differing(before.guides());
        let guides = changed.map(|i| (i, after.guide(i).to_vec())).collect();
        self.step(ScriptStep::Pose(guides));
        Ok(Some(after))
    }

    /// Takes the current stroke back.
    pub fn cancel(&mut self) {
        self.editor.cancel();
    }

    /// Shows another version.
    ///
    /// # Errors
    /// As [`GroomEditor::go_to`].
    pub fn go_to(&mut self, document: GroomDocument) -> Result<()> {
        self.editor.go_to(document)?;
        (self.ended, self.hash) = (Instant::now(), self.document().hash());
        Ok(())
    }

    /// Returns the strokes that lead to the current version, without those that were undone, the last first.
    fn strokes(&self) -> impl Iterator<Item = &ScriptStep> {
        let (mut at, mut left) = (self.hash, &self.steps[..]);
        std::iter::from_fn(move || {
            let last = left.iter().rposition(|step| step.after == at)?;
            let step = &left[last];
            (at, left) = (step.before, &left[..last]);
            Some(&step.stroke)
        })
    }

    /// Returns the number of strokes that lead to the current version.
    pub fn stroke_count(&self) -> usize {
        self.strokes().count()
    }

    /// Returns the strokes that lead to the current version, without those that were undone.
    pub fn script(&self) -> StrokeScript {
        let mut steps: Vec<_> = self.strokes().cloned().collect();
        steps.reverse();
        StrokeScript { steps }
    }
}

/// Returns the title of a tool on buttons and in the history.
pub fn title(tool: BrushTool) -> String {
    let (first, rest) = tool.name().split_at(1);
    first.to_uppercase() + rest + if tool.draws() { " cut" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brushes_share_radius_reach_and_symmetry() {
        let mut kit = BrushKit::default();
        kit.set(Brush { radius: 0.05, strength: 0.9, mirror: false, ..kit.brush(BrushTool::Comb) });
        let puff = kit.brush(BrushTool::Puff);
        assert_eq!((puff.radius, puff.mirror), (0.05, false));
        assert!(puff.strength < 0.9 && kit.brush(BrushTool::Comb).strength == 0.9);
        kit.scale(100.0);
        assert_eq!(kit.brush(BrushTool::Lay).radius, *RADII.end());
        assert_eq!(kit.acting(BrushTool::Comb, true, false).tool, BrushTool::Smooth);
        assert!(kit.acting(BrushTool::Puff, false, true).inverted);
        assert!(BrushTool::ALL.iter().all(|(tool, name)| title(*tool).to_lowercase().starts_with(name)));
    }
}
