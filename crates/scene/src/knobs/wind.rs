//! Parameters of the wind.

use super::{
    Access, Knob, Section, Value,
    flags::{OmittedValue, Slot, flag, slot, value},
    rows,
    value::*,
};
use tresses::{Wind, low_level::MAX_CELLS};

pub(super) const SECTION: Section = Section {
    key: "wind",
    title: "Wind",
    about: "Wind far from the head, and the grid that resolves the air around the hair.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "wind";
    "speed" "Speed" {SPEED} within(METERS_PER_SECOND, Wind::SPEED).log(),
        flag(flag("wind", "SPEED[,DEGREES]").common().then(WIND)),
        also("air velocity; wind strength; wind magnitude"),
        "Mean speed: 2 m/s stirs leaves, 8 a flag, 20 is a storm. 0 costs nothing.";
    "direction" "Direction" [wind_direction] number(DEGREES, -360.0, 360.0),
        also("wind angle"),
        "Direction that the wind comes from: front (0), left of the head (90), back (180).";
    "gusts" "Gusts" [simulation.wind.gusts] within(PERCENT, Wind::GUSTS),
        flag(flag("gusts", "INTENSITY")),
        also("turbulence; wind noise"),
        "Standard deviation over mean speed: 10 % over water, 20 over land, 40 between houses.";
    "gust_length" "Gust length" [simulation.wind.gust_length] within(METERS, Wind::GUST_LENGTH).log(),
        "Size of gusts; a gust passes in about this length over the wind speed.";
    "seed" "Seed" [simulation.wind.seed] integer(PLAIN, 0, 9999, 1), advanced, flag(flag("wind-seed", "N")),
        "Random seed of the gusts.";
    "cells" "Grid cells" [simulation.wind.resolution] integer(PLAIN, 0, MAX_CELLS, 8), advanced,
        "Cells of the air grid along each axis; more resolve the flow around the head. 0: uniform wind.";
    "grid_size" "Grid size" [simulation.wind.grid_size] within(TIMES, Wind::GRID_SIZE).log(), advanced,
        "Edge of the air grid relative to the size of the hair.";
};

const WIND: &[Slot] = &[slot(value("wind.direction"), OmittedValue::Kept)];

/// Wind speed along -Z; a separate parameter sets the direction.
const SPEED: Access = Access {
    get: |settings| Value::Number(settings.wind_speed()),
    set: |settings, value| {
        if let Value::Number(speed) = value {
            settings.set_wind_speed(speed);
        }
    },
    copy: |to, from| to.simulation.wind.velocity = from.simulation.wind.velocity,
};
