//! Parameters of how drawn strands avoid obstacles.

use super::{Knob, Section, flags::flag, rows, value::*};
use tresses::avoid::AvoidMode;

pub(super) const SECTION: Section = Section {
    key: "interpolation",
    title: "Avoidance",
    about: "What drawn strands do where they would enter the head or another obstacle.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "interpolation";
    "avoid" "Avoid obstacles" [interpolation.mode] choice::<AvoidMode>(), flag(flag("avoid", "MODE")),
        "Do nothing, move the vertices inside out, or let the whole strand follow its nearest guide.";
    "tightness" "Tightness" [interpolation.tightness] number(PERCENT, 0.0, 100.0),
        "How closely such strands are drawn to their guide; raise it where they still enter.";
    "tolerance" "Tolerance" [interpolation.tolerance] number(MILLIMETRES, 0.0, 10.0), advanced,
        "How far below its clearance a vertex may come; raise it where strands are changed without need.";
    "zone" "Zone" [interpolation.zone] number(CENTIMETRES, 0.0, 50.0), advanced,
        "Length of hair over which a strand moves to its guide; longer is smoother.";
    "fade_in" "Fade in" [interpolation.fade_in] number(SECONDS, 0.0, 5.0), advanced,
        "Time in which a strand moves to its guide; shorter enters less, longer moves less.";
    "fade_out" "Fade out" [interpolation.fade_out] number(SECONDS, 0.0, 5.0), advanced,
        "Time in which it moves back.";
    "speed" "Speed" [interpolation.speed] number(METRES_PER_SECOND, 0.0, 10.0).log(), advanced,
        "How fast the start of the zone follows the first hit along the strand.";
};
