//! Files that accompany a groom and its head: scalp maps, a drawn curl, painted levels of detail, colliders, ties and
//! environment maps. A [`PresetSource`] names them. The functions here read them from disk or, in a browser, from the
//! bytes in a [`Shelf`].

pub(crate) mod levels;
mod maps;
mod surroundings;
pub(crate) mod ties;

pub use levels::levels;
pub use maps::{ColorSource, MapSource};
pub use surroundings::EnvironmentMap;
pub use ties::ties;

use crate::{
    colliders::Colliders,
    shelf::Shelf,
    source::{COMPANION_FILES, Companion, PresetSource},
};
use anyhow::{Error, Result};
use std::path::Path;
use tresses::{
    LodLevel, Tie,
    groom::{
        grow::{CurlCurve, ScalpPaint},
        scalp::ScalpMap,
    },
};

/// Contents of the companion files that affect strands.
#[derive(Clone, Debug, Default)]
pub struct Maps {
    /// Maps applied while strands are built. The curl map also applies to imported grooms.
    pub paint: ScalpPaint,
    /// Stiffness factors for the guides.
    pub stiffness: Option<ScalpMap>,
    /// Drawn curl.
    pub curl: Option<CurlCurve>,
    /// Painted levels of detail.
    pub levels: Vec<LodLevel>,
    /// Bands, braids and pins.
    pub ties: Vec<Tie>,
}

/// Names of a groom's companion files, and the contents of those held in memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompanionFiles {
    names: PresetSource,
    /// Files in memory.
    pub files: Shelf,
}

impl CompanionFiles {
    /// Collects the companions that `source` names.
    pub fn of(source: &PresetSource, files: Shelf) -> Self {
        let mut names = PresetSource::default();
        for companion in &COMPANION_FILES {
            companion.set(&mut names, companion.name(source));
        }
        Self { names, files }
    }

    /// Returns a source that names only the companions, without hair.
    pub fn names(&self) -> &PresetSource {
        &self.names
    }

    /// Returns the file name of one companion.
    pub fn name(&self, companion: &Companion) -> Option<String> {
        companion.name(&self.names)
    }

    /// Returns a copy with `companion` set to `name`, or removed. `files` are added to those in memory.
    pub fn with(&self, companion: &Companion, name: Option<String>, files: &Shelf) -> Self {
        let mut changed = self.clone();
        if let Some(old) = companion.name(&self.names) {
            changed.files.take(Path::new(&old));
        }
        companion.set(&mut changed.names, name);
        changed.files.add(files);
        changed
    }

    /// Returns the files in memory except the environment map.
    fn files_of_hair(&self) -> Shelf {
        let mut files = self.files.clone();
        if let Some(name) = &self.names.environment {
            files.take(Path::new(name));
        }
        files
    }

    /// Iterates over the companions that are set, with their file names.
    pub fn all(&self) -> impl Iterator<Item = (&'static Companion, String)> {
        COMPANION_FILES.iter().filter_map(|companion| Some((companion, self.name(companion)?)))
    }

    /// Returns whether replacing `other` with these companions requires rebuilding the hair.
    pub fn differ_in_hair(&self, other: &Self) -> bool {
        let differs = |companion: &Companion| self.name(companion) != other.name(companion);
        self.files_of_hair() != other.files_of_hair()
            || COMPANION_FILES.iter().any(|c| c.kind.is_of_hair() && differs(c))
    }

    /// Returns whether `self` and `other` have different files in memory.
    pub fn files_differ(&self, other: &Self) -> bool {
        self.files != other.files
    }

    /// Reads the maps, the drawn curl, the painted levels and the ties.
    ///
    /// # Errors
    /// Returns the first file's read error.
    pub fn maps(&self) -> Result<Maps> {
        maps(&self.names, &self.files)
    }

