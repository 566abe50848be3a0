//! Parameters of the wind.

use super::{
    Knob, Section,
    flags::{Missing, Place, flag, place, value},
    rows,
    value::*,
};

pub(super) const SECTION: Section = Section {
    key: "wind",
    title: "Wind",
    about: "What the air does far from the head, and how finely the air around the hair is computed.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "wind";
    "speed" "Speed" [wind.speed] number(METRES_PER_SECOND, 0.0, 100.0).log(),
        flag(flag("wind", "SPEED[,DEGREES]").common().then(WIND)),
        "Mean speed: 2 m/s stirs leaves, 8 a flag, 20 is a storm. 0 costs nothing.";
    "direction" "Direction" [wind.direction] number(DEGREES, -360.0, 360.0),
        "Where the wind comes from: the front (0), the left of the head (90), the back (180).";
    "turbulence" "Gusts" [simulation.wind.turbulence] number(PERCENT, 0.0, 100.0),
        flag(flag("gusts", "INTENSITY")),
        "Standard deviation over mean speed: 10 % over water, 20 over land, 40 between houses.";
    "gust_length" "Gust length" [simulation.wind.gust_length] number(METRES, 0.05, 100.0).log(),
        "Size of the gusts; one passes in about this length over the speed.";
    "seed" "Seed" [simulation.wind.seed] integer(PLAIN, 0, 9999, 1), advanced, flag(flag("wind-seed", "N")),
        "Another number gives other gusts.";
    "cells" "Grid cells" [simulation.wind.cells] integer(PLAIN, 0, 96, 8), advanced,
        "Cells of the grid of air along each axis; more follow the head closer. 0: the same wind everywhere.";
    "room" "Grid size" [simulation.wind.room] number(TIMES, 1.2, 20.0).log(), advanced,
        "Edge of the grid of air over the size of the hair.";
};

const WIND: &[Place] = &[place(value("wind.direction"), Missing::Kept)];
