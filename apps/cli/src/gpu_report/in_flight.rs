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
    /// From the beginning of a frame's first pass to the end of its last by timestamps, milliseconds.
    pub span: Summary,
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
    let mut times = GpuTimes::default();
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
        times.collect(&mut pending)?;
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
    times.collect(&mut pending)?;
    Ok(FlightTimes {
        frames: walls.len(),
        gpu: Summary::of(times.sums),
        span: Summary::of(times.spans),
        stages: times.stages.summarize(),
        frame: Summary::of(walls),
        recording: Summary::of(recordings),
        untimed,
    })
}

/// Times by timestamps.
#[derive(Default)]
struct GpuTimes {
    stages: StageSamples,
    /// Sum of the stages of each frame.
    sums: Vec<f64>,
    spans: Vec<f64>,
}

impl GpuTimes {
    /// Adds the times that have arrived.
    fn collect(&mut self, pending: &mut VecDeque<PendingTimings>) -> Result<()> {
        while let Some(first) = pending.front_mut() {
            let Some(times) = first.take() else { break };
            self.sums.push(self.stages.add(times?));
            self.spans.extend(first.span());
            pending.pop_front();
        }
        Ok(())
    }
}