    /// Reads the colliders; none if no file is set.
    ///
    /// # Errors
    /// Fails if the file cannot be read. The message names the file.
    pub fn colliders(&self) -> Result<Colliders> {
        match &self.names.colliders {
            Some(path) => Colliders::read(Path::new(path), &self.files),
            None => Ok(Colliders::default()),
        }
    }

    /// Reads the environment map, if one is set.
    ///
    /// # Errors
    /// Fails if the file cannot be read. The message names the file.
    pub fn surroundings(&self) -> Result<Option<EnvironmentMap>> {
        self.names
            .environment
            .as_ref()
            .map(|path| EnvironmentMap::read(Path::new(path), &self.files))
            .transpose()
    }
}

fn maps(source: &PresetSource, files: &Shelf) -> Result<Maps> {
    let read = |name: &Option<String>| {
        let read = |name: &String| name.parse::<MapSource>().map_err(Error::msg)?.read(files);
        name.as_ref().map(read).transpose()
    };
    let color = |name: &String| name.parse::<ColorSource>().map_err(Error::msg)?.read(files);
    let curve = |name: &String| {
        let path = Path::new(name);
        anyhow::Ok(CurlCurve::parse(path, &files.load(path)?)?)
    };
    // Black is a quarter as stiff, white four times.
    let stiffness = read(&source.stiffness_map)?.map(|map| map.map(|gray| 4f32.powf(2.0 * gray - 1.0)));
    Ok(Maps {
        paint: ScalpPaint {
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
    use crate::source::companion;

    #[test]
    fn each_companion_has_its_own_field() {
        let mut source = PresetSource { style: Some("bob".into()), ..PresetSource::default() };
        for companion in &COMPANION_FILES {
            companion.set(&mut source, Some(companion.key.into()));
        }
        for companion in &COMPANION_FILES {
            assert_eq!(companion.name(&source).as_deref(), Some(companion.key));
        }
        let companions = CompanionFiles::of(&source, Shelf::default());
        assert_eq!(companions.names().style, None, "the hair is no companion");
        assert_eq!(CompanionFiles::of(companions.names(), Shelf::default()), companions);
        for companion in &COMPANION_FILES {
            let less = companions.with(companion, None, &Shelf::default());
            assert_eq!(less.name(companion), None);
            assert_eq!(less.differ_in_hair(&companions), companion.key != "environment");
            assert_eq!(less.all().count(), COMPANION_FILES.len() - 1);
        }
        // An environment map in memory does not require rebuilding the hair; a scalp map does.
        let mut sky = Shelf::default();
        sky.put("sky.hdr".into(), *b"x");
        let lit = companions.with(companion("environment").unwrap(), Some("sky.hdr".into()), &sky);
        assert!(!lit.differ_in_hair(&companions));
        let painted = companions.with(companion("density_map").unwrap(), Some("sky.hdr".into()), &sky);
        assert!(painted.differ_in_hair(&companions));
    }

    #[test]
    fn maps_and_curve_load_from_memory() {
        let names = PresetSource {
            density_map: Some("not-front".into()),
            curl_curve: Some("wave.obj".into()),
            ..PresetSource::default()
        };
        let mut files = Shelf::default();
        files.put("wave.obj".into(), *b"v 0 0 0\nv 1 1 0\nv 0 2 0\nv -1 3 0\nv 0 4 0\nl 1 2 3 4 5\n");
        let companions = CompanionFiles::of(&names, files);
        let maps = companions.maps().unwrap();
        assert!(maps.paint.density.is_some() && maps.curl.is_some() && maps.paint.length.is_none());
        let with = |key: &str, name: &str| {
            companions.with(companion(key).unwrap(), Some(name.into()), &Shelf::default())
        };
        let error = |companions: &CompanionFiles| format!("{:#}", companions.maps().unwrap_err());
        let wrong = with("length_map", "nowhere.png");
        assert!(error(&wrong).contains("nowhere.png"));
        let wrong = with("color_map", "noise");
        assert!(error(&wrong).contains(".png"));
    }
}
