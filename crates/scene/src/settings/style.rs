//! How strands are grown on a built-in style, or restyled on a groom from files.

use tresses::{
    character::FaceHair,
    groom::{
        Fill,
        grow::{Curls, Growth},
        styles::Style,
    },
};

/// The curls that others are varied from.
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

/// Strands. Most parameters are automatic: their fields count where [`Settings::gives`] them.
#[derive(Clone, Debug, PartialEq)]
pub struct StyleSettings {
    /// Growth as it is given.
    pub(crate) growth: Growth,
    /// How many strands a file's are filled up to; 0 for none but its own.
    pub(crate) grow: u32,
    /// The angle between strands of a file from which on hair between them goes with one, radians.
    pub grow_parting: f32,
    /// How many are simulated, the others following them.
    pub(crate) guides: u32,
    /// Whether every strand is simulated, whatever `guides` says.
    pub all_guides: bool,
    /// The curls that those of `growth` vary.
    pub(crate) curl: Curl,
    /// Whether a drawn curl is stretched over the whole strand instead of repeated.
    pub curl_stretch: bool,
    /// The share of their length that strands are cut to.
    pub length: f32,
    /// What grows on the face of the built-in character.
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
            face: FaceHair::default(),
        }
    }
}
