//! Followers, as groom files ask for them: so many around each guide, within a radius.
//!
//! A TressFX file says how many hairs follow each of its own, and, in text, how far around it they are rooted.
//! They have the guide's shape and lie beside it all along. Unlike [`fill`](super::fill) this asks nothing of
//! the neighbours: it is the groom as its maker saw it.

use super::{Filled, Grown, Head, Scalp, TASK};
use crate::grow::Growth;
use crate::random::Rng;
use crate::{Error, Followers, Progress, Result, Strands, bind::Parents};
use std::f32::consts::{PI, TAU};

/// Adds to each of `given` (metres, groom space) its followers: `followers` has one entry per strand, or one
/// for all. At most `most` strands come out, as evenly as that allows.
///
/// # Errors
/// [`Error::Unusable`] without strands, where the numbers do not fit together or there would be more than can
/// be drawn; [`Error::Parameter`] for a radius that is none.
pub async fn follow_with(
    given: &Strands,
    head: Head<'_>,
    followers: &[Followers],
    most: u32,
    seed: u32,
    progress: &impl Progress,
) -> Result<Filled> {
    progress.step(TASK, 0.0).await;
    let n = given.len();
    let of = |i: usize| followers[if followers.len() == 1 { 0 } else { i }];
    if followers.len() != 1 && followers.len() != n {
        let problem = format!("{n} strands, but followers for {}", followers.len());
        return Err(Error::Unusable(problem));
    }
    let total = n as u64 + (0..n).map(|i| u64::from(of(i).count)).sum::<u64>();
    if total.min(u64::from(most)) > u64::from(Growth::MOST_STRANDS) {
        return Err(Error::Unusable(format!(
            "the file asks for so many followers that there are {total} strands, more than the {} that can be drawn: say how many to grow, 0 for none",
            Growth::MOST_STRANDS
        )));
    }
    const RADIUS: crate::range::Range = crate::range!("radius of followers", 0.0 to 1.0, "m");
    for radius in followers.iter().filter_map(|f| f.radius) {
        RADIUS.check(radius)?;
    }
    let scalp = Scalp::new(given, head, PI)?;
    let room = (total.min(u64::from(most)) as usize).saturating_sub(n);
    let mut grown = Grown::new(given, room);
    let (shaper, mut line) = (scalp.shaper(head), Vec::new());
    // The first of each, then the second: where not all fit, each has some.
    let rounds = (0..n).map(|i| of(i).count).max().unwrap_or(0);
    'all: for k in 0..rounds {
        for i in 0..n {
            let Followers { count, radius } = of(i);
            if grown.parents.len() == room {
                break 'all;
            }
            if k >= count {
                continue;
            }
            if grown.parents.len().is_multiple_of(256) {
                progress.step(TASK, grown.parents.len() as f32 / room as f32).await;
            }
            let site = scalp.surface.site(i as u32);
            let radius = radius.unwrap_or(0.5 * scalp.surface.spacing[site]);
            // A sunflower's seeds: even in a disc for any number.
            let turned = Rng::new(seed ^ 0xf0110, i as u32).unit() * TAU;
            let (sin, cos) = (turned + k as f32 * 2.399_963).sin_cos();
            let out = radius * ((k as f32 + 0.5) / count as f32).sqrt();
            let normal = scalp.surface.normals[site];
            let across = normal.any_orthonormal_vector();
            let root = given.strand(i)[0] + (across * cos + normal.cross(across) * sin) * out;
            let mut rng = Rng::new(seed ^ 0x6f12, grown.parents.len() as u32);
            let parents = Parents::one(i as u32);
            shaper.grow(root, &parents, false, &mut rng, &mut line);
            shaper.clear(&mut line, &parents);
            grown.push(given, parents, &line);
        }
    }
    Ok(grown.filled(given, false, scalp.kin))
}
