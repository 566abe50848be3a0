//! Measured scenes: the two scenes of the 2008 talk, a WebGPU peer's scene, presets, and a series of strand counts.

use super::{
    recorded::StageCommands,
    results::{Run, SceneResults, StageSamples, StrandPoint},
    sitting::Sitting,
    statistics::Summary,
};
use crate::{args::Size, photographer::Photographer, preset_args};
use anyhow::{Context, Result};
use std::{path::PathBuf, time::Instant};
use tresses::{LodMode, groom::grow::Growth};
use tresses_scene::{Motion, Preset, PresetSource, Settings, Value, Viewpoint, camera::Angle};

/// Warm-up frames, in which shaders are compiled.
pub const WARM_UP: u32 = 2;

/// Time limit of a scene, seconds. After it, at least [`MIN_FRAMES`] frames are measured and no more: a software
/// driver's frames take seconds.
const LONG: f64 = 10.0;
const MIN_FRAMES: usize = 5;

/// Frames per second of the measured motion.
pub const FPS: f64 = 60.0;

/// One scene to measure.
pub struct Workload {
    /// Name for the report.
    pub name: String,
    others: &'static str,
    /// Hair and settings.
    pub preset: Preset,
    /// Chooses the strand count for about this many triangles.
    triangles: Option<u64>,
    /// Image size, pixels.
    pub size: Size,
    /// Distance of the camera, meters; `None` for a portrait.
    pub distance: Option<f32>,
    /// Number of cards to draw instead of strands.
    pub cards: Option<u32>,
    /// Names of the states and their motions.
    pub runs: Vec<(&'static str, &'static str)>,
}

/// Parameters of the renderer with values other than the command's defaults.
pub type RendererOverrides = &'static [(&'static str, Value)];

/// The command's default: tiles.
pub const TILES: RendererOverrides = &[];

/// Sample masks with one sample, as a WebGPU peer draws.
const ONE_SAMPLE: RendererOverrides =
    &[("renderer.kind", Value::Choice("masks")), ("renderer.samples", Value::Choice("1"))];

/// The talk of 2008: alpha to coverage with 8×MSAA, or the adapter's maximum.
const TALK: RendererOverrides = &[
    ("renderer.kind", Value::Choice("classic")),
    ("renderer.coverage", Value::Choice("alpha")),
    ("renderer.samples", Value::Choice("8")),
];
/// The second scene of the talk.
const TALK_SUPERSAMPLED: RendererOverrides = &[
    ("renderer.kind", Value::Choice("classic")),
    ("renderer.coverage", Value::Choice("alpha")),
    ("renderer.samples", Value::Choice("8")),
    ("renderer.ssaa", Value::Integer(2)),
];

/// Returns a preset of `source`, drawn by `drawing`, without level of detail.
pub fn preset(source: PresetSource, drawing: RendererOverrides) -> Preset {
    let mut settings = Settings::default();
    for (path, value) in drawing {
        settings.set(path, *value).expect("values of the table");
    }
    settings.lod.mode = LodMode::Off;
    Preset { source, settings, name: None }
}

/// Returns the built-in long style, with its own or the given number of strands.
pub fn style(strands: Option<u32>, drawing: RendererOverrides) -> Preset {
    let mut preset = preset(PresetSource { style: Some("long".into()), ..PresetSource::default() }, drawing);
    if let Some(strands) = strands {
        preset.settings.set("style.strands", strands).expect("a number of strands");
    }
    preset
}

/// Returns the two scenes of the 2008 talk, each by the classic renderer and by tiles.
pub fn seed() -> Vec<Workload> {
    let scene = |name: &str, others, drawing, triangles, size| Workload {
        name: format!("The 2008 talk, {name}"),
        others,
        preset: style(None, drawing),
        triangles: Some(triangles),
        size,
        distance: None,
        cards: None,
        runs: vec![("at rest", "still"), ("in motion", "turn")],
    };
    let first = |name, drawing| {
        let others = "GeForce 8800 GTX, 2008, 8×MSAA: 15.6 ms at rest, 24.4 ms in motion";
        scene(name, others, drawing, 990_000, Size { width: 1920, height: 1200 })
    };
    let second = |name, drawing| {
        let others = "GeForce 8800 GTX, 2008, 8×MSAA: 41.7 ms at rest, 57.1 ms in motion";
        scene(name, others, drawing, 2_100_000, Size { width: 1280, height: 1024 })
    };
    vec![
        first("first scene, classic", TALK),
        first("first scene, tiles", TILES),
        second("second scene, classic", TALK_SUPERSAMPLED),
        second("second scene, tiles", TILES),
    ]
}

/// Returns a groom with every strand simulated, at the size and sample count of a WebGPU peer: with the peer's way of
/// drawing, and with the command's default.
pub fn peer(grooms: &[PathBuf], heads: &[PathBuf]) -> Option<[Workload; 2]> {
    let is_default = grooms.is_empty();
    let (grooms, heads) = if is_default {
        let folder = PathBuf::from(std::env::var_os("TRESSES_ASSETS")?).join("sintel");
        let groom = folder.join("SintelHairOriginal-sintel_hair.16points.tfx");
        if !groom.exists() {
            return None;
        }
        (vec![groom], vec![folder.join("sintel.obj")])
    } else {
        (grooms.to_vec(), heads.to_vec())
    };
    let others = if is_default {
        "A WebGPU peer, two CPU cores, software Vulkan: simulate 109 ms, draw 117 ms, whole frame 1113 ms"
    } else {
        ""
    };
    let source = PresetSource { grooms, heads, ..PresetSource::default() };
    let drawn = |name: &str, drawing| {
        let mut preset = preset(source.clone(), drawing);
        preset.settings.style.all_guides = true;
        Workload {
            name: name.into(),
            others,
            preset,
            triangles: None,
            size: Size { width: 1280, height: 720 },
            distance: None,
            cards: None,
            runs: vec![("at rest", "still"), ("in motion", "turn")],
        }
    };
    Some([
        drawn("Every strand of a groom simulated, masks", ONE_SAMPLE),
        drawn("Every strand of a groom simulated, tiles", TILES),
    ])
}

