//! Hair material.

use crate::{
    knobs,
    settings::{HairColor, NATURAL, Settings},
};
use tresses::{groom::Look, light::HairMaterial, low_level::FiberShape, renderer::ShadingModel};

/// Spread of the cuticle angle per unit of highlight spread. Highlights of the fiber model then shift half as far as
/// the wider Kajiya-Kay highlights.
const TILT: f32 = 0.25;

impl Settings {
    /// Returns the material.
    pub fn material(&self) -> HairMaterial {
        let mut onto = self.clone();
        onto.shading.material =
            HairMaterial { min_width: self.shading.material.min_width, ..self.shading.of_color() };
        knobs::section("shading").for_each(|knob| knob.copy_value(&mut onto, self));
        let mut material = onto.shading.material;
        let fiber = &mut material.fiber;
        fiber.root_absorption *= self.shading.root_pigment / NATURAL.0;
        fiber.tip_absorption *= self.shading.tip_pigment / NATURAL.1;
        // These parameters apply to both shading models.
        if self.gives("shading.lightness_spread") {
            fiber.melanin_spread = material.lightness_spread;
        }
        if self.gives("shading.highlight_spread") {
            fiber.tilt_spread = TILT * material.shift_spread;
        }
        material
    }

    /// Returns the [`material`](Self::material) for a groom whose file stores the material `look`. It applies only
    /// while the color is [`HairColor::File`]; strand colors in the file take precedence over its pigments. Roughness,
    /// cuticle angle and IOR also come from the file unless the settings change them from their defaults.
    pub fn material_of(&self, look: Option<&Look>) -> HairMaterial {
        let Some(look) = look.filter(|_| self.shading.color == HairColor::File) else {
            return self.material();
        };
        let mut own = self.clone();
        own.shading.color = HairColor::Melanin;
        (own.shading.eumelanin, own.shading.pheomelanin) = (look.eumelanin, look.pheomelanin);
        own.shading.material.fiber.shape = self.shape_of(look);
        HairMaterial { uses_file_colors: true, ..own.material() }
    }

    /// Returns the fiber shape for a groom whose file stores `look`.
    fn shape_of(&self, look: &Look) -> FiberShape {
        let own = self.shading.material.fiber.shape;
        let [longitudinal, azimuthal] = look.roughness;
        let file_shape = FiberShape { longitudinal, azimuthal, tilt: look.tilt, eta: look.ior };
        if own == FiberShape::default() { file_shape.clamped() } else { own }
    }

    /// Returns the pigments and fiber shape of these settings. `file` is the material stored in the groom's file.
    /// Returns `None` for an sRGB color and the skin's, and for [`HairColor::File`] without a `file`.
    pub fn look(&self, file: Option<&Look>) -> Option<Look> {
        let mut shape = self.shading.material.fiber.shape;
        let (eumelanin, pheomelanin) = match self.shading.color {
            HairColor::File => {
                let file = file?;
                shape = self.shape_of(file);
                (file.eumelanin, file.pheomelanin)
            }
            HairColor::Srgb | HairColor::Skin => return None,
            HairColor::Blond => (0.25, 0.05),
            HairColor::Brown => (1.3, 0.2),
            HairColor::Red => (0.12, 1.5),
            HairColor::Black => (6.0, 0.3),
            HairColor::Melanin => (self.shading.eumelanin, self.shading.pheomelanin),
        };
        let FiberShape { longitudinal, azimuthal, tilt, eta } = shape;
        Some(Look { eumelanin, pheomelanin, roughness: [longitudinal, azimuthal], tilt, ior: eta })
    }

    pub(super) fn resolve_look(&self, into: &mut Self) {
        let mut material = self.material();
        // Classic has Kajiya–Kay shading.
        if self.renderer(8).is_ok_and(|renderer| renderer.shading() == ShadingModel::Fiber) {
            material.lightness_spread = material.fiber.melanin_spread;
            material.shift_spread = material.fiber.tilt_spread / TILT;
        }
        into.shading.material = material;
        into.take_as_given(knobs::section("shading").map(|knob| knob.path));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::ShadingSettings;
    use tresses::glam::Vec3;
    use tresses::{light::FiberMaterial, low_level::melanin};

    fn colored(color: HairColor) -> Settings {
        Settings { shading: ShadingSettings { color, ..Default::default() }, ..Default::default() }
    }

    #[test]
    fn named_colors_match_library_materials() {
        assert_eq!(Settings::default().material(), HairMaterial::default());
        for (color, name) in
            [(HairColor::Blond, "blond"), (HairColor::Red, "red"), (HairColor::Black, "black")]
        {
            let expected = HairMaterial { uses_file_colors: false, ..HairMaterial::named(name).unwrap() };
            assert_eq!(colored(color).material(), expected);
        }
    }

    #[test]
    fn highlight_spread_sets_both_models() {
        let mut settings = colored(HairColor::Red);
        settings.set("shading.highlight_spread", 0.4).unwrap();
        settings.set("shading.diffuse", 0.9).unwrap();
        let material = settings.material();
        assert_eq!((material.shift_spread, material.fiber.tilt_spread), (0.4, 0.1));
        assert_eq!((material.diffuse, material.primary), (0.9, HairMaterial::red().primary));
    }

    #[test]
    fn tip_pigment_scales_tip_absorption() {
        let mut settings = colored(HairColor::Melanin);
        settings.shading.tip_pigment = 0.45;
        let half = settings.material();
        settings.shading.tip_pigment = 0.9;
        let whole = settings.material();
        assert!((half.fiber.tip_absorption / whole.fiber.tip_absorption - 0.5).abs().max_element() < 1e-5);
        assert_eq!(half.fiber.root_absorption, whole.fiber.root_absorption);
        assert!(!half.uses_file_colors);
        assert_ne!(whole.fiber.tip_absorption, Vec3::ZERO);
    }

    #[test]
    fn file_material_yields_to_settings() {
        let red = Look { eumelanin: 0.12, pheomelanin: 1.5, roughness: [0.2, 0.4], ..Look::default() };
        let mut settings = Settings::default();
        let of_file = settings.material_of(Some(&red));
        assert_eq!(of_file.fiber.root_absorption, HairMaterial::red().fiber.root_absorption);
        assert!(of_file.uses_file_colors && of_file.fiber.shape.azimuthal == 0.4);
        assert_eq!(settings.look(Some(&red)), Some(red));
        // Explicit settings take precedence.
        settings.set("shading.roughness_along", 0.5).unwrap();
        assert_eq!(settings.material_of(Some(&red)).fiber.shape.azimuthal, 0.3);
        assert_eq!(settings.look(Some(&red)).unwrap().roughness, [0.5, 0.3]);
        settings.set("shading.color", "black").unwrap();
        assert_eq!(settings.material_of(Some(&red)), settings.material());
        let black = settings.look(Some(&red)).unwrap();
        assert_eq!((black.eumelanin, black.pheomelanin, black.roughness), (6.0, 0.3, [0.5, 0.3]));
        // Named colors equal their pigments.
        for name in ["blond", "brown", "red", "black"] {
            settings.set("shading.color", name).unwrap();
            let look = settings.look(None).unwrap();
            let fiber = FiberMaterial::natural(melanin(look.eumelanin, look.pheomelanin));
            assert_eq!(settings.material().fiber.root_absorption, fiber.root_absorption, "{name}");
        }
    }
}
