//! Parameters of how drawn strands avoid obstacles.

use super::{Knob, Section, flags::flag, rows, value::*};
use tresses::avoid::{AvoidMode, AvoidOptions};

pub(super) const SECTION: Section = Section {
    key: "avoidance",
    title: "Avoidance",
    about: "What drawn strands do where they would enter the head or another obstacle.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "avoidance";
    "mode" "Avoid obstacles" [avoidance.mode] choice::<AvoidMode>(), flag(flag("avoid", "MODE")),
        "Do nothing, move the vertices inside out, or let the whole strand follow its nearest guide.";
    "tightness" "Tightness" [avoidance.tightness] within(PERCENT, AvoidOptions::TIGHTNESS),
        "How closely such strands are drawn to their guide; raise it where they still enter.";
    "tolerance" "Tolerance" [avoidance.tolerance] within(MILLIMETRES, AvoidOptions::TOLERANCE), advanced,
        "How far below its clearance a vertex may come; raise it where strands are changed without need.";
    "zone" "Zone" [avoidance.zone] within(CENTIMETRES, AvoidOptions::ZONE), advanced,
        "Length of hair over which a strand moves to its guide; longer is smoother.";
    "fade_in" "Fade in" [avoidance.fade_in] within(SECONDS, AvoidOptions::FADE), advanced,
        "Time in which a strand moves to its guide; shorter enters less, longer moves less.";
    "fade_out" "Fade out" [avoidance.fade_out] within(SECONDS, AvoidOptions::FADE), advanced,
        "Time in which it moves back.";
    "speed" "Speed" [avoidance.speed] within(METRES_PER_SECOND, AvoidOptions::SPEED).log(), advanced,
        "How fast the start of the zone follows the first hit along the strand.";
};
