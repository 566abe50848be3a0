//! Densifies a groom: interpolates new strands between the input strands.
//!
//! Many grooms contain only guides: some hundreds of strands, where a head has a hundred thousand. This module fills
//! any imported groom up to a given strand count. The input strands stay bit-identical.
//!
//! ```text
//! input strands ─► paths and details ─┐
//!      roots ─► triangles ─► places ──┴─► parents ─► path, detail, tufts, clear of the head ─► strands
//! ```
//!
//! - The scalp is triangulated between the roots (`surface`). New roots are scattered evenly over the triangles, as
//!   densely as the input roots or as a map specifies (`place`). If the input strands grow on the skin, new roots are
//!   projected onto it (`skin`).
//! - The parents of a new strand are the strands at the corners of its triangle, limited to those that run with the
//!   nearest of them (`kin`). Hair that diverges at a parting or around the head, or that belongs to different clumps,
//!   is not mixed. Every strand is thus on one side of a parting, and partings are found automatically.
//! - The path of a new strand is the mean of its parents' paths, with a length between theirs. Its curls are copied
//!   unchanged from one parent (`curves`, `shape`). A strand with a single parent lies beside it, at the distance that
//!   neighbors have there: clumps close, fans open.
//! - Detail finer than the input strands is added: tufts, frizz, stray hairs (`tufts`).
//!
//! New strands are bound to guides through their parents ([`bind_filled`]) and have the representation of all other
//! strands. Each costs as much per frame as any render strand.
//!
//! Engines interpolate between three guides with barycentric weights (Nguyen and Donnelly, *Hair Animation and
//! Rendering in the Nalu Demo*, GPU Gems 2, chapter 23). They leave it to artists to mark hair that must not be mixed.

pub(crate) mod curves;
mod followers;
mod kin;
mod scatter;
mod shape;
mod skin;
mod surface;
#[cfg(test)]
mod tests;
mod tufts;

pub use followers::follow_with;

use crate::grow::{Growth, ScalpPaint, StrandVariation};
use crate::random::Rng;
use crate::scalp::ScalpMap;
use crate::skin::MapProjection;
use crate::{
    BindOptions, Error, Groom, Progress, Result, SdfGrid, Strands, TriMesh, hash::pcg, progress::at_once,
};
use crate::{
    bind::{Origins, Parents, bind_any},
    range,
    range::Range,
};
use curves::{Curves, Smoothing};
use glam::Vec3;
use kin::Kin;
use scatter::{RootPoint, Thrower};
use shape::Shaper;
use skin::Skin;
use surface::Surface;
use tufts::Tufts;

const TASK: &str = "filling the groom";

/// Options for filling a groom.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// Total number of strands, input strands included, before the map removes some.
    pub strand_count: u32,
    /// Density over the scalp: the fraction of new strands to keep, 0 to 1; `None` for all.
    pub density: Option<ScalpMap>,
    /// Center of the braincase, groom space, meters; the map is projected from it.
    pub skull: Vec3,
    /// Neighboring strands are not mixed if they diverge by more than this angle anywhere, seen from their roots,
    /// radians. π mixes all strands.
    pub parting: f32,
    /// Strength of the tufts that new strands beside one input strand form toward their tips, 0 to 1.
    pub tufts: f32,
    /// Random variation of single new strands; `shorter` has no effect.
    pub variation: StrandVariation,
    /// Seed of every random choice.
    pub seed: u32,
}

impl Default for Fill {
    fn default() -> Self {
        let variation = StrandVariation {
            frizz: 2e-4,
            strays: 0.2,
            stray: 0.0025,
            flyaways: 0.02,
            flyaway: 0.008,
            shorter: 0.0,
        };
        Self {
            strand_count: 20_000,
            density: None,
            skull: Vec3::ZERO,
            parting: 60f32.to_radians(),
            tufts: 0.55,
            variation,
            seed: 1,
        }
    }
}

impl Fill {
    /// The range of [`parting`](Self::parting).
    #[allow(clippy::approx_constant)] // The texts of ranges are made from literals.
    pub const PARTING: Range = range!("parting angle", 0.0 to 3.1415927, "rad");

    fn check(&self) -> Result<()> {
        const TUFTS: Range = range!("tuft strength", 0.0 to 1.0);
        Self::PARTING.check(self.parting)?;
        TUFTS.check(self.tufts)?;
        self.variation.check()?;
        if self.strand_count > Growth::MAX_STRANDS {
            let value = self.strand_count.to_string();
            return Err(Error::Parameter { name: "number of strands", value, range: "at most 4,000,000" });
        }
        Ok(())
    }
}

