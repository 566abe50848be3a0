//! Parameters of the level of detail.

use super::{
    Knob, Section, Value,
    flags::{Part, flag, value},
    rows,
    value::*,
};
use tresses::lod::LodMode;

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
    "fraction" "Share of the strands" [lod_fraction] number(PERCENT, 0.01, 100.0).log(),
        "What is drawn when Mode is fraction.";
    "bias" "Bias" [lod.bias] number(PLAIN, -8.0, 8.0), flag(flag("lod-bias", "STEPS")),
        "1 draws as if the hair were twice as far away, -1 half as far (auto only).";
    "strand_width" "Minimum strand width" [lod.strand_width] number(PIXELS, 0.001, 10.0).log(), advanced,
        "Strands are left out until the others are this wide; higher is faster and coarser.";
    "curve_error" "Curve error" [lod.curve_error] number(PIXELS, 0.0, 100.0).log(), advanced,
        "How far strands may deviate from their shape when drawn with fewer segments.";
    "slowest" "Longest step" [lod.slowest] number(TIMES, 1.0, 4.0), advanced,
        "How much longer the steps of the physics may get at a distance; 1 keeps the rate.";
    "slow_pixel" "Longer steps from" [lod.slow_pixel] number(MILLIMETRES, 0.001, 1000.0).log(), advanced,
        "Size of a pixel at the hair from which steps get longer.";
};

const LOD: &[Part] =
    &[value("lod.mode"), value("lod.fraction").sets(&[("lod.mode", Value::Choice("fraction"))])];
