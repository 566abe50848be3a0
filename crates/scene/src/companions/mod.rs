//! Files beside groom and head: maps on the scalp, a drawn curl, painted levels of detail, obstacles, ties and
//! environments. A [`Source`] names them; here they are read, from the disk or,
//! in a browser, from a [`Shelf`] of bytes.

pub(crate) mod levels;
mod maps;
mod shelf;
mod surroundings;
pub(crate) mod ties;

pub use levels::levels;
pub use maps::{ColorSource, MapSource};
pub use shelf::Shelf;
pub use surroundings::Surroundings;
pub use ties::ties;

use crate::{Colliders, preset::Source, settings::Maps};
use anyhow::{Error, Result};
use std::path::Path;
use tresses::groom::{
    formats,
    grow::{CurlCurve, Paint},
};

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

/// The names of what stands beside a groom, and the bytes of those that are not on the disk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Companions {
    names: Source,
    /// What is there as bytes.
    pub files: Shelf,
}

impl Companions {
    /// The companions that `source` names.
    pub fn of(source: &Source, files: Shelf) -> Self {
        let mut names = Source::default();
        for companion in &COMPANIONS {
            companion.set(&mut names, companion.name(source));
        }
        Self { names, files }
    }

    /// The names alone: a source without hair.
    pub fn names(&self) -> &Source {
        &self.names
    }

    /// The name of one of them.
    pub fn name(&self, companion: &Companion) -> Option<String> {
        companion.name(&self.names)
    }

    /// The same with another file in one place, or with none; `files` are there as bytes from then on.
    pub fn with(&self, companion: &Companion, name: Option<String>, files: &Shelf) -> Self {
        let mut changed = self.clone();
        if let Some(old) = companion.name(&self.names) {
            changed.files.take(Path::new(&old));
        }
        companion.set(&mut changed.names, name);
        changed.files.add(files);
        changed
    }

    /// The bytes of everything but the surroundings.
    fn files_of_hair(&self) -> Shelf {
        let mut files = self.files.clone();
        if let Some(name) = &self.names.environment {
            files.take(Path::new(name));
        }
        files
    }

    /// Each that there is, with the name of its file.
    pub fn all(&self) -> impl Iterator<Item = (&'static Companion, String)> {
        COMPANIONS.iter().filter_map(|companion| Some((companion, self.name(companion)?)))
    }

    /// Whether hair that has these instead of `other` has to be made again.
    pub fn differ_in_hair(&self, other: &Self) -> bool {
        let differs = |companion: &Companion| self.name(companion) != other.name(companion);
        self.files_of_hair() != other.files_of_hair()
            || COMPANIONS.iter().any(|c| c.kind.is_of_hair() && differs(c))
    }

    /// Whether there are other bytes than in `other`.
    pub fn files_differ(&self, other: &Self) -> bool {
        self.files != other.files
    }

    /// The maps, the drawn curl, the painted levels and the ties.
    ///
    /// # Errors
    /// One sentence, for the first that cannot be read.
    pub fn maps(&self) -> Result<Maps> {
        maps(&self.names, &self.files)
    }

    /// The obstacles; none where no file is named.
    ///
    /// # Errors
    /// One sentence that names the file that cannot be read.
    pub fn colliders(&self) -> Result<Colliders> {
        match &self.names.colliders {
            Some(path) => Colliders::read(Path::new(path), &self.files),
            None => Ok(Colliders::default()),
        }
    }

    /// The surroundings, if some are named.
    ///
    /// # Errors
    /// One sentence that names the file that cannot be read.
    pub fn surroundings(&self) -> Result<Option<Surroundings>> {
        self.names
            .environment
            .as_ref()
            .map(|path| Surroundings::read(Path::new(path), &self.files))
            .transpose()
    }
}

fn maps(source: &Source, files: &Shelf) -> Result<Maps> {
    let read = |name: &Option<String>| {
        let read = |name: &String| name.parse::<MapSource>().map_err(Error::msg)?.read(files);
        name.as_ref().map(read).transpose()
    };
    let color = |name: &String| name.parse::<ColorSource>().map_err(Error::msg)?.read(files);
    let curve = |name: &String| {
        let path = Path::new(name);
        anyhow::Ok(CurlCurve::parse(path, &files.load(path)?)?)
    };
    // Black hair is a quarter as stiff, white four times.
    let stiffness = read(&source.stiffness_map)?.map(|map| map.map(|grey| 4f32.powf(2.0 * grey - 1.0)));
    Ok(Maps {
        paint: Paint {
            density: read(&source.density_map)?,
            thickness: read(&source.thickness_map)?,
            length: read(&source.length_map)?,
            curl: read(&source.curl_map)?,
            color: source.color_map.as_ref().map(color).transpose()?,
        },
        stiffness,
        curl: source.curl_curve.as_ref().map(curve).transpose()?,
        levels: match &source.lod_maps {
            Some(path) => levels(Path::new(path), files)?,
            None => Vec::new(),
        },
        ties: match &source.ties {
            Some(path) => ties(Path::new(path), files)?,
            None => Vec::new(),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_companion_has_its_place() {
        let mut source = Source { style: Some("bob".into()), ..Source::default() };
        for companion in &COMPANIONS {
            companion.set(&mut source, Some(companion.key.into()));
        }
        for companion in &COMPANIONS {
            assert_eq!(companion.name(&source).as_deref(), Some(companion.key));
        }
        let companions = Companions::of(&source, Shelf::default());
        assert_eq!(companions.names().style, None, "the hair is no companion");
        assert_eq!(Companions::of(companions.names(), Shelf::default()), companions);
        for companion in &COMPANIONS {
            let less = companions.with(companion, None, &Shelf::default());
            assert_eq!(less.name(companion), None);
            assert_eq!(less.differ_in_hair(&companions), companion.key != "environment");
            assert_eq!(less.all().count(), COMPANIONS.len() - 1);
        }
        // Surroundings that come as bytes leave the hair as it is; a map does not.
        let mut sky = Shelf::default();
        sky.put("sky.hdr".into(), *b"x");
        let lit = companions.with(companion("environment").unwrap(), Some("sky.hdr".into()), &sky);
        assert!(!lit.differ_in_hair(&companions));
        let painted = companions.with(companion("density_map").unwrap(), Some("sky.hdr".into()), &sky);
        assert!(painted.differ_in_hair(&companions));
    }

    #[test]
    fn maps_and_a_curve_are_read_from_bytes() {
        let names = Source {
            density_map: Some("not-front".into()),
            curl_curve: Some("wave.obj".into()),
            ..Source::default()
        };
        let mut files = Shelf::default();
        files.put("wave.obj".into(), *b"v 0 0 0\nv 1 1 0\nv 0 2 0\nv -1 3 0\nv 0 4 0\nl 1 2 3 4 5\n");
        let companions = Companions::of(&names, files);
        let maps = companions.maps().unwrap();
        assert!(maps.paint.density.is_some() && maps.curl.is_some() && maps.paint.length.is_none());
        let with = |key: &str, name: &str| {
            companions.with(companion(key).unwrap(), Some(name.into()), &Shelf::default())
        };
        let error = |companions: &Companions| format!("{:#}", companions.maps().unwrap_err());
        let wrong = with("length_map", "nowhere.png");
        assert!(error(&wrong).contains("nowhere.png"));
        let wrong = with("color_map", "noise");
        assert!(error(&wrong).contains(".png"));
    }
}
