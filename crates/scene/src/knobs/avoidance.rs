//! Parameters of strand collision: how render strands avoid colliders.

use super::{Knob, Section, flags::flag, rows, value::*};
use tresses::{AvoidMode, AvoidOptions};

pub(super) const SECTION: Section = Section {
    key: "avoidance",
    title: "Strand collision",
    about: "Collision of render strands with the head and other colliders.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "avoidance";
    "mode" "Collision mode" [avoidance.mode] choice::<AvoidMode>(), flag(flag("avoid", "MODE")),
        also("render strand collision"),
        "Response of strands that hit a collider: none, move vertices out, or follow the nearest guide.";
    "tightness" "Tightness" [avoidance.tightness] within(PERCENT, AvoidOptions::TIGHTNESS),
        "Pull of colliding strands toward their guide; raise it if they still penetrate.";
    "tolerance" "Tolerance" [avoidance.tolerance] within(MILLIMETERS, AvoidOptions::TOLERANCE), advanced,
        "Depth below its clearance that a vertex may reach; raise it if strands change unnecessarily.";
    "zone" "Blend length" [avoidance.zone] within(CENTIMETERS, AvoidOptions::ZONE), advanced,
        "Length of hair over which a strand blends to its guide; longer is smoother.";
    "fade_in" "Fade in" [avoidance.fade_in] within(SECONDS, AvoidOptions::FADE), advanced,
        "Time in which a strand blends to its guide; shorter penetrates less, longer moves less.";
    "fade_out" "Fade out" [avoidance.fade_out] within(SECONDS, AvoidOptions::FADE), advanced,
        "Time in which a strand blends back.";
    "speed" "Speed" [avoidance.speed] within(METERS_PER_SECOND, AvoidOptions::SPEED).log(), advanced,
        "Speed at which the start of the blend follows the first hit along the strand.";
};
