//! Parameters of hair shading.

use super::{
    Knob, Section, Value, ValueKind,
    flags::{FlagValue, OmittedValue, Set, Slot, flag, slot, value},
    rows,
    value::*,
};
use crate::settings::HairColor;
use tresses::{low_level::FiberShape, renderer::ShadingModel};

pub(super) const SECTION: Section =
    Section { key: "shading", title: "Shading", about: "Hair color and shading model.", knobs: KNOBS };

const KNOBS: &[Knob] = rows! { "shading";
    "color" "Color" [shading.color] choice::<HairColor>(),
        flag(flag("color", "NAME|RRGGBB").common().first(COLOR)
            .about("Hair color: a name, or an sRGB color such as 5a3b28")),
        also("hair color; base color"),
        "Source of the hair color: the file, the skin at the roots, a preset, or the values below.";
    "srgb" "sRGB color" [shading.srgb] ValueKind::Color,
        "Color of dense hair in neutral light, if Color is srgb.";
    "eumelanin" "Eumelanin" [shading.eumelanin] number(PLAIN, 0.0, 100.0).log(),
        flag(flag("melanin", "EU,PHEO").first(MELANIN).then(PHEOMELANIN)
            .about("Pigments instead of a color: brown is 1.3,0.2, blond 0.25,0.05, red 0.12,1.5, black 6,0.3")),
        also("melanin"),
        "Brown to black pigment, if Color is melanin: blond 0.25, brown 1.3, black 6, white 0.";
    "pheomelanin" "Pheomelanin" [shading.pheomelanin] number(PLAIN, 0.0, 100.0).log(),
        also("melanin redness; redness"),
        "Yellow to red pigment, if Color is melanin: brown 0.2, red 1.5.";
    "root_pigment" "Pigment at the root" [shading.root_pigment] number(TIMES, 0.0, 5.0),
        "Pigment at the root relative to the mean; higher for regrown roots (fiber only).";
    "tip_pigment" "Pigment at the tip" [shading.tip_pigment] number(TIMES, 0.0, 5.0),
        "Pigment at the tip relative to the mean; lower for ends bleached by the sun (fiber only).";
    "lightness_spread" "Lightness spread" [shading.material.lightness_spread] number(PERCENT, 0.0, 100.0),
        auto, flag(flag("lightness-spread", "SHARE")),
        also("random color; melanin variation"),
        "Variation of lightness (melanin) between strands; higher for streaks, lower for dyed hair.";
    "roughness_along" "Longitudinal roughness" [shading.material.fiber.shape.longitudinal]
        within(PLAIN, FiberShape::ROUGHNESS),
        flag(flag("roughness", "R[,R]").first(ALONG).then(AROUND)
            .about("Roughness of the fibers: longitudinal, and azimuthal")),
        also("roughness"),
        "Roughness along the fiber, which lengthens highlights: 0.1 silk, 0.3 healthy hair, 1 wool (fiber only).";
    "roughness_around" "Azimuthal roughness" [shading.material.fiber.shape.azimuthal]
        within(PLAIN, FiberShape::ROUGHNESS),
        also("radial roughness"),
        "Roughness around the fiber: higher is softer and more opaque (fiber only).";
    "model" "Model" [renderer.model] choice::<ShadingModel>(), rebuild, flag(flag("shading", "MODEL")),
        "Scattering in and between fibers, or the cheaper Kajiya-Kay model, which classic always has.";
    "tilt" "Cuticle angle" [shading.material.fiber.shape.tilt] within(DEGREES, FiberShape::TILT), advanced,
        also("offset; cuticle tilt; scale angle"),
        "Angle of the scales, which separates the white from the colored highlight; 2 to 3° for hair (fiber only).";
    "refraction" "IOR" [shading.material.fiber.shape.eta] within(PLAIN, FiberShape::ETA), advanced,
        also("index of refraction"),
        "Index of refraction: 1.55 for hair, lower for wet hair, higher for more gloss (fiber only).";
    "density_forward" "Forward density" [shading.material.fiber.density_forward] number(PLAIN, 0.0, 1.0), advanced,
        "Fraction of forward-scattered light that hits other hair; lower is darker in the shade (fiber only).";
    "density_back" "Backward density" [shading.material.fiber.density_back] number(PLAIN, 0.0, 1.0), advanced,
        "Fraction of back-scattered light that hits other hair; higher is lighter, more saturated (fiber only).";
    "warmth_spread" "Warmth spread" [shading.material.warmth_spread] number(PERCENT, 0.0, 100.0),
        auto, advanced, flag(flag("warmth-spread", "SHARE")),
        "Variation of warmth (red against blue) between strands.";
    "highlight_spread" "Highlight spread" [shading.material.shift_spread] number(PERCENT, 0.0, 100.0),
        auto, advanced, flag(flag("highlight-spread", "SHARE")),
        "Variation of the highlight position between strands; higher breaks highlights up.";
    "root_darkness" "Root darkness" [shading.material.root_darkness] number(PLAIN, 0.0, 1.0), auto, advanced,
        "Factor on all light at the root; 1 for no darkening (kajiya-kay only).";
    "diffuse" "Diffuse" [shading.material.diffuse] number(PLAIN, 0.0, 2.0), auto, advanced,
        also("diffuse factor"),
        "Strength of diffuse reflection (kajiya-kay only).";
    "primary" "First highlight" [shading.material.primary] number(PLAIN, 0.0, 5.0), auto, advanced,
        also("spec1 factor; primary specular"),
        "Strength of the white highlight (kajiya-kay only).";
    "primary_exponent" "First highlight exponent" [shading.material.primary_exponent]
        number(PLAIN, 1.0, 1000.0).log(), auto, advanced,
        also("spec exponent 1"),
        "Sharpness of the white highlight (kajiya-kay only).";
    "primary_shift" "First highlight shift" [shading.material.primary_shift] number(PLAIN, -1.0, 1.0), auto, advanced,
        "Shift of the white highlight toward the tip, as the tangent of an angle (kajiya-kay only).";
    "secondary" "Second highlight" [shading.material.secondary] number(PLAIN, 0.0, 5.0), auto, advanced,
        also("spec2 factor; secondary specular"),
        "Strength of the colored highlight (kajiya-kay only).";
    "secondary_exponent" "Second highlight exponent" [shading.material.secondary_exponent]
        number(PLAIN, 1.0, 1000.0).log(), auto, advanced,
        also("spec exponent 2"),
        "Sharpness of the colored highlight (kajiya-kay only).";
    "secondary_shift" "Second highlight shift" [shading.material.secondary_shift] number(PLAIN, -1.0, 1.0),
        auto, advanced,
        "Shift of the colored highlight, toward the root if negative (kajiya-kay only).";
    "secondary_color" "Second highlight color" [shading.material.secondary_color] ValueKind::Color, auto, advanced,
        "Color of the second highlight and of transmitted light (kajiya-kay only).";
    "transmission" "Transmission" [shading.material.transmission] number(PLAIN, 0.0, 5.0), auto, advanced,
        also("backlit"),
        "Strength of light transmitted from behind (kajiya-kay only).";
    "transmission_exponent" "Transmission exponent" [shading.material.transmission_exponent]
        number(PLAIN, 1.0, 1000.0).log(), auto, advanced,
        "Sharpness of transmitted light (kajiya-kay only).";
    "shift_noise" "Shift noise" [shading.material.shift_noise] number(PLAIN, 0.0, 1.0), auto, advanced,
        "Noise on both highlight shifts, along the strand and per pixel (kajiya-kay only).";
    "opacity" "Fiber opacity" [shading.material.opacity] number(PLAIN, 0.0, 1.0), auto, advanced,
        also("shadow alpha"),
        "Fraction of light that each fiber blocks; higher is darker inside the hair (kajiya-kay only).";
    "saturation" "Saturation in depth" [shading.material.saturation] number(PLAIN, 0.0, 5.0), auto, advanced,
        "Extra absorption of the weaker color channels inside the hair (kajiya-kay only).";
};

const COLOR: &[FlagValue] =
    &[value("shading.color"), value("shading.srgb").sets(&[("shading.color", Value::Choice("srgb"))])];

/// Pigments and roughness apply to the fiber model only.
const FIBER: Set = ("shading.model", Value::Choice("fiber"));
const MELANIN: &[FlagValue] =
    &[value("shading.eumelanin").sets(&[("shading.color", Value::Choice("melanin")), FIBER])];
const PHEOMELANIN: &[Slot] = &[slot(value("shading.pheomelanin"), OmittedValue::Is("0"))];
const ALONG: &[FlagValue] = &[value("shading.roughness_along").sets(&[FIBER])];
const AROUND: &[Slot] = &[slot(value("shading.roughness_around"), OmittedValue::Same)];
