//! What wider strands cover: more than as many thin ones of the same area, where they reach over gaps
//! and outlines. So do strips that are never drawn narrower than a pixel, however little of it they cover.
//! The factors on the widths that take both back are measured on the CPU at load.

use super::curve::{CurveTable, resample};
use crate::{Progress, groom::BoundStrands, strands::Strand};
use glam::{Vec2, Vec3};

/// Cells along each edge of a view.
const GRID: usize = 192;
/// At most so many strands stand for all of them.
const MOST: usize = 6000;
/// The smallest share of strands that is looked at.
const LEAST: f32 = 0.004;
/// How wide a strip that is drawn a pixel wide is for its coverage, pixels: found by comparing pictures of
/// hair a few pixels large. Its mask leaves out samples, the more so where strips agree.
const STRIP: f32 = 0.95;
/// Shares of what is seen of a groom that are told apart by their thickness.
const PLACES: usize = 32;
/// The narrowest that strands are made.
const NARROWEST: f32 = 0.5;
/// The widest.
const WIDEST: f32 = 1.2;

/// The factors of a groom on the widths of fewer strands.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverTable {
    /// Share of the strands and the factor that belongs to it, shares falling from 1: in a picture as fine
    /// as can be, and with the pixel of [`CoverLevel`].
    points: [Vec<(f32, f32)>; 2],
    /// How many fibres lie before each other where hair is, -ln of what it lets through: of equal shares of
    /// what the views see of it, from thin to thick.
    thickness: Vec<f32>,
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

/// A strand that is splatted.
struct Line {
    points: Vec<Vec3>,
    /// At the root and beyond, metres: a radius for every point.
    radii: Vec<f32>,
}

/// The share of light that passes each cell of a view.
struct View {
    right: Vec3,
    up: Vec3,
    corner: Vec2,
    cell: f32,
    passes: Vec<f32>,
}

impl CoverTable {
    /// Nothing known: as wide as their area wants.
    pub fn none() -> Self {
        Self { points: [vec![(1.0, 1.0)], vec![(1.0, 1.0)]], thickness: Vec::new() }
    }

