//! Coverage and brightness of wider strands. Few wide strands cover more than many thin ones of the same
//! area, because they cover gaps and reach beyond outlines; a coarse pixel covers more as well, because
//! strands within it are treated as overlapping at random. The eye then sees less or more deeply into the
//! hair, where less light arrives. Factors that correct both are measured on the CPU
//! ([`seen`](super::seen)).

use super::{
    curve::CurveTable,
    lit::{Lit, fibers},
    seen::{EYES, Pictures, Seen, Strip},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::progress::at_once;
use crate::{Progress, groom::BoundStrands, strands::Strand};
use glam::Vec3;

/// At most so many strands stand for all of them.
const MOST: usize = 6000;
/// And at most so many find where light meets the hair first.
const MOST_FRONTS: usize = 60_000;
/// The smallest share of strands that is looked at.
const LEAST: f32 = 0.004;
/// The narrowest that strands are made.
const NARROWEST: f32 = 0.3;
/// The widest.
const WIDEST: f32 = 1.5;

/// On widths; on the fibres before what is seen, towards a light on the eye's side, and one behind; and how much
/// deeper that is seen, metres.
type Factors = [f32; 4];
/// Of full detail.
pub(super) const NONE: Factors = [1.0, 1.0, 1.0, 0.0];

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
        Self { points: [vec![(1.0, NONE)], vec![(1.0, NONE)]] }
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
        // Where the base is not all strands it stands for them, a little wider.
        let share = base as f32 / infos.len() as f32;
        // But not where light meets the hair first.
        let fronts: Vec<_> =
            (0..infos.len().min(MOST_FRONTS)).map(|i| Strip::new(strands, infos, i, None)).collect();
        let all = &fronts[..base];
        progress.step(TASK, 0.0).await;
        let mut pictures = Pictures::new(all, sphere);
        let fine = pictures.finest();
        let full = pictures.area(share.recip(), fine);
        progress.step(TASK, 0.1).await;
        let seen = pictures.seen(share.recip(), fine);
        progress.step(TASK, 0.3).await;
        let wide = infos.len() as f32 / fronts.len() as f32;
        let lit = Lit::new(&seen, &fibers(all, &fronts, sphere, wide), share.recip());
        let height = height(all, &seen);
        drop((pictures, seen, fronts));
        let whole = Whole { strands, infos, sphere, fine, full, lit, height };
        // Where the base is no more than a level there is nothing to hold it to, nor for hair a few pixels large.
        let count = |level: &CoverLevel| (level.drawn * infos.len() as f32).ceil() as usize;
        let levels: Vec<_> =
            levels.iter().filter(|level| count(level) < base && level.pixel <= 0.5 * sphere.1).collect();
        progress.step(TASK, 0.4).await;
        for [fine, coarse] in whole.levels(&levels, progress, TASK).await {
            table.points[0].push(fine);
            table.points[1].push(coarse);
        }
        table
    }

    /// The factors and the depth where the share `fraction` of the strands is drawn, and the pixel is that at which the
    /// share `automatic` would be: on their widths; on the fibres before what is seen where light comes from the
    /// eye's side; where it comes from behind the hair; and how much deeper the eye sees, metres.
    ///
    /// The factors on fibres are such that what the eye sees of the hair is on average as light as what it sees of it at
    /// full detail: narrower strands let it see deeper, wide ones close gaps that it would have looked into,
    /// and few segments cut corners.
    pub fn factors(&self, fraction: f32, automatic: f32) -> Factors {
        let [fine, coarse] = &self.points;
        let (own, beside, there) = (at(fine, fraction), at(coarse, automatic), at(fine, automatic));
        let [width, before, behind] = [0, 1, 2].map(|i| own[i] * (beside[i] / there[i]));
        [width, before, behind, (own[3] + beside[3] - there[3]).max(0.0)]
    }
}

/// How near the eyes is on average what they have `seen` of `strips`, metres.
fn height(strips: &[Strip], seen: &[Seen]) -> f32 {
    let points = strips.iter().flat_map(|strip| &strip.points);
    let eyes = EYES.map(Vec3::normalize);
    let mut sums = EYES.map(|_| [0.0f64; 2]);
    for (point, seen) in points.zip(seen) {
        for ((sum, seen), eye) in sums.iter_mut().zip(seen).zip(eyes) {
            sum[0] += f64::from(seen * point.dot(eye));
            sum[1] += f64::from(*seen);
        }
    }
    sums.map(|[sum, all]| (sum / all.max(1e-12)) as f32).iter().sum::<f32>() / EYES.len() as f32
}