/// The head that hair grows on; either part may be missing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Head<'a> {
    /// Surface, groom space, meters. New roots lie on it.
    pub mesh: Option<&'a TriMesh>,
    /// Distance field. New strands stay outside.
    pub field: Option<&'a SdfGrid>,
}

/// Input strands and new strands.
pub struct FilledStrands {
    /// The unchanged input strands, then the new ones.
    pub strands: Strands,
    /// Number of input strands.
    pub given: usize,
    /// Parents of each new strand. The indices refer to the strands passed to [`fill`].
    pub parents: Vec<Parents>,
    /// For each remaining input strand, its index among the strands passed to [`fill`].
    original: Vec<u32>,
    /// Whether the density of the new strands already follows a map.
    painted: bool,
    kin: Kin,
}

impl std::fmt::Debug for FilledStrands {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} strands, {} of them given", self.strands.len(), self.given)
    }
}

impl FilledStrands {
    /// Returns the strands painted as by [`ScalpPaint::apply`]. New strands that already follow a density map are not
    /// thinned out again.
    ///
    /// # Errors
    /// [`Error::Unusable`] if no strand is left.
    pub fn painted<'a>(
        self,
        paint: &ScalpPaint,
        on: impl Into<MapProjection<'a>>,
        seed: u32,
    ) -> Result<Self> {
        let dense = if self.painted { self.given } else { self.strands.len() };
        let (strands, kept) = paint.apply_kept(&self.strands, on.into(), seed, dense)?;
        let given = kept.partition_point(|i| (*i as usize) < self.given);
        let parents = kept[given..].iter().map(|i| self.parents[*i as usize - self.given]).collect();
        let original = kept[..given].iter().map(|i| self.original[*i as usize]).collect();
        Ok(Self { strands, given, parents, original, painted: true, kin: self.kin })
    }
}

/// [`bind`](crate::bind()) for filled strands. Guides are chosen among the input strands, as many as for all strands.
/// Each new strand follows one to three guides of its parents, and none that runs apart from them.
/// [`GuideCount::All`](crate::GuideCount::All) makes every input strand a guide.
///
/// # Errors
/// As [`bind`](crate::bind()).
pub fn bind_filled(filled: &FilledStrands, options: &BindOptions) -> Result<Groom> {
    let FilledStrands { strands, given, parents, original, kin, .. } = filled;
    let runs_with = |a, b| kin.runs_with(a, b);
    let origins = Origins { given: *given, original, parents, runs_with: &runs_with };
    // If a map removed all input strands, guides are chosen among the new ones.
    bind_any(strands, options, (*given > 0).then_some(&origins))
}

/// Fills `given` (meters, groom space) on `head`. Returns it unchanged if it already has enough strands.
///
/// # Errors
/// [`Error::Unusable`] without strands or with a strand of one vertex; [`Error::Parameter`] for more strands than can
/// be rendered or for an option out of range.
pub fn fill(given: &Strands, head: Head<'_>, options: &Fill) -> Result<FilledStrands> {
    at_once(fill_with(given, head, options, &()))
}

/// [`fill`] that reports to `progress`.
///
/// # Errors
/// As [`fill`].
pub async fn fill_with(
    given: &Strands,
    head: Head<'_>,
    options: &Fill,
    progress: &impl Progress,
) -> Result<FilledStrands> {
    options.check()?;
    progress.step(TASK, 0.0).await;
    let scalp = Scalp::new(given, head, options.parting)?;
    let requested = (options.strand_count as usize).saturating_sub(given.len());
    let map = options.density.as_ref().map(|map| (map, options.skull));
    let thrower = Thrower::new(&scalp.surface, map, options.seed);
    let count = (requested as f32 * thrower.kept_fraction(4096)).round() as usize;
    let density = (given.len() + requested) as f32 / given.len() as f32;
    let points = thrower.scatter(count, density, progress, TASK).await;

    let mut new_strands = NewStrands::new(given, points.len());
    let (shaper, mut line) = (scalp.shaper(head), Vec::new());
    let done = |from: f32, i: usize| from + 0.25 * i as f32 / count as f32;
    for (i, point) in points.iter().enumerate() {
        if i % 256 == 0 {
            progress.step(TASK, done(0.5, i)).await;
        }
        let mut rng = Rng::new(options.seed ^ 0x6f11, i as u32);
        let parents = scalp.parents(point, head.field, &mut rng);
        shaper.grow(point.root, &parents, true, &mut rng, &mut line);
        new_strands.push(given, parents, &line);
    }
    let tufts = Tufts::new(&new_strands, given.len(), &scalp.surface);
    for i in 0..points.len() {
        if i % 256 == 0 {
            progress.step(TASK, done(0.75, i)).await;
        }
        let range = new_strands.strands.range(given.len() + i);
        let line = &mut new_strands.strands.positions[range];
        tufts.comb(i, options, &mut Rng::new(options.seed ^ 0x70f7, i as u32), line);
        shaper.clear(line, &new_strands.parents[i]);
    }
    Ok(new_strands.filled(given, options.density.is_some(), scalp.kin))
}

