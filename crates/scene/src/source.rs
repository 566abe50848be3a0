//! The files that a character is made of, by name: groom and head, or a built-in style, and their [companions](Companion).

use std::path::PathBuf;
use tresses::groom::{formats, import::ImportOptions};

/// Groom, head and the other files, or a built-in style; everything may be left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Source {
    /// A built-in hairstyle.
    pub style: Option<String>,
    /// Groom files.
    pub grooms: Vec<PathBuf>,
    /// The head's files.
    pub heads: Vec<PathBuf>,
    /// What is known of their units and axes.
    pub orientation: ImportOptions,
    /// Share of the strands that stay: a picture, `picture.png:r` for a channel, or the name of a map.
    pub density_map: Option<String>,
    /// Factor of the widths, likewise.
    pub thickness_map: Option<String>,
    /// Factor of the lengths, likewise.
    pub length_map: Option<String>,
    /// Factor of the radius of curls, likewise.
    pub curl_map: Option<String>,
    /// Stiffness, likewise.
    pub stiffness_map: Option<String>,
    /// Colours of the hair: a picture.
    pub color_map: Option<String>,
    /// A drawn curl.
    pub curl_curve: Option<String>,
    /// Painted levels of detail.
    pub lod_maps: Option<String>,
    /// Obstacles.
    pub colliders: Option<String>,
    /// Bands and pins.
    pub ties: Option<String>,
    /// A picture of the surroundings.
    pub environment: Option<String>,
}

/// What kind of file a companion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A grey picture over the scalp, or a map of the library by its name.
    Map,
    /// A picture of colours over the scalp.
    Colors,
    /// A groom of one strand.
    Curve,
    /// A list of painted levels of detail.
    Levels,
    /// A list of obstacles.
    Colliders,
    /// A list of bands and pins.
    Ties,
    /// An equirectangular picture.
    Surroundings,
}

impl Kind {
    /// The endings of its files.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Map | Self::Colors => &["png"],
            Self::Curve => formats::GROOMS,
            Self::Levels | Self::Colliders | Self::Ties => &["json"],
            Self::Surroundings => &["hdr", "exr"],
        }
    }

    /// The endings of what such files name in their turn.
    pub fn needs(self) -> Vec<&'static str> {
        match self {
            Self::Levels => vec!["png"],
            Self::Colliders => [formats::MESHES, formats::COMPANIONS].concat(),
            _ => Vec::new(),
        }
    }

    /// Whether strands have to be made again when it changes.
    pub fn is_of_hair(self) -> bool {
        self != Self::Surroundings
    }
}

/// A place for a file beside groom and head.
#[derive(Debug)]
pub struct Companion {
    /// Its key in a preset.
    pub key: &'static str,
    /// The flag of the command, without its dashes.
    pub flag: &'static str,
    /// A word or two for a panel.
    pub title: &'static str,
    /// One line.
    pub hint: &'static str,
    /// What kind of file it is.
    pub kind: Kind,
    pub(crate) place: fn(&mut Source) -> &mut Option<String>,
}

impl PartialEq for Companion {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl Companion {
    /// The name of the file in `source`.
    pub fn name(&self, source: &Source) -> Option<String> {
        // The places are the same whether something is to be written there or not.
        (self.place)(&mut source.clone()).clone()
    }

    /// Puts a name there, or takes it away.
    pub fn set(&self, source: &mut Source, name: Option<String>) {
        *(self.place)(source) = name;
    }
}

macro_rules! companion {
    ($key:ident, $flag:literal, $kind:ident, $title:literal, $hint:literal) => {
        Companion {
            key: stringify!($key),
            flag: $flag,
            title: $title,
            hint: $hint,
            kind: Kind::$kind,
            place: |source| &mut source.$key,
        }
    };
}

/// All of them, in the order in which presets have them.
pub static COMPANIONS: [Companion; 11] = [
    companion!(
        density_map,
        "density-map",
        Map,
        "Density",
        "The share of the strands that stay: none where it is black, all where it is white"
    ),
    companion!(thickness_map, "thickness-map", Map, "Thickness", "What widths are multiplied by, 0 to 1"),
    companion!(length_map, "length-map", Map, "Length", "What lengths are multiplied by, 0 to 1"),
    companion!(curl_map, "curl-map", Map, "Curl radius", "What the radius of curls is multiplied by, 0 to 1"),
    companion!(
        stiffness_map,
        "stiffness-map",
        Map,
        "Stiffness",
        "Black is a quarter as stiff, white four times, middle grey as it was"
    ),
    companion!(
        color_map,
        "color-map",
        Colors,
        "Colours",
        "The colours of the hair, where shading.color is on file"
    ),
    companion!(
        curl_curve,
        "curl-curve",
        Curve,
        "Shape of curls",
        "One drawn curl, repeated along the strands: a file of one line"
    ),
    companion!(
        lod_maps,
        "lod-maps",
        Levels,
        "Levels of detail",
        "Painted levels of detail: sizes in pixels, each with maps of density and thickness"
    ),
    companion!(
        colliders,
        "colliders",
        Colliders,
        "Obstacles",
        "What hair collides with besides the head: capsules, ellipsoids and meshes that move"
    ),
    companion!(
        ties,
        "ties",
        Ties,
        "Ties",
        "Bands, braids and pins that hold the hair, where they are at rest"
    ),
    companion!(
        environment,
        "environment",
        Surroundings,
        "Surroundings",
        "An equirectangular picture that gives all light instead of key, rim and sky; its middle lies before the face"
    ),
];

/// The companion with a key.
pub fn companion(key: &str) -> Option<&'static Companion> {
    COMPANIONS.iter().find(|companion| companion.key == key)
}
