//! Values as people write them.

use super::{Kind, Knob, Refusal, Value};

impl Knob {
    /// `value` with its unit: `9 mm`, `true`, `#5a3b28`, `auto`.
    pub fn text(&self, value: Value) -> String {
        match (value, self.kind) {
            (Value::Number(v), Kind::Number { unit, .. }) => {
                with_unit(&self.shown(v).to_string(), unit.symbol)
            }
            (Value::Number(v), _) => v.to_string(),
            (Value::Integer(v), Kind::Integer { unit, .. }) => with_unit(&v.to_string(), unit.symbol),
            (Value::Integer(v), _) => v.to_string(),
            (Value::Auto, _) => "auto".into(),
            (Value::Toggle(on), _) => on.to_string(),
            (Value::Choice(name), _) => name.into(),
            (Value::Color([r, g, b]), _) => format!("#{r:02x}{g:02x}{b:02x}"),
        }
    }

    /// What is allowed, in words: `from 0 to 100 mm`, `one of auto, mask, peel`.
    pub fn range(&self) -> String {
        let auto = if self.automatic { ", or auto" } else { "" };
        match self.kind {
            Kind::Number { unit, least, most, .. } => {
                with_unit(&format!("from {least} to {most}"), unit.symbol) + auto
            }
            Kind::Integer { unit, least, most, step } => {
                let range = with_unit(&format!("from {least} to {most}"), unit.symbol);
                let multiple = if step > 1 { format!(", a multiple of {step}") } else { String::new() };
                format!("a whole number {range}{multiple}{auto}")
            }
            Kind::Toggle => "true or false".into(),
            Kind::Choice(names) => {
                let auto = if self.automatic { "auto, " } else { "" };
                format!("one of {auto}{}", names.join(", "))
            }
            Kind::Color => format!("a colour such as #5a3b28{auto}"),
        }
    }

    /// The value that `text` says: with the unit that people read or without any.
    ///
    /// # Errors
    /// One sentence.
    pub fn parse(&self, text: &str) -> Result<Value, Refusal> {
        let text = text.trim();
        let refuse = || Refusal { path: self.path, value: text.to_owned(), range: self.range() };
        if self.automatic && text == "auto" {
            return Ok(Value::Auto);
        }
        let plain = |symbol: &str| text.strip_suffix(symbol).unwrap_or(text).trim().to_owned();
        let value = match self.kind {
            Kind::Number { unit, .. } => {
                // Whoever has no µ on the keyboard.
                let number = match unit.symbol {
                    "µm" => plain("um").strip_suffix(unit.symbol).map_or(plain("um"), str::to_owned),
                    symbol => plain(symbol),
                };
                Value::Number(self.inner(number.trim().parse().map_err(|_| refuse())?))
            }
            Kind::Integer { unit, .. } => Value::Integer(plain(unit.symbol).parse().map_err(|_| refuse())?),
            Kind::Toggle => match text {
                "on" | "true" | "yes" => Value::Toggle(true),
                "off" | "false" | "no" => Value::Toggle(false),
                _ => return Err(refuse()),
            },
            Kind::Choice(names) => {
                Value::Choice(names.iter().find(|name| **name == text).ok_or_else(refuse)?)
            }
            Kind::Color => Value::Color(color(text).ok_or_else(refuse)?),
        };
        self.check(value).map_err(|_| refuse())?;
        Ok(value)
    }
}

fn with_unit(number: &str, symbol: &str) -> String {
    match symbol {
        "" => number.to_owned(),
        "°" | "%" => format!("{number}{symbol}"),
        _ => format!("{number} {symbol}"),
    }
}

/// Six hexadecimal digits, with or without `#` before them.
pub fn color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let [_, r, g, b] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some([r, g, b])
}