/// Surface, relations and skin of the input strands.
struct Scalp {
    surface: Surface,
    kin: Kin,
    skin: Option<Skin>,
}

impl Scalp {
    fn new(given: &Strands, head: Head<'_>, parting: f32) -> Result<Self> {
        if given.is_empty() {
            return Err(Error::Unusable("the groom has no strands, so it cannot be filled".into()));
        }
        if let Some(i) = (0..given.len()).find(|i| given.range(*i).len() < 2) {
            return Err(Error::Unusable(format!("strand {i} has fewer than two vertices")));
        }
        let curves = Curves::new(given, head.field, Smoothing::STRONG);
        let roots: Vec<Vec3> = given.iter().map(|strand| strand[0]).collect();
        let outward: Vec<Vec3> =
            (0..given.len() as u32).map(|i| curves.path_points(i)[1] - curves.path_points(i)[0]).collect();
        let surface = Surface::new(&roots, &outward, head.field);
        let pinned = (0..given.len()).map(|i| given.tip_pinned.get(i) == Some(&true)).collect();
        let kin = Kin::new(curves, pinned, &surface, parting);
        Ok(Self { skin: head.mesh.and_then(|mesh| Skin::new(mesh, &roots)), surface, kin })
    }

    fn shaper<'a>(&'a self, head: Head<'a>) -> Shaper<'a> {
        Shaper { kin: &self.kin, field: head.field, skin: self.skin.as_ref() }
    }

    /// Chooses the parents of a strand rooted at `point`.
    fn parents(&self, point: &RootPoint, field: Option<&SdfGrid>, rng: &mut Rng) -> Parents {
        let strands = point.sites.map(|site| {
            let all = self.surface.strands(site);
            all[pcg(rng.bits()) as usize % all.len()]
        });
        if point.sites[0] == point.sites[1] {
            return Parents::one(strands[0]);
        }
        // The nearest strand determines the side of the parting and the clump.
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| point.weights[*b].total_cmp(&point.weights[*a]));
        let [near, second, third] = order;
        let mut weights = point.weights;
        for k in [second, third] {
            if !self.kin.mixes(strands[near], strands[k], field) {
                weights[k] = 0.0;
            }
        }
        if weights[second] * weights[third] > 0.0 && !self.kin.mixes(strands[second], strands[third], field) {
            weights[third] = 0.0;
        }
        let sum: f32 = weights.iter().sum();
        // The lead, which provides the curls, is mostly the nearest strand; the random choice lets locks interlock
        // where they meet.
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

/// New strands under construction.
struct NewStrands {
    strands: Strands,
    parents: Vec<Parents>,
}

impl NewStrands {
    fn new(given: &Strands, count: usize) -> Self {
        Self { strands: given.clone(), parents: Vec::with_capacity(count) }
    }

    /// Adds a strand along `line` with the attributes of its first parent.
    fn push(&mut self, given: &Strands, parents: Parents, line: &[Vec3]) {
        let lead = parents.strands[0] as usize;
        let range = given.range(lead);
        let strands = &mut self.strands;
        strands.positions.extend(line);
        strands.radii.extend(given.radii.get(range.clone()).into_iter().flatten());
        strands.colors.extend(given.colors.get(range.clone()).into_iter().flatten());
        range.for_each(|vertex| strands.push_custom(given, [vertex, vertex], 0.0));
        strands.end_like(given, lead);
        // New strands belong to the group of their parent and are no guides.
        if let Some(mark) = strands.marks.last_mut() {
            mark.guide = false;
        }
        self.parents.push(parents);
    }

    fn filled(self, given: &Strands, painted: bool, kin: Kin) -> FilledStrands {
        let original = (0..given.len() as u32).collect();
        FilledStrands {
            strands: self.strands,
            given: given.len(),
            parents: self.parents,
            original,
            painted,
            kin,
        }
    }
}
