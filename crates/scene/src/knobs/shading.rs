//! Parameters of the look of hair.

use super::{Kind, Knob, Section, knob, value::*};
use crate::settings::HairColor;
use tresses::light::{ShadingModel, ShadingRate};

pub(super) const SECTION: Section = Section {
    key: "shading",
    title: "Shading",
    about: "Colour of the hair, and how light on it is computed.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    knob!(
        "shading.color",
        "Colour",
        choice::<HairColor>(),
        Frame,
        "A file's own colours (else brown), a preset, the sRGB colour below, or the pigments below.",
        look.color
    ),
    knob!(
        "shading.srgb",
        "sRGB colour",
        Kind::Color,
        Frame,
        "The colour with Colour on srgb: that of much hair in plain light.",
        look.srgb
    ),
    knob!(
        "shading.eumelanin",
        "Eumelanin",
        number(PLAIN, 0.0, 100.0),
        Frame,
        "Brown to black pigment with Colour on melanin: blond 0.25, brown 1.3, black 6, white 0.",
        look.eumelanin
    )
    .log(),
    knob!(
        "shading.pheomelanin",
        "Pheomelanin",
        number(PLAIN, 0.0, 100.0),
        Frame,
        "Yellow to red pigment with Colour on melanin: brown 0.2, red 1.5.",
        look.pheomelanin
    )
    .log(),
    knob!(
        "shading.model",
        "Model",
        choice::<ShadingModel>(),
        Frame,
        "Light in fibres and among them, or two highlights set by eye, which is cheaper.",
        look.model
    ),
    knob!(
        "shading.rate",
        "Shade per",
        choice::<ShadingRate>(),
        Frame,
        "Per strand vertex, or per pixel for finer noise at a higher price.",
        look.rate
    ),
    knob!(
        "shading.roughness_along",
        "Roughness along",
        number(PLAIN, 0.1, 1.0),
        Frame,
        "Length of the highlights: 0.1 wet silk, 0.3 healthy hair, 1 wool (fiber).",
        look.roughness_along
    ),
    knob!(
        "shading.roughness_around",
        "Roughness around",
        number(PLAIN, 0.1, 1.0),
        Frame,
        "Roughness around the fibre: higher is softer and more opaque (fiber).",
        look.roughness_around
    ),
    knob!(
        "shading.tilt",
        "Tilt of the scales",
        number(DEGREES, -10.0, 10.0),
        Frame,
        "Moves the white highlight away from the coloured one; 2 to 3 for hair (fiber).",
        look.tilt
    ),
    knob!(
        "shading.refraction",
        "Refraction",
        number(PLAIN, 1.05, 2.5),
        Frame,
        "Index of refraction: 1.55 for hair, lower for wet hair, higher for more gloss (fiber).",
        look.refraction
    ),
    knob!(
        "shading.root_pigment",
        "Pigment at the root",
        number(TIMES, 0.0, 5.0),
        Frame,
        "Against the mean; higher for roots that have grown out (fiber).",
        look.root_pigment
    ),
    knob!(
        "shading.tip_pigment",
        "Pigment at the tip",
        number(TIMES, 0.0, 5.0),
        Frame,
        "Against the mean; lower for ends bleached by the sun (fiber).",
        look.tip_pigment
    ),
    knob!(
        "shading.density_forward",
        "Forward density",
        number(PLAIN, 0.0, 1.0),
        Frame,
        "Share of the light scattered on that meets other hair; lower is darker inside (fiber).",
        look.density_forward
    ),
    knob!(
        "shading.density_back",
        "Backward density",
        number(PLAIN, 0.0, 1.0),
        Frame,
        "Share of the light scattered back that does; higher is lighter and more saturated (fiber).",
        look.density_back
    ),
    knob!(
        "shading.lightness_spread",
        "Lightness spread",
        number(PERCENT, 0.0, 100.0),
        Frame,
        "How much the lightness (melanin) of strands differs; more for streaks, less for dyed hair.",
        look.lightness_spread
    )
    .auto(),
    knob!(
        "shading.warmth_spread",
        "Warmth spread",
        number(PERCENT, 0.0, 100.0),
        Frame,
        "How much the warmth (red against blue) of strands differs.",
        look.warmth_spread
    )
    .auto(),
    knob!(
        "shading.highlight_spread",
        "Highlight spread",
        number(PERCENT, 0.0, 100.0),
        Frame,
        "How far highlights are shifted from strand to strand; more breaks them up.",
        look.highlight_spread
    )
    .auto(),
    knob!(
        "shading.root_darkness",
        "Root darkness",
        number(PLAIN, 0.0, 1.0),
        Frame,
        "Factor of all light at the root; 1 for none (kajiya-kay).",
        look.root_darkness
    )
    .auto(),
    knob!(
        "shading.diffuse",
        "Diffuse",
        number(PLAIN, 0.0, 2.0),
        Frame,
        "Strength of the diffuse light (kajiya-kay).",
        look.diffuse
    )
    .auto(),
    knob!(
        "shading.primary",
        "First highlight",
        number(PLAIN, 0.0, 5.0),
        Frame,
        "Strength of the white highlight (kajiya-kay).",
        look.primary
    )
    .auto(),
    knob!(
        "shading.primary_exponent",
        "First highlight's sharpness",
        number(PLAIN, 1.0, 1000.0),
        Frame,
        "The exponent (kajiya-kay).",
        look.primary_exponent
    )
    .log()
    .auto(),
    knob!(
        "shading.primary_shift",
        "First highlight's shift",
        number(PLAIN, -1.0, 1.0),
        Frame,
        "Towards the tip, as the tangent of an angle (kajiya-kay).",
        look.primary_shift
    )
    .auto(),
    knob!(
        "shading.secondary",
        "Second highlight",
        number(PLAIN, 0.0, 5.0),
        Frame,
        "Strength of the coloured highlight (kajiya-kay).",
        look.secondary
    )
    .auto(),
    knob!(
        "shading.secondary_exponent",
        "Second highlight's sharpness",
        number(PLAIN, 1.0, 1000.0),
        Frame,
        "The exponent (kajiya-kay).",
        look.secondary_exponent
    )
    .log()
    .auto(),
    knob!(
        "shading.secondary_shift",
        "Second highlight's shift",
        number(PLAIN, -1.0, 1.0),
        Frame,
        "Towards the root when negative (kajiya-kay).",
        look.secondary_shift
    )
    .auto(),
    knob!(
        "shading.secondary_color",
        "Second highlight's colour",
        Kind::Color,
        Frame,
        "Also that of the light that shines through (kajiya-kay).",
        look.secondary_color
    )
    .auto(),
    knob!(
        "shading.transmission",
        "Transmission",
        number(PLAIN, 0.0, 5.0),
        Frame,
        "Strength of the light that shines through from behind (kajiya-kay).",
        look.transmission
    )
    .auto(),
    knob!(
        "shading.transmission_exponent",
        "Transmission's sharpness",
        number(PLAIN, 1.0, 1000.0),
        Frame,
        "The exponent (kajiya-kay).",
        look.transmission_exponent
    )
    .log()
    .auto(),
    knob!(
        "shading.shift_noise",
        "Noise of the shifts",
        number(PLAIN, 0.0, 1.0),
        Frame,
        "Along a strand and per pixel (kajiya-kay).",
        look.shift_noise
    )
    .auto(),
    knob!(
        "shading.opacity",
        "Opacity of a fibre",
        number(PLAIN, 0.0, 1.0),
        Frame,
        "Share of the light that each fibre takes; higher is darker inside (kajiya-kay).",
        look.opacity
    )
    .auto(),
    knob!(
        "shading.saturation",
        "Saturation in depth",
        number(PLAIN, 0.0, 5.0),
        Frame,
        "How much more the colours that hair has less of are lost on the way (kajiya-kay).",
        look.saturation
    )
    .auto(),
];
