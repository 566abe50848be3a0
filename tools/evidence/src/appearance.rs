//! Cost of the methods of lighting, shading and drawing hair, compared with the same character, camera and motion.

use anyhow::{Context, Result};
use serde::Serialize;
use tresses::light::{ShadingModel, ShadingRate, ShadowMethod};
use tresses_cli::{
    args::Size,
    bench::{
        Adapter, Sitting,
        results::{Run, measured},
        table::{ms, table},
        workload::{self, Edges, masks},
    },
    photographer::Photographer,
};
use tresses_scene::{settings::Lamp, words::grouped};

/// Image size and number of drawn strands.
const FULL: (Size, u32) = (Size { width: 1280, height: 720 }, 20_000);
/// The same for software adapters, where frames take seconds.
const SOFTWARE: (Size, u32) = (Size { width: 640, height: 360 }, 5_000);
/// Default number of measured frames on software adapters.
pub const SOFTWARE_FRAMES: u32 = 3;
/// Samples per pixel of variants that do not compare sample counts.
const SAMPLES: &str = "4";

/// One method of drawing the character.
pub struct Variant {
    /// Topic of the comparison, a heading.
    topic: &'static str,
    /// Name of the method.
    name: &'static str,
    edges: Edges,
    set: fn(&mut Photographer),
}

/// Cost of one method.
#[derive(Debug, Serialize)]
pub struct Look {
    /// Topic of the comparison.
    pub topic: String,
    /// Name of the method.
    pub name: String,
    /// Image size, pixels.
    pub size: [u32; 2],
    /// Number of drawn strands.
    pub strands: u32,
    /// GPU memory per pixel of the image: colors, depth, layers.
    pub bytes_per_pixel: f64,
    /// Times.
    pub run: Run,
}

impl Variant {
    /// Whether an adapter with at most `most` samples per pixel supports the method.
    pub fn fits(&self, most: u32) -> bool {
        self.edges
            .modes
            .and_then(|(samples, _)| samples.parse().ok())
            .is_none_or(|samples: u32| samples <= most)
    }
}

/// Returns all methods by topic. The first of a topic is the default.
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
        shading("fiber, per strand vertex", |_| {}),
        shading("Kajiya–Kay, per strand vertex", |scene| {
            scene.character.hair_mut().set.material.model = ShadingModel::KajiyaKay;
        }),
        shading("fiber, per pixel", |scene| scene.picture.shading = ShadingRate::PerPixel),
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

/// Measures one method.
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

/// Formats the costs of drawing as a table; empty without any.
pub fn text(looks: &[Look], adapter: &Adapter) -> String {
    let Some(first) = looks.first() else { return String::new() };
    // The stages before "shadow" simulate, which is the same for all.
    let drawing = |run: &Run| {
        let from = run.stages.iter().position(|stage| stage.name == "shadow").unwrap_or(0);
        run.stages[from..].iter().map(|stage| (stage.name.clone(), stage.time.median)).collect::<Vec<_>>()
    };
    let mut names: Vec<String> = Vec::new();
    for look in looks {
        // A stage that only some methods have is listed after its predecessor there.
        let mut at = 0;
        for (name, _) in drawing(&look.run) {
            match names.iter().position(|known| *known == name) {
                Some(known) => at = known + 1,
                None => {
                    names.insert(at, name);
                    at += 1;
                }
            }
        }
    }
    let head = [String::new()].into_iter().chain(names.iter().cloned());
    let mut rows = vec![head.chain(["sum".into(), "bytes per pixel".into()]).collect::<Vec<_>>()];
    let mut topic = "";
    for look in looks {
        if look.topic != topic {
            topic = &look.topic;
            rows.push(vec![format!("{topic}:")]);
        }
        let times = drawing(&look.run);
        let time = |name: &String| times.iter().find(|(known, _)| known == name).map(|(_, ms)| *ms);
        let mut row = vec![format!("  {}", look.name)];
        row.extend(names.iter().map(|name| time(name).map_or("-".into(), ms)));
        row.push(ms(times.iter().map(|(_, ms)| ms).sum()));
        row.push(format!("{:.0}", look.bytes_per_pixel));
        rows.push(row);
    }
    let most = adapter.max_samples;
    format!(
        "\nDrawing (style long in motion, {} strands, {} × {}{}; 4×MSAA unless noted{}), \
         medians of {}\n{}",
        grouped(first.strands.into()),
        first.size[0],
        first.size[1],
        if adapter.software { ", less than on a GPU" } else { "" },
        if most < 8 { format!(", at most {most} on this adapter") } else { String::new() },
        measured(looks.iter().map(|look| look.run.frames)),
        table(&rows)
    )
}
