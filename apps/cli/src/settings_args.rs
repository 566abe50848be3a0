//! Options for all hair settings, and their effect on a preset.

use crate::{
    args::SourceArgs,
    flags::{All, CompanionFlags, FlagSet, RowFlags},
    preset_args::PresetArgs,
};
use anyhow::{Result, ensure};
use tresses_scene::{
    Preset, Settings, Value, knobs,
    settings::{ClassicBlending, HairColor},
};

/// Options for everything that a preset stores. Options override the preset, and the preset overrides the defaults.
#[derive(clap::Args, Debug, Default)]
pub struct SettingsArgs {
    #[command(flatten)]
    pub source: SourceArgs,
    #[command(flatten)]
    pub preset: PresetArgs,
    #[command(flatten)]
    pub companion_flags: CompanionFlags,
    #[command(flatten)]
    pub rows: RowFlags<All>,
}

impl SettingsArgs {
    /// Returns the preset with all options applied.
    pub fn preset(&self) -> Result<Preset> {
        let mut preset = self.preset.open()?;
        self.source.apply(&mut preset);
        apply(&self.companion_flags, &self.rows, &mut preset)?;
        self.preset.finish(&mut preset)?;
        Ok(preset)
    }
}

/// Applies the given parameters to `settings`. Rejects pigments and roughness for a shading model without them.
pub fn apply_rows<R: FlagSet>(rows: &RowFlags<R>, settings: &mut Settings) -> Result<()> {
    rows.apply(settings)?;
    let model = knobs::find("shading.model").map(|row| row.get(settings));
    for name in ["melanin", "roughness"] {
        ensure!(
            !(rows.gives(name) && rows.gives("shading")) || model != Some(Value::Choice("kajiya-kay")),
            "--{name} needs --shading fiber"
        );
    }
    Ok(())
}

