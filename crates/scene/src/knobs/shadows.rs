//! Parameters of shadows.

use super::{Kind, Knob, Section, knob, value::*};
use tresses::light::ShadowMethod;

pub(super) const SECTION: Section = Section {
    key: "shadows",
    title: "Shadows",
    about: "How hair shadows hair, head and body.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "shadows.method",
        "Method",
        choice::<ShadowMethod>(),
        Frame,
        "Solid hair, light lost on the way behind the front, fibres counted in layers, or none at all.",
        shadows.method
    ),
    knob!(
        "shadows.resolution",
        "Resolution",
        integer(TEXELS, 64, 2048, 1),
        Rebuild,
        "Texels along each edge of a shadow map; higher for shadows of single locks on the skin.",
        shadow_resolution
    ),
    knob!(
        "shadows.softness",
        "Softness on hair",
        number(MILLIMETRES, 0.1, 50.0),
        Frame,
        "Radius over which shadows on hair are averaged; larger is softer and quieter.",
        shadows.hair_radius
    )
    .log(),
    knob!(
        "shadows.body_softness",
        "Softness on skin",
        number(MILLIMETRES, 0.1, 50.0),
        Frame,
        "Radius over which the shadow of the body on itself is averaged.",
        shadows.body_radius
    )
    .log(),
    knob!(
        "shadows.density",
        "Supposed density",
        number(PER_METRE, 0.0, 10_000.0),
        Frame,
        "Fibres that light meets per metre of hair (absorption only).",
        shadows.density
    )
    .log(),
    knob!(
        "shadows.body_opacity",
        "Shadow on skin",
        number(PERCENT, 0.0, 100.0),
        Frame,
        "How much the hair before the skin takes of its light: at 100 % what it takes from other hair.",
        shadows.body_opacity
    ),
    knob!(
        "shadows.bias",
        "Bias",
        number(MILLIMETRES, 0.0, 20.0),
        Frame,
        "How far skin is lifted towards the light; raise it where skin has stripes.",
        shadows.bias
    ),
    knob!(
        "shadows.per_pixel",
        "Per pixel",
        Kind::Toggle,
        Frame,
        "Shade hair, and look its shadows up, for every pixel; dearer.",
        shadows.per_pixel
    ),
    knob!(
        "shadows.ambient",
        "Light from all sides",
        Kind::Toggle,
        Frame,
        "Follow light from the sky and from the skin through the hair; off guesses how open the sky is.",
        shadows.ambient
    ),
];
