//! The processor's part of a frame: recording and submitting it, on wgpu's device without a driver (`noop`). A driver
//! adds its own part to each command.

use anyhow::{Context as _, Result};
use serde::Serialize;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::{alloc::System, time::Instant};
use tresses::{
    Context,
    gpu::{Counts, Gpu, Tier, Timings},
};
use tresses_cli::{
    bench::{
        statistics::Summary,
        table::table,
        workload::{self, FPS, Workload},
    },
    photographer::Photographer,
};
use tresses_scene::Motion;

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
    /// What it records.
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
    let (_, motion) = *workload.runs.last().context("a state to measure")?;
    let mut scene = Photographer::on(noop()?, &workload.counted_preset()?, workload.size)?;
    let camera = workload::camera(&scene, workload.size, workload.distance);
    let motion = Motion::named(motion).context("a built-in motion")?;
    let pivot = scene.character.neck();
    let context = scene.gpu.context.clone();
    scene.reset(&motion.gesture(0.0, pivot))?;
    let (mut record, mut submit, mut allocations) = (Vec::new(), Vec::new(), Vec::new());
    for frame in 0..WARM_UP + frames {
        let pose = motion.gesture(f64::from(frame + 1) / FPS, pivot);
        scene.watch(&camera);
        let before = allocated();
        let start = Instant::now();
        let mut encoder = context.device().create_command_encoder(&Default::default());
        scene.record_advance(&mut encoder, None, &pose, (1.0 / FPS) as f32)?;
        scene.record_draw(&mut encoder, None, &camera)?;
        let recorded = Instant::now();
        context.queue().submit([encoder.finish()]);
        let submitted = Instant::now();
        if frame >= WARM_UP {
            record.push((recorded - start).as_secs_f64() * 1e3);
            submit.push((submitted - recorded).as_secs_f64() * 1e3);
            let now = allocated();
            allocations.push([now[0] - before[0], now[1] - before[1]]);
        }
    }
    allocations.sort_unstable();
    // The counts come from one more frame, whose laps take time.
    let mut timings = Timings::by(tresses::gpu::wall);
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let pose = motion.gesture(f64::from(WARM_UP + frames + 1) / FPS, pivot);
    scene.record_advance(&mut encoder, Some(&mut timings), &pose, (1.0 / FPS) as f32)?;
    scene.record_draw(&mut encoder, Some(&mut timings), &camera)?;
    let sum = |of: &dyn Fn(&Counts) -> u32| timings.counts().iter().map(|(_, counts)| of(counts)).sum();
    Ok(RecordedFrame {
        scene: workload.name.clone(),
        record: Summary::of(record),
        submit: Summary::of(submit),
        allocations: allocations.get(allocations.len() / 2).copied().unwrap_or_default(),
        counts: [
            sum(&|counts| counts.passes),
            sum(&|counts| counts.dispatches),
            sum(&|counts| counts.draws),
            sum(&|counts| counts.groups),
        ],
    })
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
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    rows.extend(frames.iter().map(|frame| {
        let times = [frame.record.median, frame.record.p95, frame.submit.median, frame.submit.p95];
        let times = times.map(|ms| format!("{ms:.3}"));
        let [count, bytes] = frame.allocations;
        let heap = [count.to_string(), format!("{:.1}", bytes as f64 * 1e-3)];
        let counts = frame.counts.map(|count| count.to_string());
        std::iter::once(frame.scene.clone()).chain(times).chain(heap).chain(counts).collect()
    }));
    format!("\nProcessor time of a frame without a driver, milliseconds\n{}", table(&rows))
}
