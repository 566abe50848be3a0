//! The processor's part of a frame: recording and submitting it, on wgpu's device without a driver (`noop`). A driver
//! adds its own part to each command.

use crate::roofline::Meter;
use anyhow::{Context as _, Result};
use serde::Serialize;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::{alloc::System, sync::Arc, time::Instant};
use tresses::{
    Context, Gpu, Timings,
    low_level::{Counts, Tier},
};
use tresses_cli::{
    bench::{
        statistics::Summary,
        table::table,
        workload::{self, FPS, Workload},
    },
    photographer::Photographer,
};
use tresses_scene::{Motion, Viewpoint};

/// Counts the allocations of this program.
#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Frames before the measured ones.
const WARM_UP: u32 = 20;

/// Processor time of a frame.
#[derive(Debug, Serialize)]
pub struct RecordedFrame {
    /// Name of the scene.
    pub scene: String,
    /// To record it.
    pub record: Summary,
    /// To finish the encoder and submit it.
    pub submit: Summary,
    /// Heap allocations, and bytes of them, in the median frame.
    pub allocations: [u64; 2],
    /// Bind groups that it creates.
    pub created: u32,
    /// Compute kernels that were compiled until then.
    pub kernels: u32,
    /// Passes, dispatches, draws and bind group changes that it records.
    pub counts: [u32; 4],
}

/// Opens the device without a driver. It chooses the kernels that GPUs use.
fn noop() -> Result<Gpu> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::NOOP;
    descriptor.backend_options.noop = wgpu::NoopBackendOptions { enable: true, ..Default::default() };
    let instance = wgpu::Instance::new(descriptor);
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let descriptor =
        wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..wgpu::DeviceDescriptor::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;
    let tier = Tier { timestamps: false, max_samples: 4, software: false };
    Ok(Gpu { info: adapter.get_info(), context: Context::new(&device, &queue).with_tier(tier), adapter })
}

/// Measures frames of the default look and prints them.
pub fn print(frames: u32, json: bool) -> Result<()> {
    let measured = [measure(&workload::long(), frames)?];
    match json {
        true => println!("{}", serde_json::to_string_pretty(&measured)?),
        false => println!("{}", text(&measured).trim_end()),
    }
    Ok(())
}

/// Measures `frames` frames of `workload`, in motion.
pub fn measure(workload: &Workload, frames: u32) -> Result<RecordedFrame> {
    let mut played = Playback::new(noop()?, workload)?;
    let (mut record, mut submit, mut allocations) = (Vec::new(), Vec::new(), Vec::new());
    for frame in 0..WARM_UP + frames {
        let before = allocated();
        let [recorded, submitted] = played.frame(None)?;
        if frame >= WARM_UP {
            record.push(recorded);
            submit.push(submitted);
            let now = allocated();
            allocations.push([now[0] - before[0], now[1] - before[1]]);
        }
    }
    allocations.sort_unstable();
    // The counts come from one more frame, whose laps take time.
    let mut timings = Timings::by(tresses::low_level::wall);
    played.frame(Some(&mut timings))?;
    let sum = |of: &dyn Fn(&Counts) -> u32| timings.counts().iter().map(|(_, counts)| of(counts)).sum();
    let [created, kernels] = created(workload)?;
    Ok(RecordedFrame {
        scene: workload.name.clone(),
        record: Summary::of(record),
        submit: Summary::of(submit),
        created,
        kernels,
        allocations: allocations.get(allocations.len() / 2).copied().unwrap_or_default(),
        counts: [
            sum(&|counts| counts.passes),
            sum(&|counts| counts.dispatches),
            sum(&|counts| counts.draws),
            sum(&|counts| counts.groups),
        ],
    })
}

/// A scene that is played frame by frame.
struct Playback {
    scene: Photographer,
    camera: Viewpoint,
    motion: Motion,
    frames: u32,
}

