//! Cards as files: the look of their material, their simulated motion, the files of each format, and the numbers of a
//! bake.

mod chain;
#[cfg(not(target_arch = "wasm32"))]
mod simulated;

pub use chain::CardChain;
#[cfg(not(target_arch = "wasm32"))]
pub use simulated::{CardClip, simulate};

use crate::settings::Settings;
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use std::{
    path::{Path, PathBuf},
    str::FromStr,
};
use tresses::{
    CharacterParts, Progress,
    groom::{
        Rig, TriMesh,
        cards::{CardAlpha, CardLook, CardOptions, Cards, NamedFile, SIZES, bake_with},
    },
    low_level::color_of,
};

/// Exponent of the light that hair loses, from its color to that of cards. With it, cards in three.js are as bright as
/// strands under a light from the front (`tools/evidence/cards-light`).
const MULTIPLE: f32 = 2.5;

/// Returns the look of cards with the hair color of `settings`. The color of cards includes light that strands scatter
/// several times.
pub fn look(settings: &Settings, alpha: CardAlpha) -> CardLook {
    let fiber = settings.material().fiber;
    let absorption = 0.5 * (fiber.root_absorption + fiber.tip_absorption);
    let color = color_of(absorption, fiber.shape.azimuthal);
    CardLook { color: 1.0 - (1.0 - color).powf(MULTIPLE), alpha, motions: Vec::new() }
}

/// A level of detail that a user asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LevelRequest {
    /// A number of cards.
    Cards(u32),
    /// A helmet.
    Helmet,
}

impl FromStr for LevelRequest {
    type Err = anyhow::Error;

    fn from_str(word: &str) -> Result<Self> {
        match word.trim() {
            "helmet" => Ok(Self::Helmet),
            number => match number.parse() {
                Ok(count) => Ok(Self::Cards(count)),
                Err(_) => bail!("a level is a number of cards, or helmet"),
            },
        }
    }
}

/// Returns default options with the levels that a user asks for.
///
/// # Errors
/// Fails for a helmet before other levels.
pub fn options(levels: &[LevelRequest]) -> Result<CardOptions> {
    let helmet = levels.last() == Some(&LevelRequest::Helmet);
    let cards = &levels[..levels.len() - usize::from(helmet)];
    let count = |level: &LevelRequest| match level {
        LevelRequest::Cards(count) => Ok(*count),
        LevelRequest::Helmet => bail!("the helmet is the last level, once"),
    };
    let levels = cards.iter().map(count).collect::<Result<_>>()?;
    Ok(CardOptions { levels, has_helmet: helmet, ..Default::default() })
}

/// Bakes the hair of `parts` at rest. `colored` tells whether strands have the colors of the groom's file.
///
/// # Errors
/// As [`bake_with`].
pub async fn of_parts(
    parts: &CharacterParts,
    options: &CardOptions,
    colored: bool,
    progress: &impl Progress,
) -> Result<Cards> {
    // Colors of the file are not drawn with a color of the settings.
    let mut strands = parts.groom.strands.unbound();
    if !colored {
        strands.colors.clear();
    }
    Ok(bake_with(&strands, parts.head.as_ref(), options, progress).await?)
}

/// A format of cards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CardFormat {
    /// One file with the body, its skeleton and all levels.
    Glb,
    /// Such a file for each level.
    SplitGlb,
    /// A file for each level, and textures.
    Obj,
}

impl CardFormat {
    /// Returns the format of `path` by its extension. `split` asks for a file for each level.
    ///
    /// # Errors
    /// Fails for other extensions than `.glb` and `.obj`.
    pub fn of(path: &Path, split: bool) -> Result<Self> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("glb") if split => Ok(Self::SplitGlb),
            Some("glb") => Ok(Self::Glb),
            Some("obj") => Ok(Self::Obj),
            _ => bail!("{}: cards can be written as .glb or .obj", path.display()),
        }
    }

    /// Encodes all files, and returns them with their paths: `path` itself or, for several files, paths that begin with
    /// its stem.
    ///
    /// # Errors
    /// Fails if a texture cannot be encoded, and for a rig of another mesh.
    pub fn encoded(
        self,
        cards: &Cards,
        body: Option<(&TriMesh, Option<&Rig>)>,
        look: &CardLook,
        path: &Path,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>> {
        match self {
            Self::Glb => Ok(vec![(path.to_owned(), cards.glb(body, look)?)]),
            Self::SplitGlb => {
                let file = |level: usize| -> Result<_> {
                    let name = format!("{}_LOD{level}.glb", stem(path)?);
                    Ok((path.with_file_name(name), cards.only(level).glb(body, look)?))
                };
                (0..cards.levels.len()).map(file).collect()
            }
            Self::Obj => Ok(in_folder_of(path, cards.obj(stem(path)?, look)?)),
        }
    }
}

/// Encodes the textures of `cards` with their mip levels for `alpha`, and returns them with paths that begin with the
/// stem of `path`.
///
/// # Errors
/// Fails for a path without a file name.
pub fn ktx2(cards: &Cards, alpha: CardAlpha, path: &Path) -> Result<Vec<(PathBuf, Vec<u8>)>> {
    Ok(in_folder_of(path, cards.textures.ktx2(stem(path)?, alpha)))
}

/// Returns the file name of `path` without its extension.
fn stem(path: &Path) -> Result<&str> {
    path.file_stem().and_then(|name| name.to_str()).context("the path has no valid file name")
}

/// Puts files into the folder of `path`.
fn in_folder_of(path: &Path, files: Vec<NamedFile>) -> Vec<(PathBuf, Vec<u8>)> {
    files.into_iter().map(|(name, bytes)| (path.with_file_name(name), bytes)).collect()
}

/// Returns the numbers of a bake from a number of strands.
pub fn numbers(cards: &Cards, strands: usize) -> Value {
    let levels = cards.levels.iter().map(|level| {
        let accuracy = &level.accuracy;
        let differences = SIZES.iter().zip(accuracy.difference);
        let differences: Vec<_> = differences.map(|(px, mean)| json!({"px": px, "opacity": mean})).collect();
        json!({
            "cards": level.cards,
            "helmet": level.helmet,
            "pictures": level.pictures,
            "vertices": level.mesh.positions.len(),
            "triangles": level.mesh.triangles.len(),
            "widening": level.widening,
            "softIou": accuracy.soft_iou,
            "silhouetteIou": accuracy.silhouette_iou,
            "coverage": accuracy.coverage,
            "coverageInOneView": accuracy.coverage_range,
            "difference": differences,
            "switchPx": accuracy.switch,
            "pop": level.pop,
            "overdraw": level.overdraw,
            "orderError": level.order_error,
        })
    });
    json!({
        "strands": strands,
        "texture": cards.textures.size,
        "texelMillimeters": 1000.0 / cards.density,
        "textureFilled": cards.filled,
        "levels": levels.collect::<Vec<_>>(),
        "notes": cards.notes,
    })
}
