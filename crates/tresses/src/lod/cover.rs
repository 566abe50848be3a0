//! Coverage and brightness of wider strands. A few wide strands cover more than many thin ones of the same area,
//! because they cover gaps and extend beyond outlines. A coarse pixel covers more as well, because strands within it
//! are treated as randomly overlapping. The eye then sees less or more deeply into the hair, where less light arrives.
//! Factors that correct both are measured on the CPU ([`visibility`](super::visibility)).

use super::{
    curve::CurveTable,
    lit::{LightDepths, fibers},
    visibility::{EYES, Pictures, Strip, Visibility},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::progress::at_once;
use crate::{Progress, groom::BoundStrands, strands::Strand};
use glam::Vec3;

/// Maximum number of strands that represent all of them.
const MAX_STRANDS: usize = 6000;
/// Maximum number of strands for the front where light first meets the hair.
const MAX_FRONTS: usize = 60_000;
/// Smallest share of strands that is measured.
const MIN_FRACTION: f32 = 0.004;
/// Minimum factor on widths.
const NARROWEST: f32 = 0.3;
/// Maximum factor on widths.
const WIDEST: f32 = 1.5;

/// Factor on widths; factors on fiber counts in front of visible hair, for light from the eye's side and from behind;
/// and how much deeper visible hair lies, meters.
type Factors = [f32; 4];
/// Factors of full detail.
pub(super) const NONE: Factors = [1.0, 1.0, 1.0, 0.0];

/// Correction factors of a groom for the widths of fewer strands, and for the light that reaches them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CoverTable {
    /// Shares of the strands, descending from 1, with their factors: in the finest image, and with the pixel of
    /// [`CoverLevel`].
    points: [Vec<(f32, Factors)>; 2],
}

/// A level of detail to be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CoverLevel {
    /// Share of the strands.
    pub fraction: f32,
    /// Share of the strands that is drawn, including those that are fading in.
    pub drawn: f32,
    /// Factor on widths that keeps the total area.
    pub widening: f32,
    /// Number of segments.
    pub segments: f32,
    /// Pixel size at which this level is chosen, meters.
    pub pixel: f32,
}

impl CoverTable {
    /// Creates a table without corrections: widths keep the area.
    pub fn none() -> Self {
        Self { points: [vec![(1.0, NONE)], vec![(1.0, NONE)]] }
    }

    /// Measures `strands`, in the order of [`arrange`](super::arrange) with the radii of `infos`, inside `sphere`
    /// (center and radius, meters), at `levels` with descending shares.
    pub async fn new(
        strands: &BoundStrands,
        infos: &[Strand],
        sphere: (Vec3, f32),
        levels: &[CoverLevel],
        progress: &impl Progress,
    ) -> Self {
        const TASK: &str = "computing levels of detail";
        let mut table = Self::none();
        let base = infos.len().min(MAX_STRANDS);
        if base == 0 || sphere.1 <= 0.0 || strands.vertex_count < 2 {
            return table;
        }
        // The base represents all strands, widened to keep the area.
        let fraction = base as f32 / infos.len() as f32;
        // The front where light first meets the hair needs more strands.
        let fronts: Vec<_> =
            (0..infos.len().min(MAX_FRONTS)).map(|i| Strip::new(strands, infos, i, None)).collect();
        let all = &fronts[..base];
        progress.step(TASK, 0.0).await;
        let mut pictures = Pictures::new(all, sphere);
        let fine = pictures.finest();
        let full = pictures.area(fraction.recip(), fine);
        progress.step(TASK, 0.1).await;
        let visibility = pictures.visibility(fraction.recip(), fine);
        progress.step(TASK, 0.3).await;
        let wide = infos.len() as f32 / fronts.len() as f32;
        let lit = LightDepths::new(&visibility, &fibers(all, &fronts, sphere, wide), fraction.recip());
        let height = height(all, &visibility);
        drop((pictures, visibility, fronts));
        let full_detail = FullDetail { strands, infos, sphere, fine, full, lit, height };
        // Skip levels with at least as many strands as the base, and levels at which hair is only a few pixels large.
        let count = |level: &CoverLevel| (level.drawn * infos.len() as f32).ceil() as usize;
        let levels: Vec<_> =
            levels.iter().filter(|level| count(level) < base && level.pixel <= 0.5 * sphere.1).collect();
        progress.step(TASK, 0.4).await;
        for [fine, coarse] in full_detail.levels(&levels, progress, TASK).await {
            table.points[0].push(fine);
            table.points[1].push(coarse);
        }
        table
    }

