//! A hair: its source and its companions.

use crate::files::Files;
use tresses::groom::{import::ImportOptions, styles::Style};
use tresses_scene::{Companion, Companions, Settings, settings::HairColor, source};

/// The key of the colours painted on the scalp.
pub const COLORS: &str = "color_map";

/// Groom and head.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A built-in style, by its name.
    Style(String),
    /// The files of one groom, and of the head it grows on if there are any.
    Files {
        /// The files.
        files: Files,
        /// Units and axes.
        options: Box<ImportOptions>,
    },
}

impl Source {
    /// A few words for a title.
    pub fn name(&self) -> String {
        match self {
            Self::Style(name) => name.clone(),
            Self::Files { files, .. } => files.name(),
        }
    }
}

/// Which hair, and the maps, obstacles and surroundings beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hair {
    /// Groom and head.
    pub source: Source,
    /// What stands beside them.
    pub companions: Companions,
}

impl Default for Hair {
    fn default() -> Self {
        Self { source: Source::Style(Style::default().name().into()), companions: Companions::default() }
    }
}

impl Hair {
    /// Whether `other` is the same hair in another light.
    pub fn is_lit_otherwise(&self, other: &Self) -> bool {
        self.source == other.source && !self.companions.differ_in_hair(&other.companions)
    }

    /// The settings under which one sees it: colours that were `painted` for it hide behind no other.
    pub fn seen_with(&self, settings: &Settings, painted: Option<&str>) -> Settings {
        let mut settings = settings.clone();
        if painted.is_some() && painted == self.companions.names().color_map.as_deref() {
            settings.shading.color = HairColor::File;
        }
        settings
    }

    /// What leads from `before` to this, a word or two.
    pub fn step_from(&self, before: &Self) -> String {
        if self.source != before.source {
            return format!("Hair: {}", self.source.name());
        }
        let name = |hair: &Self, companion: &Companion| hair.companions.name(companion);
        let mut turned = source::COMPANIONS.iter().filter(|c| name(self, c) != name(before, c));
        match (turned.next(), turned.next()) {
            (Some(one), None) => one.title.into(),
            _ => "Files".into(),
        }
    }

    /// As a preset names it; bytes of a browser have no place that could be named.
    pub fn named(&self) -> source::Source {
        let mut source = self.companions.names().clone();
        match &self.source {
            Source::Style(name) => source.style = Some(name.clone()),
            Source::Files { files: Files::Disk { grooms, heads }, options } => {
                (source.grooms, source.heads) = (grooms.clone(), heads.clone());
                source.orientation = (**options).clone();
            }
            Source::Files { files: Files::Given(_), .. } => {}
        }
        source
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses_scene::{Shelf, source::companion};

    #[test]
    fn what_changed_is_named() {
        let bob = Hair { source: Source::Style("bob".into()), ..Hair::default() };
        let with = |hair: &Hair, key: &str| {
            let name = Some("front".into());
            let companions = hair.companions.with(companion(key).unwrap(), name, &Shelf::default());
            Hair { companions, ..hair.clone() }
        };
        let (sparse, lit) = (with(&bob, "density_map"), with(&bob, "environment"));
        assert_eq!(bob.step_from(&Hair::default()), "Hair: bob");
        assert_eq!((sparse.step_from(&bob), lit.step_from(&bob)), ("Density".into(), "Surroundings".into()));
        assert_eq!(lit.step_from(&sparse), "Files");
        assert!(lit.is_lit_otherwise(&bob) && !sparse.is_lit_otherwise(&bob));
        assert!(!bob.is_lit_otherwise(&Hair::default()));
        assert_eq!(sparse.named().style.as_deref(), Some("bob"));
        assert_eq!(sparse.named().density_map.as_deref(), Some("front"));
    }

    #[test]
    fn painted_colours_are_seen() {
        let name = || Some("colours.png".to_owned());
        let companions = Companions::default().with(companion(COLORS).unwrap(), name(), &Shelf::default());
        let hair = Hair { companions, ..Hair::default() };
        let mut brown = Settings::default();
        brown.shading.color = HairColor::Brown;
        let color =
            |hair: &Hair, painted: Option<String>| hair.seen_with(&brown, painted.as_deref()).shading.color;
        assert_eq!(color(&hair, name()), HairColor::File);
        // Those of a preset that says brown, and of hair that came in their place, are not.
        assert_eq!(color(&hair, None), HairColor::Brown);
        assert_eq!(color(&Hair::default(), name()), HairColor::Brown);
    }
}
