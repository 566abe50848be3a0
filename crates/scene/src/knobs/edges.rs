//! Parameters of antialiasing.

use super::{
    Access, Choice, Kind, Knob, Section, Value,
    flags::{Part, flag, value},
    rows,
    value::*,
};
use tresses::draw::Coverage;

pub(super) const SECTION: Section = Section {
    key: "edges",
    title: "Edges",
    about: "Antialiasing: samples per pixel, and how strands thinner than a pixel cover it.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "edges";
    "samples" "Samples per pixel" {SAMPLES} Kind::Choice(COUNTS),
        auto, rebuild, flag(flag("samples", "N").first(SAMPLES_ALONE)),
        "More give smoother edges of bodies, and of hair with mask and alpha; not every adapter has more than 4.";
    "coverage" "Coverage" [view.coverage] choice::<Coverage>(),
        auto, rebuild, flag(flag("coverage", "MODE").common().first(COVERAGE_ALONE)),
        "How strands thinner than a pixel cover it: all in order, layers of them, a sample mask, or alpha to coverage.";
    "layers" "Peeled layers" [peeled_layers] integer(PLAIN, 1, Coverage::MAX_LAYERS, 1),
        rebuild, flag(flag("layers", "N")),
        "Layers of hair that are sorted, a pass each (peel only); more for light, thin hair.";
    "ssaa" "Supersampling" [ssaa] integer(TIMES, 1, 2, 1),
        rebuild, flag(flag("ssaa", "N")),
        "Pixels drawn per pixel shown, along each axis; 2 costs four times as much.";
    "min_width" "Minimum width" [shading.material.min_width] number(PIXELS, 0.0, 10.0), advanced,
        "Thinner strands are drawn this wide and proportionally sparser (mask only).";
};

/// Whoever gives one of the two does not want the other of a preset, which was chosen with another.
const SAMPLES_ALONE: &[Part] = &[value("edges.samples").resets(&["edges.coverage"])];
const COVERAGE_ALONE: &[Part] = &[value("edges.coverage").resets(&["edges.samples"])];

/// Samples per pixel that adapters may offer.
const COUNTS: &[Choice] = &[
    Choice { name: "1", hint: "one sample" },
    Choice { name: "4", hint: "4×MSAA" },
    Choice { name: "8", hint: "8×MSAA" },
    Choice { name: "16", hint: "16×MSAA" },
];

/// A number of samples, which has a name.
const SAMPLES: Access = Access {
    get: |settings| {
        Value::Choice(match settings.view.samples {
            1 => "1",
            4 => "4",
            8 => "8",
            _ => "16",
        })
    },
    set: |settings, value| {
        if let Value::Choice(name) = value
            && let Ok(samples) = name.parse()
        {
            settings.view.samples = samples;
        }
    },
    copy: |to, from| to.view.samples = from.view.samples,
};
