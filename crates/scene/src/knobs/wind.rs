//! Parameters of the wind.

use super::{Knob, Section, knob, value::*};

pub(super) const SECTION: Section = Section {
    key: "wind",
    title: "Wind",
    about: "What the air does far from the head, and how finely the air around the hair is computed.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "wind.speed",
        "Speed",
        number(METRES_PER_SECOND, 0.0, 100.0),
        Frame,
        "Mean speed; 2 stirs leaves, 8 a flag, 20 is a storm. 0 costs nothing.",
        wind.speed
    )
    .log(),
    knob!(
        "wind.direction",
        "Direction",
        number(DEGREES, -360.0, 360.0),
        Frame,
        "Where it comes from: the front (0), over the head's left (90), the back (180).",
        wind.direction
    ),
    knob!(
        "wind.turbulence",
        "Gusts",
        number(PERCENT, 0.0, 100.0),
        Frame,
        "Standard deviation over mean speed; 10 over water, 20 over land, 40 between houses.",
        simulation.wind.turbulence
    ),
    knob!(
        "wind.gust_length",
        "Gust length",
        number(METRES, 0.05, 100.0),
        Frame,
        "Size of the gusts; one passes in about this over the speed.",
        simulation.wind.gust_length
    )
    .log(),
    knob!(
        "wind.seed",
        "Seed",
        integer(PLAIN, 0, 9999, 1),
        Frame,
        "Another number, other gusts.",
        simulation.wind.seed
    ),
    knob!(
        "wind.cells",
        "Cells of the air",
        integer(PLAIN, 0, 96, 8),
        Frame,
        "Cells along each axis; finer air flows closer around the head. 0: the same wind everywhere.",
        simulation.wind.cells
    ),
    knob!(
        "wind.room",
        "Room around the hair",
        number(TIMES, 1.2, 20.0),
        Frame,
        "Edge of the grid of air over the size of the hair.",
        simulation.wind.room
    )
    .log(),
];
