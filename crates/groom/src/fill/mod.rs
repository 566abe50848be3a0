//! Hair from guides alone: new strands between the given ones of a groom.
//!
//! Many grooms are guides to be filled, some hundreds of strands where a head has a hundred thousand. Here
//! any imported groom gets as many strands as are asked for. The given ones stay what they are, to the bit.
//!
//! ```text
//! given strands ─► paths and details ─┐
//!      roots ─► triangles ─► places ──┴─► parents ─► path, detail, tufts, clear of the head ─► strands
//! ```
//!
//! - The scalp is triangulated between the roots (`surface`), wherever they are; new roots fall on the
//!   triangles, evenly and as densely as the given ones or a map have it (`place`), and are brought to the
//!   skin where the given ones grow on it (`skin`).
//! - A new strand has the strands at the corners of its triangle for parents, but only those that run with
//!   the nearest of them (`kin`): hair that runs apart at a parting, around the head or in another clump is
//!   not mixed. So every strand is on one side of a parting, and partings are found, not told.
//! - Its path is the mean of its parents' paths, with their mean lengths; what one of them does around its
//!   path, its curls, is carried over as it is (`curves`, `shape`). Where it has one parent only, it lies
//!   beside that, as far as neighbours are from each other there: clumps close, fans open.
//! - What is finer than the given strands is added: tufts, frizz, strays (`tufts`).
//!
//! New strands are bound to guides through their parents ([`bind_filled`]), with
//! the representation of all others: what they cost in a frame is what any drawn strand costs.
//!
//! Interpolating between three guides by barycentric weights is what engines do (Nguyen and Donnelly, *Hair
//! Animation and Rendering in the Nalu Demo*, GPU Gems 2, chapter 23); they leave the choice of what not to
//! mix to artists.

mod curves;
mod followers;
mod kin;
mod near;
mod place;
mod shape;
mod skin;
mod surface;
#[cfg(test)]
mod tests;
mod tufts;

pub use followers::follow_with;

use crate::grow::{Growth, Paint, Unrest};
use crate::random::Rng;
use crate::scalp::ScalpMap;
use crate::{
    BindOptions, Error, Groom, Progress, Result, SdfGrid, Strands, TriMesh, hash::pcg, progress::at_once,
    strands::Mark,
};
use crate::{
    bind::{Origins, Parents, bind_any},
    range,
    range::Range,
};
use curves::Curves;
use glam::Vec3;
use kin::Kin;
use place::{Place, Thrower};
use shape::Shaper;
use skin::Skin;
use surface::Surface;
use tufts::Tufts;

const TASK: &str = "growing strands between the given ones";

/// How a groom is filled.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// Strands in all, the given ones among them, before the map takes some away.
    pub strands: u32,
    /// Density over the scalp: the share of the new strands that there are, 0 to 1; `None` for all.
    pub density: Option<ScalpMap>,
    /// The middle of the braincase, groom space, metres, from which the map is seen.
    pub skull: Vec3,
    /// Neighbouring strands that are at a greater angle anywhere, seen from their roots, are not mixed,
    /// radians; π for all to be mixed.
    pub parting: f32,
    /// How far new strands beside one given strand run together in tufts at their tips, 0 to 1.
    pub tufts: f32,
    /// How single new strands differ; `shorter` is without effect.
    pub unrest: Unrest,
    /// What every random choice follows from.
    pub seed: u32,
}

impl Default for Fill {
    fn default() -> Self {
        let unrest =
            Unrest { frizz: 2e-4, strays: 0.2, stray: 0.0025, flyaways: 0.02, flyaway: 0.008, shorter: 0.0 };
        Self {
            strands: 20_000,
            density: None,
            skull: Vec3::ZERO,
            parting: 60f32.to_radians(),
            tufts: 0.55,
            unrest,
            seed: 1,
        }
    }
}

impl Fill {
    /// The range of [`parting`](Self::parting).
    #[allow(clippy::approx_constant)] // Ranges are given as literals: their texts are made of them.
    pub const PARTING: Range = range!("parting angle", 0.0 to 3.1415927, "rad");

    fn check(&self) -> Result<()> {
        const TUFTS: Range = range!("strength of tufts", 0.0 to 1.0);
        Self::PARTING.check(self.parting)?;
        TUFTS.check(self.tufts)?;
        self.unrest.check()?;
        if self.strands > Growth::MOST_STRANDS {
            let value = self.strands.to_string();
            return Err(Error::Parameter { name: "number of strands", value, range: "at most 4,000,000" });
        }
        Ok(())
    }
}

