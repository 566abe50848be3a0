//! Cost of a frame at several distances, at full detail and at the matching level of detail, compared with a portrait,
//! and the number of pixels that the hair covers.

use super::{
    results::{StageSamples, StageTime},
    sitting::Sitting,
    statistics::Summary,
    table::{ms, table},
    workload::{self, FPS, WARM_UP},
};
use crate::{args::Size, photographer::Photographer};
use anyhow::{Context, Result};
use serde::Serialize;
use tresses::{LodMode, LodOptions};
use tresses_scene::words::grouped;
use tresses_scene::{Motion, Viewpoint, camera::Angle, measure::MeasuredFrame};

/// Image size, pixels.
const SIZE: Size = Size { width: 1280, height: 720 };
/// Drawn strands in full detail.
const STRANDS: u32 = 20_000;
/// Distances, meters. The first is a portrait's.
pub const DISTANCES: [f32; 7] = [0.6, 1.0, 2.0, 4.0, 8.0, 15.0, 40.0];
/// A distance in meters, and the largest allowed cost of strands there as a fraction of the portrait's.
const GOAL: (f32, f64) = (15.0, 1.0 / 8.0);
/// Stages that simulate the guides.
const MOVING: [&str; 4] = ["volume", "wind", "simulate", "tessellate"];
/// Stages whose cost depends only on the image size and the head.
const OTHERS: [&str; 2] = ["body", "present"];

/// Results at one distance.
#[derive(Debug, Serialize)]
pub struct LodPoint {
    /// Distance, meters.
    pub distance: f32,
    /// Measured frames per mode.
    pub frames: u32,
    /// Pixels covered by hair.
    pub pixels: f64,
    /// Full detail.
    pub full: LodTimes,
    /// The matching level of detail.
    pub lod: LodTimes,
}

/// Cost of a frame.
#[derive(Debug, Serialize)]
pub struct LodTimes {
    /// Number of drawn strands.
    pub strands: u32,
    /// Segments per strand.
    pub segments: f32,
    /// Milliseconds of the stages that process strands.
    pub strand_stages: Summary,
    /// Milliseconds of each of those stages.
    pub stages: Vec<StageTime>,
    /// Mean milliseconds per frame of the stages that process guides.
    pub guide_stages: f64,
    /// Milliseconds of a whole frame.
    pub frame: Summary,
}

/// Measures the long style in motion at all distances.
pub fn measure(sitting: Sitting<'_>) -> Result<Vec<LodPoint>> {
    let preset = workload::style(Some(STRANDS), workload::TILES);
    let mut scene = Photographer::with_clamped_samples(&preset, SIZE, None).context("levels of detail")?;
    scene.measure_by(sitting.clock);
    let near = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), SIZE.aspect(), 1.0);
    DISTANCES.iter().map(|distance| point(&mut scene, &near.at_distance(*distance), sitting)).collect()
}

fn point(scene: &mut Photographer, camera: &Viewpoint, sitting: Sitting<'_>) -> Result<LodPoint> {
    let Sitting { frames, bar, .. } = sitting;
    let motion = Motion::named("turn").context("a built-in motion")?;
    let pivot = scene.character.neck();
    let lod_options = |mode| LodOptions { mode, ..LodOptions::default() };
    let mut rows = Vec::new();
    for mode in [LodMode::Off, LodMode::Auto] {
        scene.set_lod(lod_options(mode))?;
        scene.watch(camera);
        scene.reset(&motion.gesture(0.0, pivot))?;
        let mut stages = StageSamples::default();
        let (mut strands, mut guides, mut frame_times) = (Vec::new(), Vec::new(), Vec::new());
        for frame in 0..WARM_UP + frames {
            let pose = motion.gesture(f64::from(frame + 1) / FPS, pivot);
            let MeasuredFrame { wall, stages: times, .. } =
                scene.measured_frame(&pose, (1.0 / FPS) as f32, camera)?;
            if frame < WARM_UP {
                continue;
            }
            bar.inc(1);
            let times = times.into_iter().filter(|(name, _)| !OTHERS.contains(name));
            let (of_guides, of_strands): (Vec<_>, Vec<_>) =
                times.partition(|(name, _)| MOVING.contains(name));
            strands.push(stages.add(of_strands));
            guides.push(of_guides.iter().map(|(_, ms)| ms).sum::<f64>());
            frame_times.push(wall);
        }
        let detail = scene.detail();
        rows.push(LodTimes {
            strands: detail.strand_count,
            segments: detail.segment_count,
            strand_stages: Summary::of(strands),
            stages: stages.summarize(),
            guide_stages: guides.iter().sum::<f64>() / f64::from(frames.max(1)),
            frame: Summary::of(frame_times),
        });
    }
    scene.set_lod(lod_options(LodMode::Off))?;
    scene.reset(&motion.gesture(0.0, pivot))?;
    let pixels = scene.hair_pixels(camera)?;
    let lod = rows.pop().context("two ways")?;
    let full = rows.pop().context("two ways")?;
    Ok(LodPoint { distance: camera.distance(), frames, pixels, full, lod })
}

