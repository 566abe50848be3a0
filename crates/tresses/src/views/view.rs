//! The debug views: one list for every program that offers them.

use super::{Grid, Quantity, StrandQuantity};
use crate::{Hair, Pose, light::Term, simulate::SimulationParams, volume::HairHairMode};
use glam::Vec3;

/// What a picture shows instead of hair as it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DebugView {
    /// The simulated strands, a colour each.
    Guides,
    /// The simulated strands by speed.
    Speed,
    /// The simulated strands by strain.
    Strain,
    /// Strands by their first guide.
    Locks,
    /// Strands by number.
    Strands,
    /// Strands by direction.
    Tangents,
    /// Strands that obstacles have changed.
    FirstHit,
    /// Strands by level of detail.
    Detail,
    /// Fragments per pixel.
    Overdraw,
    /// The grid of the hair's density.
    Density,
    /// The grid of the push out of dense hair.
    Push,
    /// The flow of the air.
    Wind,
    /// The obstacles' surface as contour lines.
    Colliders,
    /// The distance to the obstacles.
    Distance,
    /// Light mirrored by the fibres' surface.
    Reflection,
    /// Light straight through fibres.
    Transmission,
    /// Light reflected inside fibres.
    Inner,
    /// Light that several fibres have scattered.
    Multiple,
    /// Light of the sky.
    Sky,
    /// Light of the lights.
    Direct,
    /// The share of the light that arrives.
    Shadow,
}

/// What the colours of a view stand for: [`super::ramp`] from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// What it is, with its unit.
    pub title: &'static str,
    /// The number drawn darkest.
    pub low: f32,
    /// The value drawn brightest by default.
    pub high: f32,
}

impl DebugView {
    /// All views, in the order of a menu.
    pub const ALL: [Self; 21] = [
        Self::Guides,
        Self::Speed,
        Self::Strain,
        Self::Locks,
        Self::Strands,
        Self::Tangents,
        Self::FirstHit,
        Self::Detail,
        Self::Overdraw,
        Self::Density,
        Self::Push,
        Self::Wind,
        Self::Colliders,
        Self::Distance,
        Self::Reflection,
        Self::Transmission,
        Self::Inner,
        Self::Multiple,
        Self::Sky,
        Self::Direct,
        Self::Shadow,
    ];

    /// The word for command lines and files, its label in a menu, and a hint of one line.
    fn words(self) -> [&'static str; 3] {
        match self {
            Self::Guides => ["guides", "Guides", "The simulated strands alone, each in its own colour"],
            Self::Speed => ["speed", "Speed of the guides", "The simulated strands, coloured by their speed"],
            Self::Strain => {
                ["strain", "Strain of the guides", "How far the edges of guides are from their rest length"]
            }
            Self::Locks => {
                ["locks", "Locks", "Each strand in the colour of the guide with the largest weight"]
            }
            Self::Strands => ["strands", "Strand ids", "Each strand in a colour of its own"],
            Self::Tangents => {
                ["tangents", "Tangents", "Directions: red to the character's left, green up, blue forward"]
            }
            Self::FirstHit => [
                "first-hit",
                "First hit",
                "Strands changed by an obstacle, by how far from the root; others grey",
            ],
            Self::Detail => [
                "lod",
                "Level of detail",
                "How much wider strands are, for those left out; segments as bands",
            ],
            Self::Overdraw => {
                ["overdraw", "Overdraw", "How many strips are drawn over each pixel, without depth test"]
            }
            Self::Density => {
                ["density", "Density", "How dense the hair is: a volume, and slices through its middle"]
            }
            Self::Push => ["push", "Push", "How hair that is denser than at rest is pushed"],
            Self::Wind => ["wind", "Wind", "How the air flows: streamlines, and slices of its speed"],
            Self::Colliders => {
                ["colliders", "Colliders", "The surface that hair collides with, as contour lines 1 cm apart"]
            }
            Self::Distance => [
                "sdf",
                "Distance to obstacles",
                "Slices through the distance field, a line per cm, white at 0",
            ],
            Self::Reflection => [
                "reflection",
                "Reflection (R)",
                "Light reflected at the surface; Kajiya–Kay: first highlight",
            ],
            Self::Transmission => {
                ["transmission", "Transmission (TT)", "Light transmitted straight through fibres"]
            }
            Self::Inner => [
                "inner",
                "Inner reflection (TRT)",
                "Light reflected internally; Kajiya–Kay: second highlight",
            ],
            Self::Multiple => [
                "multiple",
                "Multiple scattering",
                "Light scattered by other fibres; Kajiya–Kay: diffuse light",
            ],
            Self::Sky => ["sky", "Sky light", "The environment alone"],
            Self::Direct => ["direct", "Direct light", "The directional lights alone"],
            Self::Shadow => ["shadow", "Shadow", "The fraction of the direct light that arrives"],
        }
    }

