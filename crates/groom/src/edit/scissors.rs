//! Strokes that cut.

use super::{
    BrushTool, GroomEditor, Reach,
    carry::CarriedStrands,
    editor::ActiveStroke,
    line::{Crossing, CutPath},
    tools::Dab,
};
use crate::progress::in_parallel;

impl GroomEditor {
    /// Returns the carried strands, and the followers of each guide.
    ///
    /// Painted curls are left out: guides have none, and sines are not the same on all machines.
    pub(super) fn strands(&self) -> (CarriedStrands, Vec<Vec<u32>>) {
        let strands = self.document.unshaped();
        let mut followers = vec![Vec::new(); self.spheres.len()];
        for (i, binding) in (0u32..).zip(&strands.base().strands.bindings) {
            followers[binding.guides[0] as usize].push(i);
        }
        (strands, followers)
    }

    /// Returns the strands that `dabs` cut, with the share that is left of each.
    pub(super) fn cut(&self, stroke: &ActiveStroke, dabs: &[Dab]) -> Vec<(usize, f32)> {
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

    /// Cuts the hair that crosses the line of the stroke, or enters its outline.
    pub(super) fn cut_path(&mut self) {
        let Some(stroke) = &self.stroke else { return };
        let path = match stroke.brush.tool {
            BrushTool::Lasso => CutPath::outline(&stroke.outline),
            _ => Some(CutPath::line(&stroke.first, &stroke.last)),
        };
        let Some(path) = path else { return };
        let mirrored = stroke.brush.mirror.then(|| path.mirrored(self.document.middle()));
        let paths: Vec<CutPath> = std::iter::once(path).chain(mirrored).collect();
        let (strands, _) = self.strands();
        let all: Vec<usize> = (0..strands.base().strands.len())
            .filter(|i| {
                let guide = strands.base().strands.bindings[*i].guides[0] as usize;
                stroke.takes(*i as u32) && self.is_open(&stroke.brush, guide)
            })
            .collect();
        let crossings = |path: &CutPath| -> Vec<Vec<Crossing>> {
            in_parallel(&all, |i| path.crossings(&strands.strand(*i).0))
        };
        let through = stroke.brush.reach == Reach::Through;
        let mut cut = vec![f32::MAX; all.len()];
        for path in &paths {
            let crossings = crossings(path);
            let front = path.front(crossings.iter().flatten(), self.ground.field.as_deref());
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

    pub(super) fn shorten(&mut self, cut: Vec<(usize, f32)>) {
        self.dab_count += 1;
        let Some(stroke) = &mut self.stroke else { return };
        for (i, share) in cut {
            let left = stroke.lengths.strands.entry(i).or_insert(1.0);
            *left = left.min(share);
        }
    }
}
