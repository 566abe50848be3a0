//! Frames with two in flight: the processor records a frame while the GPU draws the one before.

use crate::{
    bench::{
        results::{StageSamples, StageTime},
        statistics::Summary,
        workload::FPS,
    },
    gpu_report::milliseconds,
    photographer::Photographer,
};
use anyhow::{Context, Result};
use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};
use tresses::{Timings, low_level::PendingTimings};
use tresses_scene::{Motion, Viewpoint};

/// Submitted frames that the GPU may not have finished while the next one is recorded.
const IN_FLIGHT: usize = 2;
/// Frames that are measured even after the time limit.
const MIN_FRAMES: usize = 3;

/// Numbers of frames, and time limits.
#[derive(Clone, Copy, Debug)]
pub struct FrameCounts {
    /// Frames before the measurement.
    pub warm: u32,
    /// Measured frames.
    pub frames: u32,
    /// Time limit of each of both.
    pub limit: Duration,
}

/// Times of a run.
pub struct FlightTimes {
    /// Measured frames.
    pub frames: usize,
    /// Times by timestamps, per stage; empty without comparable timestamps.
    pub stages: Vec<StageTime>,
    /// Sum of the stages of a frame, milliseconds.
    pub gpu: Summary,
    /// Time from frame to frame, milliseconds.
    pub frame: Summary,
    /// Recording and submission on this thread, milliseconds.
    pub recording: Summary,
    /// Passes of a frame that the stages leave out.
    pub untimed: u32,
}

/// Measures `scene` in `motion`.
pub fn run(
    scene: &mut Photographer,
    motion: &Motion,
    camera: &Viewpoint,
    counts: FrameCounts,
) -> Result<FlightTimes> {
    let context = scene.gpu.context.clone();
    let tier = context.tier();
    let mut timings = (tier.timestamps && !tier.software).then(|| Timings::new(&context));
    let (mut submitted, mut pending) = (VecDeque::new(), VecDeque::new());
    let (mut walls, mut recordings, mut untimed) = (Vec::new(), Vec::new(), 0);
    let (mut stages, mut sums) = (StageSamples::default(), Vec::new());
    let pivot = scene.character.neck();
    scene.watch(camera);
    scene.reset(&motion.gesture(0.0, pivot))?;
    let (mut start, mut last, mut warm) = (Instant::now(), Instant::now(), true);
    let mut frame = 0;
    loop {
        if warm && (frame >= counts.warm || frame > 0 && start.elapsed() > counts.limit) {
            (warm, start) = (false, Instant::now());
        }
        let done = walls.len() >= counts.frames as usize;
        if done || walls.len() >= MIN_FRAMES && start.elapsed() > counts.limit {
            break;
        }
        if submitted.len() == IN_FLIGHT {
            let wait = wgpu::PollType::Wait { submission_index: submitted.pop_front(), timeout: None };
            context.device().poll(wait).context("the GPU was lost")?;
        }
        collect(&mut pending, &mut stages, &mut sums)?;
        let recorded = Instant::now();
        let gesture = motion.gesture(f64::from(frame + 1) / FPS, pivot);
        let mut encoder = context.device().create_command_encoder(&Default::default());
        scene.record_advance(&mut encoder, timings.as_mut(), &gesture, (1.0 / FPS) as f32)?;
        scene.record_draw(&mut encoder, timings.as_mut(), camera)?;
        if let Some(timings) = &timings {
            timings.resolve(&mut encoder);
        }
        submitted.push_back(context.queue().submit([encoder.finish()]));
        let recording = milliseconds(recorded);
        let measured = timings.as_mut().map(|timings| timings.start_read(&context));
        untimed = untimed.max(timings.as_ref().map_or(0, Timings::untimed));
        if !warm {
            recordings.push(recording);
            walls.push(milliseconds(last));
            pending.extend(measured);
        }
        last = Instant::now();
        frame += 1;
    }
    context.device().poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
    collect(&mut pending, &mut stages, &mut sums)?;
    Ok(FlightTimes {
        frames: walls.len(),
        gpu: Summary::of(sums),
        stages: stages.summarize(),
        frame: Summary::of(walls),
        recording: Summary::of(recordings),
        untimed,
    })
}

/// Adds the times that have arrived to `stages`, and the sum of each frame to `sums`.
fn collect(
    pending: &mut VecDeque<PendingTimings>,
    stages: &mut StageSamples,
    sums: &mut Vec<f64>,
) -> Result<()> {
    while let Some(times) = pending.front_mut().and_then(PendingTimings::take) {
        pending.pop_front();
        sums.push(stages.add(times?));
    }
    Ok(())
}