/// Applies the given files and parameters to `preset`. Rejects contradictions.
pub fn apply(companion_flags: &CompanionFlags, rows: &RowFlags<All>, preset: &mut Preset) -> Result<()> {
    ensure!(
        !(rows.gives("color") && rows.gives("melanin")),
        "--color and --melanin both set the hair color: give one of them"
    );
    ensure!(
        !(rows.gives("color") && companion_flags.gives("color_map")),
        "--color and --color-map both set the hair color: give one of them"
    );
    let Preset { source, settings, .. } = preset;
    companion_flags.apply(source);
    apply_rows(rows, settings)?;
    if companion_flags.gives("color_map") {
        settings.shading.color = HairColor::File;
    } else if rows.gives("color") {
        source.color_map = None;
    }
    ensure!(
        source.environment.is_some()
            || !(rows.gives("environment-rotation") || rows.gives("environment-strength")),
        "--environment-rotation and --environment-strength need --environment"
    );
    let peels = settings.renderer.coverage == ClassicBlending::Peel;
    ensure!(!rows.gives("layers") || peels, "--layers needs --coverage peel");
    settings.renderer(16)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use tresses::renderer::Renderer;
    use tresses_scene::preset::Extent;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        settings: SettingsArgs,
    }

    fn parse(words: &[&str]) -> Result<Preset> {
        Command::try_parse_from([&["x"], words].concat())?.settings.preset()
    }

    #[test]
    fn defaults_match_the_library() {
        assert_eq!(parse(&[]).unwrap(), Preset::default());
    }

    /// Options with a value other than the default, and the parameters that they change.
    const OPTIONS: &[(&[&str], &[&str])] = &[
        (&["--strands", "500"], &["style.strands"]),
        (&["--grow", "900"], &["style.grow"]),
        (&["--guides", "30"], &["style.guides"]),
        (&["--guides", "all"], &["style.all_guides"]),
        (&["--curl", "waves", "--set", "style.curl_radius=7mm"], &["style.curl", "style.curl_radius"]),
        (&["--set", "style.curl_stretch=on"], &["style.curl_stretch"]),
        (&["--clump", "0.4"], &["style.clump"]),
        (&["--frizz", "1mm"], &["style.frizz"]),
        (&["--strays", "0.5,3mm"], &["style.strays", "style.stray_distance"]),
        (&["--flyaways", "0.5"], &["style.flyaways"]),
        (&["--width", "90um"], &["style.width"]),
        (&["--width-variation", "0.1"], &["style.width_variation"]),
        (&["--length", "0.5"], &["style.length"]),
        (&["--tip-width", "0.5"], &["style.tip_width"]),
        (&["--lightness-spread", "0.5"], &["shading.lightness_spread"]),
        (&["--warmth-spread", "0.5"], &["shading.warmth_spread"]),
        (&["--highlight-spread", "0.5"], &["shading.highlight_spread"]),
        (&["--color", "red"], &["shading.color"]),
        (&["--color", "123456"], &["shading.color", "shading.srgb"]),
        (&["--melanin", "3,1"], &["shading.color", "shading.eumelanin", "shading.pheomelanin"]),
        (&["--roughness", "0.5,0.6"], &["shading.roughness_along", "shading.roughness_around"]),
        (&["--shading", "kajiya-kay"], &["shading.model"]),
        (&["--renderer", "masks"], &["renderer.kind"]),
        (&["--samples", "4"], &["renderer.samples"]),
        (&["--coverage", "peel"], &["renderer.coverage"]),
        (&["--layers", "7"], &["renderer.layers"]),
        (&["--shade-per", "pixel"], &["renderer.rate"]),
        (&["--classic-shadows", "opaque"], &["renderer.shadows"]),
        (&["--ssaa", "2"], &["renderer.ssaa"]),
        (&["--hair-hair", "off"], &["simulation.hair_hair"]),
        (&["--wind", "8,90"], &["wind.speed", "wind.direction"]),
        (&["--gusts", "0.5"], &["wind.gusts"]),
        (&["--wind-seed", "5"], &["wind.seed"]),
        (&["--avoid", "off"], &["avoidance.mode"]),
        (&["--lod", "0.5"], &["lod.mode", "lod.fraction"]),
        (&["--lod-bias", "-1"], &["lod.bias"]),
        (&["--shadows", "off"], &["shadows.enabled"]),
        (&["--shadow-resolution", "512"], &["shadows.resolution"]),
        (&["--shadow-softness", "5"], &["shadows.softness"]),
        (&["--ambient", "off"], &["shadows.ambient"]),
        (&["--set", "simulation.drag=5"], &["simulation.drag"]),
        (&["--set", "style.frizz=1 mm", "--set", "lights.follow=off"], &["style.frizz", "lights.follow"]),
    ];

    #[test]
    fn options_override_presets_and_presets_override_defaults() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preset.toml");
        let file = path.to_str().unwrap();
        let mut all = Settings::default();
        all.set_wind_speed(3.0);
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
            // An explicit default also overrides the preset.
        }
        let calm = parse(&["--preset", file, "--wind", "0"]).unwrap().settings;
        assert_eq!((calm.wind_speed(), calm.lights.rim), (0.0, 2.0));
    }

    #[test]
    fn lights_replace_those_of_a_preset() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lit.toml");
        let file = path.to_str().unwrap();
        let words = ["--light", "-10,20", "--light", "90,0,4", "--light", "point position=0.3,0.1,0.2"];
        let saved = parse(&[&words[..], &["--save-preset", file]].concat()).unwrap();
        let list = &saved.settings.lights.list;
        let kinds: Vec<_> = list.iter().map(|light| (light.kind.name(), light.intensity)).collect();
        assert_eq!(kinds, [("distant", 2.0), ("distant", 4.0), ("point", 1.0)]);
        assert_eq!(list[0].azimuth, -10f32.to_radians());
        assert_eq!(parse(&["--preset", file]).unwrap(), saved);
        let other = parse(&["--preset", file, "--light", "sphere position=0,1,0 radius=0.1"]).unwrap();
        assert_eq!(other.settings.lights.list.len(), 1);
        let none = parse(&["--preset", file, "--set", "lights.list="]).unwrap();
        assert!(none.settings.lights.list.is_empty());
        let error = format!("{:#}", parse(&["--light", "spot position=0,1,0"]).unwrap_err());
        assert!(error.contains("a spot light needs target"), "{error}");
    }

    #[test]
    fn saved_preset_round_trips() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/mine.toml");
        let file = path.to_str().unwrap();
        let words = ["--style", "bob", "--wind", "8,45", "--density-map", "noise", "--save-preset", file];
        let saved = parse(&words).unwrap();
        assert_eq!(saved.name.as_deref(), Some("mine"));
        assert_eq!(parse(&["--preset", file]).unwrap(), saved);
        // Grooms given on the command line replace the preset's style.
        let words = ["a.tfx", "--head", "h.obj", "--preset", file];
        let other = parse(&words).unwrap();
        assert_eq!((other.source.style, other.source.grooms.len()), (None, 1));
        assert_eq!(other.source.density_map.as_deref(), Some("noise"));
    }

    #[test]
    fn invalid_assignments_are_errors() {
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

    #[test]
    fn environment_is_stored_in_a_preset() {
        let words =
            ["--environment", "sky.hdr", "--environment-rotation", "-90", "--environment-strength", "2"];
        let preset = parse(&words).unwrap();
        assert_eq!(preset.source.environment.as_deref(), Some("sky.hdr"));
        let lights = &preset.settings.lights;
        assert_eq!((lights.environment_rotation, lights.environment_strength), (-90f32.to_radians(), 2.0));
        assert!(parse(&["--environment-rotation", "20"]).is_err(), "there is nothing to turn");
    }

    #[test]
    fn contradictory_options_are_errors() {
        for words in [
            &["--color", "red", "--melanin", "1"][..],
            &["--color", "red", "--color-map", "a.png"],
            &["--shading", "kajiya-kay", "--roughness", "0.3"],
            &["--layers", "2", "--samples", "4"],
            &["--layers", "2", "--renderer", "masks"],
            &["--layers", "2", "--coverage", "alpha"],
            &["--renderer", "tiles", "--shade-per", "pixel"],
            &["--renderer", "masks", "--coverage", "alpha"],
            &["--coverage", "mask"],
            &["--shadows", "opaque"],
            &["--shadows-per-pixel"],
            &["--coverage", "alpha", "--samples", "1"],
            &["--coverage", "peel", "--samples", "4"],
            &["--light", "1,100"],
            &["--light", "point"],
            &["--light", "ring position=0,1,1"],
            &["--set", "lights.lamp1_strength=2"],
            &["--wind", "3", "--wind", "4"],
        ] {
            assert!(parse(words).is_err(), "{words:?}");
        }
        let both = parse(&["--renderer", "masks", "--samples", "4", "--color-map", "a.png"]).unwrap();
        assert_eq!(both.settings.renderer(16).unwrap(), Renderer::masks(4));
    }

    #[test]
    fn curl_and_renderer_replace_those_of_a_preset() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preset.toml");
        let file = path.to_str().unwrap();
        let curls = ["--set", "style.curl_radius=7mm", "--set", "style.curl_flatness=30%"];
        let words = [&curls[..], &["--coverage", "peel", "--layers", "8", "--ssaa", "2"]].concat();
        parse(&[&words[..], &["--save-preset", file]].concat()).unwrap();
        let shrunk = ["--preset", file, "--set", "style.curl_shrink=20%"];
        let other =
            parse(&[&shrunk[..], &["--curl", "waves", "--renderer", "masks", "--samples", "4"]].concat())
                .unwrap();
        let settings = &other.settings;
        assert!(settings.gives("style.curl_shrink") && !settings.gives("style.curl_flatness"));
        assert_eq!(settings.renderer(4).unwrap(), Renderer::masks(4));
        assert_eq!(
            (settings.renderer.layers, settings.ssaa),
            (4, 2),
            "options of the other renderer are reset"
        );
        let varied = parse(&shrunk).unwrap();
        assert!(varied.settings.gives("style.curl_flatness"), "the same curl, varied");
    }
}
