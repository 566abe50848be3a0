//! Flags of the command, as the rows describe them.
//!
//! A flag reads a text into [`Assigned`]: which parameters go back to their defaults, and which get a value.
//! Most flags are their row's value and nothing else. Some are composite: places with commas between them
//! (`--wind 8,45`), `key=value` (`--curl waves,radius=8mm`), words in the place of a number (`--guides all`).
//! What a [`Part`] of it says of other rows stands with it. Numbers are in the unit that people read or have
//! a unit of their own; shares are from 0 to 1, or have a `%`.

use super::{
    Kind, Knob, Value, find,
    text::{names, with_unit},
    value::PERCENT,
};
use crate::settings::Settings;

/// A parameter of another row, and what it becomes.
pub type Set = (&'static str, Value);

/// How a flag is written.
#[derive(Clone, Copy, Debug)]
pub struct Flag {
    /// Its name, without the dashes.
    pub name: &'static str,
    /// What stands for its value in a help text; empty for a switch that has none.
    pub value: &'static str,
    /// What it does; empty for the hint of its row.
    pub about: &'static str,
    /// Whether a short help text has it.
    pub common: bool,
    /// How often it may be given; the rows of the second time have a 2 in the place of the 1.
    pub times: usize,
    /// What stands first; nothing for a value of its row.
    first: &'static [Part],
    more: &'static [Slot],
    keys: &'static [Key],
}

/// A place in a list with commas.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    part: Part,
    missing: Missing,
}

/// What a place that is left out means.
#[derive(Clone, Copy, Debug)]
pub enum Missing {
    /// It must not be left out.
    Refused,
    /// The parameter stays as it is.
    Kept,
    /// As the place before.
    Same,
    /// This.
    Is(&'static str),
}

/// What may stand behind `key=`.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    key: &'static str,
    parts: &'static [Part],
}

/// What may stand at a place: a value of a row, or a word.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    path: &'static str,
    /// A word instead of a value.
    word: &'static str,
    sets: &'static [Set],
    resets: &'static [&'static str],
}

/// What a flag comes to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assigned {
    /// Parameters that go back to their defaults first: they went with what is replaced.
    resets: Vec<&'static str>,
    /// Parameters that get a value.
    sets: Vec<Set>,
}

/// A part that is a value of the row at `path`.
pub(super) const fn value(path: &'static str) -> Part {
    Part { path, word: "", sets: &[], resets: &[] }
}

/// A part that is a word.
pub(super) const fn word(word: &'static str, sets: &'static [Set]) -> Part {
    Part { path: "", word, sets, resets: &[] }
}

pub(super) const fn place(part: Part, missing: Missing) -> Slot {
    Slot { part, missing }
}

pub(super) const fn key(key: &'static str, parts: &'static [Part]) -> Key {
    Key { key, parts }
}

impl Part {
    /// It sets other parameters too.
    pub(super) const fn sets(mut self, sets: &'static [Set]) -> Self {
        self.sets = sets;
        self
    }