/// Returns the built-in long style as the command draws it.
pub fn long() -> Workload {
    Workload {
        name: "The style long".into(),
        others: "",
        preset: style(None, TILES),
        triangles: None,
        size: Size { width: 1280, height: 720 },
        distance: None,
        cards: None,
        runs: vec![("in motion", "turn")],
    }
}

/// Returns the hair and settings of the preset at `path`.
pub fn of_preset(
    path: &PathBuf,
    size: Size,
    (distance, cards): (Option<f32>, Option<u32>),
) -> Result<Workload> {
    let preset = preset_args::open(Some(path))?;
    let name = preset.name.clone().unwrap_or_else(|| path.display().to_string());
    Ok(Workload {
        name: format!("The preset {name}"),
        others: "",
        preset,
        triangles: None,
        size,
        distance,
        cards,
        runs: vec![("at rest", "still"), ("in motion", "turn")],
    })
}

/// Returns the strand counts of the series.
pub fn strand_counts(quick: bool) -> Vec<u32> {
    if quick { vec![1_000, 10_000, 100_000] } else { vec![1_000, 3_000, 10_000, 30_000, 100_000] }
}

/// Returns the number of strands of the default style that make about `triangles` triangles.
fn strands_for(triangles: u64) -> u32 {
    let segments = u64::from(Growth::default().vertex_count.max(2) - 1);
    u32::try_from(triangles / (2 * segments)).unwrap_or(u32::MAX)
}

impl Workload {
    /// Returns the hair and settings, with the strand count that the number of triangles asks for.
    pub fn counted_preset(&self) -> Result<Preset> {
        let mut preset = self.preset.clone();
        if let Some(triangles) = self.triangles {
            preset.settings.set("style.strands", strands_for(triangles))?;
        }
        Ok(preset)
    }
}

/// Measures `workload` in each of its states.
pub fn measure(workload: &Workload, sitting: Sitting<'_>) -> Result<SceneResults> {
    let preset = workload.counted_preset()?;
    let scene = Photographer::with_clamped_samples(&preset, workload.size, workload.cards);
    let mut scene = scene.with_context(|| workload.name.clone())?;
    let camera = camera(&scene, workload.size, workload.distance);
    let runs = workload
        .runs
        .iter()
        .map(|(state, motion)| run(&mut scene, state, motion, &camera, sitting))
        .collect::<Result<_>>()?;
    let facts = scene.facts();
    Ok(SceneResults {
        name: workload.name.clone(),
        others: workload.others.into(),
        size: [workload.size.width, workload.size.height],
        samples: scene.samples(),
        ssaa: preset.settings.ssaa,
        guides: facts.guides,
        strands: facts.strands,
        vertices_per_strand: facts.vertices_per_strand,
        triangles: facts.triangles,
        bytes: facts.bytes,
        bytes_per_vertex: facts.bytes as f64
            / (f64::from(facts.strands) * f64::from(facts.vertices_per_strand)).max(1.0),
        runs,
    })
}

/// Measures the long style with `strands` strands.
pub fn point(strands: u32, sitting: Sitting<'_>) -> Result<StrandPoint> {
    let size = Size { width: 1280, height: 720 };
    let mut scene = Photographer::with_clamped_samples(&style(Some(strands), TILES), size, None)?;
    let camera = camera(&scene, size, None);
    let run = run(&mut scene, "in motion", "turn", &camera, sitting)?;
    Ok(StrandPoint { strands: scene.facts().strands, gpu: run.gpu, frame: run.frame })
}

/// Returns a portrait camera, or the same direction from `distance` meters.
pub fn camera(scene: &Photographer, size: Size, distance: Option<f32>) -> Viewpoint {
    let portrait = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), size.aspect(), 1.0);
    distance.map_or(portrait, |meters| portrait.at_distance(meters))
}

/// Measures `scene` in a motion.
pub fn run(
    scene: &mut Photographer,
    state: &str,
    motion: &str,
    camera: &Viewpoint,
    Sitting { frames, clock, bar }: Sitting<'_>,
) -> Result<Run> {
    scene.measure_by(clock);
    let motion = Motion::named(motion).context("a built-in motion")?;
    let pivot = scene.character.neck();
    scene.reset(&motion.gesture(0.0, pivot))?;
    let mut stages = StageSamples::default();
    let (mut sums, mut walls, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    let start = Instant::now();
    for frame in 0..WARM_UP + frames {
        if walls.len() >= MIN_FRAMES && start.elapsed().as_secs_f64() > LONG {
            bar.inc(u64::from(WARM_UP + frames - frame));
            break;
        }
        let pose = motion.gesture(f64::from(frame + 1) / FPS, pivot);
        let measured = scene.measured_frame(&pose, (1.0 / FPS) as f32, camera)?;
        if frame < WARM_UP {
            continue;
        }
        bar.inc(1);
        walls.push(measured.wall);
        counts = measured.counts;
        sums.push(stages.add(measured.stages));
    }
    Ok(Run {
        state: state.into(),
        frames: walls.len() as u32,
        stages: stages.summarize(),
        recorded: counts.into_iter().map(StageCommands::from).collect(),
        gpu: Summary::of(sums),
        frame: Summary::of(walls),
    })
}
