//! Frames of the built-in character while it turns its head, and their memory.

use anyhow::{Context, Result};
use serde::Serialize;
use std::time::Instant;
use tresses_cli::{
    args::Size,
    bench::{
        PROCESSOR, Sitting,
        results::Run,
        statistics::Summary,
        workload::{self, FPS, WARM_UP},
    },
    photographer::Photographer,
};
use tresses_scene::{Motion, PresetSource, Viewpoint};

/// Image size, pixels.
pub const SIZE: Size = Size { width: 1280, height: 720 };
const MOTION: &str = "turn";
/// Time limit of whole frames, seconds. After it, at least [`MIN_FRAMES`] frames are measured and no more.
const LONG: f64 = 10.0;
const MIN_FRAMES: usize = 5;

/// One style with one strand count.
#[derive(Debug, Default, Serialize)]
pub struct FrameCase {
    /// Name of the style.
    pub style: String,
    /// Number of guides.
    pub guides: u32,
    /// Number of drawn strands.
    pub strands: u32,
    /// Vertices per drawn strand.
    pub vertices_per_strand: u32,
    /// Whether every strand is a guide.
    pub is_all_simulated: bool,
    /// Samples per pixel.
    pub samples: u32,
    /// Frames whose stages are submitted separately where the adapter has no comparable timestamps.
    pub run: Run,
    /// Frames that are submitted whole, milliseconds.
    #[serde(rename = "whole")]
    pub full_frame: Summary,
    /// Number of those.
    pub frames: u32,
    /// Their mean processor time of all threads, milliseconds, if the system reports it.
    pub processor: Option<f64>,
    /// GPU memory of the hair, bytes.
    pub hair_bytes: u64,
    /// GPU memory of the targets, shadow maps and ambient light of the view, bytes.
    pub view_bytes: u64,
}

impl FrameCase {
    /// GPU memory of the hair per drawn vertex.
    pub fn bytes_per_vertex(&self) -> f64 {
        let vertices = f64::from(self.strands) * f64::from(self.vertices_per_strand);
        self.hair_bytes as f64 / vertices.max(1.0)
    }
}

/// Measures `style`, with its own or the given number of strands, in full detail. `simulated` simulates every strand.
pub fn measure(
    style: &str,
    strands: Option<u32>,
    simulated: bool,
    sitting: Sitting<'_>,
) -> Result<FrameCase> {
    let source = PresetSource { style: Some(style.into()), ..PresetSource::default() };
    let mut preset = workload::preset(source, workload::TILES);
    if let Some(strands) = strands {
        preset.settings.set("style.strands", strands)?;
    }
    preset.settings.style.all_guides = simulated;
    let mut scene = Photographer::with_clamped_samples(&preset, SIZE, None)
        .with_context(|| format!("the style {style}"))?;
    let camera = workload::camera(&scene, SIZE, None);
    let run = workload::run(&mut scene, "in motion", MOTION, &camera, sitting)?;
    let (frame_times, processor) = measure_full_frames(&mut scene, &camera, sitting)?;
    let facts = scene.facts();
    Ok(FrameCase {
        style: style.into(),
        guides: facts.guides,
        strands: facts.strands,
        vertices_per_strand: facts.vertices_per_strand,
        is_all_simulated: simulated,
        samples: scene.samples(),
        run,
        frames: frame_times.len() as u32,
        processor,
        full_frame: Summary::of(frame_times),
        hair_bytes: facts.bytes,
        view_bytes: scene.targets().bytes() + scene.view.shadow_bytes() + scene.view.ambient_bytes(),
    })
}

/// Returns the times of frames that are submitted whole, and their mean processor time, milliseconds.
fn measure_full_frames(
    scene: &mut Photographer,
    camera: &Viewpoint,
    Sitting { frames, bar, .. }: Sitting<'_>,
) -> Result<(Vec<f64>, Option<f64>)> {
    let motion = Motion::named(MOTION).context("a built-in motion")?;
    let pivot = scene.character.neck();
    scene.reset(&motion.gesture(0.0, pivot))?;
    let mut times = Vec::new();
    let (start, mut spent) = (Instant::now(), None);
    for frame in 0..WARM_UP + frames {
        if times.len() >= MIN_FRAMES && start.elapsed().as_secs_f64() > LONG {
            bar.inc(u64::from(WARM_UP + frames - frame));
            break;
        }
        if frame == WARM_UP {
            spent = PROCESSOR.map(|now| now());
        }
        let gesture = motion.gesture(f64::from(frame + 1) / FPS, pivot);
        let time = scene.measured_frame_time(&gesture, (1.0 / FPS) as f32, camera)?;
        if frame >= WARM_UP {
            bar.inc(1);
            times.push(time);
        }
    }
    let processor = PROCESSOR.zip(spent);
    let processor =
        processor.map(|(now, then)| 1e3 * (now() - then).as_secs_f64() / times.len().max(1) as f64);
    Ok((times, processor))
}
