//! All options that say what hair is like, and what they make of a preset.

use crate::{
    args::SourceArgs, avoid_args::Avoid, edge_args::EdgeArgs, environment_args::EnvironmentArgs,
    hair_hair_args::HairHairArgs, lod_args::LodArgs, preset_args::PresetArgs, shading_args::ShadingArgs,
    shadow_args::ShadowArgs, wind_args::WindArgs,
};
use anyhow::{Result, ensure};
use tresses_scene::Preset;

/// Everything that a preset holds. What is given here wins over the preset, and that over the defaults.
#[derive(clap::Args, Debug, Default)]
pub struct SettingsArgs {
    #[command(flatten)]
    pub source: SourceArgs,
    #[command(flatten)]
    pub preset: PresetArgs,
    #[command(flatten)]
    pub edges: EdgeArgs,
    #[command(flatten)]
    pub hair_hair: HairHairArgs,
    #[command(flatten)]
    pub wind: WindArgs,
    /// What drawn strands do where they would enter the head [default: strands]
    #[arg(long, value_name = "MODE", value_enum, help_heading = "Simulation")]
    pub avoid: Option<Avoid>,
    #[command(flatten)]
    pub lod: LodArgs,
    #[command(flatten)]
    pub shading: ShadingArgs,
    #[command(flatten)]
    pub environment: EnvironmentArgs,
    #[command(flatten)]
    pub shadows: ShadowArgs,
}

