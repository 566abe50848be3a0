//! The colour of hair and how light on it is computed.

use tresses::{
    glam::Vec3,
    light::{
        FiberMaterial, HairMaterial, ShadingModel, ShadingRate,
        fiber::{FiberShape, bsdf::melanin},
        material::{linear, srgb},
    },
};

/// Where hair has its colour from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HairColor {
    /// The file's colours where it has some, else brown.
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
    /// [`LookSettings::srgb`].
    Srgb,
    /// [`LookSettings::eumelanin`] and [`LookSettings::pheomelanin`].
    Melanin,
}

/// The look of hair. What is `None` follows from the colour. Fields from `root_darkness` on are of
/// [`ShadingModel::KajiyaKay`] alone, as [`HairMaterial`]'s of the same names.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // The fields of `HairMaterial` under the same names.
pub struct LookSettings {
    /// Where the colour is from.
    pub color: HairColor,
    /// The colour of [`HairColor::Srgb`].
    pub srgb: [u8; 3],
    /// Brown to black pigment of [`HairColor::Melanin`].
    pub eumelanin: f32,
    /// Yellow to red pigment of [`HairColor::Melanin`].
    pub pheomelanin: f32,
    /// How light on hair is computed.
    pub model: ShadingModel,
    /// Where hair is shaded.
    pub rate: ShadingRate,
    /// Roughness along the fibre, 0.1 to 1.
    pub roughness_along: f32,
    /// Roughness around the fibre, 0.1 to 1.
    pub roughness_around: f32,
    /// Tilt of the scales, radians.
    pub tilt: f32,
    /// Index of refraction.
    pub refraction: f32,
    /// Pigment at the root against the mean.
    pub root_pigment: f32,
    /// Pigment at the tip against the mean.
    pub tip_pigment: f32,
    /// Share of the light scattered on that meets other hair or the eye.
    pub density_forward: f32,
    /// Share of the light scattered back that does.
    pub density_back: f32,
    /// How much the lightness (melanin) of strands differs.
    pub lightness_spread: Option<f32>,
    /// How much the warmth of strands differs.
    pub warmth_spread: Option<f32>,
    /// How far highlights are shifted from strand to strand.
    pub highlight_spread: Option<f32>,
    pub root_darkness: Option<f32>,
    pub diffuse: Option<f32>,
    pub primary: Option<f32>,
    pub primary_exponent: Option<f32>,
    pub primary_shift: Option<f32>,
    pub secondary: Option<f32>,
    pub secondary_exponent: Option<f32>,
    pub secondary_shift: Option<f32>,
    /// sRGB.
    pub secondary_color: Option<[u8; 3]>,
    pub transmission: Option<f32>,
    pub transmission_exponent: Option<f32>,
    pub shift_noise: Option<f32>,
    pub opacity: Option<f32>,
    pub saturation: Option<f32>,
}

/// What [`FiberMaterial::natural`] multiplies the pigment by at root and tip.
const NATURAL: (f32, f32) = (1.05, 0.9);

impl Default for LookSettings {
    fn default() -> Self {
        let shape = FiberShape::default();
        let fiber = FiberMaterial::uniform(Vec3::ONE);
        Self {
            color: HairColor::default(),
            srgb: [0x5a, 0x3b, 0x28],
            eumelanin: 1.3,
            pheomelanin: 0.2,
            model: ShadingModel::default(),
            rate: ShadingRate::default(),
            roughness_along: shape.longitudinal,
            roughness_around: shape.azimuthal,
            tilt: shape.tilt,
            refraction: shape.eta,
            root_pigment: NATURAL.0,
            tip_pigment: NATURAL.1,
            density_forward: fiber.density_forward,
            density_back: fiber.density_back,
            lightness_spread: None,
            warmth_spread: None,
            highlight_spread: None,
            root_darkness: None,
            diffuse: None,
            primary: None,
            primary_exponent: None,
            primary_shift: None,
            secondary: None,
            secondary_exponent: None,
            secondary_shift: None,
            secondary_color: None,
            transmission: None,
            transmission_exponent: None,
            shift_noise: None,
            opacity: None,
            saturation: None,
        }
    }
}

fn color([r, g, b]: [u8; 3]) -> Vec3 {
    srgb(u32::from_be_bytes([0, r, g, b]))
}

/// sRGB, 0 to 255, of a linear colour: the nearest that [`linear`] gives.
fn encoded(color: Vec3) -> [u8; 3] {
    color.to_array().map(|v| {
        let error = |i: &u8| (linear(f32::from(*i) / 255.0) - v).abs();
        (0..=255).min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or_default()
    })
}

