//! Parses presets.

use super::{
    Preset, VERSION, lights,
    source::{FILES, MIRROR, TEXTS},
    values::{Entry, SpannedProblem, entries, one_line, show},
};
use crate::{
    knobs::{self, Knob, SECTIONS, Value, ValueKind, color},
    settings::Settings,
    source::PresetSource,
};
use std::{ops::Range, path::PathBuf};
use toml::de::{DeTable, DeValue};

/// Problem and the line where it occurs.
pub(super) struct Problem {
    pub line: Option<usize>,
    pub problem: String,
}

pub(super) fn read(text: &str) -> Result<Preset, Problem> {
    let line = |at: &Range<usize>| {
        let end = at.start.min(text.len());
        Some(1 + text.as_bytes()[..end].iter().filter(|byte| **byte == b'\n').count())
    };
    let locate = |(at, problem): SpannedProblem| Problem { line: line(&at), problem };
    let document = DeTable::parse(text).map_err(|error| Problem {
        line: error.span().as_ref().and_then(line),
        problem: one_line(error.message()),
    })?;
    let preset = preset(&entries(document.get_ref())).map_err(locate)?;
    preset.settings.check().map_err(|error| Problem { line: None, problem: error.to_string() })?;
    Ok(preset)
}

fn preset(entries: &[Entry]) -> Result<Preset, SpannedProblem> {
    let mut preset = Preset::default();
    let mut version = false;
    for (key, value, at) in entries {
        let refuse = |problem: String| Err((at.clone(), problem));
        match (*key, value) {
            ("version", DeValue::Integer(found)) if found.to_string() == VERSION.to_string() => {
                version = true
            }
            ("version", found) => {
                return refuse(format!(
                    "the version is {}, but this program reads version {VERSION}",
                    show(found)
                ));
            }
            ("name", DeValue::String(name)) => preset.name = Some(name.to_string()),
            ("name", found) => return refuse(format!("name is {}, but must be a string", show(found))),
            ("lights", DeValue::Table(table)) => {
                let (others, list) = lights::take(&self::entries(table))?;
                section("lights", &others, &mut preset.settings)?;
                preset.settings.lights.list = list;
            }
            ("source", DeValue::Table(table)) => source(&self::entries(table), &mut preset.source)?,
            (key, DeValue::Table(table)) if SECTIONS.iter().any(|section| section.key == key) => {
                section(key, &self::entries(table), &mut preset.settings)?;
            }
            // Each of its keys is an error that names its successor.
            (key, DeValue::Table(table)) if knobs::removed::has_section(key) => {
                section(key, &self::entries(table), &mut preset.settings)?;
            }
            (key, found) => return refuse(stray(key, found)),
        }
    }
    if version { Ok(preset) } else { Err((0..0, format!("version = {VERSION} is missing"))) }
}

/// Describes an unknown table, or a key that is outside every table.
fn stray(key: &str, found: &DeValue) -> String {
    let tables = SECTIONS.iter().map(|section| section.key).chain(["source"]);
    match found {
        DeValue::Table(_) => {
            let nearest = nearest(key, tables).unwrap_or_default();
            format!("there is no table [{key}]; the nearest is [{nearest}]")
        }
        _ => match knobs::all().find(|knob| knob.key() == key) {
            Some(knob) => format!("{key} must be in its table [{}]", knob.section()),
            None if tables.clone().any(|table| table == key) => format!("{key} must be a table, [{key}]"),
            None => {
                let nearest = nearest(key, ["version", "name"].into_iter().chain(tables)).unwrap_or_default();
                format!("there is no key {key}; the nearest is {nearest}")
            }
        },
    }
}

fn section(key: &str, entries: &[Entry], settings: &mut Settings) -> Result<(), SpannedProblem> {
    for (name, found, at) in entries {
        let path = format!("{key}.{name}");
        let knob = knobs::named(&path).map_err(|problem| (at.clone(), problem))?;
        let value = value(knob, found).and_then(|value| {
            knob.set(settings, value).ok()?;
            Some(())
        });
        if value.is_none() {
            return Err((at.clone(), format!("{path} is {}, but must be {}", show(found), knob.range())));
        }
    }
    Ok(())
}

fn value(knob: &Knob, found: &DeValue) -> Option<Value> {
    Some(match (knob.kind, found) {
        (_, DeValue::String(text)) if knob.automatic && text == "auto" => Value::Auto,
        (ValueKind::Number { .. }, DeValue::Float(v)) => Value::Number(knob.inner(v.as_str().parse().ok()?)),
        (ValueKind::Number { .. }, DeValue::Integer(v)) => {
            Value::Number(knob.inner(v.to_string().parse().ok()?))
        }
        (ValueKind::Integer { .. }, DeValue::Integer(v)) => Value::Integer(v.to_string().parse().ok()?),
        (ValueKind::Toggle, DeValue::Boolean(on)) => Value::Toggle(*on),
        (ValueKind::Choice(_), DeValue::String(text)) => knob.parse(text).ok()?,
        (ValueKind::Choice(_), DeValue::Integer(v)) => knob.parse(&v.to_string()).ok()?,
        (ValueKind::Color, DeValue::String(text)) => Value::Color(color(text)?),
        _ => return None,
    })
}

fn source(entries: &[Entry], source: &mut PresetSource) -> Result<(), SpannedProblem> {
    for (key, found, at) in entries {
        let refuse = |problem: String| Err((at.clone(), problem));
        if let Some((_, files)) = FILES.iter().find(|file| file.0 == *key) {
            let Some(paths) = paths(found) else {
                return refuse(format!(
                    "source.{key} is {}, but must be a file or a list of files",
                    show(found)
                ));
            };
            *files(source) = paths;
        } else if let Some((_, _, set)) = TEXTS.iter().find(|text| text.0 == *key) {
            let DeValue::String(text) = found else {
                return refuse(format!("source.{key} is {}, but must be a string", show(found)));
            };
            if let Err(problem) = set(source, text) {
                return refuse(format!("source.{key}: {problem}"));
            }
        } else if let (&MIRROR, DeValue::Boolean(mirror)) = (key, found) {
            source.orientation.orient.is_mirrored = Some(*mirror);
        } else if *key == MIRROR {
            return refuse(format!("source.{MIRROR} is {}, but must be true or false", show(found)));
        } else {
            let nearest = nearest(key, PresetSource::keys()).unwrap_or_default();
            return refuse(format!("there is no source.{key}; the nearest is source.{nearest}"));
        }
    }
    let at = entries.first().map_or(0..0, |entry| entry.2.clone());
    let refuse = |problem: &str| Err((at.clone(), problem.to_owned()));
    if source.style.is_some() && !source.grooms.is_empty() {
        return refuse("source has a style and a groom; give one of them");
    }
    for choice in [source.orientation.orient, source.orientation.orient_head] {
        choice.check().map_err(|error| (at.clone(), format!("source: {error}")))?;
    }
    Ok(())
}

fn paths(found: &DeValue) -> Option<Vec<PathBuf>> {
    match found {
        DeValue::String(path) if !path.is_empty() => Some(vec![PathBuf::from(path.as_ref())]),
        DeValue::Array(list) => list
            .iter()
            .map(|path| match path.get_ref() {
                DeValue::String(path) if !path.is_empty() => Some(PathBuf::from(path.as_ref())),
                _ => None,
            })
            .collect(),
        _ => None,
    }
}

/// Returns the known name closest to `key`.
fn nearest<'a>(key: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    names.min_by_key(|name| strsim::damerau_levenshtein(key, name))
}
