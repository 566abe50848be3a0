//! The studio's start options.

use crate::files::Files;
use anyhow::{Context, Result, anyhow};
use std::path::PathBuf;
use tresses::groom::{import::ImportOptions, styles::Style};
use tresses_scene::{Companions, Settings, knobs};

/// What the studio shows first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The files of one groom; none for a built-in style.
    pub grooms: Vec<PathBuf>,
    /// The meshes of the head it grows on.
    pub heads: Vec<PathBuf>,
    /// The built-in style, when there is no groom: one of [`tresses::groom::styles::Style::NAMES`].
    pub style: Option<String>,
    /// What is known of the files' units and axes.
    pub import: ImportOptions,
    /// Maps, obstacles and surroundings.
    pub companions: Companions,
    /// Every parameter.
    pub settings: Settings,
    /// Whether there is a picture and nothing else, as in a page of others.
    pub bare: bool,
    /// Files that are there already, instead of those on the disk.
    pub given: Option<Files>,
    /// What went wrong before, a sentence that is shown.
    pub trouble: Option<String>,
}

impl Options {
    /// As a page's address has them: `style`, and parameters by their paths, such as
    /// `?style=bob&style.strands=5000&wind.speed=3`.
    ///
    /// # Errors
    /// One sentence, for a name or a value that does not exist.
    pub fn of<'a>(query: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self> {
        let mut options = Self::default();
        for (name, value) in query {
            if name == "style" {
                options.style = Some(value.parse::<Style>()?.name().into());
                continue;
            }
            let knob = knobs::named(name).map_err(|problem| anyhow!("the page's address: {problem}"))?;
            let done = knob.parse(value).and_then(|value| knob.set(&mut options.settings, value));
            done.context("the page's address")?;
        }
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_tells_style_and_parameters() {
        let options = Options::of([("style", "bob"), ("style.strands", "1500")]).unwrap();
        assert_eq!(options.style.as_deref(), Some("bob"));
        let strands = knobs::find("style.strands").map(|knob| knob.get(&options.settings));
        assert_eq!(strands, Some(tresses_scene::Value::Integer(1500)));
        assert_eq!(Options::of([]).unwrap(), Options::default());
    }

    #[test]
    fn what_an_address_has_wrong_is_said() {
        for (name, value) in [("style", "mohawk"), ("strands", "10"), ("style.strands", "many")] {
            let said = format!("{:#}", Options::of([(name, value)]).unwrap_err());
            assert!(said.contains(if name == "style" { value } else { "style.strands" }), "{said}");
        }
    }
}
