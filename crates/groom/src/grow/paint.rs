//! Scalp maps that modify the strands of a style or a file.

use crate::bound::strand::pack_color;
use crate::random::Rng;
use crate::scalp::ScalpMap;
use crate::skin::MapProjection;
use crate::{Error, Result};
use crate::{Strands, bound::covering_radius, curve};
use glam::{Vec2, Vec3};

/// Fraction of its length below which a cut strand is removed.
const SHAVED: f32 = 0.02;

/// Fraction of its width below which a strand is removed.
const VANISHED: f32 = 0.01;

/// Hair color painted on the scalp: albedo, linear sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorMap {
    /// Red, green and blue channels.
    pub channels: [ScalpMap; 3],
}

impl ColorMap {
    /// Returns the color at `uv`, linear.
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|c| self.channels[c].sample(uv)))
    }

    /// Returns the colors of root and tip of a strand rooted at `uv`, packed for [`Strand`](crate::bound::Strand). The
    /// root is darker and the tip lighter than the map, in the same ratio as the default colors of `tresses`.
    pub fn strand(&self, uv: Vec2) -> [u32; 2] {
        let albedo = self.sample(uv);
        [pack_color(ROOT * albedo), pack_color(TIP * albedo)]
    }
}

/// Albedo at the root and at the tip, relative to the painted albedo.
const ROOT: f32 = 0.8;
const TIP: f32 = 1.25;

/// Maps over the scalp. Each multiplies the value that applies without it, so white changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScalpPaint {
    /// Fraction of the strands that stay.
    pub density: Option<ScalpMap>,
    /// Factor on the widths; strands without width are removed.
    pub thickness: Option<ScalpMap>,
    /// Factor on the lengths: strands are cut, and those without length are removed.
    pub length: Option<ScalpMap>,
    /// Factor on the radius of curls.
    pub curl: Option<ScalpMap>,
    /// Colors of the strands.
    pub color: Option<ColorMap>,
}

fn factor(map: Option<&ScalpMap>, uv: Vec2) -> f32 {
    map.map_or(1.0, |map| map.sample(uv))
}

impl ScalpPaint {
    /// Returns the factors on length and width of a strand rooted at `uv`, or `None` if the maps remove it. `chance` is
    /// a random number from 0 to 1.
    pub(crate) fn strand(&self, uv: Vec2, chance: f32) -> Option<[f32; 2]> {
        let length = factor(self.length.as_ref(), uv).min(1.0);
        let width = factor(self.thickness.as_ref(), uv);
        let stays = chance < factor(self.density.as_ref(), uv) && length > SHAVED && width > VANISHED;
        stays.then_some([length, width])
    }

    /// Returns the factor on the radius of curls rooted at `uv`.
    pub(crate) fn curl(&self, uv: Vec2) -> f32 {
        factor(self.curl.as_ref(), uv)
    }

    /// Thins out, cuts, scales and colors the imported `strands` (groom space, meters) by the position of their roots
    /// on the maps. `seed` selects the strands that are thinned out.
    /// [`restyle`](crate::restyle) applies the map of curls.
    ///
    /// # Errors
    /// [`Error::Unusable`] if no strand is left.
    pub fn apply<'a>(
        &self,
        strands: &Strands,
        on: impl Into<MapProjection<'a>>,
        seed: u32,
    ) -> Result<Strands> {
        self.apply_kept(strands, on.into(), seed, strands.len()).map(|(strands, _)| strands)
    }

    /// [`apply`](Self::apply) that thins out only the first `dense` strands. Also returns the indices of the remaining
    /// strands.
    pub(crate) fn apply_kept(
        &self,
        strands: &Strands,
        on: MapProjection<'_>,
        seed: u32,
        dense: usize,
    ) -> Result<(Strands, Vec<u32>)> {
        let all = strands.len();
        let mut kept = Vec::with_capacity(all);
        let mut out = strands.emptied();
        let covering = covering_radius(all);
        for i in 0..all {
            let line = strands.strand(i);
            let Some(root) = line.first() else { continue };
            let uv = on.at(*root);
            let chance = if i < dense { Rng::new(seed ^ 0xd09, i as u32).unit() } else { -1.0 };
            let Some([length, width]) = self.strand(uv, chance) else { continue };
            kept.push(i as u32);
            let n = line.len();
            let range = strands.range(i);
            // The same number of vertices over a shorter length.
            let vertex_positions =
                if length < 1.0 { cut(line, length) } else { (0..n).map(|k| k as f32).collect() };
            let lerp_at = |x: f32| {
                ((x as usize).min(n.saturating_sub(2)), x - (x as usize).min(n.saturating_sub(2)) as f32)
            };
            out.positions.extend(vertex_positions.iter().map(|x| {
                let (k, f) = lerp_at(*x);
                line[k].lerp(line[(k + 1).min(n - 1)], f)
            }));
            vertex_positions.iter().for_each(|x| {
                let (k, f) = lerp_at(*x);
                out.push_custom(strands, [k, (k + 1).min(n - 1)].map(|k| range.start + k), f);
            });
            if let Some(radii) = strands.radii.get(range.clone()).filter(|r| !r.is_empty()) {
                out.radii.extend(vertex_positions.iter().map(|x| {
                    let (k, f) = lerp_at(*x);
                    width * (radii[k] + (radii[(k + 1).min(n - 1)] - radii[k]) * f)
                }));
            } else if self.thickness.is_some() {
                let taper = |k: usize| 1.0 - 0.6 * k as f32 / (n - 1).max(1) as f32;
                out.radii.extend((0..n).map(|k| width * covering * taper(k)));
            }
            if let Some(color) = &self.color {
                let albedo = color.sample(uv);
                let along = |k: usize| ROOT + (TIP - ROOT) * k as f32 / (n - 1).max(1) as f32;
                out.colors.extend((0..n).map(|k| (albedo * along(k)).min(Vec3::ONE)));
            } else {
                out.colors.extend(strands.colors.get(range).into_iter().flatten());
            }
            out.end_like(strands, i);
            // A cut strand no longer has a pinned tip.
            if let Some(pinned) = out.tip_pinned.last_mut() {
                *pinned &= length >= 1.0;
            }
        }
        if out.is_empty() {
            return Err(Error::Unusable("the maps remove all strands: they are black at every root".into()));
        }
        Ok((out, kept))
    }
}

