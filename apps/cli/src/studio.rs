//! `tresses studio`: opens the studio.

use crate::settings_args::SettingsArgs;
use anyhow::{Context, Result};
use tresses_scene::{CompanionFiles, Shelf};
use tresses_studio::Options;

/// Initial state of the window.
#[derive(clap::Args, Debug)]
pub struct StudioArgs {
    #[command(flatten)]
    settings: SettingsArgs,
}

/// Opens the window and returns when it is closed.
pub fn run(args: &StudioArgs) -> Result<()> {
    tresses_studio::run(args.options()?)
}

impl StudioArgs {
    fn options(&self) -> Result<Options> {
        let preset = self.settings.preset()?;
        let source = preset.source;
        // Report missing files here instead of in an empty window.
        for path in source.grooms.iter().chain(&source.heads) {
            std::fs::metadata(path).with_context(|| path.display().to_string())?;
        }
        let companion_files = CompanionFiles::of(&source, Shelf::default());
        companion_files.maps()?;
        companion_files.colliders()?;
        if let Some(path) = &source.environment {
            std::fs::metadata(path).with_context(|| path.clone())?;
        }
        Ok(Options {
            grooms: source.grooms,
            heads: source.heads,
            style: source.style,
            import: source.orientation,
            companion_files,
            settings: preset.settings,
            ..Default::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        args: StudioArgs,
    }

    fn options(words: &[&str]) -> Result<Options> {
        Command::try_parse_from([&["x"], words].concat())?.args.options()
    }

    #[test]
    fn options_set_the_initial_state() {
        assert_eq!(options(&[]).unwrap(), Options::default());
        let begun = options(&["--style", "bob", "--set", "wind.speed=3"]).unwrap();
        assert_eq!((begun.style.as_deref(), begun.settings.wind_speed()), (Some("bob"), 3.0));
        let preset = concat!(env!("CARGO_MANIFEST_DIR"), "/../../presets/storm.toml");
        let storm = options(&["--preset", preset]).unwrap();
        assert_eq!((storm.style.as_deref(), storm.settings.wind_speed()), (Some("long"), 14.0));
        let sparse = options(&["--density-map", "noise"]).unwrap();
        assert_eq!(sparse.companion_files.names().density_map.as_deref(), Some("noise"));
    }

    #[test]
    fn missing_files_fail_before_the_window_opens() {
        for (words, text) in [
            (&["nowhere.tfx"][..], "nowhere.tfx"),
            (&["--length-map", "nowhere.png"], "nowhere.png"),
            (&["--environment", "nowhere.hdr"], "nowhere.hdr"),
            (&["--colliders", "nowhere.json"], "nowhere.json"),
        ] {
            let said = format!("{:#}", options(words).unwrap_err());
            assert!(said.contains(text), "{said}");
        }
    }
}
