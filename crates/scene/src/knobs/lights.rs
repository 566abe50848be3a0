//! Parameters of lights.

use super::{Knob, Section, ValueKind, flags::flag, rows, value::*};

pub(super) const SECTION: Section = Section {
    key: "lights",
    title: "Lights",
    about: "Lights. An environment map replaces key, rim and ambient light.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "lights";
    "key" "Key light" [lights.key] number(TIMES, 0.0, 10.0),
        "Strength of the main light, from the upper left of the camera.";
    "rim" "Rim light" [lights.rim] number(TIMES, 0.0, 10.0),
        also("back light; backlight; kicker"),
        "Strength of the light from behind, which outlines the hair and shines through it.";
    "sky" "Ambient light" [lights.sky] number(TIMES, 0.0, 10.0),
        "Strength of the light from all other directions; lower for more contrast.";
    "rotation" "Rotation" [lights.rotation] number(DEGREES, -360.0, 360.0),
        "Rotation of key and rim light about the head, toward its left.";
    "follow" "Follow the camera" [lights.follow] ValueKind::Toggle,
        "Key and rim light move with the camera; otherwise they stay in place.";
    "exposure" "Exposure" [lights.exposure] number(TIMES, 0.01, 100.0).log(),
        "Factor on all light before tone mapping.";
    "environment_strength" "Environment strength" [lights.environment_strength] number(TIMES, 0.001, 1000.0).log(),
        flag(flag("environment-strength", "FACTOR")),
        also("hdri strength; world strength"),
        "Factor on the light of the environment map.";
    "environment_rotation" "Environment rotation" [lights.environment_rotation] number(DEGREES, -360.0, 360.0),
        flag(flag("environment-rotation", "DEGREES")),
        also("hdri rotation"),
        "Rotation of the environment map about the head, toward its left.";
};
