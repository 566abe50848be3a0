//! Parameters of lights.

use super::{
    Knob, Section, ValueKind,
    flags::{FlagValue, OmittedValue, Slot, flag, slot, value},
    rows,
    value::*,
};

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
    "lamp1_strength" "Light 1" [lights.lamps[0].irradiance] number(PLAIN, 0.0, 100.0).log(),
        flag(flag("light", "AZIMUTH,ELEVATION[,IRRADIANCE]").times(2).first(LAMP).then(LAMP_MORE)
            .about("Additional light, at most two: direction in degrees, and irradiance")),
        "Irradiance of an additional light; the key light has about 5. 0 is off.";
    "lamp1_azimuth" "Light 1 azimuth" [lights.lamps[0].azimuth] number(DEGREES, -360.0, 360.0),
        "Direction that the light comes from: front (0), left of the head (90), back (180).";
    "lamp1_elevation" "Light 1 elevation" [lights.lamps[0].elevation] number(DEGREES, -90.0, 90.0),
        "Angle of the light above the horizon.";
    "lamp2_strength" "Light 2" [lights.lamps[1].irradiance] number(PLAIN, 0.0, 100.0).log(), advanced,
        "Irradiance of a second additional light; 0 is off.";
    "lamp2_azimuth" "Light 2 azimuth" [lights.lamps[1].azimuth] number(DEGREES, -360.0, 360.0), advanced,
        "Direction that the light comes from, as for light 1.";
    "lamp2_elevation" "Light 2 elevation" [lights.lamps[1].elevation] number(DEGREES, -90.0, 90.0), advanced,
        "Angle of the light above the horizon.";
};

/// Lights on the command line replace all additional lights of a preset.
const LAMP: &[FlagValue] = &[value("lights.lamp1_azimuth").resets(&[
    "lights.lamp1_strength",
    "lights.lamp1_azimuth",
    "lights.lamp1_elevation",
    "lights.lamp2_strength",
    "lights.lamp2_azimuth",
    "lights.lamp2_elevation",
])];

const LAMP_MORE: &[Slot] = &[
    slot(value("lights.lamp1_elevation"), OmittedValue::Refused),
    slot(value("lights.lamp1_strength"), OmittedValue::Is("2")),
];
