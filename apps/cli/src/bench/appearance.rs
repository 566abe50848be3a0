//! What the ways to light, shade and draw hair cost, held against each other: one character, one
//! camera, one motion.

use super::{report::Run, workload};
use crate::{
    args::Size,
    edge_args::{EdgeArgs, Mode},
    scene::{Quality, Scene},
};
use anyhow::{Context, Result};
use indicatif::ProgressBar;
use serde::Serialize;
use tresses::{
    glam::Vec3,
    light::{Directional, ShadingModel, ShadingRate, ShadowMethod},
};

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
    let light = |topic, name, set| Variant { topic, name, quality: workload::quality(SIZE, SAMPLES, 1), set };
    let shading = |name, set| light("shading", name, set);
    let shadows = |name, set| light("shadows", name, set);
    let samples = |name, samples, ssaa| Variant {
        topic: "samples",
        name,
        quality: workload::quality(SIZE, samples, ssaa),
        set: |_| {},
    };
    let coverage = |name, samples, ssaa, mode, layers| Variant {
        topic: "coverage",
        name,
        quality: quality(samples, ssaa, mode, layers),
        set: |_| {},
    };
    vec![
        shading("fibre, per strand vertex", |_| {}),
        shading("Kajiya–Kay, per strand vertex", |scene| {
            scene.look.hair.model = ShadingModel::KajiyaKay;
        }),
        shading("fibre, per pixel", |scene| scene.look.shading = ShadingRate::PerPixel),
        shading("Kajiya–Kay, per pixel", |scene| {
            let look = &mut scene.look;
            (look.hair.model, look.shading) = (ShadingModel::KajiyaKay, ShadingRate::PerPixel);
        }),
        shadows("deep opacity maps", |_| {}),
        shadows("absorption", |scene| scene.look.shadows.method = ShadowMethod::Absorption),
        shadows("opaque", |scene| scene.look.shadows.method = ShadowMethod::Opaque),
        shadows("deep opacity maps, four lights", |scene| {
            let light = |x, z| Directional { direction: Vec3::new(x, 0.5, z), irradiance: Vec3::ONE };
            scene.add_lights([light(1.0, 0.3), light(-1.0, -0.3)]);
        }),
        shadows("deep opacity maps, per pixel", |scene| {
            scene.look.shading = ShadingRate::PerPixel;
            scene.look.shadows.per_pixel = true;
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
    let mut scene = Scene::open(&workload::style(Some(STRANDS)), variant.quality)
        .with_context(|| format!("{}, {}", variant.topic, variant.name))?;
    (variant.set)(&mut scene);
    let run = workload::run(&mut scene, "in motion", "turn", SIZE, frames, bar)?;
    Ok(Look { topic: variant.topic.into(), name: variant.name.into(), run })
}