    /// Returns the correction factors when the share `fraction` of the strands is drawn. The pixel is the one at which
    /// the share `automatic` would be chosen. In order: the factor on widths; the factor on fiber counts in front of
    /// visible hair for light from the eye's side; the same for light from behind; and how much deeper the eye sees,
    /// meters.
    ///
    /// The factors on fiber counts keep the mean brightness of visible hair as at full detail: narrower strands let the
    /// eye see deeper, wide ones close gaps, and few segments cut corners.
    pub fn factors(&self, fraction: f32, automatic: f32) -> Factors {
        let [fine, coarse] = &self.points;
        let (own, coarse_factors, fine_factors) =
            (at(fine, fraction), at(coarse, automatic), at(fine, automatic));
        let [width, before, behind] = [0, 1, 2].map(|i| own[i] * (coarse_factors[i] / fine_factors[i]));
        [width, before, behind, (own[3] + coarse_factors[3] - fine_factors[3]).max(0.0)]
    }
}

/// Returns the mean position of the visible parts of `strips` along the directions to the eyes, meters. `visibility`
/// has the visible fractions.
fn height(strips: &[Strip], visibility: &[Visibility]) -> f32 {
    let points = strips.iter().flat_map(|strip| &strip.points);
    let eyes = EYES.map(Vec3::normalize);
    let mut sums = EYES.map(|_| [0.0f64; 2]);
    for (point, fractions) in points.zip(visibility) {
        for ((sum, visible), eye) in sums.iter_mut().zip(fractions).zip(eyes) {
            sum[0] += f64::from(visible * point.dot(eye));
            sum[1] += f64::from(*visible);
        }
    }
    sums.map(|[sum, all]| (sum / all.max(1e-12)) as f32).iter().sum::<f32>() / EYES.len() as f32
}

/// Full detail, the reference for all levels.
struct FullDetail<'a> {
    strands: &'a BoundStrands,
    infos: &'a [Strand],
    sphere: (Vec3, f32),
    /// Edge of the finest cells, meters.
    fine: f32,
    /// Covered area, m².
    full: f32,
    lit: LightDepths,
    /// Mean position of visible parts along the directions to the eyes, meters.
    height: f32,
}

impl FullDetail<'_> {
    /// Measures `levels`, on two threads where the platform has threads. Each level has half the strands of the one
    /// before, so the first takes as long as all others together.
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

    /// Measures one level, in the finest image and with its own pixel. Calls `pause` between iterations to let other
    /// tasks run.
    async fn level(&self, level: &CoverLevel, pause: impl AsyncFn()) -> [(f32, Factors); 2] {
        let count = (level.drawn * self.infos.len() as f32).ceil() as usize;
        let strips: Vec<_> = (0..count.max(1))
            .map(|i| Strip::new(self.strands, self.infos, i, Some(level.segments)))
            .collect();
        let mut pictures = Pictures::new(&strips, self.sphere);
        let fibers = fibers(&strips, &strips, self.sphere, level.widening);
        let mut points = [(level.fraction, NONE); 2];
        for (point, cell) in points.iter_mut().zip([self.fine, level.pixel.max(self.fine)]) {
            // Secant method: coverage grows smoothly with the width, at a falling rate.
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
            let visibility = pictures.visibility(level.widening * b, cell);
            // Shadow maps contain the area of full detail.
            let [before, behind] = self.lit.matching(&LightDepths::new(&visibility, &fibers, level.widening));
            point.1 = [b, before, behind, self.height - height(&strips, &visibility)];
        }
        points
    }
}

/// Interpolates `points` by the logarithm of the share; constant beyond them.
fn at(points: &[(f32, Factors)], fraction: f32) -> Factors {
    let Some(k) = points.iter().position(|(at, _)| *at <= fraction) else {
        return points.last().map_or(NONE, |(_, factors)| *factors);
    };
    if k == 0 {
        return points[0].1;
    }
    let ((high, a), (low, b)) = (points[k - 1], points[k]);
    let t = (high / fraction).ln() / (high / low).ln();
    [0, 1, 2, 3].map(|i| a[i] + (b[i] - a[i]) * t)
}

/// Returns the levels that [`CoverTable::new`] measures: octaves of the share. The share `first` is always drawn, and
/// `limit` is the pixel at full detail. `widening` maps a share to the factor on widths, `segments` a pixel to a number
/// of segments.
pub fn levels(
    first: f32,
    limit: f32,
    curve: &CurveTable,
    widening: impl Fn(f32) -> f32,
    segments: impl Fn(f32) -> f32,
) -> Vec<CoverLevel> {
    let mut levels = Vec::new();
    let mut fraction = 0.5f32;
    while fraction >= MIN_FRACTION {
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

    /// `count` strands of 1 mm width, 1 m long, side by side over 20 cm.
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
    fn wide_strands_cover_beyond_edges() {
        // So dense that everything except the surroundings of the edges is covered.
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
        // A coarse pixel has a larger effect.
        assert!(width(0.0625, 0.0625) < width(0.0625, 1.0) - 0.01);
        assert!(width(0.1, 1.0) > width(0.0625, 1.0));
        assert_eq!(CoverTable::none().factors(0.1, 0.01), NONE);
    }
}
