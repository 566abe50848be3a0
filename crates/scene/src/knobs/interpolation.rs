//! Parameters of how drawn strands follow guides around obstacles.

use super::{Knob, Section, knob, value::*};
use tresses::avoid::AvoidMode;

pub(super) const SECTION: Section = Section {
    key: "interpolation",
    title: "Interpolation",
    about: "What drawn strands do where they would enter the head or another obstacle.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "interpolation.avoid",
        "Avoid obstacles",
        choice::<AvoidMode>(),
        Frame,
        "Nothing, move the vertices inside out, or let the whole strand follow its nearest guide.",
        interpolation.mode
    ),
    knob!(
        "interpolation.tolerance",
        "Tolerance",
        number(MILLIMETRES, 0.0, 10.0),
        Frame,
        "How much nearer than its clearance a vertex may come; raise it where strands change over for nothing.",
        interpolation.tolerance
    ),
    knob!(
        "interpolation.zone",
        "Zone",
        number(CENTIMETRES, 0.0, 50.0),
        Frame,
        "Length of hair over which a strand changes over; longer is smoother.",
        interpolation.zone
    ),
    knob!(
        "interpolation.tightness",
        "Tightness",
        number(PERCENT, 0.0, 100.0),
        Frame,
        "How much such strands are drawn onto their guide; raise it where they still enter.",
        interpolation.tightness
    ),
    knob!(
        "interpolation.fade_in",
        "Fade in",
        number(SECONDS, 0.0, 5.0),
        Frame,
        "Time in which a strand changes over; shorter enters less, longer moves less.",
        interpolation.fade_in
    ),
    knob!(
        "interpolation.fade_out",
        "Fade out",
        number(SECONDS, 0.0, 5.0),
        Frame,
        "Time in which it changes back.",
        interpolation.fade_out
    ),
    knob!(
        "interpolation.speed",
        "Speed",
        number(METRES_PER_SECOND, 0.0, 10.0),
        Frame,
        "How fast the change-over follows the first hit along the strand.",
        interpolation.speed
    )
    .log(),
];
