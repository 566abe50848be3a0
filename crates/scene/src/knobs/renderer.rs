//! Parameters of the renderer.

use super::{
    Access, Choice, Knob, Section, Value, ValueKind,
    flags::{FlagValue, flag, value},
    rows,
    value::*,
};
use crate::settings::{ClassicBlending, RendererKind};
use tresses::renderer::{ClassicCoverage, ShadingRate, ShadowMethod};

pub(super) const SECTION: Section = Section {
    key: "renderer",
    title: "Renderer",
    about: "How hair is drawn, and samples per pixel.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "renderer";
    "kind" "Renderer" [renderer.kind] choice::<RendererKind>(),
        auto, rebuild, flag(flag("renderer", "NAME").common().first(KIND)),
        also("oit; order independent transparency; coverage"),
        "Blending of strands thinner than a pixel: tiles, sample masks, or the classic renderer of 2008.";
    "samples" "Samples per pixel" {SAMPLES} ValueKind::Choice(COUNTS),
        auto, rebuild, flag(flag("samples", "N")),
        also("msaa; antialiasing"),
        "MSAA samples of bodies, and of hair with masks and alpha; not every adapter supports more than 4.";
    "ssaa" "Supersampling" [ssaa] integer(TIMES, 1, 2, 1),
        rebuild, flag(flag("ssaa", "N")),
        also("resolution scale; screen percentage"),
        "Rendered pixels per output pixel along each axis; 2 costs four times as much.";
    "coverage" "Classic coverage" [renderer.coverage] choice::<ClassicBlending>(),
        only(RendererKind::Classic), auto, rebuild, flag(flag("coverage", "MODE").first(COVERAGE)),
        "Blending of the classic renderer: peeled layers, or alpha to coverage (classic only).";
    "layers" "Peeled layers" [renderer.layers] integer(PLAIN, 1, ClassicCoverage::MAX_LAYERS, 1),
        only(RendererKind::Classic), rebuild, flag(flag("layers", "N")),
        also("depth peeling"),
        "Sorted layers of hair, one pass each; more for light, thin hair (classic only, with peel).";
    "rate" "Shade per" [renderer.rate] choice::<ShadingRate>(),
        only(RendererKind::Classic), advanced, rebuild, flag(flag("shade-per", "WHERE")),
        "Shading rate: per strand vertex, or per pixel for finer noise at a higher cost (classic only).";
    "shadows" "Classic shadows" [renderer.shadows] choice::<ShadowMethod>(),
        only(RendererKind::Classic), rebuild, flag(flag("classic-shadows", "METHOD")),
        also("deep opacity map; self shadowing"),
        "Method that counts the fibers between a light and a point (classic only).";
    "min_width" "Minimum width" [shading.material.min_width] number(PIXELS, 0.0, 10.0),
        only(RendererKind::Masks), advanced,
        also("min pixel width; stable rasterization"),
        "Thinner strands are drawn this wide and proportionally sparser (masks only).";
};

/// The renderer of a preset has its own sample count and options.
const CLASSIC_ROWS: &[&str] =
    &["renderer.samples", "renderer.coverage", "renderer.layers", "renderer.rate", "renderer.shadows"];
const KIND: &[FlagValue] = &[value("renderer.kind").resets(CLASSIC_ROWS)];
const COVERAGE: &[FlagValue] = &[value("renderer.coverage").resets(&["renderer.kind", "renderer.samples"])];

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
        Value::Choice(match settings.renderer.samples {
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
            settings.renderer.samples = samples;
        }
    },
    copy: |to, from| to.renderer.samples = from.renderer.samples,
};
