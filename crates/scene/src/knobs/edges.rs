//! Parameters of antialiasing.

use super::{
    Knob, Section,
    flags::{Part, flag, value},
    rows,
    value::*,
};
use crate::settings::Samples;
use tresses::draw::Coverage;

pub(super) const SECTION: Section = Section {
    key: "edges",
    title: "Edges",
    about: "Antialiasing: samples per pixel, and how strands thinner than a pixel cover it.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "edges";
    "samples" "Samples per pixel" [edges.samples] choice::<Samples>(),
        auto, rebuild, flag(flag("samples", "N").first(SAMPLES)),
        "More give smoother edges of bodies, and of hair with mask and alpha; not every adapter has more than 4.";
    "coverage" "Coverage" [edges.coverage] choice::<Coverage>(),
        auto, rebuild, flag(flag("coverage", "MODE").common().first(COVERAGE)),
        "How strands thinner than a pixel cover it: all in order, layers of them, a sample mask, or alpha to coverage.";
    "layers" "Peeled layers" [edges.layers] integer(PLAIN, 1, Coverage::MAX_LAYERS, 1),
        rebuild, flag(flag("layers", "N")),
        "Layers of hair that are sorted, a pass each (peel only); more for light, thin hair.";
    "ssaa" "Supersampling" [edges.ssaa] integer(TIMES, 1, 2, 1),
        rebuild, flag(flag("ssaa", "N")),
        "Pixels drawn per pixel shown, along each axis; 2 costs four times as much.";
    "min_width" "Minimum width" [shading.material.min_width] number(PIXELS, 0.0, 10.0), advanced,
        "Thinner strands are drawn this wide and proportionally sparser (mask only).";
};

/// Whoever gives one of the two does not want the other of a preset, which was chosen with another.
const SAMPLES: &[Part] = &[value("edges.samples").resets(&["edges.coverage"])];
const COVERAGE: &[Part] = &[value("edges.coverage").resets(&["edges.samples"])];