    /// Other parameters go back to their defaults, unless they are given too.
    pub(super) const fn resets(mut self, resets: &'static [&'static str]) -> Self {
        self.resets = resets;
        self
    }

    fn read(&self, text: &str) -> Option<Assigned> {
        let mut assigned = Assigned { resets: self.resets.to_vec(), sets: Vec::new() };
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

/// A flag of a single value.
pub(super) const fn flag(name: &'static str, value: &'static str) -> Flag {
    Flag { name, value, about: "", common: false, times: 1, first: &[], more: &[], keys: &[] }
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

    pub(super) const fn times(mut self, times: usize) -> Self {
        self.times = times;
        self
    }

    /// Any of these in the place of a value of the row.
    pub(super) const fn first(mut self, parts: &'static [Part]) -> Self {
        self.first = parts;
        self
    }

    /// More, with commas between them.
    pub(super) const fn then(mut self, places: &'static [Slot]) -> Self {
        self.more = places;
        self
    }

    /// What may be said by `key=value`, in any order.
    pub(super) const fn keys(mut self, keys: &'static [Key]) -> Self {
        self.keys = keys;
        self
    }
}

impl Knob {
    /// What `text` behind the flag of this row says, where the flag is given for the `time`th time (from 0 on).
    ///
    /// # Errors
    /// One clause that says what is allowed.
    pub fn read_flag(&'static self, text: &str, time: usize) -> Result<Assigned, String> {
        let Some(flag) = self.flag else { return Err(format!("{} has no flag", self.path)) };
        let own = [value(self.path)];
        let first = if flag.first.is_empty() { &own } else { flag.first };
        let mut assigned = Assigned::default();
        let mut at = 0;
        let mut before = "";
        for text in text.split(',').map(str::trim) {
            let (key, text, parts) = match text.split_once('=') {
                Some((key, text)) if !flag.keys.is_empty() => {
                    let Some(found) = flag.keys.iter().find(|known| known.key == key.trim()) else {
                        let keys: Vec<_> = flag.keys.iter().map(|known| known.key).collect();
                        return Err(format!("there is no {}; give {}", key.trim(), keys.join(", ")));
                    };
                    (found.key, text.trim(), found.parts)
                }
                _ => {
                    let parts = match at {
                        0 => first,
                        at => match flag.more.get(at - 1) {
                            Some(place) => std::slice::from_ref(&place.part),
                            None => return Err(format!("it takes {}", self.flag_form(&flag))),
                        },
                    };
                    (at, before) = (at + 1, text);
                    ("", text, parts)
                }
            };
            assigned.add(read_any(parts, text).ok_or_else(|| refusal(key, text, parts))?);
        }
        if at == 0 && flag.keys.is_empty() {
            return Err(format!("it takes {}", self.flag_form(&flag)));
        }
        for place in flag.more.iter().skip(at.saturating_sub(1)).take(if at == 0 { 0 } else { usize::MAX }) {
            let text = match place.missing {
                Missing::Refused => return Err(format!("it takes {}", self.flag_form(&flag))),
                Missing::Kept => continue,
                Missing::Same => before,
                Missing::Is(text) => text,
            };
            let part = std::slice::from_ref(&place.part);
            assigned.add(read_any(part, text).ok_or_else(|| refusal("", text, part))?);
        }
        Ok(if time == 0 { assigned } else { assigned.of_another(time) })
    }

    /// What the flag of this row takes, in words: `SPEED[,DEGREES]`, each with its range.
    fn flag_form(&self, flag: &Flag) -> String {
        let mut words = format!("{}: ", flag.value);
        words += &match flag.first {
            [] => flag_range(self),
            parts => parts.iter().map(Part::range).collect::<Vec<_>>().join(", or "),
        };
        for place in flag.more {
            words += &format!("; {}", place.part.range());
        }
        words
    }

    /// The paths of all rows that its flag speaks of.
    #[cfg(test)]
    pub(super) fn flag_paths(&self) -> Vec<&'static str> {
        let Some(flag) = self.flag else { return Vec::new() };
        let parts = flag.first.iter().chain(flag.more.iter().map(|place| &place.part));
        let parts = parts.chain(flag.keys.iter().flat_map(|key| key.parts));
        let paths = |part: &Part| {
            let own = (!part.path.is_empty()).then_some(part.path);
            let others = part.sets.iter().map(|(path, _)| *path).chain(part.resets.iter().copied());
            own.into_iter().chain(others).collect::<Vec<_>>()
        };
        parts.flat_map(paths).collect()
    }

    /// What a help text says of the values of the row's flag, and what is so by default.
    pub fn flag_help(&self) -> String {
        let Some(flag) = self.flag else { return String::new() };
        let of_row = |row: &Knob| match row.default() {
            Value::Auto => flag_range(row),
            value => format!("{} [default: {}]", flag_range(row), flag_text(row, value)),
        };
        let part = |part: &Part| find(part.path).map_or_else(|| format!("`{}`", part.word), of_row);
        let any = |parts: &[Part]| parts.iter().map(part).collect::<Vec<_>>().join(", or ");
        if flag.value.is_empty() {
            return String::new();
        }
        if flag.first.is_empty() && flag.more.is_empty() && flag.keys.is_empty() {
            return sentence(&of_row(self));
        }
        let own = if flag.first.is_empty() { of_row(self) } else { any(flag.first) };
        let mut lines = vec![sentence(&own)];
        for place in flag.more {
            if let Some(row) = find(place.part.path) {
                lines.push(format!("Then: {} {}", row.hint, sentence(&of_row(row))));
            }
        }
        for key in flag.keys {
            let hint = key.parts.iter().filter_map(|part| find(part.path)).map(|row| row.hint).next();
            lines.push(format!("{}=: {} {}", key.key, hint.unwrap_or_default(), sentence(&any(key.parts))));
        }
        lines.join("\n")
    }
}

