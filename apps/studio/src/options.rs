//! Start options of the studio.

use crate::files::Files;
use anyhow::{Result, anyhow};
use std::path::PathBuf;
use tresses::groom::{edit::GroomDocument, import::ImportOptions, styles::Style};
use tresses_scene::{CompanionFiles, Settings, knobs::ParsedSetting};

/// Options of a studio window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The files of one groom; empty for a built-in style.
    pub grooms: Vec<PathBuf>,
    /// Head meshes of the groom.
    pub heads: Vec<PathBuf>,
    /// The built-in style if there is no groom: one of [`tresses::groom::styles::Style::NAMES`].
    pub style: Option<String>,
    /// Units and axes of the files; unset fields are guessed.
    pub import: ImportOptions,
    /// Maps, obstacles and environment.
    pub companion_files: CompanionFiles,
    /// All parameters.
    pub settings: Settings,
    /// Whether to hide everything but the viewport, as in an embedded viewer.
    pub hides_panels: bool,
    /// Files in memory, used instead of those on disk.
    pub given: Option<Files>,
    /// Groomed hair and its name, used instead of files.
    pub edited: Option<(String, GroomDocument)>,
    /// An error to show, from the previous window.
    pub trouble: Option<String>,
}

impl Options {
    /// Parses names and values of a page's query or of a command line: `style`, and parameters by path, such as
    /// `style=bob`, `style.strands=5000`, `wind.speed=3`.
    ///
    /// # Errors
    /// Fails with one sentence for an unknown name or an invalid value.
    pub fn of<'a>(query: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self> {
        let mut options = Self::default();
        for (name, value) in query {
            if name == "style" {
                options.style = Some(value.parse::<Style>()?.name().into());
                continue;
            }
            let setting = ParsedSetting::parse(name, value).map_err(|problem| anyhow!(problem))?;
            setting.apply(&mut options.settings)?;
        }
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn query_sets_style_and_parameters() {
        let options = Options::of([("style", "bob"), ("style.strands", "1500")]).unwrap();
        assert_eq!(options.style.as_deref(), Some("bob"));
        let strands = tresses_scene::knobs::find("style.strands").map(|knob| knob.get(&options.settings));
        assert_eq!(strands, Some(tresses_scene::Value::Integer(1500)));
        assert_eq!(Options::of([]).unwrap(), Options::default());
        let lit = Options::of([("lights.list", "point position=0,0.2,0.4; 90,30")]).unwrap();
        assert_eq!(lit.settings.lights.list.len(), 2);
    }

    #[test]
    fn invalid_query_is_an_error() {
        for (name, value) in
            [("style", "mohawk"), ("strands", "10"), ("style.strands", "many"), ("lights.list", "point")]
        {
            let said = format!("{:#}", Options::of([(name, value)]).unwrap_err());
            let clause = match name {
                "style" => value,
                "lights.list" => "a point light needs position",
                _ => "style.strands",
            };
            assert!(said.contains(clause), "{said}");
        }
    }
}
