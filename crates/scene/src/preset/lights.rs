//! The list of lights in presets.

use super::values::{Entry, SpannedProblem, entries, quoted, show};
use crate::{
    knobs::{
        flags::sentence,
        light_list::{self, KeyPresence, LightInput, LightProblem, PATH, SHAPE, fields},
    },
    settings::{LightEntry, LightKind},
};
use std::fmt::Write;
use toml::de::{DeTable, DeValue};

/// Keys of two distant lights, which presets had before the list.
const FORMER: [(&str, usize, FormerKey); 6] = [
    ("lamp1_strength", 0, FormerKey::Intensity),
    ("lamp1_azimuth", 0, FormerKey::Azimuth),
    ("lamp1_elevation", 0, FormerKey::Elevation),
    ("lamp2_strength", 1, FormerKey::Intensity),
    ("lamp2_azimuth", 1, FormerKey::Azimuth),
    ("lamp2_elevation", 1, FormerKey::Elevation),
];

/// Key of a light before the list.
#[derive(Clone, Copy, Debug)]
enum FormerKey {
    Intensity,
    Azimuth,
    Elevation,
}

impl FormerKey {
    /// Returns the key in the list.
    fn key(self) -> &'static str {
        match self {
            Self::Intensity => "intensity",
            Self::Azimuth => "azimuth",
            Self::Elevation => "elevation",
        }
    }
}

/// Takes the lights out of the `entries` of the table `[lights]`. Returns the other entries and the list.
pub(super) fn take<'a>(all: &[Entry<'a>]) -> Result<(Vec<Entry<'a>>, Vec<LightEntry>), SpannedProblem> {
    let (mut others, mut list) = (Vec::new(), former(all)?);
    for entry in all {
        let (key, found, at) = entry;
        match found {
            _ if FORMER.iter().any(|(former, ..)| former == key) => {}
            DeValue::Array(tables) if *key == "list" => {
                for item in tables {
                    let index = list.len();
                    let DeValue::Table(table) = item.get_ref() else {
                        let label = light_list::label(index, "");
                        return Err((
                            at.clone(),
                            format!("{label} is {}, not a table", show(item.get_ref())),
                        ));
                    };
                    list.push(light(table, index, at)?);
                }
            }
            found if *key == "list" => {
                return Err((
                    at.clone(),
                    format!("{PATH} is {}, but must be tables [[{PATH}]]", show(found)),
                ));
            }
            _ => others.push(entry.clone()),
        }
    }
    Ok((others, list))
}

/// Reads a table of the list. `at` is the span of the list's key.
fn light(table: &DeTable, index: usize, at: &std::ops::Range<usize>) -> Result<LightEntry, SpannedProblem> {
    let entries = entries(table);
    let values: Vec<_> = entries.iter().map(|(key, value, _)| (*key, input(value))).collect();
    light_list::read(&values).map_err(|LightProblem { index: key, problem }| {
        let name = values.iter().find_map(|(key, value)| match value {
            LightInput::Text(name) if *key == "name" => Some(name.as_str()),
            _ => None,
        });
        // Without an invalid key, the problem is at the first key of the light.
        let span = entries.get(key.unwrap_or(0)).map_or(at, |(.., span)| span);
        (span.clone(), format!("{}: {problem}", light_list::label(index, name.unwrap_or_default())))
    })
}

fn input(found: &DeValue) -> LightInput {
    let number = |found: &DeValue| match found {
        DeValue::Integer(v) => v.to_string().parse().ok(),
        DeValue::Float(v) => v.as_str().parse().ok(),
        _ => None,
    };
    match found {
        DeValue::String(text) => LightInput::Text(text.to_string()),
        DeValue::Boolean(on) => LightInput::Toggle(*on),
        DeValue::Array(list) => list
            .iter()
            .map(|item| number(item.get_ref()))
            .collect::<Option<_>>()
            .map_or(LightInput::Other("a list"), LightInput::Numbers),
        found => number(found).map_or(LightInput::Other("of another type"), LightInput::Number),
    }
}

/// Returns the lights of presets that have [former keys](FORMER). A light of strength 0 was off.
fn former(entries: &[Entry]) -> Result<Vec<LightEntry>, SpannedProblem> {
    let mut lights = [0, 1].map(|_| vec![("intensity", LightInput::Number(0.0))]);
    let mut first = [None, None];
    for (key, found, at) in entries {
        let Some((_, light, current)) = FORMER.iter().find(|(former, ..)| former == key) else { continue };
        let value = input(found);
        if !matches!(value, LightInput::Number(_)) {
            return Err((at.clone(), format!("lights.{key} is {}, but must be a number", show(found))));
        }
        first[*light].get_or_insert(at);
        lights[*light].retain(|(key, _)| *key != current.key());
        lights[*light].push((current.key(), value));
    }
    let mut list = Vec::new();
    for (mut values, at) in lights.into_iter().zip(first) {
        let Some(at) = at else { continue };
        // The former defaults are those of a distant light.
        let usual = LightEntry::new(LightKind::Distant);
        for field in fields(LightKind::Distant).filter(|field| field.presence == KeyPresence::Required) {
            if values.iter().all(|(key, _)| *key != field.key) {
                values.extend(field.get(&usual).map(|value| (field.key, value)));
            }
        }
        values.push((SHAPE, LightInput::Text(LightKind::Distant.name().into())));
        let light = light_list::read(&values).map_err(|LightProblem { problem, .. }| {
            (at.clone(), format!("{}: {problem}", light_list::label(list.len(), "")))
        })?;
        list.extend((light.intensity > 0.0).then_some(light));
    }
    Ok(list)
}

/// Formats the list as tables: with `all` keys and their meaning, or with those that differ from the defaults.
pub(super) fn write(list: &[LightEntry], all: bool) -> String {
    let mut text = String::new();
    for light in list {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n[[{PATH}]]\n{SHAPE} = {}\n", quoted(light.kind.name()));
        let usual = LightEntry::new(light.kind);
        for field in fields(light.kind) {
            let Some(value) = field.get(light) else { continue };
            let is_listed = field.presence != KeyPresence::Optional || all;
            if !is_listed && field.get(&usual).as_ref() == Some(&value) {
                continue;
            }
            let value = match value {
                LightInput::Number(v) => v.to_string(),
                LightInput::Numbers(v) => {
                    format!("[{}]", v.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
                }
                LightInput::Toggle(on) => on.to_string(),
                LightInput::Text(text) => quoted(&text),
                LightInput::Other(_) => continue,
            };
            if all {
                let _ = writeln!(text, "# {} {}.", field.hint, sentence(&field.range()));
            }
            let unit = field.unit();
            let unit = if unit.is_empty() { String::new() } else { format!(" # {unit}") };
            let _ = writeln!(text, "{} = {value}{unit}", field.key);
        }
    }
    text
}
