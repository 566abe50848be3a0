//! Growth of render strands from guides.
//!
//! Guides are few; a head of hair has tens of thousands of strands. Each grown strand follows either one guide (a
//! *clump*: the guide's curve plus an offset that shrinks toward the tip) or the three guides at the corners of its
//! scalp triangle (a *multi-strand*: their barycentric blend at equal fractions of their lengths, so that no strand is
//! cut to the shortest). The result is a rest curve and a binding; the GPU adds motion each frame.
//!
//! Structure has three scales. *Locks*: strands are pulled toward their heaviest guide at the tip. *Clumps*: some
//! strands are centers, and every other strand converges on the nearest center, more so toward the tip. *Single
//! strands*: variation of length, fine frizz and flyaways.
//!
//! ```text
//! roots ─► binding ─► blend or clump ─► lock ─► clump center ─► curl ─► unrest ─► clear of the head
//! ```

mod avoid;
mod bind;
mod cells;
mod count;
mod curl;
mod groom;
mod named;
mod paint;
mod params;
mod seed;
mod shape;
mod triangles;
mod variation;

pub(crate) use bind::frames_from;
pub use curl::{CurlCurve, Curls};
pub(crate) use curl::{Strand as CurlStrand, Twist};
pub use paint::{ColorMap, ScalpPaint};
pub use params::{Clumps, Growth, StrandKind, StrandVariation};
pub(crate) use variation::add_variation;

use crate::hash::pcg;
use crate::random::Rng;
use crate::{Progress, Result, progress::at_once};
use crate::{scalp::Scalp, styles::StyledGuides};
use glam::{Vec2, Vec3};

/// One grown strand, without its vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrownStrand {
    /// Guides of the strand, by descending weight. A clump strand repeats its one guide three times.
    pub guides: [u32; 3],
    /// Weights of the guides, the largest first; the sum is 1.
    pub weights: [f32; 3],
    /// For each guide, the fraction of its length that the strand's tip follows.
    pub scale: [f32; 3],
    /// Largest radius along the strand, meters.
    pub radius: f32,
    /// Seed of every later random choice.
    pub seed: u32,
    /// Scalp coordinates of the root.
    pub root_uv: Vec2,
    /// Painted colors of root and tip, packed as in [`Strand`](crate::bound::Strand); 0 for none.
    pub colors: [u32; 2],
}

/// Grown strands at rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GrownStrands {
    /// Vertices per strand.
    pub vertex_count: usize,
    /// One entry per strand.
    pub strands: Vec<GrownStrand>,
    /// Rest positions, groom space, meters: `vertex_count` per strand, root first.
    pub positions: Vec<Vec3>,
    /// Radius of each vertex as a fraction of the strand's radius, indexed like `positions`.
    pub radii: Vec<f32>,
}

impl GrownStrands {
    /// Returns the vertices of strand `i`, root first.
    pub fn strand(&self, i: usize) -> &[Vec3] {
        &self.positions[i * self.vertex_count..(i + 1) * self.vertex_count]
    }
}

/// Grows strands on `scalp` from the guides of [`styles::guides`](crate::styles::guides), or from the same guides after
/// draping.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for growth parameters out of range, or if maps leave no place for the
/// requested strands. [`Error::Unusable`](crate::Error::Unusable) if the vertices cannot represent the curls, or if
/// painted maps remove every strand.
pub fn grow(styled: &StyledGuides, growth: &Growth, scalp: &dyn Scalp) -> Result<GrownStrands> {
    at_once(grow_with(styled, growth, scalp, &()))
}

/// [`grow`] that reports to `progress`.
///
/// # Errors
/// As [`grow`].
pub async fn grow_with(
    styled: &StyledGuides,
    growth: &Growth,
    scalp: &dyn Scalp,
    progress: &impl Progress,
) -> Result<GrownStrands> {
    const TASK: &str = "growing strands";
    growth.check()?;
    progress.step(TASK, 0.0).await;
    let scaffold = bind::Scaffold::new(styled, scalp);
    let totals = count::totals(&scaffold, styled, growth, scalp);
    growth.curls.fits(median_length(styled), growth.vertex_count)?;
    let seeds = seed::seeds(&scaffold, styled, growth, scalp, totals)?;
    let n = seeds.len();
    // Painted maps that thin hair out do not change the diameter.
    let diameter = growth.diameter_for(totals[0] + totals[1]);
    let shaper = shape::Shaper::new(&scaffold, styled, growth, scalp, &seeds);

    let vertices = growth.vertex_count as usize;
    let mut out = GrownStrands {
        vertex_count: vertices,
        strands: Vec::with_capacity(n),
        positions: Vec::with_capacity(n * vertices),
        radii: Vec::with_capacity(n * vertices),
    };
    let mut line = vec![Vec3::ZERO; vertices];
    for (i, seed) in seeds.iter().enumerate() {
        if i % 64 == 0 {
            progress.step(TASK, i as f32 / n as f32).await;
        }
        let Some([length, painted]) = seed.paint else { continue };
        let seed = &seed::Seed { fraction: seed.fraction * length, ..*seed };
        let id = pcg(growth.seed ^ pcg(i as u32 ^ 0x5eed));
        let mut rng = Rng::new(id, 1);
        let filled = shaper.fill(i, seed, &mut rng, &mut line);
        out.positions.extend_from_slice(&line);
        let width =
            seed.thickness * filled.fineness * (1.0 + growth.width_variation * rng.bell().clamp(-2.0, 2.0));
        let taper = (growth.taper_start + 0.1 * rng.bell()).clamp(0.1, 0.95);
        out.radii.extend((0..vertices).map(|k| {
            let s = k as f32 / (vertices - 1) as f32;
            let tip = ((s - taper) / (1.0 - taper)).clamp(0.0, 1.0);
            1.0 - (1.0 - growth.tip_width) * tip * tip
        }));
        out.strands.push(GrownStrand {
            guides: seed.bound.guides,
            weights: seed.bound.weights,
            scale: [filled.fraction; 3],
            radius: 0.5 * diameter * width.max(0.2) * painted,
            seed: id,
            root_uv: seed.uv,
            colors: growth.paint.color.as_ref().map_or([0; 2], |map| map.strand(seed.uv)),
        });
    }
    Ok(out)
}

/// Returns the median length of the guides, meters.
fn median_length(styled: &StyledGuides) -> f32 {
    let mut lengths: Vec<f32> = (0..styled.guides.len()).map(|i| styled.guides.length(i)).collect();
    lengths.sort_by(f32::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
