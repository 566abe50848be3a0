//! Parsing and printing of values.

use super::{Choice, Knob, Refusal, Unit, Value, ValueKind};

/// Suffixes of length units and their size in meters.
const LENGTHS: [(&str, f64); 6] =
    [("µm", 1e-6), ("μm", 1e-6), ("um", 1e-6), ("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)];

impl Knob {
    /// Formats `value` with its unit: `9 mm`, `true`, `#5a3b28`, `auto`.
    pub fn text(&self, value: Value) -> String {
        match (value, self.kind) {
            (Value::Number(v), ValueKind::Number { unit, .. }) => {
                with_unit(&self.shown(v).to_string(), unit.symbol)
            }
            (Value::Number(v), _) => v.to_string(),
            (Value::Integer(v), ValueKind::Integer { unit, .. }) => with_unit(&v.to_string(), unit.symbol),
            (Value::Integer(v), _) => v.to_string(),
            (Value::Auto, _) => "auto".into(),
            (Value::Toggle(on), _) => on.to_string(),
            (Value::Choice(name), _) => name.into(),
            (Value::Color([r, g, b]), _) => format!("#{r:02x}{g:02x}{b:02x}"),
        }
    }

    /// Describes the allowed values: `from 0 to 100 mm`, `one of auto, mask, peel`.
    pub fn range(&self) -> String {
        let auto = if self.automatic { ", or auto" } else { "" };
        match self.kind {
            ValueKind::Number { unit, min, max, .. } => {
                with_unit(&format!("from {min} to {max}"), unit.symbol) + auto
            }
            ValueKind::Integer { unit, min, max, step } => {
                let range = with_unit(&format!("from {min} to {max}"), unit.symbol);
                let multiple = if step > 1 { format!(", a multiple of {step}") } else { String::new() };
                format!("a whole number {range}{multiple}{auto}")
            }
            ValueKind::Toggle => "true or false".into(),
            ValueKind::Choice(choices) => {
                let auto = if self.automatic { "auto, " } else { "" };
                format!("one of {auto}{}", names(choices))
            }
            ValueKind::Color => format!("a color such as #5a3b28{auto}"),
        }
    }

    /// Parses `text`, in the row's unit or with an explicit unit.
    ///
    /// # Errors
    /// Returns one sentence that states the allowed values.
    pub fn parse(&self, text: &str) -> Result<Value, Refusal> {
        let text = text.trim();
        let refuse = || Refusal { path: self.path.to_owned(), value: text.to_owned(), range: self.range() };
        if self.automatic && text == "auto" {
            return Ok(Value::Auto);
        }
        let value = match self.kind {
            ValueKind::Number { unit, .. } => {
                Value::Number(self.inner(in_unit(text, unit).ok_or_else(refuse)?))
            }
            ValueKind::Integer { unit, .. } => {
                let number = text.strip_suffix(unit.symbol).unwrap_or(text).trim();
                Value::Integer(number.parse().map_err(|_| refuse())?)
            }
            ValueKind::Toggle => match text {
                "on" | "true" | "yes" => Value::Toggle(true),
                "off" | "false" | "no" => Value::Toggle(false),
                _ => return Err(refuse()),
            },
            ValueKind::Choice(choices) => {
                Value::Choice(choices.iter().find(|choice| choice.name == text).ok_or_else(refuse)?.name)
            }
            ValueKind::Color => Value::Color(color(text).ok_or_else(refuse)?),
        };
        self.check(value).map_err(|_| refuse())?;
        Ok(value)
    }
}

/// Parses a number and converts it to `unit`. Lengths may have any length unit.
pub(super) fn in_unit(text: &str, unit: Unit) -> Option<f64> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    if LENGTHS.iter().any(|(symbol, _)| *symbol == unit.symbol) {
        let found = LENGTHS.iter().find_map(|(symbol, si)| Some((text.strip_suffix(symbol)?, si)));
        if let Some((rest, si)) = found.filter(|(_, si)| **si != unit.si) {
            return Some(number(rest)? * si / unit.si);
        }
        return number(found.map_or(text, |(rest, _)| rest));
    }
    number(text.strip_suffix(unit.symbol).unwrap_or(text))
}

/// Returns the names of `choices`, separated by commas.
pub(super) fn names(choices: &[Choice]) -> String {
    choices.iter().map(|choice| choice.name).collect::<Vec<_>>().join(", ")
}

pub(super) fn with_unit(number: &str, symbol: &str) -> String {
    match symbol {
        "" => number.to_owned(),
        "°" | "%" => format!("{number}{symbol}"),
        _ => format!("{number} {symbol}"),
    }
}

/// Parses six hexadecimal digits, with or without a leading `#`.
pub fn color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let [_, r, g, b] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some([r, g, b])
}
