//! Parameters of shadows.

use super::{Knob, Section, ValueKind, flags::flag, rows, value::*};
use crate::settings::RendererKind;

pub(super) const SECTION: Section = Section {
    key: "shadows",
    title: "Shadows",
    about: "Shadows of hair on hair, head and body.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "shadows";
    "enabled" "Shadows" [shadows.is_enabled] ValueKind::Toggle, flag(flag("shadows", "on|off")),
        "Shadows of hair and bodies; off lets every light reach every point.";
    "softness" "Softness on hair" [shadows.hair_radius] number(MILLIMETERS, 0.1, 50.0).log(),
        flag(flag("shadow-softness", "MM")),
        also("shadow blur"),
        "Radius over which shadows on hair are averaged; larger is softer and more stable.";
    "body_opacity" "Shadow on skin" [shadows.body_opacity] number(PERCENT, 0.0, 100.0),
        "Strength of hair shadows on skin; at 100 %, as strong as on other hair.";
    "strand_by_strand" "Per-strand variation" [shadows.strand_by_strand] number(PERCENT, 0.0, 100.0),
        flag(flag("shadow-strands", "SHARE")),
        "Variation of light and shadow from strand to strand; 100 % as in real hair (fiber only).";
    "strand_map" "Strand map" [view.strand_map_resolution] integer(TEXELS, 0, 2048, 1), rebuild, flag(flag("strand-map", "N")),
        "Texels along each edge of the maps of lit strands; 1024 for stills, 0 for stochastic shadows (fiber only).";
    "ambient" "Propagate ambient light" [shadows.has_ambient] ValueKind::Toggle, flag(flag("ambient", "on|off")),
        "Propagates light from the sky and from skin through the hair; off estimates sky visibility.";
    "maps" "Lights with shadow maps" [view.shadow_maps] integer(PLAIN, 1, 8, 1), advanced, rebuild,
        flag(flag("shadow-maps", "N")),
        also("maximum shadow casters"),
        "Maximum number of lights with shadow maps; others light the hair softly.";
    "resolution" "Resolution" [view.shadow_resolution] integer(TEXELS, 64, 2048, 1),
        advanced, rebuild, flag(flag("shadow-resolution", "N")),
        also("shadow map size"),
        "Texels along each edge of a shadow map; higher for shadows of single locks on skin.";
    "ambient_cells" "Ambient cells" [view.ambient_resolution] integer(PLAIN, 4, 64, 1), advanced, rebuild,
        flag(flag("ambient-cells", "N")),
        "Cells along each edge of the ambient light grid; 48 suits short hair and takes 8 times as long as 24.";
    "body_softness" "Softness on skin" [shadows.body_radius] number(MILLIMETERS, 0.1, 50.0).log(), advanced,
        "Radius over which shadows of the body on itself are averaged.";
    "density" "Assumed density" [shadows.density] number(PER_METER, 0.0, 10_000.0).log(), advanced,
        only(RendererKind::Classic),
        "Fibers that light hits per meter of hair (classic only, with absorption).";
    "bias" "Bias" [shadows.bias] number(MILLIMETERS, 0.0, 20.0), advanced,
        also("shadow bias; depth bias"),
        "Offset of skin toward the light; raise it if skin shows stripes.";
};
