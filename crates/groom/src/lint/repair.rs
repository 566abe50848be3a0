//! Repairs grooms for all later stages.

use glam::Vec3;

use super::{MIN_SEGMENT, MIN_STRAND};
use crate::{MAX_STRAND_VERTICES, Strands};

/// Counts of what a repair changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct RepairReport {
    /// Vertices merged with the one before them, or removed because they are not finite.
    pub merged_vertices: usize,
    /// Dropped strands, which had one vertex or no length.
    pub dropped_strands: usize,
    /// Resampled strands, which had more vertices than can be drawn.
    pub resampled_strands: usize,
}

/// Merges coincident vertices, drops strands without length, and resamples strands with too many vertices. Roots and
/// tips stay in place, and attributes follow their vertices. A second repair changes nothing.
pub fn repair(strands: &mut Strands) -> RepairReport {
    repair_kept(strands).0
}

/// [`repair`] that also returns the indices of the strands that are left.
pub fn repair_kept(strands: &mut Strands) -> (RepairReport, Vec<u32>) {
    let mut done = RepairReport::default();
    let mut left = Vec::with_capacity(strands.len());
    let limit = MAX_STRAND_VERTICES as usize;
    let mut out = strands.emptied();
    for i in 0..strands.len() {
        let range = strands.range(i);
        let kept = keep(&strands.positions[range.clone()]);
        let at = |k: &usize| range.start + k;
        let length: f32 = kept
            .windows(2)
            .map(|w| strands.positions[at(&w[0])].distance(strands.positions[at(&w[1])]))
            .sum();
        if kept.len() < 2 || !length.is_finite() || length < MIN_STRAND {
            done.dropped_strands += 1;
            continue;
        }
        left.push(i as u32);
        done.merged_vertices += range.len() - kept.len();
        let samples: Vec<(usize, usize, f32)> = if kept.len() > limit {
            done.resampled_strands += 1;
            resample(&kept.iter().map(|k| strands.positions[at(k)]).collect::<Vec<_>>(), length, limit)
                .into_iter()
                .map(|(k, t)| (at(&kept[k]), at(&kept[k + 1]), t))
                // Interpolation would round the tip; copy it exactly.
                .map(|(a, b, t)| if t < 1.0 { (a, b, t) } else { (b, b, 0.0) })
                .collect()
        } else {
            kept.iter().map(|k| (at(k), at(k), 0.0)).collect()
        };
        for (a, b, t) in samples {
            out.push_between(strands, [a, b], t);
        }
        out.end_like(strands, i);
    }
    // Discard impossible widths, and attributes that are not finite.
    if out.radii.iter().any(|r| !r.is_finite() || *r < 0.0) || out.radii.iter().all(|r| *r == 0.0) {
        out.radii.clear();
    }
    if out.colors.iter().any(|c| !c.is_finite()) {
        out.colors.clear();
    }
    if out.root_uvs.iter().any(|uv| !uv.is_finite()) {
        out.root_uvs.clear();
    }
    let (count, vertices) = (out.len(), out.positions.len());
    out.attributes.retain(|attribute| attribute.fits(count, vertices));
    *strands = out;
    (done, left)
}

/// Returns the vertices of a strand to keep: finite, and each at least [`MIN_SEGMENT`] from the one before.
fn keep(strand: &[Vec3]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(strand.len());
    let far = |a: usize, b: usize| strand[a].distance(strand[b]) >= MIN_SEGMENT;
    let mut tip = None;
    for i in (0..strand.len()).filter(|i| strand[*i].is_finite()) {
        tip = Some(i);
        if kept.last().is_none_or(|last| far(*last, i)) {
            kept.push(i);
        }
    }
    // Keep the tip, and drop vertices that are too close before it.
    if let Some(tip) = tip.filter(|tip| kept.last() != Some(tip)) {
        while kept.len() > 1 && kept.last().is_some_and(|last| !far(*last, tip)) {
            kept.pop();
        }
        if kept.last().is_some_and(|last| far(*last, tip)) {
            kept.push(tip);
        }
    }
    kept
}

/// Returns `count` locations at equal distances along `points`: segment and fraction of it.
fn resample(points: &[Vec3], length: f32, count: usize) -> Vec<(usize, f32)> {
    let (mut segment, mut before) = (0, 0.0);
    let last = points.len() - 2;
    (0..count)
        .map(|i| {
            if i + 1 == count {
                return (last, 1.0);
            }
            let goal = length * i as f32 / (count - 1) as f32;
            let mut segment_length = points[segment].distance(points[segment + 1]);
            while segment < last && before + segment_length < goal {
                before += segment_length;
                segment += 1;
                segment_length = points[segment].distance(points[segment + 1]);
            }
            (segment, ((goal - before) / segment_length).clamp(0.0, 1.0))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(n: usize, step: f32) -> Vec<Vec3> {
        (0..n).map(|i| Vec3::Y * (i as f32 * step)).collect()
    }

    #[test]
    fn duplicates_merge_and_ends_stay() {
        let mut strands = Strands::default();
        let (a, b, c) = (Vec3::ZERO, Vec3::X * 0.1, Vec3::X * 0.2);
        strands.push(&[a, a, b, b, c, c + Vec3::X * 1e-6]);
        strands.radii = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let done = repair(&mut strands);
        assert_eq!(strands.strand(0), &[a, b, c + Vec3::X * 1e-6]);
        assert_eq!(strands.radii, vec![1.0, 3.0, 6.0]);
        assert_eq!(done, RepairReport { merged_vertices: 3, ..Default::default() });
    }

    #[test]
    fn strands_without_length_are_dropped() {
        let mut strands = Strands::default();
        strands.push(&[Vec3::X]);
        strands.push(&[Vec3::X, Vec3::X, Vec3::X]);
        strands.push(&line(3, 0.01));
        strands.push(&[Vec3::NAN, Vec3::X]);
        strands.root_uvs = (0..4).map(|i| glam::Vec2::splat(i as f32)).collect();
        let done = repair(&mut strands);
        assert_eq!((done.dropped_strands, strands.len()), (3, 1));
        assert_eq!(strands.root_uvs, vec![glam::Vec2::splat(2.0)]);
        let before = strands.clone();
        assert_eq!(repair(&mut strands), RepairReport::default());
        assert_eq!(strands, before);
    }

    #[test]
    fn long_strands_are_resampled_evenly() {
        let mut strands = Strands::default();
        strands.push(&line(1000, 0.001));
        strands.colors = (0..1000).map(|i| Vec3::splat(i as f32)).collect();
        assert_eq!(repair(&mut strands).resampled_strands, 1);
        assert_eq!(strands.positions.len(), MAX_STRAND_VERTICES as usize);
        let step = 0.999 / 63.0;
        for (i, p) in strands.positions.iter().enumerate() {
            assert!((p.y - step * i as f32).abs() < 1e-4, "{i}: {p}");
            assert!((strands.colors[i].x - p.y * 1000.0).abs() < 0.1);
        }
        assert_eq!(strands.positions[63], line(1000, 0.001)[999]);
    }
}
