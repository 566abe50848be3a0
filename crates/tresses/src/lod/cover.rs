//! Coverage and brightness of wider strands. Few wide strands cover more than many thin ones of the same
//! area, because they cover gaps and reach beyond outlines; a coarse pixel covers more as well, because
//! strands within it are treated as overlapping at random. The eye then sees less or more deeply into the
//! hair, where less light arrives. Factors that correct both are measured on the CPU at load
//! ([`seen`](super::seen)).

use super::{
    curve::CurveTable,
    lit::{Lit, fibers},
    seen::{Pictures, Strip},
};
use crate::{Progress, groom::BoundStrands, strands::Strand};
use glam::Vec3;

/// At most so many strands stand for all of them.
const MOST: usize = 6000;
/// The smallest share of strands that is looked at.
const LEAST: f32 = 0.004;
/// The narrowest that strands are made.
const NARROWEST: f32 = 0.3;
/// The widest.
const WIDEST: f32 = 1.5;

/// On widths, and on the fibres before what is seen: towards a light on the eye's side, and one behind.
type Factors = [f32; 3];

/// The factors of a groom on the widths of fewer strands, and on what light meets of them.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverTable {
    /// Share of the strands and the factors that belong to it, shares falling from 1: in a picture as fine
    /// as can be, and with the pixel of [`CoverLevel`].
    points: [Vec<(f32, Factors)>; 2],
}

/// A level of detail whose coverage is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoverLevel {
    /// Share of the strands.
    pub fraction: f32,
    /// The share that is there at least, those that are narrower for it included.
    pub drawn: f32,
    /// The factor on their widths that keeps their area.
    pub widening: f32,
    /// Their segments.
    pub segments: f32,
    /// The pixel at which that level is chosen, metres.
    pub pixel: f32,
}

impl CoverTable {
    /// Nothing known: as wide as their area wants.
    pub fn none() -> Self {
        Self { points: [vec![(1.0, [1.0; 3])], vec![(1.0, [1.0; 3])]] }
    }

    /// For `strands` in the order of [`arrange`](super::arrange) with the radii of `infos`, inside `sphere`
    /// (its middle and radius, metres), at `levels` with falling shares.
    pub async fn new(
        strands: &BoundStrands,
        infos: &[Strand],
        sphere: (Vec3, f32),
        levels: &[CoverLevel],
        progress: &impl Progress,
    ) -> Self {
        const TASK: &str = "measuring levels of detail";
        let mut table = Self::none();
        let base = infos.len().min(MOST);
        if base == 0 || sphere.1 <= 0.0 || strands.vertex_count < 2 {
            return table;
        }
        let strips = |count: usize, segments: Option<f32>| -> Vec<Strip> {
            (0..count).map(|i| Strip::new(strands, infos, i, segments)).collect()
        };
        // Where the base is not all strands it stands for them, a little wider.
        let share = base as f32 / infos.len() as f32;
        let all = strips(base, None);
        progress.step(TASK, 0.0).await;
        let mut pictures = Pictures::new(&all, sphere);
        let fine = pictures.finest();
        let full = pictures.covered(share.recip(), fine, |_, _, _| ());
        progress.step(TASK, 0.1).await;
        let seen = pictures.seen(share.recip(), fine);
        progress.step(TASK, 0.3).await;
        let lit = Lit::new(&seen, &fibers(&all, sphere, share.recip()), share.recip());
        drop((pictures, all, seen));
        for (i, level) in levels.iter().enumerate() {
            // Each level has half the strands of the one before.
            let done = 1.0 - 0.6 * 0.5f32.powi(i as i32);
            let count = (level.drawn * infos.len() as f32).ceil() as usize;
            // Nor is anything known of hair a few pixels large.
            if count >= base || level.pixel > 0.5 * sphere.1 {
                continue;
            }
            progress.step(TASK, done).await;
            let strips = strips(count.max(1), Some(level.segments));
            let mut pictures = Pictures::new(&strips, sphere);
            let fibers = fibers(&strips, sphere, level.widening);
            progress.step(TASK, done).await;
            for (points, cell) in table.points.iter_mut().zip([fine, level.pixel.max(fine)]) {
                // The secant method: coverage grows smoothly, and ever slower, with the width.
                let (mut a, mut b) = (1.0, 0.85);
                let mut cover = |factor: f32| pictures.covered(level.widening * factor, cell, |_, _, _| ());
                let (mut at_a, mut at_b) = (cover(a), cover(b));
                for _ in 0..3 {
                    let slope = (at_a - at_b) / (a - b);
                    if !slope.is_finite() || slope < 1e-9 {
                        break;
                    }
                    let next = (b + (full - at_b) / slope).clamp(NARROWEST, WIDEST);
                    (a, at_a, b) = (b, at_b, next);
                    if (a - b).abs() < 2e-3 {
                        break;
                    }
                    progress.step(TASK, done).await;
                    at_b = cover(b);
                }
                let seen = pictures.seen(level.widening * b, cell);
                // Shadow maps hold the area of full detail.
                let [before, behind] = lit.matching(&Lit::new(&seen, &fibers, level.widening));
                points.push((level.fraction, [b, before, behind]));
            }
        }
        table
    }

