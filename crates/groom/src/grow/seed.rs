//! Roots of the render strands, and the guides of each.

use super::Growth;
use super::bind::{GuideWeights, Scaffold};
use super::count::{clump_density, multi_density, open};
use crate::random::{Rng, smoothstep};
use crate::scalp::{Scalp, scalp_uv, spread_direction};
use crate::styles::StyledGuides;
use crate::{Error, Result};
use glam::{Vec2, Vec3};

/// A strand before it has a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seed {
    pub(crate) root: Vec3,
    pub(crate) uv: Vec2,
    pub(crate) bound: GuideWeights,
    /// Side of the parting, 1 or -1; `parting_distance` is the distance from it, meters.
    pub(crate) side: f32,
    pub(crate) parting_distance: f32,
    /// Whether the strand follows one guide.
    pub(crate) clump: bool,
    /// Fraction of the guides' length at which the strand ends.
    pub(crate) fraction: f32,
    /// Width relative to the usual width.
    pub(crate) thickness: f32,
    /// Painted factors on length and width; `None` if the maps remove the strand. A removed strand stays in the list,
    /// so that maps do not change the other strands.
    pub(crate) paint: Option<[f32; 2]>,
}

/// Distance from the whorl below which strands follow one guide, meters.
const SINGLE_GUIDE_RADIUS: f32 = 0.035;

/// Tries per strand before growth fails for lack of a place.
const PATIENCE: u64 = 400;

/// Returns the strands to grow. Roots follow one evenly spread sequence over the scalp, thinned out by density, so
/// every prefix of the list is evenly spread too.
pub(crate) fn seeds(
    scaffold: &Scaffold,
    styled: &StyledGuides,
    growth: &Growth,
    scalp: &dyn Scalp,
    [clumps, multis]: [usize; 2],
) -> Result<Vec<Seed>> {
    let total = clumps + multis;
    let skull = scalp.landmarks().skull;
    let mut rng = Rng::new(growth.seed, 0x6000);
    let start = Vec2::new(rng.unit(), rng.unit());
    let mut seeds = Vec::with_capacity(total);
    let mut left = [clumps, multis];
    for i in 0..(total as u64 + 1000) * PATIENCE {
        if left == [0, 0] {
            break;
        }
        let Ok(i) = u32::try_from(i) else { break };
        let mut rng = Rng::new(growth.seed ^ 0x77, i);
        // Draw the kind at random, so that both kinds run out together.
        let clump = rng.unit() * ((left[0] + left[1]) as f32) < left[0] as f32 && left[0] > 0 || left[1] == 0;
        let dir = (spread_direction(i, start) + 0.002 * rng.bell3()).normalize_or(Vec3::Y);
        let root = scalp.point(dir);
        // Equal steps of direction cover unequal areas of the scalp.
        let area = root.distance_squared(skull) / 0.016;
        if rng.unit() > area {
            continue;
        }
        let edge = styled.hairline.inside(root);
        if edge < 0.0 {
            continue;
        }
        let (side, parting_distance) = styled.parting.as_ref().map_or((1.0, 1.0), |parting| {
            let q = parting.nearest(root);
            (if root.x >= q.x { 1.0 } else { -1.0 }, q.distance(root))
        });
        if parting_distance < styled.recipe.parting_half_width * rng.range(0.6, 1.4) {
            continue;
        }
        let uv = scalp_uv(root - skull);
        let open = open(styled, root, parting_distance);
        let density =
            if clump { clump_density(growth, edge, open, uv) } else { multi_density(growth, edge, open, uv) };
        if rng.unit() >= density {
            continue;
        }
        // At a whorl, hair parts in all directions. The mean of three guides is a stub that covers little, and single
        // guides leave gaps. Half of each kind closes both.
        let crown = styled.parting.is_none()
            && root.distance(styled.whorl) < SINGLE_GUIDE_RADIUS * rng.range(0.5, 1.0);
        let single = clump || (crown && rng.unit() < 0.5);
        let bound = if single { scaffold.single(root) } else { scaffold.blend(root) };
        let Some(bound) = bound else { continue };
        left[usize::from(!clump)] -= 1;
        let fraction = fraction(growth, edge, &mut rng);
        seeds.push(Seed {
            root,
            uv,
            bound,
            side,
            parting_distance,
            clump: single,
            fraction,
            paint: growth.paint.strand(uv, rng.unit()),
            thickness: growth
                .thickness_map
                .as_ref()
                .map_or_else(|| 0.55 + 0.45 * smoothstep(0.0, 0.012, edge), |map| map.sample(uv)),
        });
    }
    if left == [0, 0] {
        return match total > 0 && seeds.iter().all(|seed| seed.paint.is_none()) {
            true => {
                Err(Error::Unusable("the maps remove all strands: they are black wherever hair grows".into()))
            }
            false => Ok(seeds),
        };
    }
    Err(Error::Parameter {
        name: "number of strands",
        value: total.to_string(),
        range: "0, because the scalp maps are black inside the hairline",
    })
}

/// Returns the length of a strand relative to its guides: slightly shorter, with many short strands at the hairline.
fn fraction(growth: &Growth, edge: f32, rng: &mut Rng) -> f32 {
    let shorter = 1.0 - growth.variation.shorter * (0.15 + 0.85 * rng.unit());
    let fringe = 1.0 - smoothstep(0.0, 0.01, edge);
    if rng.unit() < 0.55 * fringe { shorter * rng.range(0.12, 0.45) } else { shorter }
}
