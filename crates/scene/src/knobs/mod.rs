//! Table of all parameters.
//!
//! A [`Knob`] is a row of the table: a parameter of [`Settings`] with its path, unit, range, hint and cost of change.
//! Its value and default are stored in a field of the library's option structs, which the row names. The rows in
//! [`SECTIONS`] are the only list of parameters: studio panels, preset keys, `--set`, command-line flags and
//! `docs/reference/parameters.md` are generated from them. `CONTRIBUTING.md` shows how to add a parameter.
//!
//! [`Value`] holds SI units; interfaces show the row's [`Unit`]. For example, `style.curl_radius` is 0.009 in
//! [`Value::Number`] and 9 in millimeters, its unit. [`Knob::shown`] and [`Knob::inner`] convert.
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
pub mod flags;
pub mod light_list;
mod lights;
mod lod;
pub mod removed;
pub mod renamed;
mod renderer;
mod setting;
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
pub use setting::ParsedSetting;
pub(crate) use style::CURLS;
pub use text::color;
pub use value::{Choice, Refusal, SliderScale, Unit, Value, ValueKind};

use crate::settings::{RendererKind, Settings};

/// A group of parameters.
#[derive(Debug)]
pub struct Section {
    /// First part of the paths of its rows, and the table name in presets.
    pub key: &'static str,
    /// Display name.
    pub title: &'static str,
    /// Description of its parameters, one sentence.
    pub about: &'static str,
    /// Rows of the section.
    pub knobs: &'static [Knob],
}

/// All sections, in display order.
pub const SECTIONS: &[Section] = &[
    style::SECTION,
    shading::SECTION,
    lights::SECTION,
    wind::SECTION,
    simulation::SECTION,
    avoidance::SECTION,
    shadows::SECTION,
    renderer::SECTION,
    lod::SECTION,
];

/// A parameter: one row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Knob {
    /// Unique name: the section's key, a dot, and the row's key.
    pub path: &'static str,
    /// Display name.
    pub label: &'static str,
    /// Effect and when to change it, one line.
    pub hint: &'static str,
    /// Names in other programs, lowercase, separated by `; `. Searches find them.
    pub aliases: &'static str,
    /// Type and range of the values.
    pub kind: ValueKind,
    /// Cost of a change.
    pub cost: Change,
    /// Whether [`Value::Auto`] is allowed. The value then follows from the style, the file or the color.
    pub automatic: bool,
    /// Whether it is rarely needed, such as seeds, grids and tolerances. Interfaces collapse advanced parameters.
    pub advanced: bool,
    /// The only renderer that reads it; `None` if several do. Interfaces show it only with that renderer.
    pub renderer: Option<RendererKind>,
    /// Dedicated command-line flag, if it has one besides `--set`.
    pub flag: Option<Flag>,
    field: Access,
}

/// Accessors of a row's field.
#[derive(Clone, Copy, Debug)]
struct Access {
    get: fn(&Settings) -> Value,
    set: fn(&mut Settings, Value),
    /// Copies the field from the second argument to the first without rounding.
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

    const fn only(mut self, renderer: RendererKind) -> Self {
        self.renderer = Some(renderer);
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

    const fn also(mut self, aliases: &'static str) -> Self {
        self.aliases = aliases;
        self
    }

    const fn flag(mut self, flag: Flag) -> Self {
        self.flag = Some(flag);
        self
    }

    /// Returns the key of the section.
    pub fn section(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(section, _)| section)
    }