impl Playback {
    fn new(gpu: Gpu, workload: &Workload) -> Result<Self> {
        let (_, motion) = *workload.runs.last().context("a state to measure")?;
        let mut scene = Photographer::on(gpu, &workload.counted_preset()?, workload.size)?;
        let camera = workload::camera(&scene, workload.size, workload.distance);
        let motion = Motion::named(motion).context("a built-in motion")?;
        let start = motion.gesture(0.0, scene.character.neck());
        scene.reset(&start)?;
        Ok(Self { scene, camera, motion, frames: 0 })
    }

    /// Records and submits a frame, and returns the milliseconds of both.
    fn frame(&mut self, mut timings: Option<&mut Timings>) -> Result<[f64; 2]> {
        self.frames += 1;
        let pose = self.motion.gesture(f64::from(self.frames) / FPS, self.scene.character.neck());
        self.scene.watch(&self.camera);
        let context = self.scene.gpu.context.clone();
        let start = Instant::now();
        let mut encoder = context.device().create_command_encoder(&Default::default());
        self.scene.record_advance(&mut encoder, timings.as_deref_mut(), &pose, (1.0 / FPS) as f32)?;
        self.scene.record_draw(&mut encoder, timings, &self.camera)?;
        let recorded = Instant::now();
        context.queue().submit([encoder.finish()]);
        Ok([recorded - start, recorded.elapsed()].map(|time| time.as_secs_f64() * 1e3))
    }
}

/// Returns the bind groups that a frame creates after the first ones, and the compute kernels created until then.
fn created(workload: &Workload) -> Result<[u32; 2]> {
    let meter = Meter::default();
    let mut gpu = noop()?;
    gpu.context = gpu.context.with_probe(Arc::new(meter.clone()));
    let mut played = Playback::new(gpu, workload)?;
    for _ in 0..WARM_UP {
        played.frame(None)?;
    }
    let before = meter.groups();
    played.frame(None)?;
    Ok([meter.groups() - before, meter.kernels()])
}

/// Heap allocations of this program so far, and their bytes.
fn allocated() -> [u64; 2] {
    let stats = ALLOCATOR.stats();
    [stats.allocations + stats.reallocations, stats.bytes_allocated].map(|count| count as u64)
}

/// Formats frames as a table.
pub fn text(frames: &[RecordedFrame]) -> String {
    let head = [
        "scene",
        "record",
        "p95",
        "submit",
        "p95",
        "allocations",
        "kB",
        "passes",
        "dispatches",
        "draws",
        "bind groups set",
        "created",
        "kernels",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    rows.extend(frames.iter().map(|frame| {
        let times = [frame.record.median, frame.record.p95, frame.submit.median, frame.submit.p95];
        let times = times.map(|ms| format!("{ms:.3}"));
        let [count, bytes] = frame.allocations;
        let heap = [count.to_string(), format!("{:.1}", bytes as f64 * 1e-3)];
        let counts =
            frame.counts.into_iter().chain([frame.created, frame.kernels]).map(|count| count.to_string());
        std::iter::once(frame.scene.clone()).chain(times).chain(heap).chain(counts).collect()
    }));
    format!("\nProcessor time of a frame without a driver, milliseconds\n{}", table(&rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_frames_create_no_bind_groups() {
        assert_eq!(created(&workload::long()).unwrap()[0], 0);
    }

    #[test]
    fn a_meter_counts_uploads_and_read_backs_of_one_frame() {
        let meter = Meter::default();
        let mut gpu = noop().unwrap();
        gpu.context = gpu.context.with_probe(Arc::new(meter.clone()));
        let mut played = Playback::new(gpu, &workload::long()).unwrap();
        let context = played.scene.gpu.context.clone();
        let mut count = |frames: u32| {
            meter.start(&context);
            for _ in 0..frames {
                played.frame(None).unwrap();
            }
            meter.host_transfers()
        };
        // The first frames write more.
        count(2);
        let [one, two] = [1, 2].map(count);
        // Small values share few uploads.
        assert!((1..=6).contains(&one.uploads), "{one:?} {two:?}");
        assert!((1..=12).contains(&two.uploads), "{one:?} {two:?}");
        // A frame reads back at most the length of the lists of tiles.
        assert!(one.read_backs <= 1 && two.read_backs > 0, "{one:?} {two:?}");
    }
}
