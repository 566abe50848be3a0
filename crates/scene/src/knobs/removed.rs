//! Parameters and flags of earlier versions, for errors that name their successors.

/// Path of a removed parameter, and its successor.
const ROWS: &[(&str, &str)] = &[
    (
        "edges.coverage",
        "renderer.kind (tiles, masks or classic) and, for classic, renderer.coverage (peel or alpha)",
    ),
    ("edges.layers", "renderer.layers"),
    ("edges.min_width", "renderer.min_width"),
    ("edges.samples", "renderer.samples"),
    ("edges.ssaa", "renderer.ssaa"),
    ("lights.lamp1_strength", LAMPS),
    ("lights.lamp1_azimuth", LAMPS),
    ("lights.lamp1_elevation", LAMPS),
    ("lights.lamp2_strength", LAMPS),
    ("lights.lamp2_azimuth", LAMPS),
    ("lights.lamp2_elevation", LAMPS),
    ("shading.rate", "renderer.rate, which only renderer.kind = \"classic\" has"),
    (
        "shadows.method",
        "shadows.enabled = false for no shadows, or renderer.shadows (opaque, absorption or deep), which only \
         renderer.kind = \"classic\" has",
    ),
    (
        "shadows.per_pixel",
        "renderer.rate = \"pixel\", which only renderer.kind = \"classic\" has; its shadows are per vertex",
    ),
];

/// Successor of the parameters of two lights. Presets with these keys still open: `preset::lights`.
const LAMPS: &str = "lights.list, a light as in lights.list=\"distant azimuth=90 elevation=30 intensity=2\"";

/// Removed values of flags: flag, value, successor.
const VALUES: &[(&str, &str, &str)] = &[
    ("coverage", "tiles", "--renderer tiles"),
    ("coverage", "mask", "--renderer masks"),
    ("shadows", "absorption", "--renderer classic --classic-shadows absorption"),
    ("shadows", "deep", "--shadows on"),
    ("shadows", "opaque", "--renderer classic --classic-shadows opaque"),
];

/// Removed flags without a value, and their successors.
pub const FLAGS: &[(&str, &str)] =
    &[("shadows-per-pixel", "--shade-per pixel, whose shadows are per vertex")];

/// Returns the successor of the removed parameter at `path`.
pub(super) fn row(path: &str) -> Option<&'static str> {
    ROWS.iter().find(|(removed, _)| *removed == path).map(|(_, successor)| *successor)
}

/// Returns whether all parameters of a section were removed.
pub(crate) fn has_section(key: &str) -> bool {
    ROWS.iter().any(|(path, _)| path.split_once('.').is_some_and(|(section, _)| section == key))
}

/// Returns the successor of a removed value of a flag.
pub(super) fn value(flag: &str, value: &str) -> Option<&'static str> {
    let is = |(name, removed, _): &&(&str, &str, &str)| *name == flag && *removed == value;
    VALUES.iter().find(is).map(|(_, _, successor)| *successor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::knobs;

    #[test]
    fn successors_exist() {
        let exists = |path: &str| path == knobs::light_list::PATH || knobs::find(path).is_some();
        for (path, successor) in ROWS {
            assert!(knobs::find(path).is_none(), "{path} is not removed");
            let error = knobs::named(path).unwrap_err();
            assert_eq!(error, format!("there is no {path}; use {successor}"));
            let words = successor.split(|c: char| !c.is_alphanumeric() && c != '.' && c != '_');
            let paths: Vec<_> = words.filter(|word| word.contains('.')).collect();
            assert!(!paths.is_empty() && paths.iter().all(|path| exists(path)), "{successor}");
        }
        for (flag, value, successor) in VALUES {
            let row = knobs::all().find(|row| row.flag.is_some_and(|known| known.name == *flag)).unwrap();
            assert_eq!(row.read_flag(value).unwrap_err(), format!("use {successor}"));
        }
    }
}