    /// The factors where the share `fraction` of the strands is drawn, and the pixel is that at which the
    /// share `automatic` would be: on their widths; on the fibres before what is seen where light comes from the
    /// eye's side; and where it comes from behind the hair.
    ///
    /// The last two are such that what the eye sees of the hair is on average as light as what it sees of it at
    /// full detail: narrower strands let it see deeper, wide ones close gaps that it would have looked into,
    /// and few segments cut corners.
    pub fn factors(&self, fraction: f32, automatic: f32) -> [f32; 3] {
        let [fine, coarse] = &self.points;
        let (own, beside, there) = (at(fine, fraction), at(coarse, automatic), at(fine, automatic));
        [0, 1, 2].map(|i| own[i] * (beside[i] / there[i]))
    }
}

/// Between `points` by the logarithm of the share, constant beyond them.
fn at(points: &[(f32, Factors)], fraction: f32) -> Factors {
    let Some(k) = points.iter().position(|(at, _)| *at <= fraction) else {
        return points.last().map_or([1.0; 3], |(_, factors)| *factors);
    };
    if k == 0 {
        return points[0].1;
    }
    let ((many, a), (few, b)) = (points[k - 1], points[k]);
    let t = (many / fraction).ln() / (many / few).ln();
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t)
}

/// The levels that [`CoverTable::new`] looks at: octaves. The share `first` is always drawn. At full detail the pixel
/// is `limit`; the functions tell the widening of a share, and the segments at a pixel.
pub fn levels(
    first: f32,
    limit: f32,
    curve: &CurveTable,
    widening: impl Fn(f32) -> f32,
    segments: impl Fn(f32) -> f32,
) -> Vec<CoverLevel> {
    let mut levels = Vec::new();
    let mut fraction = 0.5f32;
    while fraction >= LEAST {
        let pixel = limit / fraction;
        let segments = segments(pixel);
        let drawn = fraction.max(first);
        let widening = widening(drawn) / curve.length(segments);
        levels.push(CoverLevel { fraction, drawn, widening, segments, pixel });
        fraction *= 0.5;
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::groom::Influence;
    use crate::progress::at_once;

    /// `count` strands of a millimetre that fall side by side, a metre long, over 20 cm.
    fn curtain(count: u32) -> (BoundStrands, Vec<Strand>) {
        let mut strands = BoundStrands::new(2);
        for i in 0..count {
            let x = (i.reverse_bits() as f32 / 2f32.powi(32) - 0.5) * 0.2;
            let influence = Influence { guide: 0, weight: 1.0, scale: 1.0 };
            let strand = Strand { radius: 5e-4, seed: i, root_color: 0, tip_color: 0 };
            let line = [Vec3::new(x, 0.5, 0.01 * x), Vec3::new(x, -0.5, 0.01 * x)];
            strands.push(strand, &line, &[1.0; 2], &[influence]);
        }
        let infos = strands.strands.clone();
        (strands, infos)
    }

    #[test]
    fn wide_strands_reach_over_the_edges() {
        // So dense that all is covered but what lies beyond the edges.
        let (strands, infos) = curtain(1024);
        let level = |fraction: f32, pixel| CoverLevel {
            fraction,
            drawn: fraction,
            widening: 1.0 / fraction,
            segments: 1.0,
            pixel,
        };
        let levels = [level(0.25, 0.0), level(0.0625, 0.06)];
        let table = at_once(CoverTable::new(&strands, &infos, (Vec3::ZERO, 0.55), &levels, &()));
        let width = |fraction, automatic| table.factors(fraction, automatic)[0];
        assert_eq!(table.factors(1.0, 1.0), [1.0; 3]);
        assert!(width(0.0625, 1.0) < 1.0, "{}", width(0.0625, 1.0));
        // A coarse pixel more so.
        assert!(width(0.0625, 0.0625) < width(0.0625, 1.0) - 0.01);
        assert!(width(0.1, 1.0) > width(0.0625, 1.0));
        assert_eq!(CoverTable::none().factors(0.1, 0.01), [1.0; 3]);
    }
}
