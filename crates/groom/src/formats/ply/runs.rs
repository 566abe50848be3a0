//! Strands in points without edges.
//!
//! Reconstructions write the same number of points for each strand: 100 in HAAR, NeuralHaircut and GaussianHaircut. The
//! first two give each strand a random color of its own.

use glam::Vec3;

/// Numbers of points per strand that are tried, the most usual first.
const LENGTHS: [usize; 6] = [100, 256, 128, 64, 50, 32];
/// Step between strands relative to the median step within them, and the share of strands where it is at least that.
const JUMP: f32 = 6.0;
const MIN_FRACTION: f32 = 0.95;
/// Share of neighboring strands that may have the same random color.
const MAX_SAME_COLOR: f32 = 0.05;

/// Returns the number of points per strand; `None` if the points do not tell. `colors` is empty, or has one per point.
pub(super) fn length(points: &[Vec3], colors: &[[u8; 3]]) -> Option<usize> {
    let fits = |length: &usize| points.len().is_multiple_of(*length) && points.len() > *length;
    LENGTHS.into_iter().filter(fits).find(|length| has_colors(colors, *length) || has_jumps(points, *length))
}

/// Whether each strand has one color, and neighbors differ.
fn has_colors(colors: &[[u8; 3]], length: usize) -> bool {
    let strands: Vec<&[[u8; 3]]> = colors.chunks_exact(length).collect();
    let is_one = |strand: &&[[u8; 3]]| strand.iter().all(|color| *color == strand[0]);
    let same = strands.windows(2).filter(|pair| pair[0][0] == pair[1][0]).count();
    strands.len() > 1 && strands.iter().all(is_one) && (same as f32) < MAX_SAME_COLOR * strands.len() as f32
}

/// Whether nearly all steps between strands are far longer than those within them.
fn has_jumps(points: &[Vec3], length: usize) -> bool {
    let (mut within, mut between) = (Vec::new(), Vec::new());
    for (i, pair) in points.windows(2).enumerate() {
        let step = pair[0].distance(pair[1]);
        if (i + 1) % length == 0 { between.push(step) } else { within.push(step) }
    }
    within.sort_by(f32::total_cmp);
    let median = within[within.len() / 2];
    let jumps = |steps: &[f32]| steps.iter().filter(|step| **step > JUMP * median).count() as f32;
    median > 0.0
        && jumps(&between) >= MIN_FRACTION * between.len() as f32
        && jumps(&within) <= (1.0 - MIN_FRACTION) * between.len() as f32
}
