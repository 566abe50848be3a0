//! The options for how light on hair is computed.

use std::str::FromStr;
use tresses::light::{FiberMaterial, HairMaterial, ShadingModel, ShadingRate, fiber::bsdf::melanin};
use tresses_scene::settings::{HairColor, LookSettings};

/// Which model shades hair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Model {
    /// Two highlights and a diffuse colour, set by eye: the cheapest
    KajiyaKay,
    /// Light refracted and absorbed in fibres and scattered among them
    Fiber,
}

/// Where hair is shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Per {
    /// For each strand vertex, interpolated along the hair
    Vertex,
    /// For each pixel
    Pixel,
}

/// Whether something is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Switch {
    /// Done
    On,
    /// Left out
    Off,
}

/// Concentrations of the two pigments of hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Melanin {
    /// Brown to black.
    pub eumelanin: f32,
    /// Yellow to red.
    pub pheomelanin: f32,
}

impl FromStr for Melanin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse().ok().filter(|v| (0.0..=100.0).contains(v));
        let parts: Option<Vec<f32>> = text.split(',').map(number).collect();
        match parts.as_deref() {
            Some([eumelanin]) => Ok(Self { eumelanin: *eumelanin, pheomelanin: 0.0 }),
            Some([eumelanin, pheomelanin]) => Ok(Self { eumelanin: *eumelanin, pheomelanin: *pheomelanin }),
            _ => Err("give eumelanin and pheomelanin, each 0 to 100, as in 1.3,0.2".into()),
        }
    }
}

/// A roughness along and one around the fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    longitudinal: f32,
    azimuthal: f32,
}

impl FromStr for Roughness {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse().ok().filter(|v| (0.1..=1.0).contains(v));
        let parts: Option<Vec<f32>> = text.split(',').map(number).collect();
        match parts.as_deref() {
            Some([both]) => Ok(Self { longitudinal: *both, azimuthal: *both }),
            Some([longitudinal, azimuthal]) => {
                Ok(Self { longitudinal: *longitudinal, azimuthal: *azimuthal })
            }
            _ => Err("give one number from 0.1 to 1, or two: along and around the fibre".into()),
        }
    }
}

/// How light on hair is computed.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Shading")]
pub struct ShadingArgs {
    /// The model of the fibres [default: fiber]
    #[arg(long, value_name = "MODEL", value_enum)]
    pub shading: Option<Model>,
    /// Pigments of the hair instead of its colour: eumelanin (brown to black) and pheomelanin (yellow to
    /// red); brown is 1.3,0.2, blond 0.25,0.05, red 0.12,1.5, black 6,0.3
    #[arg(long, value_name = "EU,PHEO")]
    pub melanin: Option<Melanin>,
    /// Roughness of the fibres, 0.1 (wet silk) to 1 (wool): along them, and around them [default: 0.3,0.3]
    #[arg(long, value_name = "R[,R]")]
    pub roughness: Option<Roughness>,
    /// Where light is computed [default: vertex]
    #[arg(long, value_name = "WHERE", value_enum)]
    pub shade_per: Option<Per>,
    /// Follow light from the sky and from the skin through the hair; off guesses how open the sky is
    /// [default: on]
    #[arg(long, value_name = "WHETHER", value_enum)]
    pub ambient: Option<Switch>,
}

impl ShadingArgs {
    /// Why they make no sense together, if they do not.
    pub fn check(&self) -> anyhow::Result<()> {
        let fiber_only = [("--melanin", self.melanin.is_some()), ("--roughness", self.roughness.is_some())];
        if self.shading == Some(Model::KajiyaKay)
            && let Some((name, _)) = fiber_only.iter().find(|(_, given)| *given)
        {
            anyhow::bail!("{name} is a matter of --shading fiber");
        }
        Ok(())
    }

    /// Whether light from all sides is to be followed, where `now` is what holds otherwise.
    pub fn follows(&self, now: bool) -> bool {
        self.ambient.map_or(now, |switch| switch == Switch::On)
    }