    /// For `strands` in the order of [`arrange`](super::arrange) with the radii of `infos`, inside the sphere
    /// of `radius` metres around `middle`, at `levels` with falling shares.
    pub async fn new(
        strands: &BoundStrands,
        infos: &[Strand],
        (middle, radius): (Vec3, f32),
        levels: &[CoverLevel],
        progress: &impl Progress,
    ) -> Self {
        const TASK: &str = "measuring levels of detail";
        let mut table = Self::none();
        let base = infos.len().min(MOST);
        if base == 0 || radius <= 0.0 {
            return table;
        }
        let share = base as f32 / infos.len() as f32;
        let lines: Vec<Line> = (0..base).map(|i| line(strands, infos, i)).collect();
        progress.step(TASK, 0.0).await;
        let mut views = views(middle, radius);
        // Where the base is not all strands it stands for them, a little wider.
        let full = covered(&mut views, &lines, share.recip(), 0.0, None);
        table.thickness = thickness(&views);
        for (i, level) in levels.iter().enumerate() {
            // Each level has half the strands of the one before.
            let done = 1.0 - 0.5f32.powi(i as i32 + 1);
            let count = (level.drawn * infos.len() as f32).ceil() as usize;
            if count >= base {
                continue;
            }
            let lines = &lines[..count.max(1)];
            for (points, pixel) in table.points.iter_mut().zip([0.0, STRIP * level.pixel]) {
                let mut cover = |factor: f32| {
                    covered(&mut views, lines, level.widening * factor, pixel, Some(level.segments))
                };
                // The secant method: coverage grows smoothly, and ever slower, with the width.
                let (mut a, mut b) = (1.0, 0.85);
                progress.step(TASK, done).await;
                let (mut at_a, mut at_b) = (cover(a), cover(b));
                for _ in 0..3 {
                    let slope = (at_a - at_b) / (a - b);
                    if !slope.is_finite() || slope < 1e-6 {
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
                points.push((level.fraction, b));
            }
        }
        table
    }

    /// The factor where the share `fraction` of the strands is drawn, and the pixel is that at which the
    /// share `automatic` would be.
    pub fn factor(&self, fraction: f32, automatic: f32) -> f32 {
        let [fine, coarse] = &self.points;
        at(fine, fraction) * (at(coarse, automatic) / at(fine, automatic))
    }

    /// What light meets of strands whose widths have the factor `cover`, as a factor on those widths.
    ///
    /// The eye sees into hair of the thickness `T` as deep as `exp(-cover t)` of it is seen, on average to
    /// `t = 1 / cover - T / (exp(cover T) - 1)`: the deeper, the narrower strands are. What it sees should on
    /// average be lit as what it sees at full detail; so what light meets on the way there is scaled by
    /// the quotient of the two mean depths. Hair that is thin is seen through at any level and keeps its
    /// whole area (`1 / cover`); in the thickest light and eye reach as deep (1). A groom is both: the mean
    /// over all that is seen of it.
    pub fn shadow(&self, cover: f32) -> f32 {
        let places = self.thickness.len();
        if places == 0 {
            return 1.0;
        }
        let at = |thickness: &f32| depth(1.0, *thickness) / depth(cover, *thickness);
        self.thickness.iter().map(at).sum::<f32>() / (places as f32 * cover)
    }
}

/// How deep into hair of a `thickness` the eye sees on average where strands' widths have the factor `cover`.
fn depth(cover: f32, thickness: f32) -> f32 {
    let scaled = cover * thickness;
    if scaled < 1e-2 {
        return thickness * (0.5 - scaled / 12.0);
    }
    1.0 / cover - thickness / scaled.exp_m1()
}

/// Between `points` by the logarithm of the share, constant beyond them.
fn at(points: &[(f32, f32)], fraction: f32) -> f32 {
    let Some(k) = points.iter().position(|(at, _)| *at <= fraction) else {
        return points.last().map_or(1.0, |(_, factor)| *factor);
    };
    if k == 0 {
        return points[0].1;
    }
    let ((many, a), (few, b)) = (points[k - 1], points[k]);
    a + (b - a) * (many / fraction).ln() / (many / few).ln()
}

fn line(strands: &BoundStrands, infos: &[Strand], i: usize) -> Line {
    let n = strands.vertex_count as usize;
    let rest = strands.rest[i * n..(i + 1) * n].iter();
    let (points, radii) = rest.map(|rest| rest.unpack(&strands.bindings[i])).unzip::<_, _, Vec<_>, Vec<_>>();
    Line { points, radii: radii.into_iter().map(|r: f32| r * infos[i].radius).collect() }
}

/// From before, from a side, and between them from above.
fn views(middle: Vec3, radius: f32) -> [View; 3] {
    [Vec3::Z, Vec3::X, Vec3::new(-1.0, 0.6, -1.0)].map(|back| {
        let back = back.normalize();
        let right = Vec3::Y.cross(back).normalize();
        let up = back.cross(right);
        let middle = Vec2::new(middle.dot(right), middle.dot(up));
        let cell = 2.1 * radius / GRID as f32;
        View { right, up, corner: middle - 1.05 * radius, cell, passes: vec![1.0; GRID * GRID] }
    })
}

/// The mean share of the views that `lines` cover, each `widening` times as wide as it is and drawn with
/// so many segments, in a picture with pixels of `pixel` metres.
fn covered(views: &mut [View], lines: &[Line], widening: f32, pixel: f32, segments: Option<f32>) -> f32 {
    let mut sum = 0.0;
    for view in views.iter_mut() {
        view.passes.fill(1.0);
        for line in lines {
            match segments {
                None => view.splat(&line.points, &line.radii, widening, pixel),
                Some(s) => view.splat(&resample(&line.points, s), &line.radii, widening, pixel),
            }
        }
        sum += view.passes.iter().map(|passes| 1.0 - passes).sum::<f32>() / view.passes.len() as f32;
    }
    sum / views.len() as f32
}

/// See [`CoverTable::thickness`].
fn thickness(views: &[View]) -> Vec<f32> {
    let mut passes: Vec<f32> = views.iter().flat_map(|view| &view.passes).copied().collect();
    passes.retain(|passes| *passes < 0.999);
    passes.sort_by(|a, b| b.total_cmp(a));
    let all: f32 = passes.iter().map(|passes| 1.0 - passes).sum();
    let (mut places, mut sum) = (Vec::new(), 0.0);
    for passes in passes {
        sum += 1.0 - passes;
        // The middle of the next share.
        if sum >= all * (places.len() as f32 + 0.5) / PLACES as f32 {
            places.push(-passes.max(1e-9).ln());
        }
    }
    places
}

impl View {
    fn splat(&mut self, points: &[Vec3], radii: &[f32], widening: f32, pixel: f32) {
        let scale = self.cell.recip();
        let at = |p: Vec3| (Vec2::new(p.dot(self.right), p.dot(self.up)) - self.corner) * scale;
        let last = (points.len() - 1) as f32;
        for k in 0..points.len() - 1 {
            let (a, b) = (at(points[k]), at(points[k + 1]));
            let way = b - a;
            let length = way.length();
            if length < 1e-6 {
                continue;
            }
            let across = way.perp() / length;
            let steps = length.ceil();
            let along = (k as f32 + 0.5) / last * (radii.len() - 1) as f32;
            let real = 2.0 * radii[along as usize] * widening * scale;
            let width = real.max(pixel * scale);
            let lanes = width.ceil().max(1.0);
            // The share of a cell that a patch of the strip covers.
            let patch = 1.0 - (length / steps * (real / lanes)).min(1.0);
            for i in 0..steps as u32 {
                let middle = a + way * ((i as f32 + 0.5) / steps);
                for lane in 0..lanes as u32 {
                    let p = middle + across * ((lane as f32 + 0.5) / lanes - 0.5) * width;
                    let (x, y) = (p.x as usize, p.y as usize);
                    if p.x >= 0.0 && p.y >= 0.0 && x < GRID && y < GRID {
                        self.passes[y * GRID + x] *= patch;
                    }
                }
            }
        }
    }
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
        assert_eq!(table.factor(1.0, 1.0), 1.0);
        assert!(table.factor(0.0625, 1.0) < 1.0, "{}", table.factor(0.0625, 1.0));
        // A coarse pixel more so.
        assert!(table.factor(0.0625, 0.0625) < table.factor(0.0625, 1.0) - 0.01);
        assert!(table.factor(0.1, 1.0) > table.factor(0.0625, 1.0));
        assert_eq!(CoverTable::none().factor(0.1, 0.01), 1.0);
    }

    #[test]
    fn light_meets_what_the_eye_sees() {
        let table = |thickness: &[f32]| CoverTable { thickness: thickness.to_vec(), ..CoverTable::none() };
        let shadow = |thickness| table(&[thickness]).shadow(0.5);
        assert!((shadow(1e-3) - 2.0).abs() < 1e-3 && (shadow(30.0) - 1.0).abs() < 1e-3);
        // Brute force: where what is seen of three fibres' thickness lies.
        let mean = |cover: f32| {
            let seen = |i: u32| (-cover * 3.0 * (i as f32 + 0.5) / 1000.0).exp();
            let sum: f32 = (0..1000).map(|i| seen(i) * 3.0 * (i as f32 + 0.5) / 1000.0).sum();
            sum / (0..1000).map(seen).sum::<f32>()
        };
        assert!((shadow(3.0) - 2.0 * mean(1.0) / mean(0.5)).abs() < 1e-3, "{}", shadow(3.0));
        assert_eq!(table(&[3.0, 1.0]).shadow(1.0), 1.0);
        assert!((table(&[1e-3, 30.0]).shadow(0.5) - 1.5).abs() < 2e-3);
        // A curtain 200 mm wide of 1024 strands of a millimetre: five over each other.
        let (strands, infos) = curtain(1024);
        let table = at_once(CoverTable::new(&strands, &infos, (Vec3::ZERO, 0.55), &[], &()));
        let middle = table.thickness[PLACES / 2];
        assert!(table.thickness.is_sorted() && (4.0..10.0).contains(&middle), "{:?}", table.thickness);
    }
}
