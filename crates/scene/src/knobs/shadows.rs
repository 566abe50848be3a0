//! Parameters of shadows.

use super::{Kind, Knob, Section, flags::flag, rows, value::*};
use tresses::light::ShadowMethod;

pub(super) const SECTION: Section = Section {
    key: "shadows",
    title: "Shadows",
    about: "How hair shadows hair, head and body.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "shadows";
    "method" "Method" [shadows.method] choice::<ShadowMethod>(), flag(flag("shadows", "METHOD")),
        "How fibres between a light and a point are counted.";
    "softness" "Softness on hair" [shadows.hair_radius] number(MILLIMETRES, 0.1, 50.0).log(),
        flag(flag("shadow-softness", "MM")),
        "Radius over which shadows on hair are averaged; larger is softer and steadier.";
    "body_opacity" "Shadow on skin" [shadows.body_opacity] number(PERCENT, 0.0, 100.0),
        "How much light hair takes from the skin behind it; at 100 % as much as from other hair.";
    "strand_by_strand" "Strand by strand" [shadows.strand_by_strand] number(PERCENT, 0.0, 100.0),
        flag(flag("shadow-strands", "SHARE")),
        "How much strands are in light or shade one by one, not as their surroundings; fibre model only.";
    "strand_map" "Strand map" [view.strand_map] integer(TEXELS, 0, 2048, 1), rebuild, flag(flag("strand-map", "N")),
        "Texels of maps that find which strands are in light: 1024 for stills, 0 to let chance decide (fiber).";
    "ambient" "Follow ambient light" [shadows.ambient] Kind::Toggle, flag(flag("ambient", "on|off")),
        "Follow light of the sky and of the skin through the hair; off estimates the open part of the sky.";
    "per_pixel" "Per pixel" [shadows.per_pixel] Kind::Toggle, flag(flag("shadows-per-pixel", "")),
        "Shade hair and look up its shadows at each pixel; slower.";
    "resolution" "Resolution" [view.shadow_resolution] integer(TEXELS, 64, 2048, 1),
        advanced, rebuild, flag(flag("shadow-resolution", "N")),
        "Texels along each edge of a shadow map; higher for shadows of single locks on the skin.";
    "ambient_cells" "Ambient cells" [view.ambient_cells] integer(PLAIN, 4, 64, 1), advanced, rebuild,
        flag(flag("ambient-cells", "N")),
        "Cells of ambient light along each edge; short hair is truer with 48, which take eight times as long as 24.";
    "body_softness" "Softness on skin" [shadows.body_radius] number(MILLIMETRES, 0.1, 50.0).log(), advanced,
        "Radius over which the shadow of the body on itself is averaged.";
    "density" "Assumed density" [shadows.density] number(PER_METRE, 0.0, 10_000.0).log(), advanced,
        "Fibres that light meets per metre of hair (absorption only).";
    "bias" "Bias" [shadows.bias] number(MILLIMETRES, 0.0, 20.0), advanced,
        "Distance by which skin is moved towards the light; raise it where skin shows stripes.";
};
