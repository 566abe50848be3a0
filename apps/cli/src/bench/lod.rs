//! The cost of a frame at a distance, at full detail and at the matching level of detail, with the pixels that
//! the hair covers.

use super::{
    Sitting,
    report::{ms, table},
    statistics::Summary,
    workload::{self, FPS, WARM_UP},
};
use crate::{args::Size, photographer::Photographer};
use anyhow::{Context, Result};
use serde::Serialize;
use tresses::lod::{LodMode, LodOptions};
use tresses_scene::words::grouped;
use tresses_scene::{Motion, Viewpoint, camera::Angle};

/// Pixels.
const SIZE: Size = Size { width: 1280, height: 720 };
/// Drawn strands in full detail.
const STRANDS: u32 = 20_000;
/// Samples per pixel.
const SAMPLES: &str = "4";
/// Metres.
pub const DISTANCES: [f32; 6] = [0.8, 2.0, 4.0, 8.0, 16.0, 40.0];
/// The stages that simulate, whose work is that of the guides.
const MOVING: [&str; 4] = ["volume", "wind", "simulate", "tessellate"];
/// The stages that only the picture's size and the head matter to.
const OTHERS: [&str; 2] = ["body", "present"];

/// One distance.
#[derive(Debug, Serialize)]
pub struct Point {
    /// Metres.
    pub distance: f32,
    /// Measured for each of the two.
    pub frames: u32,
    /// What the hair covers.
    pub pixels: f64,
    /// All of it.
    pub full: Times,
    /// At its level of detail.
    pub lod: Times,
}

/// What it costs.
#[derive(Debug, Serialize)]
pub struct Times {
    /// Drawn.
    pub strands: u32,
    /// Of each strand.
    pub segments: f32,
    /// Milliseconds of the stages that work on strands.
    pub strand_stages: Summary,
    /// Milliseconds of those that work on guides, mean per frame.
    pub guide_stages: f64,
    /// Milliseconds of a whole frame.
    pub frame: Summary,
}

/// Measures the long style in motion at all distances.
pub fn measure(sitting: Sitting<'_>) -> Result<Vec<Point>> {
    let mut scene = Photographer::with_samples_at_most(
        &workload::style(Some(STRANDS), workload::masks(SAMPLES, 1)),
        SIZE,
    )
    .context("levels of detail")?;
    scene.measure_by(sitting.clock);
    let near = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), SIZE.aspect(), 1.0);
    DISTANCES.iter().map(|distance| point(&mut scene, &near.moved(*distance), sitting)).collect()
}

fn point(scene: &mut Photographer, camera: &Viewpoint, sitting: Sitting<'_>) -> Result<Point> {
    let Sitting { frames, bar, .. } = sitting;
    let motion = Motion::named("turn").context("a built-in motion")?;
    let pivot = scene.pivot();
    let way = |mode| LodOptions { mode, ..LodOptions::default() };
    let mut rows = Vec::new();
    for mode in [LodMode::Off, LodMode::Auto] {
        scene.set_lod(way(mode))?;
        scene.watch(camera);
        scene.reset(&motion.pose(0.0, pivot))?;
        let (mut strands, mut guides, mut whole) = (Vec::new(), Vec::new(), Vec::new());
        for frame in 0..WARM_UP + frames {
            let pose = motion.pose(f64::from(frame + 1) / FPS, pivot);
            let (wall, times) = scene.measured_frame(&pose, (1.0 / FPS) as f32, camera)?;
            if frame < WARM_UP {
                continue;
            }
            bar.inc(1);
            let sum = |wanted: &dyn Fn(&str) -> bool| {
                times.iter().filter(|(name, _)| wanted(name)).map(|(_, ms)| ms).sum::<f64>()
            };
            strands.push(sum(&|name| !MOVING.contains(&name) && !OTHERS.contains(&name)));
            guides.push(sum(&|name| MOVING.contains(&name)));
            whole.push(wall);
        }
        let detail = scene.detail();
        rows.push(Times {
            strands: detail.strands,
            segments: detail.segments,
            strand_stages: Summary::of(strands),
            guide_stages: guides.iter().sum::<f64>() / f64::from(frames.max(1)),
            frame: Summary::of(whole),
        });
    }
    scene.set_lod(way(LodMode::Off))?;
    scene.reset(&motion.pose(0.0, pivot))?;
    let pixels = scene.hair_pixels(camera)?;
    let lod = rows.pop().context("two ways")?;
    let full = rows.pop().context("two ways")?;
    Ok(Point { distance: camera.distance(), frames, pixels, full, lod })
}

/// As a table.
pub fn text(points: &[Point]) -> String {
    let head = [
        "metres",
        "pixels",
        "strands",
        "segments",
        "strand stages: full",
        "level",
        "guide stages: full",
        "level",
        "frame: full",
        "level",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    for Point { distance, pixels, full, lod, .. } in points {
        rows.push(vec![
            format!("{distance:.1}"),
            grouped(*pixels as u64),
            grouped(lod.strands.into()),
            format!("{:.1}", lod.segments),
            ms(full.strand_stages.median),
            ms(lod.strand_stages.median),
            ms(full.guide_stages),
            ms(lod.guide_stages),
            ms(full.frame.median),
            ms(lod.frame.median),
        ]);
    }
    format!(
        "\nLevel of detail (style long in motion, {} strands, {} × {}, {}×MSAA), medians, guide stages means\n{}",
        grouped(STRANDS.into()),
        SIZE.width,
        SIZE.height,
        SAMPLES,
        table(&rows)
    )
}
