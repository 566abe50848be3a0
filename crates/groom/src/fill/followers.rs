//! Child strands that groom files define by a count per guide and a radius.
//!
//! A TressFX file stores how many hairs follow each of its strands and, as text, the radius around the guide within
//! which they are rooted. Child strands have the shape of their guide and stay beside it. Unlike [`fill`](super::fill),
//! this does not depend on the neighboring strands, so the groom matches what its artist saw.

use super::{FilledStrands, Head, NewStrands, Scalp, TASK};
use crate::grow::Growth;
use crate::random::Rng;
use crate::{Error, Followers, Progress, Result, Strands, bind::Parents};
use std::f32::consts::{PI, TAU};

/// Adds to each of `given` (meters, groom space) its child strands. `followers` has one entry per strand, or one for
/// all. The result has at most `max_strands` strands; that limit reduces the children of all strands evenly.
///
/// # Errors
/// [`Error::Unusable`] without strands, if the numbers of strands and followers differ, or for more strands than can be
/// rendered; [`Error::Parameter`] for an invalid radius.
pub async fn follow_with(
    given: &Strands,
    head: Head<'_>,
    followers: &[Followers],
    max_strands: u32,
    seed: u32,
    progress: &impl Progress,
) -> Result<FilledStrands> {
    progress.step(TASK, 0.0).await;
    let n = given.len();
    let of = |i: usize| followers[if followers.len() == 1 { 0 } else { i }];
    if followers.len() != 1 && followers.len() != n {
        let problem = format!("the groom has {n} strands, but child strand settings for {}", followers.len());
        return Err(Error::Unusable(problem));
    }
    let total = n as u64 + (0..n).map(|i| u64::from(of(i).count)).sum::<u64>();
    if total.min(u64::from(max_strands)) > u64::from(Growth::MAX_STRANDS) {
        return Err(Error::Unusable(format!(
            "with the child strands of the file there are {total} strands, more than the {} that can be rendered; set how many to grow, or 0 for none",
            Growth::MAX_STRANDS
        )));
    }
    const RADIUS: crate::range::Range = crate::range!("child strand radius", 0.0 to 1.0, "m");
    for radius in followers.iter().filter_map(|f| f.radius) {
        RADIUS.check(radius)?;
    }
    let scalp = Scalp::new(given, head, PI)?;
    let capacity = (total.min(u64::from(max_strands)) as usize).saturating_sub(n);
    let mut new_strands = NewStrands::new(given, capacity);
    let (shaper, mut line) = (scalp.shaper(head), Vec::new());
    // Add the first child of every strand, then the second: if not all fit, each strand has some.
    let rounds = (0..n).map(|i| of(i).count).max().unwrap_or(0);
    'all: for k in 0..rounds {
        for i in 0..n {
            let Followers { count, radius } = of(i);
            if new_strands.parents.len() == capacity {
                break 'all;
            }
            if k >= count {
                continue;
            }
            if new_strands.parents.len().is_multiple_of(256) {
                progress.step(TASK, new_strands.parents.len() as f32 / capacity as f32).await;
            }
            let site = scalp.surface.site(i as u32);
            let radius = radius.unwrap_or(0.5 * scalp.surface.spacing[site]);
            // Sunflower spiral: evenly spread in a disc for any count.
            let start_angle = Rng::new(seed ^ 0xf0110, i as u32).unit() * TAU;
            let (sin, cos) = (start_angle + k as f32 * 2.399_963).sin_cos();
            let out = radius * ((k as f32 + 0.5) / count as f32).sqrt();
            let normal = scalp.surface.normals[site];
            let across = normal.any_orthonormal_vector();
            let root = given.strand(i)[0] + (across * cos + normal.cross(across) * sin) * out;
            let mut rng = Rng::new(seed ^ 0x6f12, new_strands.parents.len() as u32);
            let parents = Parents::one(i as u32);
            shaper.grow(root, &parents, false, &mut rng, &mut line);
            shaper.clear(&mut line, &parents);
            new_strands.push(given, parents, &line);
        }
    }
    Ok(new_strands.filled(given, false, scalp.kin))
}
