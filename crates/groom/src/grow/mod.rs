//! Drawn strands grown from guides.
//!
//! Guides are few; a head of hair is tens of thousands of strands. Each grown strand follows either one
//! guide (a *clump*: the guide's curve, with an offset that shrinks towards the tip) or the three guides at
//! the corners of its scalp triangle (*multi-strand*: their barycentric blend at equal fractions of their
//! lengths, so that no strand is cut to the shortest). The result is a rest curve and a binding; motion is
//! added each frame on the GPU.
//!
//! Structure has three scales. *Locks*: strands are drawn towards their heaviest guide at the tip.
//! *Clumps*: some strands are centres, and every other strand converges on the nearest centre, more so
//! towards the tip. *Single strands*: lengths, fine frizz, and flyaways.
//!
//! ```text
//! roots ─► binding ─► blend or clump ─► lock ─► clump centre ─► curl ─► unrest ─► clear of the head
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
mod unrest;

pub(crate) use bind::frames_from;
pub use curl::{CurlCurve, Curls};
pub(crate) use curl::{Strand as CurlStrand, Twist};
pub use paint::{ColorMap, Paint};
pub use params::{Clumps, Growth, Kind, Unrest};
pub(crate) use unrest::unrest;

use crate::hash::pcg;
use crate::random::Rng;
use crate::{Progress, Result, progress::at_once};
use crate::{scalp::Scalp, styles::StyledGuides};
use glam::{Vec2, Vec3};

/// One grown strand, apart from its vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrownStrand {
    /// The guides it follows, the heaviest first. A clump strand names its one guide three times.
    pub guides: [u32; 3],
    /// Their weights, the largest first; the sum is 1.
    pub weights: [f32; 3],
    /// For each guide the fraction of it at which the strand's tip hangs.
    pub scale: [f32; 3],
    /// Largest radius along the strand, metres.
    pub radius: f32,
    /// From which every later random choice follows.
    pub seed: u32,
    /// Scalp coordinates of the root.
    pub root_uv: Vec2,
    /// Painted colours of root and tip, packed as in [`Strand`](crate::bound::Strand); 0 for none.
    pub colors: [u32; 2],
}

/// Grown strands at rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GrownStrands {
    /// Vertices of each strand.
    pub vertex_count: usize,
    /// The strands.
    pub strands: Vec<GrownStrand>,
    /// Rest positions, groom space, metres: `vertex_count` of each strand in turn, root first.
    pub positions: Vec<Vec3>,
    /// Radius of each vertex as a fraction of the strand's, indexed as `positions`.
    pub radii: Vec<f32>,
}

impl GrownStrands {
    /// The vertices of strand `i`, root first.
    pub fn strand(&self, i: usize) -> &[Vec3] {
        &self.positions[i * self.vertex_count..(i + 1) * self.vertex_count]
    }
}

/// Grows strands on `scalp` from guides as [`styles::guides`](crate::styles::guides) makes them, or
/// from the same guides after draping.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for growth parameters out of range, and where maps
/// leave no place for the strands that are asked for.
pub fn grow(styled: &StyledGuides, growth: &Growth, scalp: &dyn Scalp) -> Result<GrownStrands> {
    at_once(grow_with(styled, growth, scalp, &()))
}

/// The same, telling `progress`.
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
    growth.curls.fits(median_length(styled), growth.vertices)?;
    let seeds = seed::seeds(&scaffold, styled, growth, scalp, totals)?;
    let n = seeds.len();
    // Hair that is thinned out is no thicker for it.
    let diameter = growth.diameter_for(totals[0] + totals[1]);
    let shaper = shape::Shaper::new(&scaffold, styled, growth, scalp, &seeds);

    let vertices = growth.vertices as usize;
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

/// The median length of the guides, metres.
fn median_length(styled: &StyledGuides) -> f32 {
    let mut lengths: Vec<f32> = (0..styled.guides.len()).map(|i| styled.guides.length(i)).collect();
    lengths.sort_by(f32::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
