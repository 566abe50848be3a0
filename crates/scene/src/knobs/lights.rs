//! Parameters of the light.

use super::{
    Kind, Knob, Section,
    flags::{Missing, Part, Slot, flag, place, value},
    rows,
    value::*,
};

pub(super) const SECTION: Section = Section {
    key: "lights",
    title: "Lights",
    about: "Where light comes from. A picture of the surroundings replaces key, rim and sky.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "lights";
    "key" "Key light" [lights.key] number(TIMES, 0.0, 10.0),
        "Strength of the main light, from the upper left of the camera.";
    "rim" "Rim light" [lights.rim] number(TIMES, 0.0, 10.0),
        "Strength of the light from behind, which traces the outline and shines through the hair.";
    "sky" "Ambient light" [lights.sky] number(TIMES, 0.0, 10.0),
        "Strength of the light of the sky, from all other directions; lower for more contrast.";
    "turn" "Turn" [lights.turn] number(DEGREES, -360.0, 360.0),
        "Turns key and rim about the head, towards its left.";
    "follow" "Follow the camera" [lights.follow] Kind::Toggle,
        "Key and rim move with the camera; otherwise they stay in place.";
    "exposure" "Exposure" [lights.exposure] number(TIMES, 0.01, 100.0).log(),
        "Factor of all light before tone mapping.";
    "environment_strength" "Surroundings" [lights.environment_strength] number(TIMES, 0.001, 1000.0).log(),
        flag(flag("environment-strength", "FACTOR")),
        "Factor of the light of a picture of the surroundings.";
    "environment_turn" "Turn of surroundings" [lights.environment_turn] number(DEGREES, -360.0, 360.0),
        flag(flag("environment-turn", "DEGREES")),
        "Turns a picture of the surroundings about the head, towards its left.";
    "lamp1_strength" "Lamp 1" [lights.lamps[0].irradiance] number(PLAIN, 0.0, 100.0).log(),
        flag(flag("light", "AZIMUTH,ELEVATION[,IRRADIANCE]").times(2).first(LAMP).then(LAMP_MORE)
            .about("Another light, at most two: its direction in degrees, and its strength")),
        "Irradiance of another light, where the key light has about 5; 0 is off.";
    "lamp1_azimuth" "Lamp 1 azimuth" [lights.lamps[0].azimuth] number(DEGREES, -360.0, 360.0),
        "Where it comes from: the front (0), the left of the head (90), the back (180).";
    "lamp1_elevation" "Lamp 1 elevation" [lights.lamps[0].elevation] number(DEGREES, -90.0, 90.0),
        "Angle above the horizon.";
    "lamp2_strength" "Lamp 2" [lights.lamps[1].irradiance] number(PLAIN, 0.0, 100.0).log(), advanced,
        "Irradiance of a second such light; 0 is off.";
    "lamp2_azimuth" "Lamp 2 azimuth" [lights.lamps[1].azimuth] number(DEGREES, -360.0, 360.0), advanced,
        "Where it comes from.";
    "lamp2_elevation" "Lamp 2 elevation" [lights.lamps[1].elevation] number(DEGREES, -90.0, 90.0), advanced,
        "Angle above the horizon.";
};

/// Lights on the command line replace all lamps of a preset.
const LAMP: &[Part] = &[value("lights.lamp1_azimuth").resets(&[
    "lights.lamp1_strength",
    "lights.lamp1_azimuth",
    "lights.lamp1_elevation",
    "lights.lamp2_strength",
    "lights.lamp2_azimuth",
    "lights.lamp2_elevation",
])];

const LAMP_MORE: &[Slot] = &[
    place(value("lights.lamp1_elevation"), Missing::Refused),
    place(value("lights.lamp1_strength"), Missing::Is("2")),
];
