//! Command-line flags of the parameters.
//!
//! A flag parses its text to [`Assignment`]: parameters to reset to their defaults, and parameters to set. Most flags
//! set only the parameter of their row. Composite flags take a comma-separated list (`--wind 8,45`) or words in place
//! of a number (`--guides all`). A [`FlagValue`] also lists the changes it makes to other rows. Numbers are in the
//! row's unit unless they carry another unit; shares are from 0 to 1, or have a `%`.

use super::{
    Knob, Value, ValueKind, find, removed,
    text::{names, with_unit},
    value::PERCENT,
};
use crate::settings::Settings;

/// Path of a parameter and the value to set.
pub type Set = (&'static str, Value);

/// Syntax of a flag.
#[derive(Clone, Copy, Debug)]
pub struct Flag {
    /// Name, without the dashes.
    pub name: &'static str,
    /// Placeholder of the value in help texts; empty for a switch without a value.
    pub value: &'static str,
    /// Description; empty to use the hint of the row.
    pub about: &'static str,
    /// Whether the short help text lists the flag.
    pub common: bool,
    /// Alternatives for the first element; empty for a value of the row.
    first: &'static [FlagValue],
    more: &'static [Slot],
}

/// An element of a comma-separated list.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    part: FlagValue,
    missing: OmittedValue,
}

/// Meaning of an omitted element.
#[derive(Clone, Copy, Debug)]
pub enum OmittedValue {
    /// An error.
    Refused,
    /// The parameter does not change.
    Kept,
    /// The value of the previous element.
    Same,
    /// This value.
    Is(&'static str),
}

/// Syntax of an element: a value of a row, or a word.
#[derive(Clone, Copy, Debug)]
pub struct FlagValue {
    path: &'static str,
    /// Word to match instead of a value.
    word: &'static str,
    sets: &'static [Set],
    resets: &'static [&'static str],
}

/// Result of parsing a flag.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assignment {
    /// Parameters to reset first, because they belong to the value being replaced.
    resets: Vec<&'static str>,
    /// Parameters to set.
    sets: Vec<Set>,
}

/// Returns a part that matches a value of the row at `path`.
pub(super) const fn value(path: &'static str) -> FlagValue {
    FlagValue { path, word: "", sets: &[], resets: &[] }
}

/// Returns a part that matches a word.
pub(super) const fn word(word: &'static str, sets: &'static [Set]) -> FlagValue {
    FlagValue { path: "", word, sets, resets: &[] }
}

pub(super) const fn slot(part: FlagValue, missing: OmittedValue) -> Slot {
    Slot { part, missing }
}

impl FlagValue {
    /// Adds values to set in other parameters.
    pub(super) const fn sets(mut self, sets: &'static [Set]) -> Self {
        self.sets = sets;
        self
    }

    /// Adds parameters to reset. Values that the flag sets explicitly take precedence.
    pub(super) const fn resets(mut self, resets: &'static [&'static str]) -> Self {
        self.resets = resets;
        self
    }

    fn read(&self, text: &str) -> Option<Assignment> {
        let mut assigned = Assignment { resets: self.resets.to_vec(), sets: Vec::new() };
        if !self.path.is_empty() {
            assigned.sets.push((self.path, flag_value(find(self.path)?, text)?));
        } else if text != self.word {
            return None;
        }
        assigned.sets.extend(self.sets);
        Some(assigned)
    }

    fn range(&self) -> String {
        match find(self.path) {
            Some(row) => flag_range(row),
            None => self.word.to_owned(),
        }
    }
}

/// Returns a flag that takes a single value.
pub(super) const fn flag(name: &'static str, value: &'static str) -> Flag {
    Flag { name, value, about: "", common: false, first: &[], more: &[] }
}

impl Flag {
    pub(super) const fn common(mut self) -> Self {
        self.common = true;
        self
    }

    pub(super) const fn about(mut self, about: &'static str) -> Self {
        self.about = about;
        self
    }

    /// Sets the alternatives that replace the row's value as the first element.
    pub(super) const fn first(mut self, parts: &'static [FlagValue]) -> Self {
        self.first = parts;
        self
    }

    /// Adds further comma-separated elements.
    pub(super) const fn then(mut self, slots: &'static [Slot]) -> Self {
        self.more = slots;
        self
    }
}

impl Knob {
    /// Parses `text`, the argument of this row's flag.
    ///
    /// # Errors
    /// Returns one clause that states the allowed values.
    pub fn read_flag(&'static self, text: &str) -> Result<Assignment, String> {
        let Some(flag) = self.flag else { return Err(format!("{} has no flag", self.path)) };
        let own = [value(self.path)];
        let first = if flag.first.is_empty() { &own } else { flag.first };
        let refused = || format!("expected {}", self.flag_form(&flag));
        let mut texts = text.split(',').map(str::trim);
        let mut text = texts.next().unwrap_or_default();
        let mut assigned = read_any(first, text).ok_or_else(|| match removed::value(flag.name, text) {
            Some(successor) => format!("use {successor}"),
            None => refusal(first),
        })?;
        for slot in flag.more {
            text = match (texts.next(), slot.missing) {
                (Some(text), _) | (None, OmittedValue::Is(text)) => text,
                (None, OmittedValue::Same) => text,
                (None, OmittedValue::Kept) => continue,
                (None, OmittedValue::Refused) => return Err(refused()),
            };
            let part = std::slice::from_ref(&slot.part);
            assigned.add(read_any(part, text).ok_or_else(|| refusal(part))?);
        }
        if texts.next().is_some() {
            return Err(refused());
        }
        Ok(assigned)
    }

