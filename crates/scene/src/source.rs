//! Names of the files that a character is built from: groom and head, or a built-in style, and their
//! [companions](Companion).

use std::path::PathBuf;
use tresses::groom::{formats, import::ImportOptions};

/// Groom, head and companion files, or a built-in style. All fields are optional.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PresetSource {
    /// Name of a built-in hairstyle, on the head of `heads` if there is one.
    pub style: Option<String>,
    /// Groom files.
    pub grooms: Vec<PathBuf>,
    /// Head files.
    pub heads: Vec<PathBuf>,
    /// Known units and axes of groom and head.
    pub orientation: ImportOptions,
    /// Density map, the share of strands kept: an image, `image.png:r` for one channel, or the name of a built-in map.
    pub density_map: Option<String>,
    /// Width factor map, in the same notation.
    pub thickness_map: Option<String>,
    /// Length factor map, in the same notation.
    pub length_map: Option<String>,
    /// Curl radius factor map, in the same notation.
    pub curl_map: Option<String>,
    /// Stiffness map, in the same notation.
    pub stiffness_map: Option<String>,
    /// Hair color image.
    pub color_map: Option<String>,
    /// Drawn curl.
    pub curl_curve: Option<String>,
    /// Painted levels of detail.
    pub lod_maps: Option<String>,
    /// Collider file.
    pub colliders: Option<String>,
    /// File of bands, braids and pins.
    pub ties: Option<String>,
    /// Environment map.
    pub environment: Option<String>,
}

impl PresetSource {
    /// Whether the hair is a built-in style on the built-in body.
    pub fn is_mannequin(&self) -> bool {
        self.grooms.is_empty() && self.heads.is_empty()
    }
}

/// File type of a companion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompanionKind {
    /// A grayscale image over the scalp, or the name of a built-in map.
    Map,
    /// A color image over the scalp.
    Colors,
    /// A groom of one strand.
    Curve,
    /// A list of painted levels of detail.
    Levels,
    /// A list of colliders.
    Colliders,
    /// A list of bands, braids and pins.
    Ties,
    /// An equirectangular environment map.
    Surroundings,
}

impl CompanionKind {
    /// Returns the file extensions.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Map | Self::Colors => &["png"],
            Self::Curve => formats::GROOMS,
            Self::Levels | Self::Colliders | Self::Ties => &["json"],
            Self::Surroundings => &["hdr", "exr"],
        }
    }

    /// Returns the extensions of files that a companion of this kind refers to.
    pub fn needs(self) -> Vec<&'static str> {
        match self {
            Self::Levels => vec!["png"],
            Self::Colliders => [formats::MESHES, formats::RESOURCES].concat(),
            _ => Vec::new(),
        }
    }

    /// Returns whether a change of the file requires rebuilding the strands.
    pub fn is_of_hair(self) -> bool {
        self != Self::Surroundings
    }
}

/// Description of one companion file.
#[derive(Debug)]
pub struct Companion {
    /// Key in a preset.
    pub key: &'static str,
    /// Command-line flag, without its dashes.
    pub flag: &'static str,
    /// Title in a panel, one or two words.
    pub title: &'static str,
    /// Description, one line.
    pub hint: &'static str,
    /// File type.
    pub kind: CompanionKind,
    pub(crate) field: fn(&mut PresetSource) -> &mut Option<String>,
}

impl PartialEq for Companion {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl Companion {
    /// Returns the companion's file name in `source`.
    pub fn name(&self, source: &PresetSource) -> Option<String> {
        // `field` needs a mutable source, so read from a copy.
        (self.field)(&mut source.clone()).clone()
    }

    /// Sets or removes the companion's file name in `source`.
    pub fn set(&self, source: &mut PresetSource, name: Option<String>) {
        *(self.field)(source) = name;
    }
}

macro_rules! companion {
    ($key:ident, $flag:literal, $kind:ident, $title:literal, $hint:literal) => {
        Companion {
            key: stringify!($key),
            flag: $flag,
            title: $title,
            hint: $hint,
            kind: CompanionKind::$kind,
            field: |source| &mut source.$key,
        }
    };
}

/// All companions, in the order of presets.
pub static COMPANION_FILES: [Companion; 11] = [
    companion!(
        density_map,
        "density-map",
        Map,
        "Density",
        "Fraction of strands that remain: none where the map is black, all where it is white"
    ),
    companion!(thickness_map, "thickness-map", Map, "Thickness", "Factor on strand widths, 0 to 1"),
    companion!(length_map, "length-map", Map, "Length", "Factor on strand lengths, 0 to 1"),
    companion!(curl_map, "curl-map", Map, "Curl radius", "Factor on the radius of curls, 0 to 1"),
    companion!(
        stiffness_map,
        "stiffness-map",
        Map,
        "Stiffness",
        "Factor on stiffness: 1/4 where the map is black, 1 at middle gray, 4 where it is white"
    ),
    companion!(color_map, "color-map", Colors, "Colors", "Colors of the hair, if shading.color is file"),
    companion!(
        curl_curve,
        "curl-curve",
        Curve,
        "Curl shape",
        "A drawn curl, repeated along the strands: a file with one line"
    ),
    companion!(
        lod_maps,
        "lod-maps",
        Levels,
        "Levels of detail",
        "Painted levels of detail: sizes in pixels, each with density and thickness maps"
    ),
    companion!(
        colliders,
        "colliders",
        Colliders,
        "Colliders",
        "Colliders besides the head: moving capsules, ellipsoids and meshes"
    ),
    companion!(
        ties,
        "ties",
        Ties,
        "Ties",
        "Bands, braids and pins that hold the hair, at their rest positions"
    ),
    companion!(
        environment,
        "environment",
        Surroundings,
        "Environment",
        "Equirectangular environment map that replaces key, rim and ambient light; its center is in front of the face"
    ),
];

/// Returns the companion with the given key.
pub fn companion(key: &str) -> Option<&'static Companion> {
    COMPANION_FILES.iter().find(|companion| companion.key == key)
}
