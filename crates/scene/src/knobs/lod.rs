//! Parameters of the level of detail.

use super::{Knob, Section, knob, value::*};
use crate::settings::LodChoice;

pub(super) const SECTION: Section = Section {
    key: "lod",
    title: "Level of detail",
    about: "How much of the hair is drawn, those strands that are left being wider.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "lod.mode",
        "Mode",
        choice::<LodChoice>(),
        Frame,
        "By the size of a pixel at the hair, full detail at any distance, or the share below.",
        lod.mode
    ),
    knob!(
        "lod.fraction",
        "Share of the strands",
        number(PERCENT, 0.01, 100.0),
        Frame,
        "What is drawn with Mode on fraction.",
        lod.fraction
    )
    .log(),
    knob!(
        "lod.bias",
        "Bias",
        number(PLAIN, -8.0, 8.0),
        Frame,
        "1 draws as if the hair were twice as far away, -1 half as far (auto only).",
        lod.bias
    ),
    knob!(
        "lod.strand_width",
        "Least strand width",
        number(PIXELS, 0.001, 10.0),
        Frame,
        "Strands are left out until the others are this wide; higher is faster and coarser.",
        lod.strand_width
    )
    .log(),
    knob!(
        "lod.curve_error",
        "Curve error",
        number(PIXELS, 0.0, 100.0),
        Frame,
        "How far strands may stray from their shape when drawn with fewer segments.",
        lod.curve_error
    )
    .log(),
    knob!(
        "lod.slowest",
        "Slowest step",
        number(TIMES, 1.0, 4.0),
        Frame,
        "How much longer the steps of the physics may get far away; 1 keeps the rate.",
        lod.slowest
    ),
    knob!(
        "lod.slow_pixel",
        "Slower from",
        number(MILLIMETRES, 0.001, 1000.0),
        Frame,
        "Size of a pixel at the hair from which on steps get longer.",
        lod.slow_pixel
    )
    .log(),
];
