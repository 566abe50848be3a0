//! A parameter and its value, by their texts.

use super::{Knob, Refusal, Value, light_list, named};
use crate::settings::{LightEntry, Settings};

/// A parameter and its value: what `--set`, queries of a page and its scripts set.
#[derive(Clone, Debug, PartialEq)]
pub enum ParsedSetting {
    /// A value of a row.
    Row(ParsedRow),
    /// The list of lights.
    Lights(Vec<LightEntry>),
}

/// A row and a valid value.
#[derive(Clone, Copy, Debug)]
pub struct ParsedRow {
    knob: &'static Knob,
    value: Value,
}

impl PartialEq for ParsedRow {
    fn eq(&self, other: &Self) -> bool {
        (self.knob.path, self.value) == (other.knob.path, other.value)
    }
}

impl ParsedSetting {
    /// Parses the value of the parameter at `path`: of a row, or the list of lights.
    ///
    /// # Errors
    /// Returns one clause that names the parameter and the allowed values.
    pub fn parse(path: &str, value: &str) -> Result<Self, String> {
        if path == light_list::PATH {
            return light_list::list(value).map(Self::Lights);
        }
        let knob = named(path)?;
        let value = knob.parse(value).map_err(|refusal| refusal.to_string())?;
        Ok(Self::Row(ParsedRow { knob, value }))
    }

    /// Returns the path of the parameter.
    pub fn path(&self) -> &'static str {
        match self {
            Self::Row(row) => row.knob.path,
            Self::Lights(_) => light_list::PATH,
        }
    }

    /// Returns the display name of the parameter.
    pub fn label(&self) -> &'static str {
        match self {
            Self::Row(row) => row.knob.label,
            Self::Lights(_) => "List of lights",
        }
    }

    /// Sets the value in `settings`.
    ///
    /// # Errors
    /// As [`Knob::set`].
    pub fn apply(&self, settings: &mut Settings) -> Result<(), Refusal> {
        match self {
            Self::Row(row) => row.knob.set(settings, row.value),
            Self::Lights(list) => {
                settings.lights.list.clone_from(list);
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_lights_are_set_by_text() {
        let mut settings = Settings::default();
        for (path, value) in [("wind.speed", "3"), ("lights.list", "10,20; point position=0,1,0")] {
            let parsed = ParsedSetting::parse(path, value).unwrap();
            assert_eq!(parsed.path(), path);
            parsed.apply(&mut settings).unwrap();
        }
        assert_eq!((settings.wind_speed(), settings.lights.list.len()), (3.0, 2));
        ParsedSetting::parse("lights.list", "").unwrap().apply(&mut settings).unwrap();
        assert!(settings.lights.list.is_empty());
    }

    #[test]
    fn invalid_texts_name_the_parameter() {
        for (path, value, clause) in [
            ("wind.speed", "fast", "wind.speed is fast"),
            ("wind.sped", "3", "the nearest is wind.speed"),
            ("lights.list", "point", "light 1 of lights.list: a point light needs position"),
            ("lights.lamp1_strength", "3", "use lights.list"),
        ] {
            let error = ParsedSetting::parse(path, value).unwrap_err();
            assert!(error.contains(clause), "{path}={value}: {error}");
        }
    }
}
