//! Parameters of the level of detail.

use super::{
    Knob, Section, Value, ValueKind,
    flags::{FlagValue, flag, value},
    rows,
    value::*,
};
use tresses::{LodMode, LodOptions};

pub(super) const SECTION: Section = Section {
    key: "lod",
    title: "Level of detail",
    about: "Number of strands drawn and simulation rate by distance; fewer strands are drawn wider.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "lod";
    "mode" "Mode" [lod.mode] choice::<LodMode>(),
        flag(flag("lod", "auto|off|FRACTION").common().first(LOD)
            .about("Strands drawn: `auto` by the pixel size at the hair, `off` for all, or a fraction of them")),
        also("level of detail; hair lod"),
        "Level of detail by the pixel size at the hair, full detail at any distance, or a fixed fraction.";
    "fraction" "Fraction of strands" [lod_fraction] within(PERCENT, LodOptions::FRACTION).log(),
        also("lod percent; lod strand reduction"),
        "Fraction of strands drawn, if Mode is fraction.";
    "bias" "Bias" [lod.bias] within(PLAIN, LodOptions::BIAS), flag(flag("lod-bias", "STEPS")),
        "Level offset: 1 draws as if the hair were twice as far away, -1 half as far (auto only).";
    "strand_width" "Minimum strand width" [lod.strand_width] within(PIXELS, LodOptions::STRAND_WIDTH).log(), advanced,
        "Width to which strands are widened as others are dropped; higher is faster and coarser.";
    "curve_error" "Curve error" [lod.curve_error] within(PIXELS, LodOptions::CURVE_ERROR).log(), advanced,
        "Maximum deviation of strands that are drawn with fewer segments.";
    "slowest" "Longest step" [lod.slowest] within(TIMES, LodOptions::SLOWEST), advanced,
        "Maximum factor on the length of a simulation step at a distance; 1 keeps the rate.";
    "slow_pixel" "Longer steps from" [lod.slow_pixel] within(MILLIMETERS, LodOptions::SLOW_PIXEL).log(), advanced,
        "Pixel size at the hair from which simulation steps get longer.";
    "guides" "Guide distance" [lod.guides] within(PIXELS, LodOptions::GUIDES).log(), advanced,
        "Guides nearer than this to a simulated guide follow it; 0 simulates all, or means 3 in a crowd.";
    "substep_pixel" "Fewer substeps from" [lod.substep_pixel] within(MILLIMETERS, LodOptions::SUBSTEP_PIXEL).log(), advanced,
        "Pixel size that halves the substeps; twice that quarters them. 0: never, or 3 in a crowd.";
    "collision_pixel" "Less self-collision from" [lod.collision_pixel]
        within(MILLIMETERS, LodOptions::COLLISION_PIXEL).log(), advanced,
        "Pixel size from which self-collision fades; it is off at twice that. 0: never, or 4 in a crowd.";
    "sleep" "Sleep" [lod.can_sleep] ValueKind::Toggle, advanced,
        "Pauses the simulation of hair at rest or out of view; always on in a crowd.";
};

const LOD: &[FlagValue] =
    &[value("lod.mode"), value("lod.fraction").sets(&[("lod.mode", Value::Choice("fraction"))])];
