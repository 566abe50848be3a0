//! Formats presets as text.

use super::{
    Preset, VERSION, lights,
    source::{FILES, MIRROR, TEXTS, slashes},
    values::quoted,
};
use crate::{
    knobs::{Knob, SECTIONS, Value, ValueKind, light_list},
    settings::Settings,
    source::PresetSource,
};

/// Which parameters a preset lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extent {
    /// Only parameters that differ from their defaults.
    #[default]
    Changed,
    /// All parameters, each with its hint and its allowed range.
    All,
}

impl Preset {
    /// Returns the text of the preset file.
    pub fn write(&self, extent: Extent) -> String {
        let mut text = match extent {
            Extent::Changed => String::from(
                "# Settings of Tresses that differ from the defaults; `tresses knobs` lists all.\n",
            ),
            Extent::All => String::from("# All settings of Tresses.\n"),
        };
        text += &format!("version = {VERSION}\n");
        if let Some(name) = &self.name {
            text += &format!("name = {}\n", quoted(name));
        }
        text += &source(&self.source);
        for section in SECTIONS {
            let knobs: Vec<_> = section
                .knobs
                .iter()
                .filter(|knob| extent == Extent::All || !knob.is_default(&self.settings))
                .collect();
            if !knobs.is_empty() {
                text += &format!("\n[{}]\n", section.key);
            }
            for knob in knobs {
                text += &line(knob, &self.settings, extent);
            }
            if light_list::PATH.split_once('.').is_some_and(|(key, _)| key == section.key) {
                text += &lights::write(&self.settings.lights.list, extent == Extent::All);
            }
        }
        text
    }
}

fn source(source: &PresetSource) -> String {
    if source.is_empty() {
        return String::new();
    }
    let mut text = String::from("\n[source]\n");
    let mut own = source.clone();
    for (key, files) in FILES {
        let files: Vec<String> = files(&mut own).iter().map(|path| quoted(&slashes(path))).collect();
        match files.as_slice() {
            [] => {}
            [one] => text += &format!("{key} = {one}\n"),
            many => text += &format!("{key} = [{}]\n", many.join(", ")),
        }
    }
    for (key, get, _) in TEXTS {
        if let Some(value) = get(source) {
            text += &format!("{key} = {}\n", quoted(&value));
        }
    }
    if let Some(mirror) = source.orientation.orient.is_mirrored {
        text += &format!("{MIRROR} = {mirror}\n");
    }
    text
}

fn line(knob: &Knob, settings: &Settings, extent: Extent) -> String {
    let value = match knob.get(settings) {
        Value::Auto => quoted("auto"),
        Value::Number(v) => knob.shown(v).to_string(),
        Value::Integer(v) => v.to_string(),
        Value::Toggle(on) => on.to_string(),
        Value::Choice(name) if name.parse::<u32>().is_ok() => name.to_owned(),
        Value::Choice(name) => quoted(name),
        value @ Value::Color(_) => quoted(&knob.text(value)),
    };
    let unit = match knob.kind {
        ValueKind::Number { unit, .. } | ValueKind::Integer { unit, .. } => unit.symbol,
        _ => "",
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" # {unit}") };
    match extent {
        Extent::Changed => format!("{} = {value}{unit}\n", knob.key()),
        Extent::All => {
            format!("# {} Allowed: {}.\n{} = {value}{unit}\n", knob.hint, knob.range(), knob.key())
        }
    }
}
