//! Tables and values of TOML.

use std::ops::Range;
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// Key, value, and the span of the key in the text.
pub(super) type Entry<'a> = (&'a str, &'a DeValue<'a>, Range<usize>);

/// Span of a problem in the text, and its description.
pub(super) type SpannedProblem = (Range<usize>, String);

/// Returns the table's entries in file order.
pub(super) fn entries<'a>(table: &'a DeTable<'a>) -> Vec<Entry<'a>> {
    let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
        let key: &'a Spanned<std::borrow::Cow<'a, str>> = key;
        (key.get_ref().as_ref(), value.get_ref(), key.span())
    };
    let mut entries: Vec<Entry<'a>> = table.iter().map(entry).collect();
    entries.sort_by_key(|(_, _, at)| at.start);
    entries
}

/// Formats a value from the file, shortened.
pub(super) fn show(found: &DeValue) -> String {
    let text = match found {
        DeValue::String(text) => format!("\"{text}\""),
        DeValue::Integer(v) => v.to_string(),
        DeValue::Float(v) => v.to_string(),
        DeValue::Boolean(v) => v.to_string(),
        DeValue::Datetime(v) => v.to_string(),
        DeValue::Array(_) => "a list".into(),
        DeValue::Table(_) => "a table".into(),
    };
    let text = one_line(&text);
    if text.chars().count() > 60 { text.chars().take(57).chain("...".chars()).collect() } else { text }
}

pub(super) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Formats a text as a value.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
