//! Flags are stable: scripts and documentation depend on them.

use super::Cli;
use clap::CommandFactory;

/// Flags of hair settings, shared by `render`, `studio` and `preset`.
const SETTINGS: &[&str] = &[
    "ambient",
    "avoid",
    "classic-shadows",
    "clump",
    "colliders",
    "color",
    "color-map",
    "coverage",
    "curl",
    "curl-curve",
    "curl-map",
    "density-map",
    "environment",
    "environment-strength",
    "environment-rotation",
    "flyaways",
    "frizz",
    "front",
    "guides",
    "gusts",
    "hair-hair",
    "head",
    "head-front",
    "head-unit",
    "head-up",
    "highlight-spread",
    "layers",
    "length-map",
    "light",
    "lightness-spread",
    "lod",
    "lod-bias",
    "lod-maps",
    "melanin",
    "mirror",
    "preset",
    "renderer",
    "roughness",
    "samples",
    "save-preset",
    "set",
    "shade-per",
    "shading",
    "shadow-resolution",
    "shadow-softness",
    "shadows",
    "ssaa",
    "stiffness-map",
    "strands",
    "strays",
    "style",
    "thickness-map",
    "ties",
    "tip-width",
    "unit",
    "up",
    "warmth-spread",
    "width",
    "width-variation",
    "wind",
    "wind-seed",
];
/// Flags that only `render` has.
const RENDER: &[&str] = &[
    "camera",
    "debug",
    "debug-max",
    "distance",
    "distance-to",
    "fps",
    "frames",
    "motion",
    "out",
    "size",
    "zoom",
];
const DEMO: &[&str] = &[
    "clump",
    "color-map",
    "coverage",
    "curl",
    "curl-curve",
    "curl-map",
    "density-map",
    "flyaways",
    "frizz",
    "highlight-spread",
    "layers",
    "length-map",
    "lightness-spread",
    "out",
    "preset",
    "renderer",
    "samples",
    "save-preset",
    "set",
    "ssaa",
    "stiffness-map",
    "strays",
    "style",
    "thickness-map",
    "tip-width",
    "warmth-spread",
    "width",
    "width-variation",
];
const COMPARE: &[&str] =
    &["ambient", "assets", "json", "melanin", "only", "out", "roughness", "samples", "shading", "shadows"];

/// Returns the flags in `names` that `command` lacks.
fn missing<'a>(command: &str, names: &[&'a str]) -> Vec<&'a str> {
    let mut cli = Cli::command();
    cli.build();
    let command = cli.find_subcommand(command).unwrap();
    let has = |name: &&&str| command.get_arguments().any(|arg| arg.get_long() == Some(**name));
    names.iter().filter(|name| !has(name)).copied().collect()
}

#[test]
fn no_flag_is_lost() {
    for command in ["render", "studio", "preset"] {
        assert_eq!(missing(command, SETTINGS), [""; 0], "{command}");
    }
    assert_eq!(missing("render", RENDER), [""; 0]);
    assert_eq!(missing("demo", DEMO), [""; 0]);
    assert_eq!(missing("compare", COMPARE), [""; 0]);
    assert_eq!(missing("compare", &["curl"]), ["curl"], "what is missing would be seen");
}

#[test]
fn command_definition_is_valid() {
    Cli::command().debug_assert();
}

#[test]
fn short_help_is_short_and_long_help_has_topics() {
    let mut cli = Cli::command();
    let render = cli.find_subcommand_mut("render").unwrap();
    let (short, long) = (render.render_help().to_string(), render.render_long_help().to_string());
    let count = |text: &str| text.lines().filter(|line| line.trim_start().starts_with("--")).count();
    assert!((15..=25).contains(&count(&short)), "{short}");
    assert!(count(&long) >= SETTINGS.len() + RENDER.len(), "{long}");
    for topic in ["Hair:", "Style:", "Shading:", "Wind:", "Shadows:", "Maps on the scalp:", "Image:"] {
        assert!(long.contains(&format!("\n{topic}\n")), "{topic} {long}");
    }
    for flag in ["--out", "--size", "--style", "--color", "--curl", "--set"] {
        assert!(short.contains(flag), "{flag}: {short}");
    }
}

#[test]
fn typos_get_a_suggestion() {
    use clap::Parser;
    for (words, name) in [
        (&["tresses", "render", "--styl", "bob"][..], "; did you mean --style?"),
        (&["tresses", "rendr"], "; did you mean render?"),
        (&["tresses", "render", "--camera", "frnt"], "; did you mean front?"),
    ] {
        let Err(error) = Cli::try_parse_from(words) else { panic!("{words:?} is nothing") };
        assert_eq!(super::meant(&error).as_deref(), Some(name), "{error}");
    }
}