/// Full detail, to which levels are held.
struct Whole<'a> {
    strands: &'a BoundStrands,
    infos: &'a [Strand],
    sphere: (Vec3, f32),
    /// The finest cells, metres.
    fine: f32,
    /// The area that it covers, m².
    full: f32,
    lit: Lit,
    /// How near the eyes what they see is, metres.
    height: f32,
}

impl Whole<'_> {
    /// The points of `levels`: at once on two threads where there are threads, since each level has half the strands
    /// of the one before, so that the first takes as long as all others.
    async fn levels(
        &self,
        levels: &[&CoverLevel],
        progress: &impl Progress,
        task: &'static str,
    ) -> Vec<[(f32, Factors); 2]> {
        #[cfg(not(target_arch = "wasm32"))]
        {
            let _ = (progress, task);
            let measured = |level: &&CoverLevel| at_once(self.level(level, async || ()));
            let Some((first, others)) = levels.split_first() else { return Vec::new() };
            std::thread::scope(|scope| {
                let others = scope.spawn(|| others.iter().map(measured).collect::<Vec<_>>());
                let mut points = vec![measured(first)];
                points.extend(others.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
                points
            })
        }
        #[cfg(target_arch = "wasm32")]
        {
            let mut points = Vec::new();
            for (i, level) in levels.iter().enumerate() {
                let done = 1.0 - 0.6 * 0.5f32.powi(i as i32);
                points.push(self.level(level, async || progress.step(task, done).await).await);
            }
            points
        }
    }

    /// The points of one level, in a picture as fine as can be and with its own pixel; `pause` lets others work.
    async fn level(&self, level: &CoverLevel, pause: impl AsyncFn()) -> [(f32, Factors); 2] {
        let count = (level.drawn * self.infos.len() as f32).ceil() as usize;
        let strips: Vec<_> = (0..count.max(1))
            .map(|i| Strip::new(self.strands, self.infos, i, Some(level.segments)))
            .collect();
        let mut pictures = Pictures::new(&strips, self.sphere);
        let fibers = fibers(&strips, &strips, self.sphere, level.widening);
        let mut points = [(level.fraction, NONE); 2];
        for (point, cell) in points.iter_mut().zip([self.fine, level.pixel.max(self.fine)]) {
            // The secant method: coverage grows smoothly, and ever slower, with the width.
            let (mut a, mut b) = (1.0, 0.85);
            let mut cover = |factor: f32| pictures.area(level.widening * factor, cell);
            let (mut at_a, mut at_b) = (cover(a), cover(b));
            for _ in 0..3 {
                let slope = (at_a - at_b) / (a - b);
                if !slope.is_finite() || slope < 1e-9 {
                    break;
                }
                let next = (b + (self.full - at_b) / slope).clamp(NARROWEST, WIDEST);
                (a, at_a, b) = (b, at_b, next);
                if (a - b).abs() < 2e-3 {
                    break;
                }
                pause().await;
                at_b = cover(b);
            }
            let seen = pictures.seen(level.widening * b, cell);
            // Shadow maps hold the area of full detail.
            let [before, behind] = self.lit.matching(&Lit::new(&seen, &fibers, level.widening));
            point.1 = [b, before, behind, self.height - height(&strips, &seen)];
        }
        points
    }
}

/// Between `points` by the logarithm of the share, constant beyond them.
fn at(points: &[(f32, Factors)], fraction: f32) -> Factors {
    let Some(k) = points.iter().position(|(at, _)| *at <= fraction) else {
        return points.last().map_or(NONE, |(_, factors)| *factors);
    };
    if k == 0 {
        return points[0].1;
    }
    let ((many, a), (few, b)) = (points[k - 1], points[k]);
    let t = (many / fraction).ln() / (many / few).ln();
    [0, 1, 2, 3].map(|i| a[i] + (b[i] - a[i]) * t)
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
        assert_eq!(table.factors(1.0, 1.0), NONE);
        assert!(width(0.0625, 1.0) < 1.0, "{}", width(0.0625, 1.0));
        // A coarse pixel more so.
        assert!(width(0.0625, 0.0625) < width(0.0625, 1.0) - 0.01);
        assert!(width(0.1, 1.0) > width(0.0625, 1.0));
        assert_eq!(CoverTable::none().factors(0.1, 0.01), NONE);
    }
}
