//! Strokes that cut: the strands under the brush, or along a path, with the share that is left of each.

use super::{
    Brush, BrushRegion,
    deform::DeformedStrands,
    hair::EditedHair,
    line::{Crossing, CutPath},
    tools::Dab,
};
use crate::progress::in_parallel;

/// Returns the strands that `dabs` cut.
pub(super) fn by_brush(
    hair: &EditedHair,
    strands: &DeformedStrands,
    brush: &Brush,
    seed: u32,
    dabs: &[Dab],
) -> Vec<(usize, f32)> {
    let mut is_affected = vec![false; hair.guides.len()];
    hair.affected(brush, seed, dabs).into_iter().for_each(|guide| is_affected[guide] = true);
    let bindings = &strands.base().strands.bindings;
    let of: Vec<usize> =
        (0..bindings.len()).filter(|i| is_affected[bindings[*i].guides[0] as usize]).collect();
    let cut = |i: &usize| {
        let line = strands.strand(*i).0;
        let entry = |dab: &Dab| dab.entry(&line, brush);
        let entry = dabs.iter().filter_map(entry).reduce(f32::min)?;
        brush.takes(seed, *i as u32).then_some((*i, entry / (line.len() - 1) as f32))
    };
    in_parallel(&of, cut).into_iter().flatten().collect()
}

/// Returns the strands that cross a path.
///
/// Painted curls are left out: guides have none, and sines are not the same on all machines.
pub(super) fn along_path(hair: &EditedHair, path: CutPath, brush: &Brush, seed: u32) -> Vec<(usize, f32)> {
    let mirrored = brush.mirror.then(|| path.mirrored(hair.document.mirror_x()));
    let paths: Vec<CutPath> = std::iter::once(path).chain(mirrored).collect();
    let strands = hair.document.unshaped();
    let base = &strands.base().strands;
    let is_open =
        |i: &usize| brush.takes(seed, *i as u32) && hair.is_open(brush, base.bindings[*i].guides[0] as usize);
    let all: Vec<usize> = (0..base.len()).filter(is_open).collect();
    let through = brush.region == BrushRegion::Through;
    let mut cut = vec![f32::MAX; all.len()];
    for path in &paths {
        let crossings = in_parallel(&all, |i| path.crossings(&strands.strand(*i).0));
        let front = path.front(crossings.iter().flatten(), hair.field());
        for (cut, crossings) in cut.iter_mut().zip(&crossings) {
            let is_cut = |crossing: &&Crossing| through || crossing.depth <= front[crossing.bin()];
            if let Some(first) = crossings.iter().find(is_cut) {
                *cut = cut.min(first.at);
            }
        }
    }
    let last = (base.vertex_count - 1) as f32;
    let cut = all.into_iter().zip(cut).filter(|(_, at)| *at < f32::MAX).map(|(i, at)| (i, at / last));
    cut.collect()
}
