//! Parameters of the look of hair.

use super::{
    Kind, Knob, Section, Value,
    flags::{Missing, Part, Set, Slot, flag, place, value},
    rows,
    value::*,
};
use crate::settings::HairColor;
use tresses::light::{ShadingModel, ShadingRate, fiber::FiberShape};

pub(super) const SECTION: Section = Section {
    key: "shading",
    title: "Shading",
    about: "Colour of the hair, and how light on it is computed.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "shading";
    "color" "Colour" [shading.color] choice::<HairColor>(),
        flag(flag("color", "NAME|RRGGBB").common().first(COLOR)
            .about("Colour of the hair: a name, or an sRGB colour such as 5a3b28")),
        "The colours or the material of the file, a preset, the sRGB colour below, or the pigments below.";
    "srgb" "sRGB colour" [shading.srgb] Kind::Color,
        "The colour of much hair in neutral light, when Colour is srgb.";
    "eumelanin" "Eumelanin" [shading.eumelanin] number(PLAIN, 0.0, 100.0).log(),
        flag(flag("melanin", "EU,PHEO").first(MELANIN).then(PHEOMELANIN)
            .about("Pigments instead of a colour: brown is 1.3,0.2, blond 0.25,0.05, red 0.12,1.5, black 6,0.3")),
        "Brown to black pigment when Colour is melanin: blond 0.25, brown 1.3, black 6, white 0.";
    "pheomelanin" "Pheomelanin" [shading.pheomelanin] number(PLAIN, 0.0, 100.0).log(),
        "Yellow to red pigment when Colour is melanin: brown 0.2, red 1.5.";
    "root_pigment" "Pigment at the root" [shading.root_pigment] number(TIMES, 0.0, 5.0),
        "Relative to the mean; higher for roots that have grown out (fiber).";
    "tip_pigment" "Pigment at the tip" [shading.tip_pigment] number(TIMES, 0.0, 5.0),
        "Relative to the mean; lower for ends bleached by the sun (fiber).";
    "lightness_spread" "Lightness spread" [shading.material.lightness_spread] number(PERCENT, 0.0, 100.0),
        auto, flag(flag("lightness-spread", "SHARE")),
        "How much the lightness (melanin) of strands varies; more for streaks, less for dyed hair.";
    "roughness_along" "Roughness along" [shading.material.fiber.shape.longitudinal] within(PLAIN, FiberShape::ROUGHNESS),
        flag(flag("roughness", "R[,R]").first(ALONG).then(AROUND)
            .about("Roughness of the fibres: along them, and around them")),
        "Length of the highlights: 0.1 wet silk, 0.3 healthy hair, 1 wool (fiber).";
    "roughness_around" "Roughness around" [shading.material.fiber.shape.azimuthal] within(PLAIN, FiberShape::ROUGHNESS),
        "Roughness around the fibre: higher is softer and more opaque (fiber).";
    "model" "Model" [shading.material.model] choice::<ShadingModel>(), flag(flag("shading", "MODEL")),
        "Light in fibres and among them, or two highlights set by eye, which is cheaper.";
    "rate" "Shade per" [shading.rate] choice::<ShadingRate>(), advanced, flag(flag("shade-per", "WHERE")),
        "Strand vertex, or pixel for finer noise at a higher cost.";
    "tilt" "Cuticle tilt" [shading.material.fiber.shape.tilt] within(DEGREES, FiberShape::TILT), advanced,
        "Angle of the scales: separates the white highlight from the coloured one; 2 to 3° for hair (fiber).";
    "refraction" "Refraction" [shading.material.fiber.shape.eta] within(PLAIN, FiberShape::ETA), advanced,
        "Index of refraction: 1.55 for hair, lower for wet hair, higher for more gloss (fiber).";
    "density_forward" "Forward density" [shading.material.fiber.density_forward] number(PLAIN, 0.0, 1.0), advanced,
        "Share of the light that a fibre scatters forward that meets other hair; lower is darker in the shade (fiber).";
    "density_back" "Backward density" [shading.material.fiber.density_back] number(PLAIN, 0.0, 1.0), advanced,
        "Share of the light scattered back that does; higher is lighter and more saturated (fiber).";
    "warmth_spread" "Warmth spread" [shading.material.warmth_spread] number(PERCENT, 0.0, 100.0),
        auto, advanced, flag(flag("warmth-spread", "SHARE")),
        "How much the warmth (red against blue) of strands varies.";
    "highlight_spread" "Highlight spread" [shading.material.shift_spread] number(PERCENT, 0.0, 100.0),
        auto, advanced, flag(flag("highlight-spread", "SHARE")),
        "How far highlights are shifted from strand to strand; more breaks them up.";
    "root_darkness" "Root darkness" [shading.material.root_darkness] number(PLAIN, 0.0, 1.0), auto, advanced,
        "Factor of all light at the root; 1 for none (kajiya-kay).";
    "diffuse" "Diffuse" [shading.material.diffuse] number(PLAIN, 0.0, 2.0), auto, advanced,
        "Strength of the diffuse light (kajiya-kay).";
    "primary" "First highlight" [shading.material.primary] number(PLAIN, 0.0, 5.0), auto, advanced,
        "Strength of the white highlight (kajiya-kay).";
    "primary_exponent" "First highlight exponent" [shading.material.primary_exponent]
        number(PLAIN, 1.0, 1000.0).log(), auto, advanced,
        "Sharpness of the white highlight (kajiya-kay).";
    "primary_shift" "First highlight shift" [shading.material.primary_shift] number(PLAIN, -1.0, 1.0), auto, advanced,
        "Towards the tip, as the tangent of an angle (kajiya-kay).";
    "secondary" "Second highlight" [shading.material.secondary] number(PLAIN, 0.0, 5.0), auto, advanced,
        "Strength of the coloured highlight (kajiya-kay).";
    "secondary_exponent" "Second highlight exponent" [shading.material.secondary_exponent]
        number(PLAIN, 1.0, 1000.0).log(), auto, advanced,
        "Sharpness of the coloured highlight (kajiya-kay).";
    "secondary_shift" "Second highlight shift" [shading.material.secondary_shift] number(PLAIN, -1.0, 1.0),
        auto, advanced,
        "Towards the root when negative (kajiya-kay).";
    "secondary_color" "Second highlight colour" [shading.material.secondary_color] Kind::Color, auto, advanced,
        "Also the colour of the light that shines through (kajiya-kay).";
    "transmission" "Transmission" [shading.material.transmission] number(PLAIN, 0.0, 5.0), auto, advanced,
        "Strength of the light that shines through from behind (kajiya-kay).";
    "transmission_exponent" "Transmission exponent" [shading.material.transmission_exponent]
        number(PLAIN, 1.0, 1000.0).log(), auto, advanced,
        "Sharpness of the light that shines through (kajiya-kay).";
    "shift_noise" "Shift noise" [shading.material.shift_noise] number(PLAIN, 0.0, 1.0), auto, advanced,
        "Noise of both shifts along a strand and per pixel (kajiya-kay).";
    "opacity" "Fibre opacity" [shading.material.opacity] number(PLAIN, 0.0, 1.0), auto, advanced,
        "Share of the light that each fibre takes; higher is darker inside (kajiya-kay).";
    "saturation" "Saturation in depth" [shading.material.saturation] number(PLAIN, 0.0, 5.0), auto, advanced,
        "How much more of the weaker colour channels is absorbed on the way (kajiya-kay).";
};

const COLOR: &[Part] =
    &[value("shading.color"), value("shading.srgb").sets(&[("shading.color", Value::Choice("srgb"))])];

/// Pigments and roughness are those of fibres.
const FIBER: Set = ("shading.model", Value::Choice("fiber"));
const MELANIN: &[Part] =
    &[value("shading.eumelanin").sets(&[("shading.color", Value::Choice("melanin")), FIBER])];
const PHEOMELANIN: &[Slot] = &[place(value("shading.pheomelanin"), Missing::Is("0"))];
const ALONG: &[Part] = &[value("shading.roughness_along").sets(&[FIBER])];
const AROUND: &[Slot] = &[place(value("shading.roughness_around"), Missing::Same)];