/// What hair grows on; either may be missing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Head<'a> {
    /// Its surface, groom space, metres: new roots lie on it.
    pub mesh: Option<&'a TriMesh>,
    /// Its distance field: new strands stay outside.
    pub field: Option<&'a SdfGrid>,
}

/// Given strands and new ones.
pub struct Filled {
    /// The given ones first, as they were, then the new ones.
    pub strands: Strands,
    /// How many are given.
    pub given: usize,
    /// What each new strand is made of. Indices are those of the strands that were given to be filled.
    pub parents: Vec<Parents>,
    /// For each given strand that is left, which one it was.
    original: Vec<u32>,
    /// Whether new strands are as dense as a map says already.
    painted: bool,
    kin: Kin,
}

impl std::fmt::Debug for Filled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} strands, {} of them given", self.strands.len(), self.given)
    }
}

impl Filled {
    /// The same, painted as [`Paint::apply`] does; strands that grew by a map of density are not thinned out
    /// once more.
    ///
    /// # Errors
    /// [`Error::Unusable`] when nothing is left.
    pub fn painted(self, paint: &Paint, skull: Vec3, seed: u32) -> Result<Self> {
        let dense = if self.painted { self.given } else { self.strands.len() };
        let (strands, kept) = paint.apply_kept(&self.strands, skull, seed, dense)?;
        let given = kept.partition_point(|i| (*i as usize) < self.given);
        let parents = kept[given..].iter().map(|i| self.parents[*i as usize - self.given]).collect();
        let original = kept[..given].iter().map(|i| self.original[*i as usize]).collect();
        Ok(Self { strands, given, parents, original, painted: true, kin: self.kin })
    }
}

/// [`bind`](crate::bind()) for filled strands: guides are chosen among the given ones, as many as for all strands; new
/// strands follow the guides of their parents, one to three, and none that runs apart from them.
/// [`GuideCount::All`](crate::GuideCount::All) makes every given strand a guide.
///
/// # Errors
/// As [`bind`](crate::bind()).
pub fn bind_filled(filled: &Filled, options: &BindOptions) -> Result<Groom> {
    let Filled { strands, given, parents, original, kin, .. } = filled;
    let runs_with = |a, b| kin.runs_with(a, b);
    let origins = Origins { given: *given, original, parents, runs_with: &runs_with };
    // Where a map has left none of the given strands, guides are chosen among all.
    bind_any(strands, options, (*given > 0).then_some(&origins))
}

/// Fills `given` (metres, groom space) on `head`. Where there are as many already, nothing changes.
///
/// # Errors
/// [`Error::Unusable`] without strands or with a strand of one vertex, [`Error::Parameter`] for more strands
/// than can be drawn or an angle that is none.
pub fn fill(given: &Strands, head: Head<'_>, options: &Fill) -> Result<Filled> {
    at_once(fill_with(given, head, options, &()))
}

/// The same, telling `progress`.
///
/// # Errors
/// As [`fill`].
pub async fn fill_with(
    given: &Strands,
    head: Head<'_>,
    options: &Fill,
    progress: &impl Progress,
) -> Result<Filled> {
    options.check()?;
    progress.step(TASK, 0.0).await;
    let scalp = Scalp::new(given, head, options.parting)?;
    let wanted = (options.strands as usize).saturating_sub(given.len());
    let map = options.density.as_ref().map(|map| (map, options.skull));
    let thrower = Thrower::new(&scalp.surface, map, options.seed);
    let count = (wanted as f32 * thrower.share(4096)).round() as usize;
    let density = (given.len() + wanted) as f32 / given.len() as f32;
    let places = thrower.places(count, density, progress, TASK).await;

    let mut grown = Grown::new(given, places.len());
    let (shaper, mut line) = (scalp.shaper(head), Vec::new());
    let done = |from: f32, i: usize| from + 0.25 * i as f32 / count as f32;
    for (i, place) in places.iter().enumerate() {
        if i % 256 == 0 {
            progress.step(TASK, done(0.5, i)).await;
        }
        let mut rng = Rng::new(options.seed ^ 0x6f11, i as u32);
        let parents = scalp.parents(place, head.field, &mut rng);
        shaper.grow(place.root, &parents, true, &mut rng, &mut line);
        grown.push(given, parents, &line);
    }
    let tufts = Tufts::new(&grown, given.len(), &scalp.surface);
    for i in 0..places.len() {
        if i % 256 == 0 {
            progress.step(TASK, done(0.75, i)).await;
        }
        let range = grown.strands.range(given.len() + i);
        let line = &mut grown.strands.positions[range];
        tufts.comb(i, options, &mut Rng::new(options.seed ^ 0x70f7, i as u32), line);
        shaper.clear(line, &grown.parents[i]);
    }
    Ok(grown.filled(given, options.density.is_some(), scalp.kin))
}