impl Assigned {
    fn add(&mut self, other: Self) {
        self.resets.extend(other.resets);
        self.sets.extend(other.sets);
    }

    /// The same for the rows of the `time`th time.
    fn of_another(self, time: usize) -> Self {
        let other = |path: &str| {
            let path = path.replace('1', &(time + 1).to_string());
            find(&path).map_or("", |row| row.path)
        };
        Self {
            resets: self.resets,
            sets: self.sets.iter().map(|(path, value)| (other(path), *value)).collect(),
        }
    }

    /// Puts back what goes with what is replaced. Before any of several flags [sets](Self::set) something.
    pub fn reset(&self, settings: &mut Settings) {
        self.resets.iter().filter_map(|path| find(path)).for_each(|row| row.reset(settings));
    }

    /// Gives its parameters their values.
    ///
    /// # Errors
    /// One sentence, when a value is out of range.
    pub fn set(&self, settings: &mut Settings) -> Result<(), super::Refusal> {
        self.sets.iter().try_for_each(|(path, value)| settings.set(path, *value))
    }
}

/// What the first part that understands `text` makes of it.
fn read_any(parts: &[Part], text: &str) -> Option<Assigned> {
    parts.iter().find_map(|part| part.read(text))
}

fn refusal(key: &str, text: &str, parts: &[Part]) -> String {
    let ranges: Vec<_> = parts.iter().map(Part::range).collect();
    let named = if key.is_empty() { "it".to_owned() } else { format!("{key} is {text}, but") };
    format!("{named} must be {}", ranges.join(", or "))
}

/// A value of `row` as its flag has it: of shares, a number without a unit is from 0 to 1.
fn flag_value(row: &Knob, text: &str) -> Option<Value> {
    match row.kind {
        Kind::Number { unit: PERCENT, .. } if !text.ends_with('%') && text != "auto" => {
            let share: f64 = text.parse().ok()?;
            row.parse(&(100.0 * share).to_string()).ok()
        }
        _ => row.parse(text).ok(),
    }
}

/// What flags allow for `row`.
fn flag_range(row: &Knob) -> String {
    match row.kind {
        Kind::Number { unit: PERCENT, least, most, .. } => {
            format!("from {} to {}", share(least), share(most))
        }
        Kind::Number { unit, least, most, .. } => with_unit(&format!("from {least} to {most}"), unit.symbol),
        Kind::Integer { unit, least, most, .. } => {
            with_unit(&format!("a whole number from {least} to {most}"), unit.symbol)
        }
        Kind::Choice(choices) => format!("one of {}", names(choices)),
        Kind::Toggle => "on or off".into(),
        Kind::Color => "a colour such as 5a3b28".into(),
    }
}

fn flag_text(row: &Knob, value: Value) -> String {
    match (row.kind, value) {
        (Kind::Number { unit: PERCENT, .. }, Value::Number(v)) => share(row.shown(v)),
        (_, Value::Toggle(on)) => if on { "on" } else { "off" }.into(),
        (_, value) => row.text(value),
    }
}

/// Percent as a share, without the noise of the division.
fn share(percent: f64) -> String {
    ((percent * 1e7).round() / 1e9).to_string()
}

fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
