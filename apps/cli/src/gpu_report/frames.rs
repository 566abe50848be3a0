//! Times of frames per stage: each frame alone, as `tresses bench` measures, and with two frames in flight.

use super::{
    device,
    in_flight::{self, FlightTimes, FrameCounts},
    section::{Draft, cells},
};
use crate::{
    args::Size,
    bench::{
        Sitting,
        recorded::StageCommands,
        results::StageTime,
        statistics::Summary,
        workload::{self, TILES, style},
    },
    photographer::Photographer,
};
use anyhow::{Context, Result};
use indicatif::ProgressBar;
use serde_json::{Value, json};
use std::time::Duration;
use tresses::{Gpu, low_level::wall};
use tresses_scene::{Motion, Preset};

/// Motion of all cases.
const MOTION: &str = "turn";
/// Wind speed of the second case, m/s.
const WIND: f32 = 8.0;
/// Ratio of 95th percentile and median above which frames are irregular.
const IRREGULAR: f64 = 3.0;
/// Ratio of the stages' sum and the elapsed time above which timestamps are wrong. Passes overlap a little.
const MAX_SUM: f64 = 1.5;

/// A measured scene.
struct FrameCase {
    name: &'static str,
    preset: Preset,
    size: Size,
    counts: FrameCounts,
    /// Frames that are measured alone.
    single_frames: u32,
}

/// Measures all cases on the default adapter.
pub fn measure(draft: &mut Draft, quick: bool) -> Result<()> {
    let gpu = device::open()?;
    let tier = gpu.context.tier();
    draft.note(match (tier.software, tier.timestamps) {
        (true, _) => "Software driver: few frames; stages are timed by wall clock, each submitted alone.",
        (false, true) => "Stages by timestamps; frames, recording and submission by wall clock.",
        (false, false) => "This adapter has no timestamps: whole frames only.",
    });
    for case in cases(tier.software, quick) {
        one(draft, &gpu, &case).context(case.name)?;
        draft.keep();
    }
    Ok(())
}

/// Returns the cases. A software driver draws few frames.
fn cases(software: bool, quick: bool) -> Vec<FrameCase> {
    let counts = |warm, frames| FrameCounts { warm, frames, limit: Duration::from_secs(30) };
    let default = style(None, TILES);
    let mut windy = default.clone();
    windy.settings.set_wind_speed(WIND);
    let (hd, uhd) = (Size { width: 1280, height: 720 }, Size { width: 3840, height: 2160 });
    let (first, others, single_frames) = match (software, quick) {
        (true, _) => (counts(1, 3), counts(1, 2), 3),
        (false, true) => (counts(50, 75), counts(20, 30), 10),
        (false, false) => (counts(200, 300), counts(50, 100), 30),
    };
    let case = |name, preset, size, counts| FrameCase { name, preset, size, counts, single_frames };
    let mut cases = vec![case("default, 1280 × 720", default.clone(), hd, first)];
    if !(software && quick) {
        cases.push(case("wind, 1280 × 720", windy, hd, others));
        cases.push(case("default, 3840 × 2160", default, uhd, others));
    }
    cases
}

/// Measures a case and adds its tables.
fn one(draft: &mut Draft, gpu: &Gpu, case: &FrameCase) -> Result<()> {
    let mut scene = Photographer::on(gpu.clone(), &case.preset, case.size)?;
    let camera = workload::camera(&scene, case.size, None);
    let motion = Motion::named(MOTION).context("a built-in motion")?;
    let flight = in_flight::run(&mut scene, &motion, &camera, case.counts)?;
    let title = format!("{}, two frames in flight, {} frames", case.name, flight.frames);
    let mut frame =
        vec![("from frame to frame", flight.frame), ("recording and submission", flight.recording)];
    if !flight.stages.is_empty() {
        frame.insert(0, ("first pass to last", flight.span));
    }
    add_times(draft, &title, (&flight.stages, flight.gpu), &frame);
    draft.keep();
    let sitting = Sitting { frames: case.single_frames, clock: wall, bar: &ProgressBar::hidden() };
    let run = workload::run(&mut scene, "in motion", MOTION, &camera, sitting)?;
    let title = format!("{}, each frame alone, {} frames", case.name, run.frames);
    add_times(draft, &title, (&run.stages, run.gpu), &[("whole frame", run.frame)]);
    let title = format!("{}, recorded commands", case.name);
    for stage in &run.recorded {
        let row = std::iter::once(json!(stage.stage)).chain(stage.numbers().map(Value::from));
        draft.row(&title, &[&["stage"][..], &StageCommands::NAMES].concat(), row.collect());
    }
    for problem in problems(&flight, gpu.context.tier().software) {
        draft.find(format!("{}: {problem}", case.name));
    }
    Ok(())
}

/// Adds a table of the times of `stages`, their sum and the whole frames.
fn add_times(
    draft: &mut Draft,
    title: &str,
    (stages, sum): (&[StageTime], Summary),
    frame: &[(&str, Summary)],
) {
    let sum = (!stages.is_empty()).then_some(("all stages", sum));
    let stages = stages.iter().map(|stage| (&*stage.name, stage.time));
    for (name, time) in stages.chain(sum).chain(frame.iter().copied()) {
        let row = cells![name, time.median, time.p95];
        draft.row(title, &["stage", "median, ms", "95th percentile, ms"], row);
    }
}

/// Returns unusual relations of the times.
fn problems(flight: &FlightTimes, software: bool) -> Vec<String> {
    let FlightTimes { gpu, frame, stages, .. } = flight;
    let mut problems = Vec::new();
    if !software && frame.p95 > IRREGULAR * frame.median {
        problems.push(format!("irregular frames: median {:.2} ms, p95 {:.2} ms", frame.median, frame.p95));
    }
    if !stages.is_empty() && gpu.median <= 0.0 {
        problems.push("all timestamps are equal".to_owned());
    }
    if flight.untimed > 0 {
        problems.push(format!("the stages leave out {} passes of a frame", flight.untimed));
    }
    if gpu.median > MAX_SUM * frame.median {
        problems.push(format!("stages take {:.2} ms, but a frame {:.2} ms", gpu.median, frame.median));
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unusual_times_are_found() {
        let time = |median, p95| Summary { median, p95 };
        let flight = |gpu, frame| FlightTimes {
            frames: 9,
            stages: vec![StageTime { name: "draw".into(), time: gpu }],
            gpu,
            span: gpu,
            frame,
            recording: time(1.0, 1.0),
            untimed: 0,
        };
        assert_eq!(problems(&flight(time(4.0, 5.0), time(5.0, 6.0)), false), [""; 0]);
        for (gpu, frame, word) in [
            (time(4.0, 5.0), time(5.0, 60.0), "irregular"),
            (time(0.0, 0.0), time(5.0, 6.0), "equal"),
            (time(9.0, 9.0), time(5.0, 6.0), "stages take"),
        ] {
            let found = problems(&flight(gpu, frame), false);
            assert!(found.len() == 1 && found[0].contains(word), "{found:?}");
        }
        let found = problems(&FlightTimes { untimed: 2, ..flight(time(4.0, 5.0), time(5.0, 6.0)) }, false);
        assert!(found.len() == 1 && found[0].contains("leave out 2 passes"), "{found:?}");
    }

    #[test]
    fn software_drivers_draw_few_frames() {
        let frames =
            |software, quick| cases(software, quick).iter().map(|case| case.counts.frames).sum::<u32>();
        assert!(frames(true, true) <= 3 && frames(true, false) < 10 && frames(false, false) > 400);
    }
}
