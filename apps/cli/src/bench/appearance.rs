//! The cost of the methods of lighting, shading and drawing hair, compared: one character, one camera, one
//! motion.

use super::{
    results::Run,
    sitting::Sitting,
    workload::{self, Edges, masks},
};
use crate::{args::Size, photographer::Photographer};
use anyhow::{Context, Result};
use serde::Serialize;
use tresses::light::{ShadingModel, ShadingRate, ShadowMethod};
use tresses_scene::settings::Lamp;

/// Pixels, and drawn strands.
const FULL: (Size, u32) = (Size { width: 1280, height: 720 }, 20_000);
/// The same on a software adapter, where frames take seconds.
const SOFTWARE: (Size, u32) = (Size { width: 640, height: 360 }, 5_000);
/// Measured frames there, if none are asked for.
pub const SOFTWARE_FRAMES: u32 = 3;
/// Samples per pixel where samples are not what is compared.
const SAMPLES: &str = "4";

/// One way to draw the character.
pub struct Variant {
    /// What is compared: a heading.
    topic: &'static str,
    /// Which of its ways.
    name: &'static str,
    edges: Edges,
    set: fn(&mut Photographer),
}

/// What one way costs.
#[derive(Debug, Serialize)]
pub struct Look {
    /// What is compared.
    pub topic: String,
    /// Which of its ways.
    pub name: String,
    /// Of the picture, pixels.
    pub size: [u32; 2],
    /// Drawn.
    pub strands: u32,
    /// GPU memory per pixel of the picture: colours, depth, layers.
    pub bytes_per_pixel: f64,
    /// Times.
    pub run: Run,
}

impl Variant {
    /// Whether an adapter that offers at most `most` samples per pixel can draw it.
    pub fn fits(&self, most: u32) -> bool {
        self.edges
            .modes
            .and_then(|(samples, _)| samples.parse().ok())
            .is_none_or(|samples: u32| samples <= most)
    }
}

/// All that are measured, topic by topic; the first of a topic is the default.
pub fn variants() -> Vec<Variant> {
    let light = |topic, name, set| Variant { topic, name, edges: masks(SAMPLES, 1), set };
    let shading = |name, set| light("shading", name, set);
    let shadows = |name, set| light("shadows", name, set);
    let samples =
        |name, samples, ssaa| Variant { topic: "samples", name, edges: masks(samples, ssaa), set: |_| {} };
    let coverage = |name, samples, ssaa, mode, layers| Variant {
        topic: "coverage",
        name,
        edges: Edges { modes: Some((samples, mode)), layers, ssaa: Some(ssaa) },
        set: |_| {},
    };
    vec![
        shading("fibre, per strand vertex", |_| {}),
        shading("Kajiya–Kay, per strand vertex", |scene| {
            scene.character.hair_mut().set.material.model = ShadingModel::KajiyaKay;
        }),
        shading("fibre, per pixel", |scene| scene.picture.shading = ShadingRate::PerPixel),
        shading("Kajiya–Kay, per pixel", |scene| {
            scene.character.hair_mut().set.material.model = ShadingModel::KajiyaKay;
            scene.picture.shading = ShadingRate::PerPixel;
        }),
        shadows("deep opacity maps", |_| {}),
        shadows("absorption", |scene| scene.picture.shadows.method = ShadowMethod::Absorption),
        shadows("opaque", |scene| scene.picture.shadows.method = ShadowMethod::Opaque),
        shadows("deep opacity maps, four lights", |scene| {
            let light = |x: f32, z: f32| Lamp {
                azimuth: x.atan2(z),
                elevation: 0.5f32.atan2(x.hypot(z)),
                irradiance: 1.0,
            };
            scene.lighting.lamps = [light(1.0, 0.3), light(-1.0, -0.3)];
        }),
        shadows("deep opacity maps, per pixel", |scene| {
            scene.picture.shading = ShadingRate::PerPixel;
            scene.picture.shadows.per_pixel = true;
        }),
        samples("4×MSAA", "4", 1),
        samples("1 sample", "1", 1),
        samples("8×MSAA", "8", 1),
        samples("2×2 SSAA", "1", 2),
        samples("4×MSAA and 2×2 SSAA", "4", 2),
        coverage("masks, 4×MSAA", "4", 1, "mask", None),
        coverage("alpha to coverage, 4×MSAA", "4", 1, "alpha", None),
        coverage("tiles", "4", 1, "tiles", None),
        coverage("tiles, 1 sample", "1", 1, "tiles", None),
        coverage("1 peeled layer", "1", 1, "peel", Some(1)),
        coverage("4 peeled layers", "1", 1, "peel", Some(4)),
        coverage("8 peeled layers", "1", 1, "peel", Some(8)),
        coverage("4 peeled layers and 2×2 SSAA", "1", 2, "peel", Some(4)),
    ]
}

/// Measures one of them.
pub fn measure(variant: &Variant, software: bool, sitting: Sitting<'_>) -> Result<Look> {
    let (size, strands) = if software { SOFTWARE } else { FULL };
    let mut scene = Photographer::open(&workload::style(Some(strands), variant.edges), size)
        .with_context(|| format!("{}, {}", variant.topic, variant.name))?;
    (variant.set)(&mut scene);
    let camera = workload::camera(&scene, size, None);
    let run = workload::run(&mut scene, "in motion", "turn", &camera, sitting)?;
    Ok(Look {
        topic: variant.topic.into(),
        name: variant.name.into(),
        size: [size.width, size.height],
        strands: scene.facts().strands,
        bytes_per_pixel: scene.bytes_per_pixel(),
        run,
    })
}
