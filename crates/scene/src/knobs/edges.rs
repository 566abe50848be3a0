//! Parameters of antialiasing.

use super::{
    Access, Choice, Knob, Section, Value, ValueKind,
    flags::{FlagValue, flag, value},
    rows,
    value::*,
};
use tresses::draw::Coverage;

pub(super) const SECTION: Section = Section {
    key: "edges",
    title: "Antialiasing",
    about: "Samples per pixel, and coverage by strands thinner than a pixel.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "edges";
    "samples" "Samples per pixel" {SAMPLES} ValueKind::Choice(COUNTS),
        auto, rebuild, flag(flag("samples", "N").first(SAMPLES_ALONE)),
        also("msaa; antialiasing"),
        "MSAA samples of bodies, and of hair with mask and alpha; not every adapter supports more than 4.";
    "coverage" "Coverage" [view.coverage] choice::<Coverage>(),
        auto, rebuild, flag(flag("coverage", "MODE").common().first(COVERAGE_ALONE)),
        also("oit; order independent transparency"),
        "Blending of strands thinner than a pixel: tiles, peeled layers, sample mask, or alpha to coverage.";
    "layers" "Peeled layers" [peeled_layers] integer(PLAIN, 1, Coverage::MAX_LAYERS, 1),
        rebuild, flag(flag("layers", "N")),
        also("depth peeling"),
        "Sorted layers of hair, one pass each (peel only); more for light, thin hair.";
    "ssaa" "Supersampling" [ssaa] integer(TIMES, 1, 2, 1),
        rebuild, flag(flag("ssaa", "N")),
        also("resolution scale; screen percentage"),
        "Rendered pixels per output pixel along each axis; 2 costs four times as much.";
    "min_width" "Minimum width" [shading.material.min_width] number(PIXELS, 0.0, 10.0), advanced,
        also("min pixel width; stable rasterization"),
        "Thinner strands are drawn this wide and proportionally sparser (mask only).";
};

/// A flag for one of the two resets the other, because a preset chooses them as a pair.
const SAMPLES_ALONE: &[FlagValue] = &[value("edges.samples").resets(&["edges.coverage"])];
const COVERAGE_ALONE: &[FlagValue] = &[value("edges.coverage").resets(&["edges.samples"])];

/// Sample counts that adapters may support.
const COUNTS: &[Choice] = &[
    Choice { name: "1", hint: "one sample" },
    Choice { name: "4", hint: "4×MSAA" },
    Choice { name: "8", hint: "8×MSAA" },
    Choice { name: "16", hint: "16×MSAA" },
];

/// The sample count as a named choice.
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
