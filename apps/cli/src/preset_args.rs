//! Presets on the command line, and single parameters by name.

use anyhow::{Result, bail};
use std::{path::PathBuf, str::FromStr};
use tresses_scene::{Preset, knobs::ParsedSetting, preset::Extent};

/// Options for presets and single parameters.
#[derive(clap::Args, Clone, Debug, Default)]
#[command(next_help_heading = "Presets")]
pub struct PresetArgs {
    /// Load settings and hair from a preset; other options take precedence
    #[arg(long, value_name = "FILE")]
    preset: Option<PathBuf>,
    /// Set any parameter that `tresses knobs` lists, as in simulation.drag=5; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE")]
    assignments: Vec<Assignment>,
    /// Write the result of all options to a preset
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    save_preset: Option<PathBuf>,
}

impl PresetArgs {
    /// Returns the given preset, or the defaults.
    pub fn open(&self) -> Result<Preset> {
        open(self.preset.as_ref())
    }

    /// Applies `--set` to `preset`, checks its settings, and writes it to the file of `--save-preset`, if given.
    pub fn finish(&self, preset: &mut Preset) -> Result<()> {
        for Assignment(setting) in &self.assignments {
            setting.apply(&mut preset.settings)?;
        }
        preset.settings.check()?;
        if let Some(path) = &self.save_preset {
            if path.extension().is_none_or(|extension| extension != "toml") {
                bail!("{}: a preset must be a .toml file", path.display());
            }
            preset.name = path.file_stem().map(|name| name.to_string_lossy().into_owned());
            preset
                .save(path, Extent::Changed)
                .map_err(|error| anyhow::anyhow!("{}: {error}", path.display()))?;
            eprintln!("Wrote {}.", path.display());
        }
        Ok(())
    }
}

/// Returns the preset at `path`, or the defaults.
pub fn open(path: Option<&PathBuf>) -> Result<Preset> {
    Ok(path.map(|path| Preset::open(path)).transpose()?.unwrap_or_default())
}

/// A parameter and its value.
#[derive(Clone, Debug)]
struct Assignment(ParsedSetting);

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (path, value) = text.split_once('=').ok_or("expected NAME=VALUE, as in simulation.drag=5")?;
        ParsedSetting::parse(path.trim(), value).map(Self)
    }
}