    /// Puts what is given into `look`.
    pub fn apply(&self, look: &mut LookSettings) {
        match self.shading {
            Some(Model::KajiyaKay) => look.model = ShadingModel::KajiyaKay,
            Some(Model::Fiber) => look.model = ShadingModel::Fiber,
            None if self.melanin.is_some() || self.roughness.is_some() => look.model = ShadingModel::Fiber,
            None => {}
        }
        if let Some(Melanin { eumelanin, pheomelanin }) = self.melanin {
            (look.color, look.eumelanin, look.pheomelanin) = (HairColor::Melanin, eumelanin, pheomelanin);
        }
        if let Some(Roughness { longitudinal, azimuthal }) = self.roughness {
            (look.roughness_along, look.roughness_around) = (longitudinal, azimuthal);
        }
        match self.shade_per {
            Some(Per::Vertex) => look.rate = ShadingRate::PerVertex,
            Some(Per::Pixel) => look.rate = ShadingRate::PerPixel,
            None => {}
        }
    }

    /// What they make of a material that follows from no settings.
    pub fn vary(&self, material: &mut HairMaterial, rate: &mut ShadingRate) {
        match self.shading {
            Some(Model::KajiyaKay) => material.model = ShadingModel::KajiyaKay,
            Some(Model::Fiber) => material.model = ShadingModel::Fiber,
            None if self.melanin.is_some() || self.roughness.is_some() => {
                material.model = ShadingModel::Fiber
            }
            None => {}
        }
        if let Some(Melanin { eumelanin, pheomelanin }) = self.melanin {
            material.file_colors = false;
            material.fiber = FiberMaterial::natural(melanin(eumelanin, pheomelanin));
        }
        if let Some(Roughness { longitudinal, azimuthal }) = self.roughness {
            (material.fiber.shape.longitudinal, material.fiber.shape.azimuthal) = (longitudinal, azimuthal);
        }
        match self.shade_per {
            Some(Per::Vertex) => *rate = ShadingRate::PerVertex,
            Some(Per::Pixel) => *rate = ShadingRate::PerPixel,
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::glam::Vec3;

    #[test]
    fn values_mean_what_they_say() {
        assert_eq!("1.3,0.2".parse(), Ok(Melanin { eumelanin: 1.3, pheomelanin: 0.2 }));
        assert_eq!("2".parse(), Ok(Melanin { eumelanin: 2.0, pheomelanin: 0.0 }));
        assert_eq!("0.2".parse(), Ok(Roughness { longitudinal: 0.2, azimuthal: 0.2 }));
        for text in ["", "-1", "1,2,3", "nan", "200", "a,b"] {
            assert!(text.parse::<Melanin>().is_err(), "{text}");
        }
        for text in ["", "0", "1.1", "0.3,", "inf"] {
            assert!(text.parse::<Roughness>().is_err(), "{text}");
        }
    }

    #[test]
    fn pigments_ask_for_fibres() {
        let mut look = LookSettings { model: ShadingModel::KajiyaKay, ..Default::default() };
        let args =
            ShadingArgs { melanin: "0,1".parse().ok(), shade_per: Some(Per::Pixel), ..Default::default() };
        args.apply(&mut look);
        let (mut varied, mut rate) = (HairMaterial::black(), ShadingRate::default());
        args.vary(&mut varied, &mut rate);
        let material = look.material();
        assert_eq!(
            (material.model, look.rate, rate),
            (ShadingModel::Fiber, ShadingRate::PerPixel, look.rate)
        );
        assert_eq!(material.fiber, varied.fiber);
        let middle = 0.5 * (material.fiber.root_absorption + material.fiber.tip_absorption);
        assert!((middle / Vec3::new(0.187, 0.4, 1.05) - 1.0).abs().max_element() < 0.05);
        assert!(ShadingArgs { shading: Some(Model::KajiyaKay), ..args }.check().is_err());
    }
}
