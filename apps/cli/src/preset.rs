//! `tresses preset`: prints the given options as a preset.

use crate::{say, settings_args::SettingsArgs};
use anyhow::Result;
use tresses_scene::preset::Extent;

/// Options of `tresses preset`.
#[derive(clap::Args, Debug)]
pub struct PresetCommandArgs {
    /// Write all parameters with hints and ranges, not only those that differ from the defaults
    #[arg(long)]
    pub all: bool,
    #[command(flatten)]
    pub settings: SettingsArgs,
}

/// Runs `tresses preset`.
pub fn run(args: &PresetCommandArgs) -> Result<()> {
    let preset = args.settings.preset()?;
    let extent = if args.all { Extent::All } else { Extent::Changed };
    say!("{}", preset.write(extent).trim_end());
    Ok(())
}