/// Returns for each vertex of `line` its new position, in vertex indices, if the line ends at the fraction `fraction`
/// of its length.
fn cut(line: &[Vec3], fraction: f32) -> Vec<f32> {
    let n = line.len();
    let end = fraction * curve::length(line);
    let mut passed = 0.0;
    let mut last = (n - 1) as f32;
    for (k, w) in line.windows(2).enumerate() {
        let step = w[0].distance(w[1]);
        if passed + step >= end {
            last = k as f32 + if step > 0.0 { (end - passed) / step } else { 0.0 };
            break;
        }
        passed += step;
    }
    (0..n).map(|k| last * k as f32 / (n - 1).max(1) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strands 10 cm long that stick out of a head at the origin.
    fn ball(count: usize) -> Strands {
        let mut strands = Strands::default();
        for i in 0..count {
            let dir = crate::scalp::spread_direction(i as u32, Vec2::new(0.3, 0.6));
            let line: Vec<Vec3> = (0..11).map(|k| dir * (0.09 + 0.01 * k as f32)).collect();
            strands.push(&line);
        }
        strands
    }

    fn left() -> ScalpMap {
        ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 1.0 } else { 0.25 })
    }

    /// Returns the mean of `value` over the strands rooted well to the left of the head, and well to the right.
    fn sides(strands: &Strands, value: impl Fn(usize) -> f32) -> [f32; 2] {
        [1.0, -1.0].map(|side| {
            let there: Vec<f32> =
                (0..strands.len()).filter(|i| strands.strand(*i)[0].x * side > 0.03).map(&value).collect();
            there.iter().sum::<f32>() / there.len().max(1) as f32
        })
    }

    #[test]
    fn paint_affects_only_painted_side() {
        let strands = ball(4000);
        let count =
            |s: &Strands, side: f32| (0..s.len()).filter(|i| s.strand(*i)[0].x * side > 0.03).count() as f32;
        let thin = ScalpPaint { density: Some(left()), ..ScalpPaint::default() }
            .apply(&strands, Vec3::ZERO, 1)
            .unwrap();
        let kept = [1.0, -1.0].map(|side| count(&thin, side) / count(&strands, side));
        let good = |[l, r]: [f32; 2]| l == 1.0 && (r - 0.25).abs() < 0.04;
        assert!(good(kept) && !good([kept[1], kept[0]]), "{kept:?}");

        let cut = ScalpPaint { length: Some(left()), ..ScalpPaint::default() }
            .apply(&strands, Vec3::ZERO, 1)
            .unwrap();
        let lengths = sides(&cut, |i| cut.length(i));
        let good = |[l, r]: [f32; 2]| (l - 0.1).abs() < 1e-5 && (r - 0.025).abs() < 1e-5;
        assert!(good(lengths) && !good([lengths[1], lengths[0]]), "{lengths:?}");

        let fine = ScalpPaint { thickness: Some(left()), ..ScalpPaint::default() }
            .apply(&strands, Vec3::ZERO, 1)
            .unwrap();
        let widths = sides(&fine, |i| fine.radii[fine.range(i).start]);
        assert!((widths[1] / widths[0] - 0.25).abs() < 1e-4, "{widths:?}");

        let gray = ScalpMap::from_fn(2, |_| 0.2);
        let color = Some(ColorMap { channels: [left(), gray.clone(), gray] });
        let red = ScalpPaint { color, ..ScalpPaint::default() }.apply(&strands, Vec3::ZERO, 1).unwrap();
        let roots = sides(&red, |i| red.colors[red.range(i).start].x);
        assert!((roots[0] - 0.8).abs() < 1e-5 && (roots[1] - 0.2).abs() < 1e-5, "{roots:?}");
        assert_eq!(ScalpPaint::default().apply(&strands, Vec3::ZERO, 1).unwrap(), strands);
    }

    #[test]
    fn all_black_maps_are_rejected() {
        let black = ScalpMap::from_fn(2, |_| 0.0);
        for paint in [
            ScalpPaint { density: Some(black.clone()), ..ScalpPaint::default() },
            ScalpPaint { length: Some(black.clone()), ..ScalpPaint::default() },
            ScalpPaint { thickness: Some(black), ..ScalpPaint::default() },
        ] {
            assert!(paint.apply(&ball(20), Vec3::ZERO, 1).is_err());
        }
    }
}
