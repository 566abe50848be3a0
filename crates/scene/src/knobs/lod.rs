//! Parameters of the level of detail.

use super::{
    Kind, Knob, Section, Value,
    flags::{Part, flag, value},
    rows,
    value::*,
};
use tresses::lod::{LodMode, LodOptions};

pub(super) const SECTION: Section = Section {
    key: "lod",
    title: "Level of detail",
    about: "How much of the hair is drawn; the strands that remain are wider.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "lod";
    "mode" "Mode" [lod.mode] choice::<LodMode>(),
        flag(flag("lod", "auto|off|FRACTION").common().first(LOD)
            .about("Strands drawn: `auto` by the size of a pixel, `off` for all, or a share of them")),
        "By the size of a pixel at the hair, full detail at any distance, or a fixed share.";
    "fraction" "Share of the strands" [lod_fraction] within(PERCENT, LodOptions::FRACTION).log(),
        "What is drawn when Mode is fraction.";
    "bias" "Bias" [lod.bias] within(PLAIN, LodOptions::BIAS), flag(flag("lod-bias", "STEPS")),
        "1 draws as if the hair were twice as far away, -1 half as far (auto only).";
    "strand_width" "Minimum strand width" [lod.strand_width] within(PIXELS, LodOptions::STRAND_WIDTH).log(), advanced,
        "Strands are left out until the others are this wide; higher is faster and coarser.";
    "curve_error" "Curve error" [lod.curve_error] within(PIXELS, LodOptions::CURVE_ERROR).log(), advanced,
        "How far strands may deviate from their shape when drawn with fewer segments.";
    "slowest" "Longest step" [lod.slowest] within(TIMES, LodOptions::SLOWEST), advanced,
        "How much longer the steps of the physics may get at a distance; 1 keeps the rate.";
    "slow_pixel" "Longer steps from" [lod.slow_pixel] within(MILLIMETRES, LodOptions::SLOW_PIXEL).log(), advanced,
        "Size of a pixel at the hair from which steps get longer.";
    "guides" "Reach of guides" [lod.guides] within(PIXELS, LodOptions::GUIDES).log(), advanced,
        "Guides nearer than this to one that is simulated go with it; 0 simulates all, in a crowd means 3.";
    "substep_pixel" "Fewer substeps from" [lod.substep_pixel] within(MILLIMETRES, LodOptions::SUBSTEP_PIXEL).log(), advanced,
        "Size of a pixel from which half the substeps do, at twice that a quarter; 0 for never, in a crowd for 3.";
    "alone_pixel" "Alone from" [lod.alone_pixel] within(MILLIMETRES, LodOptions::ALONE_PIXEL).log(), advanced,
        "Size of a pixel from which hair feels less of other hair, at twice that none; 0: never, in a crowd 4.";
    "sleep" "Sleep" [lod.sleep] Kind::Toggle, advanced,
        "Hair that has come to rest or is out of view is left as it is; hair of a crowd always is.";
};

const LOD: &[Part] =
    &[value("lod.mode"), value("lod.fraction").sets(&[("lod.mode", Value::Choice("fraction"))])];
