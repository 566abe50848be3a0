//! Built-in hairstyles: fields over the scalp, and the guides that follow them.
//!
//! A [`Style`] becomes a [`Recipe`] of numbers, from which [`guides`] makes strands. Roots are spread
//! evenly inside a [`Hairline`]. From each root a path leaves the scalp at an angle, is combed away from
//! the [`Parting`] and back, stays clear of the head by a distance that grows with the height of its root
//! (hair from the top lies over hair from the sides), falls where the head no longer supports it, and ends
//! at a length or at a common hem. Waves are added along the path.
//!
//! The shapes are close to their equilibrium under gravity and contact; the simulation of `tresses::drape`
//! finishes them, with as much hold as the style needs to keep its volume and its wave ([`Hold`]). Spirals are not part of the guides, as three spirals
//! of different phase have no meaningful mean; [`Curls`](crate::grow::Curls) describes how
//! [`grow`](crate::grow) winds the drawn strands around them.

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

/// Vertices of each guide.
pub const GUIDE_VERTICES: usize = 32;

/// Guides of a hairstyle with what is known of them and of the scalp.
#[derive(Clone, Debug)]
pub struct StyledGuides {
    /// The guides, root first, [`GUIDE_VERTICES`] each at equal distances along it, with scalp
    /// coordinates. A draped version may take their place.
    pub guides: Strands,
    /// Multiplier of the simulation's stiffness, one per guide.
    pub stiffness: Vec<f32>,
    /// Where hair grows.
    pub hairline: Hairline,
    /// The parting, if there is one.
    pub parting: Option<Parting>,
    /// Where the hair of the crown parts, on the scalp, metres.
    pub whorl: Vec3,
    /// The space that hair leaves free, or `None` where a fringe falls into it.
    pub face: Option<Face>,
    /// The numbers that the guides were made from.
    pub recipe: Recipe,
}

/// The guides of `style` on `scalp`.
pub fn guides(style: &Style, scalp: &dyn Scalp) -> StyledGuides {
    guides_of(&style.recipe(), scalp)
}

/// The guides of any recipe on `scalp`.
pub fn guides_of(recipe: &Recipe, scalp: &dyn Scalp) -> StyledGuides {
    at_once(guides_with(recipe, scalp, &()))
}

/// The same, telling `progress`.
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
        // Twice, as chords cut corners: what was even along the path is not quite along its chords.
        let chords = resample_chords(&field.trace(root, i as u32), GUIDE_VERTICES);
        let mut line = resample_chords(&chords, GUIDE_VERTICES);
        for p in line.iter_mut().skip(1) {
            // In creases, as behind the ears, the first way out is not all of it.
            for _ in 0..4 {
                let depth = 5e-4 - scalp.distance(*p);
                *p += scalp.normal(*p) * depth.max(0.0);
            }
        }
        strands.push(&line);
    }
    lines.styled(recipe, scalp, strands)
}

/// The lines on a scalp that a recipe's guides follow.
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

    /// What is known of `guides` that follow these lines.
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
