//! Former names of parameters and flags. Presets, `--set`, queries of the page and Python read both names.

/// Former path of a parameter, and its path.
const ROWS: &[(&str, &str)] = &[
    ("style.stray_reach", "style.stray_distance"),
    ("style.flyaway_reach", "style.flyaway_distance"),
    ("lights.turn", "lights.rotation"),
    ("lights.environment_turn", "lights.environment_rotation"),
    ("wind.room", "wind.grid_size"),
    ("simulation.cohesion_reach", "simulation.cohesion_distance"),
    ("lod.alone_pixel", "lod.collision_pixel"),
];

/// Former name of a flag, and its name.
pub const FLAGS: &[(&str, &str)] = &[("environment-turn", "environment-rotation")];

/// Returns the path of the parameter that `path` names, possibly by its former name.
pub(super) fn current(path: &str) -> &str {
    ROWS.iter().find(|(former, _)| *former == path).map_or(path, |(_, current)| current)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::knobs;

    #[test]
    fn former_names_find_their_rows() {
        for (former, current) in ROWS {
            assert!(knobs::all().all(|row| row.path != *former), "{former} is not renamed");
            assert_eq!(knobs::find(former).map(|row| row.path), Some(*current));
        }
        for (former, current) in FLAGS {
            let mut flags = knobs::all().filter_map(|row| row.flag);
            assert!(flags.any(|flag| flag.name == *current), "{current}");
            assert!(knobs::all().filter_map(|row| row.flag).all(|flag| flag.name != *former), "{former}");
        }
    }
}