    /// A word in lower case, for command lines and files.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// What a menu calls it.
    pub fn label(self) -> &'static str {
        self.words()[1]
    }

    /// What it shows, in one line.
    pub fn hint(self) -> &'static str {
        self.words()[2]
    }

    /// The view of a [`name`](Self::name).
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|view| view.name() == name)
    }

    /// What its colours stand for, where that is a number.
    pub fn scale(self) -> Option<Scale> {
        let scale = |title, high| Some(Scale { title, low: 0.0, high });
        match self {
            Self::Speed => scale("speed, m/s", 1.0),
            Self::Strain => scale("strain", 0.01),
            Self::FirstHit => scale("from the root, m", 0.25),
            Self::Detail => scale("doublings of the width", 4.0),
            Self::Overdraw => scale("strips per pixel", 100.0),
            Self::Density => scale("density, km/m³", 2000.0),
            Self::Push => scale("push, m/s²", 5.0),
            Self::Wind => scale("speed of the air, m/s", 10.0),
            Self::Distance => Some(Scale { title: "distance, m", low: -0.1, high: 0.1 }),
            Self::Shadow => scale("share of the light", 1.0),
            _ => None,
        }
    }

    /// Why there would be nothing to see with these physics.
    pub fn missing(self, physics: &SimulationParams) -> Option<&'static str> {
        match self {
            Self::Density | Self::Push if physics.hair_hair.mode == HairHairMode::Off => {
                Some("hair–hair interaction is off: there is no grid")
            }
            Self::Wind if !physics.wind.blows() => Some("there is no wind"),
            _ => None,
        }
    }

    /// Whether hair is left out of the picture, which would hide what is to be seen.
    pub fn hides_hair(self) -> bool {
        use DebugView::*;
        matches!(self, Guides | Speed | Strain | Overdraw | Density | Push | Distance)
    }

    /// The grid whose values it shows, where it shows one and there is one: what [`super::Peak`] measures.
    pub fn grid(self, hair: &Hair) -> Option<Grid<'_>> {
        grid(self, hair).filter(|_| self != Self::Distance)
    }

    /// The quantity that drawn strands have the colour of.
    pub(super) fn strands(self) -> Option<StrandQuantity> {
        match self {
            Self::Locks => Some(StrandQuantity::Lock),
            Self::Strands => Some(StrandQuantity::Strand),
            Self::Tangents => Some(StrandQuantity::Tangent),
            Self::FirstHit => Some(StrandQuantity::FirstHit),
            Self::Detail => Some(StrandQuantity::Detail),
            _ => None,
        }
    }

    /// The term of the shading that is shown alone.
    pub fn term(self) -> Option<Term> {
        match self {
            Self::Reflection => Some(Term::Reflection),
            Self::Transmission => Some(Term::Transmission),
            Self::Inner => Some(Term::Inner),
            Self::Multiple => Some(Term::Multiple),
            Self::Sky => Some(Term::Sky),
            Self::Direct => Some(Term::Direct),
            Self::Shadow => Some(Term::Shadow),
            _ => None,
        }
    }
}

/// The grid that a view shows, or the box in which it looks.
pub(super) fn grid(view: DebugView, hair: &Hair) -> Option<Grid<'_>> {
    let volume = &hair.volume;
    let (texture, quantity, turns) = match view {
        DebugView::Density => (&volume.hair, Quantity::Channel(3), false),
        DebugView::Push => (&volume.push, Quantity::Length, true),
        // The box alone.
        DebugView::Distance => (&volume.hair, Quantity::Channel(0), false),
        DebugView::Wind => {
            let air = hair.air.as_ref()?;
            let place = air.now();
            return Some(Grid {
                texture: &air.view,
                pose: hair.motion.to_drawn.after(&Pose { translation: place.corner, ..Pose::IDENTITY }),
                scale: Vec3::splat(place.scale),
                bias: Vec3::ZERO,
                quantity: Quantity::Length,
                turns: true,
            });
        }
        _ => return None,
    };
    let (scale, bias) = (Vec3::splat(volume.grid.scale), volume.grid.bias);
    Some(Grid { texture, pose: hair.motion.head, scale, bias, quantity, turns })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_has_words_of_its_own() {
        for (i, view) in DebugView::ALL.into_iter().enumerate() {
            assert_eq!(DebugView::named(view.name()), Some(view));
            assert!(view.hint().len() <= 80 && !view.hint().ends_with('.'), "{}", view.hint());
            assert!(view.name().chars().all(|c| c.is_ascii_lowercase() || c == '-'));
            for other in &DebugView::ALL[..i] {
                assert!(view != *other && view.name() != other.name() && view.label() != other.label());
            }
        }
        assert_eq!(DebugView::named("nothing"), None);
    }
}
