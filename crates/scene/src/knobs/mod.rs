//! The table of all parameters: what an interface shows, a preset holds, a flag sets and the documentation
//! lists.
//!
//! A [`Knob`] is a row of it: a parameter of [`Settings`] with path, unit, range, hint and what a change
//! costs. The value itself, with its default, is a field of the library's option structs, which the row
//! names. There is no other list: the panels of the studio, the keys of presets, `--set`, the flags of the
//! command and `docs/knobs.md` are made of the rows in [`SECTIONS`]. `CONTRIBUTING.md` adds one as an example.
//!
//! Values are SI inside and human outside: `style.curl_radius` is 0.009 in [`Value::Number`] and 9 in the
//! row's [`Unit`], which is the millimetre. [`Knob::shown`] and [`Knob::inner`] convert.
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

mod avoidance;
mod change;
mod document;
mod edges;
pub mod flags;
mod lights;
mod lod;
mod shading;
mod shadows;
mod simulation;
mod style;
mod text;
mod value;
mod wind;

pub use change::{Change, Changes};
pub use document::markdown;
pub use flags::Flag;
pub(crate) use style::CURLS;
pub use text::color;
pub use value::{Choice, Kind, Refusal, Scale, Unit, Value};

use crate::settings::Settings;

/// A group of parameters.
#[derive(Debug)]
pub struct Section {
    /// The first part of its rows' paths, and its table's name in a preset.
    pub key: &'static str,
    /// What it is called.
    pub title: &'static str,
    /// What its parameters do, in a sentence.
    pub about: &'static str,
    /// Its parameters.
    pub knobs: &'static [Knob],
}

/// All parameters, in the order in which people look for them.
pub const SECTIONS: &[Section] = &[
    style::SECTION,
    shading::SECTION,
    lights::SECTION,
    wind::SECTION,
    simulation::SECTION,
    avoidance::SECTION,
    shadows::SECTION,
    edges::SECTION,
    lod::SECTION,
];

/// A parameter: a row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Knob {
    /// Its name: the section's key, a dot, and its own.
    pub path: &'static str,
    /// What it is called.
    pub label: &'static str,
    /// What it does and when to change it, in a line.
    pub hint: &'static str,
    /// What its values are.
    pub kind: Kind,
    /// What a change costs.
    pub cost: Change,
    /// Whether [`Value::Auto`] is a value: as it suits the style, the file or the colour.
    pub automatic: bool,
    /// Whether it is seldom needed: seeds, grids, tolerances. Interfaces fold it away.
    pub advanced: bool,
    /// The flag of the command that sets it, where it has one besides `--set`.
    pub flag: Option<Flag>,
    field: Access,
}

/// How a row reads and writes its field.
#[derive(Clone, Copy, Debug)]
struct Access {
    get: fn(&Settings) -> Value,
    set: fn(&mut Settings, Value),
    /// From the second to the first, to the bit.
    copy: fn(&mut Settings, &Settings),
}

impl Knob {
    const fn auto(mut self) -> Self {
        self.automatic = true;
        self
    }

    const fn advanced(mut self) -> Self {
        self.advanced = true;
        self
    }

    const fn rebuild(mut self) -> Self {
        self.cost = Change::Rebuild;
        self
    }

    const fn regrow(mut self) -> Self {
        self.cost = Change::Regrow;
        self
    }

    const fn flag(mut self, flag: Flag) -> Self {
        self.flag = Some(flag);
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
        if self.automatic && !settings.given.contains(self.path) {
            return Value::Auto;
        }
        (self.field.get)(settings)
    }

    /// Gives it a value.
    ///
    /// # Errors
    /// One sentence for a value out of range or of another kind; `settings` stay as they were.
    pub fn set(&self, settings: &mut Settings, value: Value) -> Result<(), Refusal> {
        self.check(value)?;
        self.put(settings, value);
        Ok(())
    }

    /// Gives it a value that is known to be allowed.
    fn put(&self, settings: &mut Settings, value: Value) {
        if value == Value::Auto {
            settings.given.remove(self.path);
            (self.field.copy)(settings, &Settings::default());
        } else {
            if self.automatic {
                settings.given.insert(self.path);
            }
            (self.field.set)(settings, value);
        }
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
        settings.given.remove(self.path);
        (self.field.copy)(settings, &Settings::default());
    }

    /// Gives it in `to` the number that it has in `from`, unless it is automatic there.
    pub(crate) fn lay(&self, to: &mut Settings, from: &Settings) {
        if !self.automatic || from.given.contains(self.path) {
            (self.field.copy)(to, from);
        }
    }
}

/// All of them, in order.
pub fn all() -> impl Iterator<Item = &'static Knob> {
    SECTIONS.iter().flat_map(|section| section.knobs)
}

/// Those of the section with this key.
pub(crate) fn section(key: &str) -> impl Iterator<Item = &'static Knob> {
    SECTIONS.iter().filter(move |section| section.key == key).flat_map(|section| section.knobs)
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

/// The rows of a section: key, label, `[field]`, what its values are, what else is to say of it, hint.
macro_rules! rows {
    ($section:literal;
     $($key:literal $label:literal $field:tt $kind:expr, $($more:ident $(($($value:expr),*))?,)* $hint:literal;)*) => {
        &[$(
            $crate::knobs::Knob {
                path: concat!($section, ".", $key),
                label: $label,
                hint: $hint,
                kind: $kind,
                cost: $crate::knobs::Change::Frame,
                automatic: false,
                advanced: false,
                flag: None,
                field: $crate::knobs::rows!(@ $field),
            }
            $(.$more($($($value),*)?))*
        ),*]
    };
    (@ [$($field:tt)+]) => {
        $crate::knobs::Access {
            get: |settings| $crate::knobs::value::Field::value(&settings.$($field)+),
            set: |settings, value| $crate::knobs::value::Field::put(&mut settings.$($field)+, value),
            copy: |to, from| to.$($field)+.clone_from(&from.$($field)+),
        }
    };
    (@ {$access:expr}) => { $access };
}
use rows;

#[cfg(test)]
mod tests;
