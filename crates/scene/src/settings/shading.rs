//! The colour of hair and how light on it is computed.

use tresses::light::{FiberMaterial, HairMaterial, ShadingRate, fiber::bsdf::melanin, material::srgb};

/// Where hair has its colour from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HairColor {
    /// The file's colours where it has some, else what it has the hair look like, else brown.
    #[default]
    File,
    /// Light blond.
    Blond,
    /// Brown.
    Brown,
    /// Copper red.
    Red,
    /// Black.
    Black,
    /// [`ShadingSettings::srgb`].
    Srgb,
    /// [`ShadingSettings::eumelanin`] and [`ShadingSettings::pheomelanin`].
    Melanin,
}

/// The look of hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingSettings {
    /// Where the colour is from.
    pub color: HairColor,
    /// The colour of [`HairColor::Srgb`].
    pub srgb: [u8; 3],
    /// Brown to black pigment of [`HairColor::Melanin`].
    pub eumelanin: f32,
    /// Yellow to red pigment of [`HairColor::Melanin`].
    pub pheomelanin: f32,
    /// Pigment at the root against the mean.
    pub root_pigment: f32,
    /// Pigment at the tip against the mean.
    pub tip_pigment: f32,
    /// Where hair is shaded.
    pub rate: ShadingRate,
    /// The material as it is given: what is automatic of it follows from the colour.
    pub(crate) material: HairMaterial,
}

/// What [`FiberMaterial::natural`] multiplies the pigment by at root and tip.
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
            rate: ShadingRate::default(),
            material: HairMaterial::default(),
        }
    }
}

impl ShadingSettings {
    /// The material of the colour alone.
    pub(crate) fn of_color(&self) -> HairMaterial {
        let [r, g, b] = self.srgb;
        let material = match self.color {
            HairColor::File => HairMaterial::default(),
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
        HairMaterial { file_colors: self.color == HairColor::File, ..material }
    }
}
