//! The list of debug views, shared by all programs that offer them.

use super::{GridView, Quantity, StrandQuantity, Term};
use crate::{Pose, hair::Hair, simulate::SimulationParams, volume::HairHairMode};
use glam::Vec3;

/// A debug view: the quantity that a frame shows instead of shaded hair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum DebugView {
    /// Guides (the simulated strands), a color each.
    Guides,
    /// Guides by speed.
    Speed,
    /// Guides by strain.
    Strain,
    /// Strands by the guide with the largest weight.
    Locks,
    /// Strands by index.
    Strands,
    /// Strands by direction.
    Tangents,
    /// Strands changed by obstacles.
    FirstHit,
    /// Strands by level of detail.
    Detail,
    /// Overdraw: strips per pixel.
    Overdraw,
    /// Grid of the hair's density.
    Density,
    /// Grid of the push out of dense hair.
    Push,
    /// Flow of the air.
    Wind,
    /// Surface of the obstacles, as contour lines.
    Colliders,
    /// Distance to the obstacles.
    Distance,
    /// Light reflected by the surface of fibers (R).
    Reflection,
    /// Light transmitted straight through fibers (TT).
    Transmission,
    /// Light reflected inside fibers (TRT).
    Inner,
    /// Light scattered by several fibers.
    Multiple,
    /// Light from the sky.
    Sky,
    /// Light from the directional lights.
    Direct,
    /// Fraction of the direct light that arrives.
    Shadow,
}

/// Color scale of a view: [`super::ramp`] from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ColorScale {
    /// Quantity, with its unit.
    pub title: &'static str,
    /// Value drawn darkest.
    pub low: f32,
    /// Value drawn brightest by default.
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

    /// Name for command lines and files, label for a menu, and a hint of one line.
    fn words(self) -> [&'static str; 3] {
        match self {
            Self::Guides => ["guides", "Guides", "Simulated strands only, one color per strand"],
            Self::Speed => ["speed", "Guide speed", "Simulated strands, colored by speed"],
            Self::Strain => ["strain", "Guide strain", "Deviation of guide edges from their rest length"],
            Self::Locks => {
                ["locks", "Locks", "Each strand in the color of the guide with the largest weight"]
            }
            Self::Strands => ["strands", "Strand ids", "One color per strand"],
            Self::Tangents => {
                ["tangents", "Tangents", "Directions: red to the character's left, green up, blue forward"]
            }
            Self::FirstHit => [
                "first-hit",
                "First hit",
                "Strands changed by an obstacle, by distance from the root; others gray",
            ],
            Self::Detail => {
                ["lod", "Level of detail", "Widening that makes up for dropped strands; segments as bands"]
            }
            Self::Overdraw => ["overdraw", "Overdraw", "Strips drawn over each pixel, without depth test"],
            Self::Density => {
                ["density", "Density", "Density of the hair: a volume, and slices through its middle"]
            }
            Self::Push => ["push", "Push", "Push on hair that is denser than at rest"],
            Self::Wind => ["wind", "Wind", "Flow of the air: streamlines, and slices of its speed"],
            Self::Colliders => {
                ["colliders", "Colliders", "Surface that hair collides with, as contour lines 1 cm apart"]
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
                ["transmission", "Transmission (TT)", "Light transmitted straight through fibers"]
            }
            Self::Inner => [
                "inner",
                "Inner reflection (TRT)",
                "Light reflected internally; Kajiya–Kay: second highlight",
            ],
            Self::Multiple => [
                "multiple",
                "Multiple scattering",
                "Light scattered by other fibers; Kajiya–Kay: diffuse light",
            ],
            Self::Sky => ["sky", "Sky light", "Light from the environment only"],
            Self::Direct => ["direct", "Direct light", "Light from the directional lights only"],
            Self::Shadow => ["shadow", "Shadow", "Fraction of the direct light that arrives"],
        }
    }

    /// Name in lower case, for command lines and files.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Label for a menu.
    pub fn label(self) -> &'static str {
        self.words()[1]
    }

    /// Description in one line.
    pub fn hint(self) -> &'static str {
        self.words()[2]
    }

    /// Returns the view with a [`name`](Self::name).
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|view| view.name() == name)
    }

    /// Color scale, if the colors encode a number.
    pub fn scale(self) -> Option<ColorScale> {
        let scale = |title, high| Some(ColorScale { title, low: 0.0, high });
        match self {
            Self::Speed => scale("speed, m/s", 1.0),
            Self::Strain => scale("strain", 0.01),
            Self::FirstHit => scale("root distance, m", 0.25),
            Self::Detail => scale("width doublings", 4.0),
            Self::Overdraw => scale("strips per pixel", 100.0),
            Self::Density => scale("density, km/m³", 2000.0),
            Self::Push => scale("push, m/s²", 5.0),
            Self::Wind => scale("air speed, m/s", 10.0),
            Self::Distance => Some(ColorScale { title: "distance, m", low: -0.1, high: 0.1 }),
            Self::Shadow => scale("fraction of the light", 1.0),
            _ => None,
        }
    }

    /// Returns the reason if the view would be empty with these physics.
    pub fn missing(self, physics: &SimulationParams) -> Option<&'static str> {
        match self {
            Self::Density | Self::Push if physics.hair_hair.mode == HairHairMode::Off => {
                Some("self-collision is off, so there is no grid")
            }
            Self::Wind if !physics.wind.blows() => Some("there is no wind"),
            _ => None,
        }
    }

    /// Whether the frame leaves out hair, which would occlude the view.
    pub(crate) fn hides_hair(self) -> bool {
        use DebugView::*;
        matches!(self, Guides | Speed | Strain | Overdraw | Density | Push | Distance)
    }

    /// Returns the grid whose values the view shows, if it has one. [`super::Peak`] measures it.
    pub fn grid(self, hair: &Hair) -> Option<GridView<'_>> {
        grid(self, hair).filter(|_| self != Self::Distance)
    }

    /// Quantity that colors the drawn strands.
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

    /// Term of the shading that is shown alone.
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

/// Returns the grid that a view shows, or the box in which it evaluates its values.
pub(super) fn grid(view: DebugView, hair: &Hair) -> Option<GridView<'_>> {
    let volume = &hair.volume;
    let (texture, quantity, rotates) = match view {
        DebugView::Density => (&volume.hair, Quantity::Channel(3), false),
        DebugView::Push => (&volume.push, Quantity::Length, true),
        // Only the box matters.
        DebugView::Distance => (&volume.hair, Quantity::Channel(0), false),
        DebugView::Wind => {
            let air = hair.air.as_ref()?;
            let air_grid = air.current_grid();
            return Some(GridView {
                texture: &air.view,
                pose: hair.motion.to_drawn.after(&Pose { translation: air_grid.corner, ..Pose::IDENTITY }),
                scale: Vec3::splat(air_grid.scale),
                bias: Vec3::ZERO,
                quantity: Quantity::Length,
                rotates: true,
            });
        }
        _ => return None,
    };
    let (scale, bias) = (Vec3::splat(volume.grid.scale), volume.grid.bias);
    Some(GridView { texture, pose: hair.motion.head, scale, bias, quantity, rotates })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_have_unique_names_and_labels() {
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
