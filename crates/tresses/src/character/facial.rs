//! Options of face grooms: brows, lashes and a beard. Their color is the hair's, a shade darker.

use crate::{
    light::HairMaterial,
    simulate::{RestOptions, SimulationParams},
    volume::HairHair,
    wind::Wind,
};

/// Pigment of brows and beard relative to the hair.
const DARKER: f32 = 1.5;

/// Returns the material of a face groom for hair of `material`.
pub(super) fn darker(material: &HairMaterial) -> HairMaterial {
    let mut own = *material;
    own.fiber.root_absorption *= DARKER;
    own.fiber.tip_absorption *= DARKER;
    own.root_color *= 1.0 / DARKER;
    own.tip_color *= 1.0 / DARKER;
    own
}

/// Returns the physics of a face groom. It is too thin for a density grid; wind moves it only if it hangs.
pub(super) fn physics(hair: &SimulationParams, hangs: bool) -> SimulationParams {
    let wind = if hangs { hair.wind } else { Wind::default() };
    SimulationParams { hair_hair: HairHair::OFF, wind, ..*hair }
}

/// Returns the rest options of a face groom: the support of the hair, the other defaults.
pub(super) fn rest(hair: &RestOptions) -> RestOptions {
    RestOptions { support: hair.support, ..RestOptions::default() }
}
