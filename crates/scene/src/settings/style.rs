//! Settings for growing strands on a built-in style, and for restyling a groom from files.

use tresses::{
    FaceHair, MapCoordinates,
    groom::{
        Fill,
        grow::{Curls, Growth},
        styles::Style,
    },
};

/// Curl preset that other parameters modify.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curl {
    /// Straight.
    #[default]
    None,
    /// [`Curls::waves`].
    Waves,
    /// [`Curls::ringlets`].
    Ringlets,
    /// [`Curls::coils`].
    Coils,
}

impl Curl {
    pub(crate) fn curls(self) -> Curls {
        match self {
            Self::None => Curls::default(),
            Self::Waves => Curls::waves(),
            Self::Ringlets => Curls::ringlets(),
            Self::Coils => Curls::coils(),
        }
    }
}

/// Strand settings. Most parameters are automatic: their fields apply only if
/// [`Settings::gives`](super::Settings::gives) returns true for them.
#[derive(Clone, Debug, PartialEq)]
pub struct StyleSettings {
    /// Explicitly set growth parameters.
    pub(crate) growth: Growth,
    /// Number of strands to which a groom from a file is filled; 0 keeps only its own strands.
    pub(crate) grow: u32,
    /// Angle between strands of a file, radians, beyond which the hair between them follows one strand instead of a
    /// mix.
    pub grow_parting: f32,
    /// Number of guides.
    pub(crate) guides: u32,
    /// Whether every strand is simulated. Overrides `guides`.
    pub all_guides: bool,
    /// Curl preset that `growth` modifies.
    pub(crate) curl: Curl,
    /// Whether a drawn curl is stretched over the whole strand instead of repeated.
    pub curl_stretch: bool,
    /// Share of their length to which strands are cut.
    pub length: f32,
    /// Coordinates in maps.
    pub maps: MapCoordinates,
    /// Hair on the face of the built-in character.
    pub face: FaceHair,
}

impl Default for StyleSettings {
    fn default() -> Self {
        Self {
            growth: Growth::default(),
            grow: 0,
            grow_parting: Fill::default().parting,
            guides: Style::default().recipe().guides,
            all_guides: false,
            curl: Curl::default(),
            curl_stretch: false,
            length: 1.0,
            maps: MapCoordinates::default(),
            face: FaceHair::default(),
        }
    }
}
