//! Cost of the methods of lighting, shading and drawing hair, compared with the same character, camera and motion.

use anyhow::{Context, Result};
use serde::Serialize;
use tresses_cli::{
    args::Size,
    bench::{
        Adapter, Sitting,
        results::{Run, measured},
        table::{ms, table},
        workload::{self, Drawing},
    },
    photographer::Photographer,
};
use tresses_scene::Value::{self, Choice, Integer};
use tresses_scene::{settings::Lamp, words::grouped};

/// Image size and number of drawn strands.
const FULL: (Size, u32) = (Size { width: 1280, height: 720 }, 20_000);
/// The same for software adapters, where frames take seconds.
const SOFTWARE: (Size, u32) = (Size { width: 640, height: 360 }, 5_000);
/// Default number of measured frames on software adapters.
pub const SOFTWARE_FRAMES: u32 = 3;
/// One method of drawing the character.
pub struct Variant {
    /// Topic of the comparison, a heading.
    topic: &'static str,
    /// Name of the method.
    name: &'static str,
    drawing: Drawing,
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
        let samples = self.drawing.iter().find(|(path, _)| *path == "renderer.samples");
        let count = |(_, value): &(_, Value)| match value {
            Choice(count) => count.parse().ok(),
            _ => None,
        };
        samples.and_then(count).is_none_or(|samples: u32| samples <= most)
    }
}

const TILES: (&str, Value) = ("renderer.kind", Choice("tiles"));
const MASKS: (&str, Value) = ("renderer.kind", Choice("masks"));
const CLASSIC: (&str, Value) = ("renderer.kind", Choice("classic"));
const ALPHA: (&str, Value) = ("renderer.coverage", Choice("alpha"));
const PER_PIXEL: (&str, Value) = ("renderer.rate", Choice("pixel"));
const KAJIYA_KAY: (&str, Value) = ("shading.model", Choice("kajiya-kay"));
const ONE: (&str, Value) = ("renderer.samples", Choice("1"));
const FOUR: (&str, Value) = ("renderer.samples", Choice("4"));
const EIGHT: (&str, Value) = ("renderer.samples", Choice("8"));
const SSAA: (&str, Value) = ("renderer.ssaa", Integer(2));

const ONE_LAYER: (&str, Value) = ("renderer.layers", Integer(1));
const EIGHT_LAYERS: (&str, Value) = ("renderer.layers", Integer(8));
const ABSORPTION: (&str, Value) = ("renderer.shadows", Choice("absorption"));
const OPAQUE: (&str, Value) = ("renderer.shadows", Choice("opaque"));

/// Returns all methods by topic. The first of a topic is the default.
pub fn variants() -> Vec<Variant> {
    let variant = |topic, name, drawing| Variant { topic, name, drawing, set: |_| {} };
    let shading = |name, drawing| variant("shading", name, drawing);
    let shadows = |name, drawing| variant("shadows", name, drawing);
    let samples = |name, drawing| variant("samples", name, drawing);
    let coverage = |name, drawing| variant("coverage", name, drawing);
    vec![
        shading("fiber, masks", &[MASKS, FOUR]),
        shading("Kajiya–Kay, masks", &[MASKS, FOUR, KAJIYA_KAY]),
        shading("Kajiya–Kay, classic, per strand vertex", &[CLASSIC, ALPHA, FOUR]),
        shading("Kajiya–Kay, classic, per pixel", &[CLASSIC, ALPHA, FOUR, PER_PIXEL]),
        shadows("deep opacity maps", &[CLASSIC, ALPHA, FOUR]),
        shadows("absorption", &[CLASSIC, ALPHA, FOUR, ABSORPTION]),
        shadows("opaque", &[CLASSIC, ALPHA, FOUR, OPAQUE]),
        Variant {
            set: |scene| {
                let light = |x: f32, z: f32| Lamp {
                    azimuth: x.atan2(z),
                    elevation: 0.5f32.atan2(x.hypot(z)),
                    irradiance: 1.0,
                };
                scene.lighting.lamps = [light(1.0, 0.3), light(-1.0, -0.3)];
            },
            ..shadows("deep opacity maps, four lights", &[CLASSIC, ALPHA, FOUR])
        },
        samples("4×MSAA", &[MASKS, FOUR]),
        samples("1 sample", &[MASKS, ONE]),
        samples("8×MSAA", &[MASKS, EIGHT]),
        samples("2×2 SSAA", &[MASKS, ONE, SSAA]),
        samples("4×MSAA and 2×2 SSAA", &[MASKS, FOUR, SSAA]),
        coverage("masks, 4×MSAA", &[MASKS, FOUR]),
        coverage("alpha to coverage, 4×MSAA", &[CLASSIC, ALPHA, FOUR]),
        coverage("tiles", &[TILES, FOUR]),
        coverage("tiles, 1 sample", &[TILES, ONE]),
        coverage("1 peeled layer", &[CLASSIC, ONE_LAYER]),
        coverage("4 peeled layers", &[CLASSIC]),
        coverage("8 peeled layers", &[CLASSIC, EIGHT_LAYERS]),
        coverage("4 peeled layers and 2×2 SSAA", &[CLASSIC, SSAA]),
    ]
}

/// Measures one method.
pub fn measure(variant: &Variant, software: bool, sitting: Sitting<'_>) -> Result<Look> {
    let (size, strands) = if software { SOFTWARE } else { FULL };
    let mut scene = Photographer::open(&workload::style(Some(strands), variant.drawing), size)
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
