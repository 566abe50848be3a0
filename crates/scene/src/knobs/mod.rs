//! The table of all parameters: what an interface shows, a preset holds and the documentation lists.
//!
//! A [`Knob`] is a parameter of [`Settings`] with a name, a unit, a range and a line that says when to turn
//! it. Knobs stand in [`SECTIONS`], in the order of the pipeline. There is no other list: the panels of the
//! studio, the keys of presets, `--set` and `docs/knobs.md` are made of this one.
//!
//! Values are SI inside and human outside: `style.curl_radius` is 0.009 in [`Value::Number`] and 9 in the
//! knob's [`Unit`], which is the millimetre. [`Knob::shown`] and [`Knob::inner`] convert.
//!
//! ```
//! use tresses_scene::{Settings, Value, knobs};
//! let mut settings = Settings::default();
//! let drag = knobs::find("simulation.drag").unwrap();
//! drag.set(&mut settings, Value::Number(5.0)).unwrap();
//! assert_eq!(settings.simulation.drag, 5.0);
//! assert!(drag.set(&mut settings, Value::Number(1e9)).is_err());
//! drag.reset(&mut settings);
//! assert_eq!(settings, Settings::default());
//! ```

mod document;
mod edges;
mod interpolation;
mod lights;
mod lod;
mod shading;
mod shadows;
mod simulation;
mod style;
mod text;
mod value;
mod wind;

pub use document::markdown;
pub use text::color;
pub use value::{Kind, Refusal, Scale, Unit, Value};

use crate::settings::{Change, Settings};

/// A group of parameters.
#[derive(Debug)]
pub struct Section {
    /// The first part of its knobs' paths, and its table's name in a preset.
    pub key: &'static str,
    /// What it is called.
    pub title: &'static str,
    /// What its parameters do, in a sentence.
    pub about: &'static str,
    /// Its parameters.
    pub knobs: &'static [Knob],
}

/// All parameters, in the order of the pipeline.
pub const SECTIONS: &[Section] = &[
    style::SECTION,
    simulation::SECTION,
    wind::SECTION,
    interpolation::SECTION,
    shading::SECTION,
    lights::SECTION,
    shadows::SECTION,
    edges::SECTION,
    lod::SECTION,
];

/// A parameter.
#[derive(Clone, Copy, Debug)]
pub struct Knob {
    /// Its name: the section's key, a dot, and its own.
    pub path: &'static str,
    /// What it is called.
    pub label: &'static str,
    /// What it does and when to turn it, in a line.
    pub hint: &'static str,
    /// What its values are.
    pub kind: Kind,
    /// What a change costs.
    pub cost: Change,
    /// Whether [`Value::Auto`] is a value: as it suits the style, the file or the colour.
    pub automatic: bool,
    get: fn(&Settings) -> Value,
    set: fn(&mut Settings, Value),
}

impl Knob {
    const fn log(mut self) -> Self {
        if let Kind::Number { unit, least, most, .. } = self.kind {
            self.kind = Kind::Number { unit, least, most, scale: Scale::Log };
        }
        self
    }

    const fn auto(mut self) -> Self {
        self.automatic = true;
        self
    }

    /// The key of its section.
    pub fn section(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(section, _)| section)
    }

    /// Its name within the section.
    pub fn key(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(_, key)| key)
    }

    /// Its value in `settings`.
    pub fn get(&self, settings: &Settings) -> Value {
        (self.get)(settings)
    }

    /// Gives it a value.
    ///
    /// # Errors
    /// One sentence for a value out of range or of another kind; `settings` stay as they were.
    pub fn set(&self, settings: &mut Settings, value: Value) -> Result<(), Refusal> {
        self.check(value)?;
        (self.set)(settings, value);
        Ok(())
    }

    /// Its value by default.
    pub fn default(&self) -> Value {
        self.get(&Settings::default())
    }

    /// Whether `settings` have it as it is by default.
    pub fn is_default(&self, settings: &Settings) -> bool {
        self.get(settings) == self.default()
    }

    /// Gives it back its default.
    pub fn reset(&self, settings: &mut Settings) {
        (self.set)(settings, self.default());
    }
}

/// All of them, in order.
pub fn all() -> impl Iterator<Item = &'static Knob> {
    SECTIONS.iter().flat_map(|section| section.knobs)
}

/// The one of this path.
pub fn find(path: &str) -> Option<&'static Knob> {
    all().find(|knob| knob.path == path)
}

/// The one of this path.
///
/// # Errors
/// One sentence that names the nearest, where there is none.
pub fn named(path: &str) -> Result<&'static Knob, String> {
    if let Some(knob) = find(path) {
        return Ok(knob);
    }
    let key = path.rsplit_once('.').map_or(path, |(_, key)| key);
    // One that only stands in another section is nearer than any other.
    let elsewhere = all().find(|knob| knob.key() == key);
    let by_letters = || all().min_by_key(|knob| strsim::damerau_levenshtein(path, knob.path));
    Err(match elsewhere.or_else(by_letters) {
        Some(knob) => format!("there is no {path}; the nearest is {}, {}", knob.path, knob.range()),
        None => format!("there is no {path}"),
    })
}

/// A row of the table: path, label, kind, cost, field, hint.
macro_rules! knob {
    ($path:literal, $label:literal, $kind:expr, $cost:ident, $hint:literal, $($field:tt)+) => {
        $crate::knobs::Knob {
            path: $path,
            label: $label,
            hint: $hint,
            kind: $kind,
            cost: $crate::settings::Change::$cost,
            automatic: false,
            get: |settings| $crate::knobs::value::Field::value(&settings.$($field)+),
            set: |settings, value| $crate::knobs::value::Field::put(&mut settings.$($field)+, value),
        }
    };
}
use knob;

#[cfg(test)]
mod tests;
