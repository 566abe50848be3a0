//! Face grooms: brows, lashes and a beard besides the hair.
//!
//! Each is a groom of its own with roots on the same skin, so it follows jaw and brows. Its color is the hair's, a
//! shade darker.

use crate::{
    Result,
    groom::{
        BindOptions, Groom, GuideCount, Strands, TriMesh, bind,
        mannequin::facial::{self, Beard},
    },
    light::HairMaterial,
    simulate::{RestOptions, SimulationParams},
    volume::HairHair,
    wind::Wind,
};

/// Pigment of brows and beard relative to the hair.
const DARKER: f32 = 1.5;

/// The built-in character's brows, lashes and beard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceHair {
    /// Whether there are brows.
    pub brows: bool,
    /// Whether there are lashes.
    pub lashes: bool,
    /// The kind of beard.
    pub beard: Beard,
}

impl Default for FaceHair {
    fn default() -> Self {
        Self { brows: true, lashes: true, beard: Beard::None }
    }
}

/// A groom on the face.
#[derive(Clone, Debug)]
pub struct FaceGroom {
    /// Guides and strands.
    pub groom: Groom,
    /// Whether it is long enough to collide and to move in the wind, like a full beard. Other face grooms move only
    /// with the skin.
    pub hangs: bool,
}

impl FaceHair {
    /// Grows the grooms on `mesh`, a mesh of the built-in character.
    ///
    /// # Errors
    /// As [`bind()`].
    pub fn grow(&self, mesh: &TriMesh) -> Result<Vec<FaceGroom>> {
        let (mut fine, mut beard) = (Strands::default(), Strands::default());
        if self.brows {
            facial::brows(&mut fine);
        }
        if self.lashes {
            facial::lashes(&mut fine);
        }
        facial::beard(&mut beard, self.beard, mesh);
        let hangs = self.beard == Beard::Full;
        let all = [(fine, false, 12), (beard, hangs, if hangs { 24 } else { 60 })];
        let bound =
            all.into_iter().filter(|(strands, ..)| !strands.is_empty()).map(|(strands, hangs, of)| {
                let vertices = strands.range(0).len() as u32;
                let options = BindOptions {
                    guides: GuideCount::OneIn(of),
                    guide_vertices: Some(vertices.max(8)),
                    strand_vertices: Some(vertices),
                    ..Default::default()
                };
                Ok(FaceGroom { groom: bind(&strands, &options)?, hangs })
            });
        bound.collect()
    }
}

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
