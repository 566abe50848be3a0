//! Parameters of the light.

use super::{Kind, Knob, Section, knob, value::*};

pub(super) const SECTION: Section = Section {
    key: "lights",
    title: "Lights",
    about: "Where light comes from. Key, rim and sky give way to a picture of the surroundings.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "lights.key",
        "Key light",
        number(TIMES, 0.0, 10.0),
        Frame,
        "Strength of the main light, from the camera's upper left.",
        lights.key
    ),
    knob!(
        "lights.rim",
        "Rim light",
        number(TIMES, 0.0, 10.0),
        Frame,
        "Strength of the light from behind, which traces the outline and shines through.",
        lights.rim
    ),
    knob!(
        "lights.sky",
        "Sky",
        number(TIMES, 0.0, 10.0),
        Frame,
        "Strength of the light from everywhere else; lower for drama.",
        lights.sky
    ),
    knob!(
        "lights.turn",
        "Turn",
        number(DEGREES, -360.0, 360.0),
        Frame,
        "Turns key and rim about the head, towards its left.",
        lights.turn
    ),
    knob!(
        "lights.follow",
        "Go with the camera",
        Kind::Toggle,
        Frame,
        "Key and rim go with the camera, as a photographer's do; else they stay in place.",
        lights.follow
    ),
    knob!(
        "lights.lamp1_strength",
        "Lamp 1",
        number(PLAIN, 0.0, 100.0),
        Frame,
        "Irradiance of another light, where the key light has about 5; 0 is off.",
        lights.lamps[0].irradiance
    )
    .log(),
    knob!(
        "lights.lamp1_azimuth",
        "Lamp 1 from",
        number(DEGREES, -360.0, 360.0),
        Frame,
        "Where it comes from: the front (0), over the head's left (90), the back (180).",
        lights.lamps[0].azimuth
    ),
    knob!(
        "lights.lamp1_elevation",
        "Lamp 1 height",
        number(DEGREES, -90.0, 90.0),
        Frame,
        "Above the horizon.",
        lights.lamps[0].elevation
    ),
    knob!(
        "lights.lamp2_strength",
        "Lamp 2",
        number(PLAIN, 0.0, 100.0),
        Frame,
        "Irradiance of one more light; 0 is off.",
        lights.lamps[1].irradiance
    )
    .log(),
    knob!(
        "lights.lamp2_azimuth",
        "Lamp 2 from",
        number(DEGREES, -360.0, 360.0),
        Frame,
        "Where it comes from.",
        lights.lamps[1].azimuth
    ),
    knob!(
        "lights.lamp2_elevation",
        "Lamp 2 height",
        number(DEGREES, -90.0, 90.0),
        Frame,
        "Above the horizon.",
        lights.lamps[1].elevation
    ),
    knob!(
        "lights.environment_turn",
        "Turn of surroundings",
        number(DEGREES, -360.0, 360.0),
        Frame,
        "Turns a picture of the surroundings about the head, towards its left.",
        lights.environment_turn
    ),
    knob!(
        "lights.environment_strength",
        "Surroundings",
        number(TIMES, 0.001, 1000.0),
        Frame,
        "What the light of a picture of the surroundings is multiplied by.",
        lights.environment_strength
    )
    .log(),
    knob!(
        "lights.exposure",
        "Exposure",
        number(TIMES, 0.01, 100.0),
        Frame,
        "Factor of all light before the picture is tone mapped.",
        lights.exposure
    )
    .log(),
];