impl LookSettings {
    /// The material of the colour alone.
    fn of_color(&self) -> HairMaterial {
        let material = match self.color {
            HairColor::File => return HairMaterial::default(),
            HairColor::Blond => HairMaterial::blond(),
            HairColor::Brown => HairMaterial::brown(),
            HairColor::Red => HairMaterial::red(),
            HairColor::Black => HairMaterial::black(),
            HairColor::Srgb => HairMaterial::colored(color(self.srgb)),
            HairColor::Melanin => HairMaterial {
                fiber: FiberMaterial::natural(melanin(self.eumelanin, self.pheomelanin)),
                ..HairMaterial::default()
            },
        };
        HairMaterial { file_colors: false, ..material }
    }

    /// As the library has it.
    pub fn material(&self) -> HairMaterial {
        let mut material = self.of_color();
        material.model = self.model;
        let fiber = &mut material.fiber;
        fiber.root_absorption *= self.root_pigment / NATURAL.0;
        fiber.tip_absorption *= self.tip_pigment / NATURAL.1;
        fiber.shape = FiberShape {
            longitudinal: self.roughness_along,
            azimuthal: self.roughness_around,
            tilt: self.tilt,
            eta: self.refraction,
        };
        fiber.density_forward = self.density_forward;
        fiber.density_back = self.density_back;
        if let Some(spread) = self.lightness_spread {
            fiber.melanin_spread = spread;
        }
        if let Some(spread) = self.highlight_spread {
            // Half as wide as the shift of the softer highlights of the other model.
            fiber.tilt_spread = 0.25 * spread;
        }
        let put = |place: &mut f32, value: Option<f32>| *place = value.unwrap_or(*place);
        put(&mut material.lightness_spread, self.lightness_spread);
        put(&mut material.warmth_spread, self.warmth_spread);
        put(&mut material.shift_spread, self.highlight_spread);
        put(&mut material.root_darkness, self.root_darkness);
        put(&mut material.diffuse, self.diffuse);
        put(&mut material.primary, self.primary);
        put(&mut material.primary_exponent, self.primary_exponent);
        put(&mut material.primary_shift, self.primary_shift);
        put(&mut material.secondary, self.secondary);
        put(&mut material.secondary_exponent, self.secondary_exponent);
        put(&mut material.secondary_shift, self.secondary_shift);
        put(&mut material.transmission, self.transmission);
        put(&mut material.transmission_exponent, self.transmission_exponent);
        put(&mut material.shift_noise, self.shift_noise);
        put(&mut material.opacity, self.opacity);
        put(&mut material.saturation, self.saturation);
        if let Some(secondary) = self.secondary_color {
            material.secondary_color = color(secondary);
        }
        material
    }

    pub(super) fn resolve(&self, into: &mut Self) {
        let material = self.material();
        let fiber = self.model == ShadingModel::Fiber;
        into.lightness_spread =
            Some(if fiber { material.fiber.melanin_spread } else { material.lightness_spread });
        into.warmth_spread = Some(material.warmth_spread);
        into.highlight_spread =
            Some(if fiber { material.fiber.tilt_spread / 0.25 } else { material.shift_spread });
        into.root_darkness = Some(material.root_darkness);
        into.diffuse = Some(material.diffuse);
        into.primary = Some(material.primary);
        into.primary_exponent = Some(material.primary_exponent);
        into.primary_shift = Some(material.primary_shift);
        into.secondary = Some(material.secondary);
        into.secondary_exponent = Some(material.secondary_exponent);
        into.secondary_shift = Some(material.secondary_shift);
        into.secondary_color = Some(encoded(material.secondary_color));
        into.transmission = Some(material.transmission);
        into.transmission_exponent = Some(material.transmission_exponent);
        into.shift_noise = Some(material.shift_noise);
        into.opacity = Some(material.opacity);
        into.saturation = Some(material.saturation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_default_hair_looks_as_the_library_has_it() {
        assert_eq!(LookSettings::default().material(), HairMaterial::default());
        for (color, name) in
            [(HairColor::Blond, "blond"), (HairColor::Red, "red"), (HairColor::Black, "black")]
        {
            let expected = HairMaterial { file_colors: false, ..HairMaterial::named(name).unwrap() };
            assert_eq!(LookSettings { color, ..Default::default() }.material(), expected);
        }
    }

    #[test]
    fn colours_are_encoded_as_they_were() {
        for rgb in [[0, 1, 2], [90, 59, 40], [255, 254, 128]] {
            assert_eq!(encoded(color(rgb)), rgb);
        }
    }

    #[test]
    fn pigment_is_spread_over_the_strand() {
        let look = LookSettings { color: HairColor::Melanin, tip_pigment: 0.45, ..Default::default() };
        let (whole, half) = (LookSettings { tip_pigment: 0.9, ..look }.material(), look.material());
        assert!((half.fiber.tip_absorption / whole.fiber.tip_absorption - 0.5).abs().max_element() < 1e-5);
        assert_eq!(half.fiber.root_absorption, whole.fiber.root_absorption);
        assert!(!half.file_colors);
    }
}