    /// Describes the flag's argument, such as `SPEED[,DEGREES]`, with the range of each element.
    fn flag_form(&self, flag: &Flag) -> String {
        let mut words = format!("{}: ", flag.value);
        words += &match flag.first {
            [] => flag_range(self),
            parts => parts.iter().map(FlagValue::range).collect::<Vec<_>>().join(", or "),
        };
        for slot in flag.more {
            words += &format!("; {}", slot.part.range());
        }
        words
    }

    /// Returns the paths of all rows that the flag sets or resets.
    #[cfg(test)]
    pub(super) fn flag_paths(&self) -> Vec<&'static str> {
        let Some(flag) = self.flag else { return Vec::new() };
        let parts = flag.first.iter().chain(flag.more.iter().map(|slot| &slot.part));
        let paths = |part: &FlagValue| {
            let own = (!part.path.is_empty()).then_some(part.path);
            let others = part.sets.iter().map(|(path, _)| *path).chain(part.resets.iter().copied());
            own.into_iter().chain(others).collect::<Vec<_>>()
        };
        parts.flat_map(paths).collect()
    }

    /// Returns the help text of the flag's values, with ranges and defaults.
    pub fn flag_help(&self) -> String {
        let Some(flag) = self.flag else { return String::new() };
        let of_row = |row: &Knob| match row.default() {
            Value::Auto => flag_range(row),
            value => format!("{} [default: {}]", flag_range(row), flag_text(row, value)),
        };
        let part = |part: &FlagValue| find(part.path).map_or_else(|| format!("`{}`", part.word), of_row);
        let any = |parts: &[FlagValue]| parts.iter().map(part).collect::<Vec<_>>().join(", or ");
        if flag.value.is_empty() {
            return String::new();
        }
        if flag.first.is_empty() && flag.more.is_empty() {
            return sentence(&of_row(self));
        }
        let own = if flag.first.is_empty() { of_row(self) } else { any(flag.first) };
        let mut lines = vec![sentence(&own)];
        for slot in flag.more {
            if let Some(row) = find(slot.part.path) {
                lines.push(format!("Then: {} {}", row.hint, sentence(&of_row(row))));
            }
        }
        lines.join("\n")
    }
}

impl Assignment {
    fn add(&mut self, other: Self) {
        self.resets.extend(other.resets);
        self.sets.extend(other.sets);
    }

    /// Resets the parameters that belong to replaced values. With several flags, reset all before any
    /// [`set`](Self::set).
    pub fn reset(&self, settings: &mut Settings) {
        self.resets.iter().filter_map(|path| find(path)).for_each(|row| row.reset(settings));
    }

    /// Sets the parameters.
    ///
    /// # Errors
    /// Fails if a value is out of range.
    pub fn set(&self, settings: &mut Settings) -> Result<(), super::Refusal> {
        self.sets.iter().try_for_each(|(path, value)| settings.set(path, *value))
    }
}

/// Returns the assignments of the first part that matches `text`.
fn read_any(parts: &[FlagValue], text: &str) -> Option<Assignment> {
    parts.iter().find_map(|part| part.read(text))
}

fn refusal(parts: &[FlagValue]) -> String {
    let ranges: Vec<_> = parts.iter().map(FlagValue::range).collect();
    format!("it must be {}", ranges.join(", or "))
}

/// Parses a value of `row` in flag syntax, where a share without a unit is from 0 to 1.
fn flag_value(row: &Knob, text: &str) -> Option<Value> {
    match row.kind {
        ValueKind::Number { unit: PERCENT, .. } if !text.ends_with('%') && text != "auto" => {
            let fraction: f64 = text.parse().ok()?;
            row.parse(&(100.0 * fraction).to_string()).ok()
        }
        _ => row.parse(text).ok(),
    }
}

/// Describes the values that flags accept for `row`.
fn flag_range(row: &Knob) -> String {
    match row.kind {
        ValueKind::Number { unit: PERCENT, min, max, .. } => {
            format!("from {} to {}", fraction_text(min), fraction_text(max))
        }
        ValueKind::Number { unit, min, max, .. } => with_unit(&format!("from {min} to {max}"), unit.symbol),
        ValueKind::Integer { unit, min, max, .. } => {
            with_unit(&format!("a whole number from {min} to {max}"), unit.symbol)
        }
        ValueKind::Choice(choices) => format!("one of {}", names(choices)),
        ValueKind::Toggle => "on or off".into(),
        ValueKind::Color => "a color such as 5a3b28".into(),
    }
}

fn flag_text(row: &Knob, value: Value) -> String {
    match (row.kind, value) {
        (ValueKind::Number { unit: PERCENT, .. }, Value::Number(v)) => fraction_text(row.shown(v)),
        (_, Value::Toggle(on)) => if on { "on" } else { "off" }.into(),
        (_, value) => row.text(value),
    }
}

/// Converts percent to a share, rounded to remove floating-point noise.
fn fraction_text(percent: f64) -> String {
    ((percent * 1e7).round() / 1e9).to_string()
}

pub(crate) fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