    /// Returns the key within the section.
    pub fn key(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(_, key)| key)
    }

    /// Returns the value in `settings`.
    pub fn get(&self, settings: &Settings) -> Value {
        if self.automatic && !settings.given.contains(self.path) {
            return Value::Auto;
        }
        (self.field.get)(settings)
    }

    /// Sets the value in `settings`.
    ///
    /// # Errors
    /// Fails if the value is out of range or of the wrong type; `settings` do not change.
    pub fn set(&self, settings: &mut Settings, value: Value) -> Result<(), Refusal> {
        self.check(value)?;
        self.put(settings, value);
        Ok(())
    }

    /// Sets a value that has passed [`check`](Self::check).
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

    /// Whether the renderer of `settings` reads the parameter.
    pub fn is_read(&self, settings: &Settings) -> bool {
        self.renderer.is_none_or(|only| only == settings.renderer_kind())
    }

    /// Returns the default value.
    pub fn default(&self) -> Value {
        self.get(&Settings::default())
    }

    /// Returns whether `settings` have the default value.
    pub fn is_default(&self, settings: &Settings) -> bool {
        self.get(settings) == self.default()
    }

    /// Resets the value to its default.
    pub fn reset(&self, settings: &mut Settings) {
        settings.given.remove(self.path);
        (self.field.copy)(settings, &Settings::default());
    }

    /// Copies the value from `from` to `to`, unless it is automatic in `from`.
    pub(crate) fn copy_value(&self, to: &mut Settings, from: &Settings) {
        if !self.automatic || from.given.contains(self.path) {
            (self.field.copy)(to, from);
        }
    }
}

/// Iterates over all rows in display order.
pub fn all() -> impl Iterator<Item = &'static Knob> {
    SECTIONS.iter().flat_map(|section| section.knobs)
}

/// Iterates over the rows of the section with this key.
pub(crate) fn section(key: &str) -> impl Iterator<Item = &'static Knob> {
    SECTIONS.iter().filter(move |section| section.key == key).flat_map(|section| section.knobs)
}

/// Returns the row with this path, or with this former path.
pub fn find(path: &str) -> Option<&'static Knob> {
    let path = renamed::current(path);
    all().find(|knob| knob.path == path)
}

/// Returns the row with this path. The [list of lights](light_list) is no row.
///
/// # Errors
/// If there is none with this path, names its successor, the row that another program calls so, or the nearest row.
pub fn named(path: &str) -> Result<&'static Knob, String> {
    if let Some(knob) = find(path) {
        return Ok(knob);
    }
    if path == light_list::PATH {
        return Err(format!(
            "{path} is a list of lights, not a single value; use --light, or [[{path}]] in a preset"
        ));
    }
    if let Some(successor) = removed::row(path) {
        return Err(format!("there is no {path}; use {successor}"));
    }
    let key = path.rsplit_once('.').map_or(path, |(_, key)| key);
    let words = key.replace(['_', '-'], " ").to_lowercase();
    // A row with the same key in another section is the best suggestion.
    let also = || all().find(|knob| knob.aliases.split("; ").any(|alias| alias == words));
    let elsewhere = all().find(|knob| knob.key() == key).or_else(also);
    let by_letters = || all().min_by_key(|knob| strsim::damerau_levenshtein(path, knob.path));
    Err(match elsewhere.or_else(by_letters) {
        Some(knob) => format!("there is no {path}; the nearest is {}, {}", knob.path, knob.range()),
        None => format!("there is no {path}"),
    })
}

/// Rows of a section: key, label, `[field]`, kind, modifiers, hint.
macro_rules! rows {
    ($section:literal;
     $($key:literal $label:literal $field:tt $kind:expr, $($more:ident $(($($value:expr),*))?,)* $hint:literal;)*) => {
        &[$(
            $crate::knobs::Knob {
                path: concat!($section, ".", $key),
                label: $label,
                hint: $hint,
                aliases: "",
                kind: $kind,
                cost: $crate::knobs::Change::Frame,
                automatic: false,
                advanced: false,
                renderer: None,
                flag: None,
                field: $crate::knobs::rows!(@ $field),
            }
            $(.$more($($($value),*)?))*
        ),*]
    };
    (@ [$($field:tt)+]) => {
        $crate::knobs::Access {
            get: |settings| $crate::knobs::value::SettingsField::value(&settings.$($field)+),
            set: |settings, value| $crate::knobs::value::SettingsField::put(&mut settings.$($field)+, value),
            copy: |to, from| to.$($field)+.clone_from(&from.$($field)+),
        }
    };
    (@ {$access:expr}) => { $access };
}
use rows;

#[cfg(test)]
mod tests;