/// What is known of the given strands.
struct Scalp {
    surface: Surface,
    kin: Kin,
    skin: Option<Skin>,
}

impl Scalp {
    fn new(given: &Strands, head: Head<'_>, parting: f32) -> Result<Self> {
        if given.is_empty() {
            return Err(Error::Unusable("the groom has no strands to grow others between".into()));
        }
        if let Some(i) = (0..given.len()).find(|i| given.range(*i).len() < 2) {
            return Err(Error::Unusable(format!("strand {i} has fewer than two vertices")));
        }
        let curves = Curves::new(given, head.field);
        let roots: Vec<Vec3> = given.iter().map(|strand| strand[0]).collect();
        let ways: Vec<Vec3> =
            (0..given.len() as u32).map(|i| curves.knots(i)[1] - curves.knots(i)[0]).collect();
        let surface = Surface::new(&roots, &ways, head.field);
        let pinned = (0..given.len()).map(|i| given.tip_pinned.get(i) == Some(&true)).collect();
        let kin = Kin::new(curves, pinned, &surface, parting);
        Ok(Self { skin: head.mesh.and_then(|mesh| Skin::new(mesh, &roots)), surface, kin })
    }

    fn shaper<'a>(&'a self, head: Head<'a>) -> Shaper<'a> {
        Shaper { kin: &self.kin, field: head.field, skin: self.skin.as_ref() }
    }

    /// The parents of a strand rooted at `place`.
    fn parents(&self, place: &Place, field: Option<&SdfGrid>, rng: &mut Rng) -> Parents {
        let strands = place.sites.map(|site| {
            let all = self.surface.strands(site);
            all[pcg(rng.bits()) as usize % all.len()]
        });
        if place.sites[0] == place.sites[1] {
            return Parents::one(strands[0]);
        }
        // The nearest decides on which side of a parting it is, and in which clump.
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| place.weights[*b].total_cmp(&place.weights[*a]));
        let [near, second, third] = order;
        let mut weights = place.weights;
        for k in [second, third] {
            if !self.kin.mixes(strands[near], strands[k], field) {
                weights[k] = 0.0;
            }
        }
        if weights[second] * weights[third] > 0.0 && !self.kin.mixes(strands[second], strands[third], field) {
            weights[third] = 0.0;
        }
        let sum: f32 = weights.iter().sum();
        // Whose curls it has: mostly those of the nearest, so that locks interlock where they meet.
        let mut chance = rng.unit() * weights.iter().map(|w| w.powi(3)).sum::<f32>();
        let lead = order.into_iter().find(|k| {
            chance -= weights[*k].powi(3);
            chance < 0.0
        });
        let lead = lead.unwrap_or(near);
        let order = [lead, (lead + 1) % 3, (lead + 2) % 3];
        Parents { strands: order.map(|k| strands[k]), weights: order.map(|k| weights[k] / sum) }
    }
}

/// New strands as they are made.
struct Grown {
    strands: Strands,
    parents: Vec<Parents>,
}

impl Grown {
    fn new(given: &Strands, count: usize) -> Self {
        Self { strands: given.clone(), parents: Vec::with_capacity(count) }
    }

    /// A strand along `line` with the attributes of its first parent.
    fn push(&mut self, given: &Strands, parents: Parents, line: &[Vec3]) {
        let lead = parents.strands[0] as usize;
        let range = given.range(lead);
        let strands = &mut self.strands;
        strands.push(line);
        strands.radii.extend(given.radii.get(range.clone()).into_iter().flatten());
        strands.colors.extend(given.colors.get(range).into_iter().flatten());
        strands.root_uvs.extend(given.root_uvs.get(lead));
        strands.tip_pinned.extend(given.tip_pinned.get(lead));
        // New hair is of the group it grows in, and no guide.
        strands.marks.extend(given.marks.get(lead).map(|mark| Mark { guide: false, ..*mark }));
        self.parents.push(parents);
    }

    fn filled(self, given: &Strands, painted: bool, kin: Kin) -> Filled {
        let original = (0..given.len() as u32).collect();
        Filled { strands: self.strands, given: given.len(), parents: self.parents, original, painted, kin }
    }
}
