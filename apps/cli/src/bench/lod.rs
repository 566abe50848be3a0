//! The cost of a frame at a distance, at full detail and at the matching level of detail, with the pixels that
//! the hair covers, and how it compares with a portrait's.

use super::{
    results::StageTime,
    sitting::Sitting,
    statistics::Summary,
    table::{ms, table},
    workload::{self, FPS, WARM_UP},
};
use crate::{args::Size, photographer::Photographer};
use anyhow::{Context, Result};
use serde::Serialize;
use tresses::lod::{LodMode, LodOptions};
use tresses_scene::words::grouped;
use tresses_scene::{Motion, Viewpoint, camera::Angle, measure::Measured};

/// Pixels.
const SIZE: Size = Size { width: 1280, height: 720 };
/// Drawn strands in full detail.
const STRANDS: u32 = 20_000;
/// Metres; the first is a portrait's.
pub const DISTANCES: [f32; 7] = [0.6, 1.0, 2.0, 4.0, 8.0, 15.0, 40.0];
/// At so many metres strands are to cost at most so much of what they cost in the portrait.
const GOAL: (f32, f64) = (15.0, 1.0 / 8.0);
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
    /// Those, one by one.
    pub stages: Vec<StageTime>,
    /// Milliseconds of those that work on guides, mean per frame.
    pub guide_stages: f64,
    /// Milliseconds of a whole frame.
    pub frame: Summary,
}

/// Measures the long style in motion at all distances.
pub fn measure(sitting: Sitting<'_>) -> Result<Vec<Point>> {
    let preset = workload::style(Some(STRANDS), workload::Edges::default());
    let mut scene = Photographer::with_samples_at_most(&preset, SIZE).context("levels of detail")?;
    scene.measure_by(sitting.clock);
    let near = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), SIZE.aspect(), 1.0);
    DISTANCES.iter().map(|distance| point(&mut scene, &near.moved(*distance), sitting)).collect()
}

fn point(scene: &mut Photographer, camera: &Viewpoint, sitting: Sitting<'_>) -> Result<Point> {
    let Sitting { frames, bar, .. } = sitting;
    let motion = Motion::named("turn").context("a built-in motion")?;
    let pivot = scene.character.neck();
    let way = |mode| LodOptions { mode, ..LodOptions::default() };
    let mut rows = Vec::new();
    for mode in [LodMode::Off, LodMode::Auto] {
        scene.set_lod(way(mode))?;
        scene.watch(camera);
        scene.reset(&motion.gesture(0.0, pivot))?;
        let mut stages: Vec<(&'static str, Vec<f64>)> = Vec::new();
        let (mut strands, mut guides, mut whole) = (Vec::new(), Vec::new(), Vec::new());
        for frame in 0..WARM_UP + frames {
            let pose = motion.gesture(f64::from(frame + 1) / FPS, pivot);
            let Measured { wall, stages: times, .. } =
                scene.measured_frame(&pose, (1.0 / FPS) as f32, camera)?;
            if frame < WARM_UP {
                continue;
            }
            bar.inc(1);
            let (mut of_strands, mut of_guides) = (0.0, 0.0);
            for (name, ms) in times.into_iter().filter(|(name, _)| !OTHERS.contains(name)) {
                if MOVING.contains(&name) {
                    of_guides += ms;
                    continue;
                }
                of_strands += ms;
                match stages.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, values)) => values.push(ms),
                    None => stages.push((name, vec![ms])),
                }
            }
            strands.push(of_strands);
            guides.push(of_guides);
            whole.push(wall);
        }
        let detail = scene.detail();
        rows.push(Times {
            strands: detail.strands,
            segments: detail.segments,
            strand_stages: Summary::of(strands),
            stages: StageTime::all(stages),
            guide_stages: guides.iter().sum::<f64>() / f64::from(frames.max(1)),
            frame: Summary::of(whole),
        });
    }
    scene.set_lod(way(LodMode::Off))?;
    scene.reset(&motion.gesture(0.0, pivot))?;
    let pixels = scene.hair_pixels(camera)?;
    let lod = rows.pop().context("two ways")?;
    let full = rows.pop().context("two ways")?;
    Ok(Point { distance: camera.distance(), frames, pixels, full, lod })
}

/// As tables, with what is to be said of the goal.
pub fn text(points: &[Point]) -> String {
    let Some(portrait) = points.first() else { return String::new() };
    let share = |point: &Point| point.lod.strand_stages.median / portrait.lod.strand_stages.median.max(1e-9);
    let head = [
        "metres",
        "pixels",
        "strands",
        "segments",
        "strand stages: full",
        "level",
        "of the portrait's",
        "guide stages: full",
        "level",
        "frame: full",
        "level",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    for point in points {
        let Point { distance, pixels, full, lod, .. } = point;
        rows.push(vec![
            format!("{distance:.1}"),
            grouped(*pixels as u64),
            grouped(lod.strands.into()),
            format!("{:.1}", lod.segments),
            ms(full.strand_stages.median),
            ms(lod.strand_stages.median),
            format!("{:.3}", share(point)),
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
    let metres = points.iter().map(|point| format!("{:.1} m", point.distance));
    let mut rows =
        vec![std::iter::once("strand stages at their level".into()).chain(metres).collect::<Vec<_>>()];
    for stage in &portrait.lod.stages {
        let time = |point: &Point| {
            point.lod.stages.iter().find(|s| s.name == stage.name).map_or("-".into(), |s| ms(s.time.median))
        };
        rows.push(std::iter::once(stage.name.clone()).chain(points.iter().map(time)).collect());
    }
    text += &table(&rows);
    let (metres, most) = GOAL;
    if let Some(point) = points.iter().find(|point| point.distance == metres) {
        let share = share(point);
        let verdict = if share <= most { "as wanted, at most" } else { "wanted is at most" };
        text += &format!(
            "At {metres} m they cost 1/{:.1} of what they cost at {} m; {verdict} 1/{}.\n",
            1.0 / share.max(1e-9),
            portrait.distance,
            1.0 / most
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_is_held_against_the_portrait() {
        let times = |ms: f64| Times {
            strands: 20_000,
            segments: 31.0,
            strand_stages: Summary { median: ms, p95: ms },
            stages: StageTime::all(vec![("shadow", vec![ms])]),
            guide_stages: 1.0,
            frame: Summary::default(),
        };
        let point =
            |distance, ms| Point { distance, frames: 1, pixels: 9.0, full: times(100.0), lod: times(ms) };
        let said = |ms| text(&[point(0.6, 100.0), point(15.0, ms)]);
        assert!(said(10.0).ends_with("1/10.0 of what they cost at 0.6 m; as wanted, at most 1/8.\n"));
        assert!(said(20.0).ends_with("1/5.0 of what they cost at 0.6 m; wanted is at most 1/8.\n"));
        assert!(said(10.0).lines().any(|line| line.split_whitespace().eq(["shadow", "100.0", "10.0"])));
        assert_eq!(text(&[]), "");
    }
}