/// Formats the results as tables, with a verdict on the goal.
pub fn text(points: &[LodPoint]) -> String {
    let Some(portrait) = points.first() else { return String::new() };
    let cost_ratio =
        |point: &LodPoint| point.lod.strand_stages.median / portrait.lod.strand_stages.median.max(1e-9);
    let head = [
        "meters",
        "pixels",
        "strands",
        "segments",
        "strand stages: full",
        "level",
        "relative to portrait",
        "guide stages: full",
        "level",
        "frame: full",
        "level",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    for point in points {
        let LodPoint { distance, pixels, full, lod, .. } = point;
        rows.push(vec![
            format!("{distance:.1}"),
            grouped(*pixels as u64),
            grouped(lod.strands.into()),
            format!("{:.1}", lod.segments),
            ms(full.strand_stages.median),
            ms(lod.strand_stages.median),
            format!("{:.3}", cost_ratio(point)),
            ms(full.guide_stages),
            ms(lod.guide_stages),
            ms(full.frame.median),
            ms(lod.frame.median),
        ]);
    }
    let mut text = format!(
        "\nLevel of detail (style long in motion, {} strands, {} × {}), medians, guide stages means\n{}",
        grouped(STRANDS.into()),
        SIZE.width,
        SIZE.height,
        table(&rows)
    );
    let meters = points.iter().map(|point| format!("{:.1} m", point.distance));
    let mut rows = vec![std::iter::once("strand stages, level".into()).chain(meters).collect::<Vec<_>>()];
    for stage in &portrait.lod.stages {
        let time = |point: &LodPoint| {
            point.lod.stages.iter().find(|s| s.name == stage.name).map_or("-".into(), |s| ms(s.time.median))
        };
        rows.push(std::iter::once(stage.name.clone()).chain(points.iter().map(time)).collect());
    }
    text += &table(&rows);
    let (meters, max_ratio) = GOAL;
    if let Some(point) = points.iter().find(|point| point.distance == meters) {
        let ratio = cost_ratio(point);
        let verdict =
            if ratio <= max_ratio { "within the goal of at most" } else { "above the goal of at most" };
        text += &format!(
            "At {meters} m, strand stages cost 1/{:.1} of their cost at {} m; {verdict} 1/{}.\n",
            1.0 / ratio.max(1e-9),
            portrait.distance,
            1.0 / max_ratio
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_compared_with_the_portrait() {
        let times = |ms: f64| LodTimes {
            strands: 20_000,
            segments: 31.0,
            strand_stages: Summary { median: ms, p95: ms },
            stages: vec![StageTime { name: "shadow".into(), time: Summary::of(vec![ms]) }],
            guide_stages: 1.0,
            frame: Summary::default(),
        };
        let point =
            |distance, ms| LodPoint { distance, frames: 1, pixels: 9.0, full: times(100.0), lod: times(ms) };
        let said = |ms| text(&[point(0.6, 100.0), point(15.0, ms)]);
        assert!(said(10.0).ends_with("1/10.0 of their cost at 0.6 m; within the goal of at most 1/8.\n"));
        assert!(said(20.0).ends_with("1/5.0 of their cost at 0.6 m; above the goal of at most 1/8.\n"));
        assert!(said(10.0).lines().any(|line| line.split_whitespace().eq(["shadow", "100.0", "10.0"])));
        assert_eq!(text(&[]), "");
    }
}
