//! What the ways to light, shade and draw hair cost, held against each other: one character, one
//! camera, one motion.

use super::workload;
use crate::{
    args::{Size, Source},
    edge_args::{EdgeArgs, Mode},
    scene::{Quality, Scene},
};
use anyhow::{Context, Result};
use indicatif::ProgressBar;
use tresses::light::{ShadingModel, ShadingRate};

use super::report::Run;
use serde::Serialize;

/// Pixels.
const SIZE: Size = Size { width: 1280, height: 720 };
/// Drawn strands.
const STRANDS: u32 = 20_000;
/// Samples per pixel where samples are not what is compared.
const SAMPLES: u32 = 4;

/// One way to draw the character.
pub struct Variant {
    /// What is compared: a heading.
    topic: &'static str,
    /// Which of its ways.
    name: &'static str,
    quality: Quality,
    set: fn(&mut Scene),
}

/// What one way costs.
#[derive(Debug, Serialize)]
pub struct Look {
    /// What is compared.
    pub topic: String,
    /// Which of its ways.
    pub name: String,
    /// Times.
    pub run: Run,
}

fn quality(samples: u32, ssaa: u32, coverage: Mode, layers: Option<u32>) -> Quality {
    let edges = EdgeArgs { samples: Some(samples), ssaa, coverage: Some(coverage), layers };
    Quality { at_most: true, ..Quality::new(SIZE, edges) }
}

/// All that are measured, topic by topic; the first of a topic is the default.
pub fn variants() -> Vec<Variant> {
    let shading =
        |name, set| Variant { topic: "shading", name, quality: quality(SAMPLES, 1, Mode::Mask, None), set };
    let samples = |name, samples, ssaa| Variant {
        topic: "samples",
        name,
        quality: quality(samples, ssaa, Mode::Mask, None),
        set: |_| {},
    };
    let coverage = |name, samples, ssaa, mode, layers| Variant {
        topic: "coverage",
        name,
        quality: quality(samples, ssaa, mode, layers),
        set: |_| {},
    };
    vec![
        shading("per strand vertex", |_| {}),
        shading("per pixel", |scene| scene.look_mut().shading = ShadingRate::PerPixel),
        shading("fibre, per strand vertex", |scene| scene.look_mut().hair.model = ShadingModel::Fiber),
        shading("fibre, per pixel", |scene| {
            let look = scene.look_mut();
            (look.hair.model, look.shading) = (ShadingModel::Fiber, ShadingRate::PerPixel);
        }),
        samples("4×MSAA", 4, 1),
        samples("1 sample", 1, 1),
        samples("8×MSAA", 8, 1),
        samples("2×2 SSAA", 1, 2),
        samples("4×MSAA and 2×2 SSAA", 4, 2),
        coverage("masks, 4×MSAA", 4, 1, Mode::Mask, None),
        coverage("alpha to coverage, 4×MSAA", 4, 1, Mode::Alpha, None),
        coverage("1 peeled layer", 1, 1, Mode::Peel, Some(1)),
        coverage("4 peeled layers", 1, 1, Mode::Peel, Some(4)),
        coverage("8 peeled layers", 1, 1, Mode::Peel, Some(8)),
        coverage("4 peeled layers and 2×2 SSAA", 1, 2, Mode::Peel, Some(4)),
    ]
}

/// Measures one of them.
pub fn measure(variant: &Variant, frames: u32, bar: &ProgressBar) -> Result<Look> {
    let source = Source { style: Some("long".into()), strands: Some(STRANDS), ..Source::default() };
    let mut scene = Scene::open(&source, variant.quality)
        .with_context(|| format!("{}, {}", variant.topic, variant.name))?;
    (variant.set)(&mut scene);
    let run = workload::run(&mut scene, "in motion", "turn", SIZE, frames, bar)?;
    Ok(Look { topic: variant.topic.into(), name: variant.name.into(), run })
}
