//! The roots of the drawn strands, and the guides that each is bound to.

use super::Growth;
use super::bind::{Bound, Scaffold};
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
    pub(crate) bound: Bound,
    /// The side of the parting, and the distance from it, metres.
    pub(crate) side: f32,
    pub(crate) beside: f32,
    /// Whether it follows one guide.
    pub(crate) clump: bool,
    /// Fraction of the guides' length at which it ends.
    pub(crate) fraction: f32,
    /// Width against the usual one.
    pub(crate) thickness: f32,
    /// Painted factors of length and width; `None` where there is to be no strand. It is still in the list,
    /// so that the others stay where and what they are whatever is painted.
    pub(crate) paint: Option<[f32; 2]>,
}

/// Distance from the whorl below which strands follow one guide, metres.
const ALONE: f32 = 0.035;

/// Tries for each strand before it is said that there is no place for it.
const PATIENCE: u64 = 400;

/// The strands: roots follow one evenly spread sequence over the scalp, thinned out by density,
/// so that the strands of every beginning of the list are spread evenly too.
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
        // Which kind comes next is drawn so that both run out together.
        let clump = rng.unit() * ((left[0] + left[1]) as f32) < left[0] as f32 && left[0] > 0 || left[1] == 0;
        let dir = (spread_direction(i, start) + 0.002 * rng.bell3()).normalize_or(Vec3::Y);
        let root = scalp.point(dir);
        // Equal steps of direction are unequal areas of the scalp.
        let area = root.distance_squared(skull) / 0.016;
        if rng.unit() > area {
            continue;
        }
        let edge = styled.hairline.inside(root);
        if edge < 0.0 {
            continue;
        }
        let (side, beside) = styled.parting.as_ref().map_or((1.0, 1.0), |parting| {
            let q = parting.nearest(root);
            (if root.x >= q.x { 1.0 } else { -1.0 }, q.distance(root))
        });
        if beside < styled.recipe.parting_half_width * rng.range(0.6, 1.4) {
            continue;
        }
        let uv = scalp_uv(root - skull);
        let open = open(styled, root, beside);
        let density =
            if clump { clump_density(growth, edge, open, uv) } else { multi_density(growth, edge, open, uv) };
        if rng.unit() >= density {
            continue;
        }
        // At a whorl hair parts in all directions. The mean of three guides is a stub that covers little,
        // and single guides leave gaps between them: half of each closes both.
        let crown = styled.parting.is_none() && root.distance(styled.whorl) < ALONE * rng.range(0.5, 1.0);
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
            beside,
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
                Err(Error::Unusable("the maps leave no strand: they are black wherever hair grows".into()))
            }
            false => Ok(seeds),
        };
    }
    Err(Error::Parameter {
        name: "number of strands",
        value: total.to_string(),
        range: "0 where the scalp maps leave no place inside the hairline",
    })
}

/// How long a strand is against its guides: a little shorter, and many short ones at the hairline.
fn fraction(growth: &Growth, edge: f32, rng: &mut Rng) -> f32 {
    let shorter = 1.0 - growth.unrest.shorter * (0.15 + 0.85 * rng.unit());
    let fringe = 1.0 - smoothstep(0.0, 0.01, edge);
    if rng.unit() < 0.55 * fringe { shorter * rng.range(0.12, 0.45) } else { shorter }
}