impl SettingsArgs {
    /// What all of them come to.
    pub fn preset(&self) -> Result<Preset> {
        ensure!(
            self.source.color.is_none() || self.shading.melanin.is_none(),
            "--color and --melanin both say what colour the hair has: give one"
        );
        self.shading.check()?;
        let mut preset = self.preset.open()?;
        self.source.apply(&mut preset)?;
        self.environment.apply(&mut preset)?;
        let settings = &mut preset.settings;
        self.edges.apply(settings)?;
        self.hair_hair.apply(settings);
        self.wind.apply(settings);
        if let Some(avoid) = self.avoid {
            settings.interpolation.mode = avoid.into();
        }
        self.lod.apply(settings);
        self.shading.apply(&mut settings.look);
        settings.shadows.ambient = self.shading.follows(settings.shadows.ambient);
        self.shadows.apply(settings)?;
        self.preset.finish(&mut preset)?;
        Ok(preset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use tresses_scene::{Settings, knobs, preset::Extent};

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        settings: SettingsArgs,
    }

    fn parse(words: &[&str]) -> Result<Preset> {
        Command::try_parse_from([&["x"], words].concat())?.settings.preset()
    }

    #[test]
    fn by_default_everything_is_as_in_the_library() {
        assert_eq!(parse(&[]).unwrap(), Preset::default());
    }

    /// Every option with another value than by default, and the knobs that it turns.
    const OPTIONS: &[(&[&str], &[&str])] = &[
        (&["--strands", "500"], &["style.strands"]),
        (&["--guides", "30"], &["style.guides"]),
        (&["--guides", "all"], &["style.all_guides"]),
        (&["--curl", "waves,radius=7mm"], &["style.curl", "style.curl_radius"]),
        (&["--curl", "wavelength=whole"], &["style.curl_stretch"]),
        (&["--clump", "0.4,spacing=4mm"], &["style.clump", "style.clump_spacing"]),
        (&["--frizz", "1mm"], &["style.frizz"]),
        (&["--strays", "0.5,3mm"], &["style.strays", "style.stray_reach"]),
        (&["--flyaways", "0.5"], &["style.flyaways"]),
        (&["--width", "90um"], &["style.width"]),
        (&["--width-variation", "0.1"], &["style.width_variation"]),
        (&["--tip-width", "0.5"], &["style.tip_width"]),
        (&["--lightness-spread", "0.5"], &["shading.lightness_spread"]),
        (&["--warmth-spread", "0.5"], &["shading.warmth_spread"]),
        (&["--highlight-spread", "0.5"], &["shading.highlight_spread"]),
        (&["--color", "red"], &["shading.color"]),
        (&["--color", "123456"], &["shading.color", "shading.srgb"]),
        (&["--melanin", "3,1"], &["shading.color", "shading.eumelanin", "shading.pheomelanin"]),
        (&["--roughness", "0.5,0.6"], &["shading.roughness_along", "shading.roughness_around"]),
        (&["--shading", "kajiya-kay"], &["shading.model"]),
        (&["--shade-per", "pixel"], &["shading.rate"]),
        (&["--samples", "4"], &["edges.samples"]),
        (&["--coverage", "mask"], &["edges.coverage"]),
        (&["--layers", "7"], &["edges.layers"]),
        (&["--ssaa", "2"], &["edges.ssaa"]),
        (&["--hair-hair", "off"], &["simulation.hair_hair"]),
        (&["--wind", "8,90"], &["wind.speed", "wind.direction"]),
        (&["--gusts", "0.5"], &["wind.turbulence"]),
        (&["--wind-seed", "5"], &["wind.seed"]),
        (&["--avoid", "off"], &["interpolation.avoid"]),
        (&["--lod", "0.5"], &["lod.mode", "lod.fraction"]),
        (&["--lod-bias", "-1"], &["lod.bias"]),
        (&["--shadows", "opaque"], &["shadows.method"]),
        (&["--shadow-resolution", "512"], &["shadows.resolution"]),
        (&["--shadow-softness", "5"], &["shadows.softness"]),
        (&["--shadows-per-pixel"], &["shadows.per_pixel"]),
        (
            &["--light", "10,20,3"],
            &["lights.lamp1_strength", "lights.lamp1_azimuth", "lights.lamp1_elevation"],
        ),
        (&["--set", "simulation.drag=5"], &["simulation.drag"]),
        (&["--set", "style.frizz=1 mm", "--set", "lights.follow=off"], &["style.frizz", "lights.follow"]),
    ];

    #[test]
    fn options_win_over_a_preset_and_that_over_the_defaults() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preset.toml");
        let file = path.to_str().unwrap();
        let mut all = Settings::default();
        all.wind.speed = 3.0;
        all.lights.rim = 2.0;
        Preset { settings: all.clone(), ..Default::default() }.save(&path, Extent::Changed).unwrap();
        assert_eq!(parse(&["--preset", file]).unwrap().settings, all);
        for (words, paths) in OPTIONS {
            let alone = parse(words).unwrap().settings;
            let turned: Vec<_> =
                knobs::all().filter(|knob| !knob.is_default(&alone)).map(|knob| knob.path).collect();
            let mut expected = paths.to_vec();
            expected.sort_by_key(|path| knobs::all().position(|knob| knob.path == *path));
            assert_eq!(turned, expected, "{words:?}");
            let over = parse(&[&["--preset", file], *words].concat()).unwrap().settings;
            for knob in knobs::all() {
                let from = if paths.contains(&knob.path) { &alone } else { &all };
                assert_eq!(knob.get(&over), knob.get(from), "{words:?}: {}", knob.path);
            }
            // And a default that is given explicitly wins as well.
        }
        let calm = parse(&["--preset", file, "--wind", "0"]).unwrap().settings;
        assert_eq!((calm.wind.speed, calm.lights.rim), (0.0, 2.0));
    }

    #[test]
    fn what_is_saved_is_the_same_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/mine.toml");
        let file = path.to_str().unwrap();
        let words = ["--style", "bob", "--wind", "8,45", "--density-map", "noise", "--save-preset", file];
        let saved = parse(&words).unwrap();
        assert_eq!(saved.name.as_deref(), Some("mine"));
        assert_eq!(parse(&["--preset", file]).unwrap(), saved);
        // Two grooms, and a style instead of them.
        let words = ["a.tfx", "--head", "h.obj", "--preset", file];
        let other = parse(&words).unwrap();
        assert_eq!((other.source.style, other.source.grooms.len()), (None, 1));
        assert_eq!(other.source.density_map.as_deref(), Some("noise"));
    }

    #[test]
    fn assignments_that_make_no_sense_are_refused() {
        for (text, clause) in [
            ("simulation.drga=5", "the nearest is simulation.drag"),
            ("simulation.drag", "as in simulation.drag=5"),
            ("simulation.drag=lots", "from 0 to 100 1/s"),
            ("simulation.drag=500", "from 0 to 100 1/s"),
            ("=", "the nearest is"),
        ] {
            let error = format!("{:#}", parse(&["--set", text]).unwrap_err());
            assert!(error.contains(clause), "{text}: {error}");
        }
    }
}
