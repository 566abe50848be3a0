//! The hair of a document: its source and its companion files.

use crate::files::Files;
use tresses::CharacterFiles;
use tresses::groom::{edit::GroomDocument, import::ImportOptions, styles::Style};
use tresses_scene::{Companion, CompanionFiles, Settings, settings::HairColor, source};

/// Companion key of the color map on the scalp.
pub const COLORS: &str = "color_map";

/// A groom with its head.
#[derive(Clone, Debug, PartialEq)]
pub enum HairSource {
    /// Name of a built-in style.
    Style(String),
    /// A built-in style on the head of files.
    Head {
        /// Name of the style.
        style: String,
        /// The head.
        files: Files,
        /// Units and axes.
        options: Box<ImportOptions>,
    },
    /// The files of one groom, and of its head if there is one.
    Files {
        /// The files.
        files: Files,
        /// Units and axes.
        options: Box<ImportOptions>,
    },
    /// A version of groomed hair.
    Edited {
        /// Name of the hair before the first stroke.
        name: String,
        /// The version.
        document: GroomDocument,
    },
}

impl HairSource {
    /// Returns a short name for titles.
    pub fn name(&self) -> String {
        match self {
            Self::Style(name) => name.clone(),
            Self::Head { style, files, .. } => format!("{style} on {}", files.name()),
            Self::Files { files, .. } => files.name(),
            Self::Edited { name, .. } => name.clone(),
        }
    }

    /// Returns the source of `files`: their groom or, if they hold a head alone, the built-in style named `style` on
    /// it.
    pub fn of_files(files: Files, style: &str, options: Box<ImportOptions>) -> Self {
        match files.hold_groom() {
            true => Self::Files { files, options },
            false => Self::Head { style: style.into(), files, options },
        }
    }

    /// Returns the built-in style named `style`, on the same head if it is a file's.
    pub fn with_style(&self, style: &str) -> Self {
        match self {
            Self::Head { files, options, .. } => {
                Self::Head { style: style.into(), files: files.clone(), options: options.clone() }
            }
            _ => Self::Style(style.into()),
        }
    }

    /// Returns the name of the built-in style, if it is one.
    pub fn style(&self) -> Option<&str> {
        match self {
            Self::Style(style) | Self::Head { style, .. } => Some(style),
            _ => None,
        }
    }

    /// Returns the version, if the hair is groomed.
    pub fn document(&self) -> Option<&GroomDocument> {
        match self {
            Self::Edited { document, .. } => Some(document),
            _ => None,
        }
    }

    /// Whether `other` is a version of the same groomed hair.
    pub fn is_version_of(&self, other: &Self) -> bool {
        self.document().zip(other.document()).is_some_and(|(a, b)| a.is_version_of(b))
    }

    /// Returns the files that the hair was read from; none for a built-in style.
    pub fn files(&self) -> CharacterFiles<'_> {
        match self {
            Self::Head { files, .. } | Self::Files { files, .. } => files.borrowed(),
            _ => CharacterFiles::Given(&[]),
        }
    }
}

/// Hair and its maps, obstacles and environment.
#[derive(Clone, Debug, PartialEq)]
pub struct DocumentHair {
    /// Groom and head.
    pub source: HairSource,
    /// Maps, obstacles and environment.
    pub companion_files: CompanionFiles,
}

impl Default for DocumentHair {
    fn default() -> Self {
        Self {
            source: HairSource::Style(Style::default().name().into()),
            companion_files: CompanionFiles::default(),
        }
    }
}

impl DocumentHair {
    /// Whether `other` differs at most in its environment.
    pub fn is_lit_otherwise(&self, other: &Self) -> bool {
        self.source == other.source && !self.companion_files.differ_in_hair(&other.companion_files)
    }

    /// Returns `settings` with the hair color taken from the color map, if `painted` names this hair's map. A newly
    /// loaded map is visible at once this way.
    pub fn settings_with_color_map(&self, settings: &Settings, painted: Option<&str>) -> Settings {
        let mut settings = settings.clone();
        if painted.is_some() && painted == self.companion_files.names().color_map.as_deref() {
            settings.shading.color = HairColor::File;
        }
        settings
    }

    /// Returns a label of a few words for the change from `before`.
    pub fn step_from(&self, before: &Self) -> String {
        if matches!(self.source, HairSource::Edited { .. }) && before.source.document().is_none() {
            return "Groom".into();
        }
        if self.source != before.source {
            return format!("Hair: {}", self.source.name());
        }
        let name = |hair: &Self, companion: &Companion| hair.companion_files.name(companion);
        let mut changed = source::COMPANION_FILES.iter().filter(|c| name(self, c) != name(before, c));
        match (changed.next(), changed.next()) {
            (Some(one), None) => one.title.into(),
            _ => "Files".into(),
        }
    }

    /// Returns the source for a preset. Files in a browser and groomed hair have no path, so they are left out.
    pub fn named(&self) -> source::PresetSource {
        let mut source = self.companion_files.names().clone();
        match &self.source {
            HairSource::Style(name) => source.style = Some(name.clone()),
            HairSource::Files { files: Files::Disk { grooms, heads }, options } => {
                (source.grooms, source.heads) = (grooms.clone(), heads.clone());
                source.orientation = (**options).clone();
            }
            HairSource::Head { style, files: Files::Disk { heads, .. }, options } => {
                (source.style, source.heads) = (Some(style.clone()), heads.clone());
                source.orientation = (**options).clone();
            }
            HairSource::Files { files: Files::Given(_), .. }
            | HairSource::Head { files: Files::Given(_), .. }
            | HairSource::Edited { .. } => {}
        }
        source
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses_scene::{Shelf, source::companion};

    #[test]
    fn undo_label_names_the_change() {
        let bob = DocumentHair { source: HairSource::Style("bob".into()), ..DocumentHair::default() };
        let with = |hair: &DocumentHair, key: &str| {
            let name = Some("front".into());
            let companions = hair.companion_files.with(companion(key).unwrap(), name, &Shelf::default());
            DocumentHair { companion_files: companions, ..hair.clone() }
        };
        let (sparse, lit) = (with(&bob, "density_map"), with(&bob, "environment"));
        assert_eq!(bob.step_from(&DocumentHair::default()), "Hair: bob");
        assert_eq!((sparse.step_from(&bob), lit.step_from(&bob)), ("Density".into(), "Environment".into()));
        assert_eq!(lit.step_from(&sparse), "Files");
        assert!(lit.is_lit_otherwise(&bob) && !sparse.is_lit_otherwise(&bob));
        assert!(!bob.is_lit_otherwise(&DocumentHair::default()));
        assert_eq!(sparse.named().style.as_deref(), Some("bob"));
        assert_eq!(sparse.named().density_map.as_deref(), Some("front"));
    }

    #[test]
    fn loaded_color_map_becomes_the_hair_color() {
        let name = || Some("colors.png".to_owned());
        let companions =
            CompanionFiles::default().with(companion(COLORS).unwrap(), name(), &Shelf::default());
        let hair = DocumentHair { companion_files: companions, ..DocumentHair::default() };
        let mut brown = Settings::default();
        brown.shading.color = HairColor::Brown;
        let color = |hair: &DocumentHair, painted: Option<String>| {
            hair.settings_with_color_map(&brown, painted.as_deref()).shading.color
        };
        assert_eq!(color(&hair, name()), HairColor::File);
        // A preset that says brown, and hair without the map, keep their color.
        assert_eq!(color(&hair, None), HairColor::Brown);
        assert_eq!(color(&DocumentHair::default(), name()), HairColor::Brown);
    }
}
