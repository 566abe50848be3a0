//! Parameters of the wind.

use super::{
    Access, Knob, Section, Value,
    flags::{Missing, Slot, flag, place, value},
    rows,
    value::*,
};
use tresses::wind::{MAX_CELLS, Wind};

pub(super) const SECTION: Section = Section {
    key: "wind",
    title: "Wind",
    about: "What the air does far from the head, and how finely the air around the hair is computed.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "wind";
    "speed" "Speed" {SPEED} within(METRES_PER_SECOND, Wind::SPEED).log(),
        flag(flag("wind", "SPEED[,DEGREES]").common().then(WIND)),
        "Mean speed: 2 m/s stirs leaves, 8 a flag, 20 is a storm. 0 costs nothing.";
    "direction" "Direction" [wind_direction] number(DEGREES, -360.0, 360.0),
        "Where the wind comes from: the front (0), the left of the head (90), the back (180).";
    "gusts" "Gusts" [simulation.wind.gusts] within(PERCENT, Wind::GUSTS),
        flag(flag("gusts", "INTENSITY")),
        "Standard deviation over mean speed: 10 % over water, 20 over land, 40 between houses.";
    "gust_length" "Gust length" [simulation.wind.gust_length] within(METRES, Wind::GUST_LENGTH).log(),
        "Size of the gusts; one passes in about this length over the speed.";
    "seed" "Seed" [simulation.wind.seed] integer(PLAIN, 0, 9999, 1), advanced, flag(flag("wind-seed", "N")),
        "Another number gives other gusts.";
    "cells" "Grid cells" [simulation.wind.cells] integer(PLAIN, 0, MAX_CELLS, 8), advanced,
        "Cells of the grid of air along each axis; more follow the head closer. 0: the same wind everywhere.";
    "room" "Grid size" [simulation.wind.room] within(TIMES, Wind::ROOM).log(), advanced,
        "Edge of the grid of air over the size of the hair.";
};

const WIND: &[Slot] = &[place(value("wind.direction"), Missing::Kept)];

/// The speed of wind from the front.
const SPEED: Access = Access {
    get: |settings| Value::Number(settings.wind_speed()),
    set: |settings, value| {
        if let Value::Number(speed) = value {
            settings.set_wind_speed(speed);
        }
    },
    copy: |to, from| to.simulation.wind.velocity = from.simulation.wind.velocity,
};
