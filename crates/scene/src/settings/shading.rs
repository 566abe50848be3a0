//! Hair color and shading settings.

use tresses::{
    light::{FiberMaterial, HairMaterial},
    low_level::{melanin, srgb},
};

/// Source of the hair color.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HairColor {
    /// The file's strand colors if present, otherwise the file's material, otherwise brown.
    #[default]
    File,
    /// The body's color at the root of each strand.
    Skin,
    /// Light blond.
    Blond,
    /// Brown.
    Brown,
    /// Copper red.
    Red,
    /// Black.
    Black,
    /// The sRGB color [`ShadingSettings::srgb`].
    Srgb,
    /// Pigments [`ShadingSettings::eumelanin`] and [`ShadingSettings::pheomelanin`].
    Melanin,
}

/// Settings of hair shading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingSettings {
    /// Source of the color.
    pub color: HairColor,
    /// Color of [`HairColor::Srgb`].
    pub srgb: [u8; 3],
    /// Brown to black pigment of [`HairColor::Melanin`].
    pub eumelanin: f32,
    /// Yellow to red pigment of [`HairColor::Melanin`].
    pub pheomelanin: f32,
    /// Pigment at the root relative to the mean.
    pub root_pigment: f32,
    /// Pigment at the tip relative to the mean.
    pub tip_pigment: f32,
    /// Explicitly set material parameters. Automatic ones follow from the color.
    pub(crate) material: HairMaterial,
}

/// Factors by which [`FiberMaterial::natural`] scales the pigment at root and tip.
pub(crate) const NATURAL: (f32, f32) = (1.05, 0.9);

impl Default for ShadingSettings {
    fn default() -> Self {
        Self {
            color: HairColor::default(),
            srgb: [0x5a, 0x3b, 0x28],
            eumelanin: 1.3,
            pheomelanin: 0.2,
            root_pigment: NATURAL.0,
            tip_pigment: NATURAL.1,
            material: HairMaterial::default(),
        }
    }
}

impl ShadingSettings {
    /// Returns the material that the color alone defines.
    pub(crate) fn of_color(&self) -> HairMaterial {
        let [r, g, b] = self.srgb;
        let material = match self.color {
            HairColor::File | HairColor::Skin => HairMaterial::default(),
            HairColor::Blond => HairMaterial::blond(),
            HairColor::Brown => HairMaterial::brown(),
            HairColor::Red => HairMaterial::red(),
            HairColor::Black => HairMaterial::black(),
            HairColor::Srgb => HairMaterial::colored(srgb(u32::from_be_bytes([0, r, g, b]))),
            HairColor::Melanin => HairMaterial {
                fiber: FiberMaterial::natural(melanin(self.eumelanin, self.pheomelanin)),
                ..HairMaterial::default()
            },
        };
        HairMaterial { uses_file_colors: matches!(self.color, HairColor::File | HairColor::Skin), ..material }
    }
}
