//! Built-in hairstyles: fields over the scalp, and the guides that follow them.
//!
//! A [`Style`] expands to a [`Recipe`] of numbers, from which [`guides`] makes strands. Roots are spread evenly inside
//! a [`Hairline`]. From each root a path leaves the scalp at an angle and is combed away from the [`Parting`] and back.
//! It stays clear of the head by a distance that grows with the height of its root (hair from the top lies over hair
//! from the sides), falls where the head no longer supports it, and ends at a length or at a common hem. Waves are
//! added along the path.
//!
//! The shapes are close to their equilibrium under gravity and contact. The simulation of `tresses::drape` finishes
//! them, with as much hold as the style needs to keep its volume and its wave ([`Hold`]). Guides have no spirals,
//! because three spirals of different phase have no meaningful mean. Instead, [`Curls`](crate::grow::Curls) describes
//! how [`grow`](crate::grow) winds the render strands around the guides.

mod cooked;
mod face;
mod hairline;
mod parting;
mod recipe;
mod roots;
mod trace;

pub use cooked::{cook, settled};
pub use face::Face;
pub use hairline::Hairline;
pub use parting::Parting;
pub use recipe::{Bob, Curly, Hold, Long, LowTop, Recipe, Short, Style};

use crate::{
    Progress, Strands,
    curve::resample_chords,
    progress::at_once,
    scalp::{Scalp, scalp_uv},
};
use glam::Vec3;

/// Vertices per guide.
pub const GUIDE_VERTICES: usize = 32;

/// Guides of a hairstyle, with their stiffness and the lines of the scalp.
#[derive(Clone, Debug)]
pub struct StyledGuides {
    /// Guides, root first, with [`GUIDE_VERTICES`] vertices each at equal distances and with scalp coordinates. A
    /// draped version may replace them.
    pub guides: Strands,
    /// Multiplier of the simulation's stiffness, one per guide.
    pub stiffness: Vec<f32>,
    /// Border of the region where hair grows.
    pub hairline: Hairline,
    /// Parting, if there is one.
    pub parting: Option<Parting>,
    /// Whorl, where the hair of the crown parts, on the scalp, meters.
    pub whorl: Vec3,
    /// Region that hair does not enter, or `None` if a fringe falls into it.
    pub face: Option<Face>,
    /// Recipe of the guides.
    pub recipe: Recipe,
}

/// Returns the guides of `style` on `scalp`.
pub fn guides(style: &Style, scalp: &dyn Scalp) -> StyledGuides {
    guides_of(&style.recipe(), scalp)
}

/// Returns the guides of any recipe on `scalp`.
pub fn guides_of(recipe: &Recipe, scalp: &dyn Scalp) -> StyledGuides {
    at_once(guides_with(recipe, scalp, &()))
}

/// [`guides_of`] that reports to `progress`.
pub async fn guides_with(recipe: &Recipe, scalp: &dyn Scalp, progress: &impl Progress) -> StyledGuides {
    let lines = Lines::new(recipe, scalp);
    let field = lines.field(recipe, scalp);
    let mut strands = Strands::default();
    let Lines { hairline, parting, .. } = &lines;
    let roots = roots::guide_roots(scalp, hairline, parting.as_ref(), recipe.guides as usize, recipe.seed);
    let count = roots.len();
    for (i, root) in roots.into_iter().enumerate() {
        if i % 4 == 0 {
            progress.step("tracing guides", i as f32 / count as f32).await;
        }
        // Resample twice, because equal steps along the path are not quite equal along its chords.
        let chords = resample_chords(&field.trace(root, i as u32), GUIDE_VERTICES);
        let mut line = resample_chords(&chords, GUIDE_VERTICES);
        for p in line.iter_mut().skip(1) {
            // In creases, for example behind the ears, one step does not lead all the way out.
            for _ in 0..4 {
                let depth = 5e-4 - scalp.distance(*p);
                *p += scalp.normal(*p) * depth.max(0.0);
            }
        }
        strands.push(&line);
    }
    lines.styled(recipe, scalp, strands)
}

/// The lines on a scalp that the guides of a recipe follow.
struct Lines {
    hairline: Hairline,
    parting: Option<Parting>,
    whorl: Vec3,
}

impl Lines {
    fn new(recipe: &Recipe, scalp: &dyn Scalp) -> Self {
        let hairline = Hairline::new(scalp, recipe.hairline_raise, recipe.hairline_irregularity, recipe.seed);
        let parting = recipe.parting.map(|x| Parting::new(scalp, x, recipe));
        let whorl = || scalp.point(Vec3::new(-0.12, 0.85, -0.5));
        Self { whorl: parting.as_ref().map_or_else(whorl, Parting::end), hairline, parting }
    }

    fn field<'a>(&'a self, recipe: &'a Recipe, scalp: &'a dyn Scalp) -> trace::Field<'a> {
        let (marks, face) = (scalp.landmarks(), Face::new(scalp));
        trace::Field { recipe, scalp, marks, parting: self.parting.as_ref(), face, whorl: self.whorl }
    }

    /// Adds scalp coordinates and stiffness to `guides` that follow these lines.
    fn styled(self, recipe: &Recipe, scalp: &dyn Scalp, mut guides: Strands) -> StyledGuides {
        let field = self.field(recipe, scalp);
        let roots: Vec<Vec3> = guides.iter().map(|guide| guide[0]).collect();
        guides.root_uvs = roots.iter().map(|root| scalp_uv(root - field.marks.skull)).collect();
        let stiffness = roots.iter().map(|root| recipe.stiffness.at(field.layer(*root))).collect();
        let face = (!recipe.fringe).then_some(field.face);
        let Self { hairline, parting, whorl } = self;
        StyledGuides { guides, stiffness, hairline, parting, whorl, face, recipe: *recipe }
    }
}

#[cfg(test)]
pub(crate) mod tests;
