//! Lower bound of each stage's time: the work of its shaders in a frame, counted on the GPU, divided by the peak rates
//! of the same adapter, measured in the same run. `docs/research/roofline.md` explains the table.

pub mod expected;
pub mod instrument;
mod meter;
mod rates;

use anyhow::{Context, Result};
pub use meter::{CommandWork, HostTransfers, Meter, StageWork};
use rates::Rates;
use serde::Serialize;
use std::sync::Arc;
use tresses::{
    Gpu, Timings,
    low_level::{Clock, Counts, Tier},
};
use tresses_cli::{
    bench::{
        Sitting,
        results::{Run, StageTime},
        table::{ms, table},
        workload::{self, FPS, WARM_UP, Workload},
    },
    photographer::Photographer,
};
use tresses_scene::{Motion, Viewpoint};

/// Stages and their lower bounds.
#[derive(Debug, Default, Serialize)]
pub struct Roofline {
    /// Name of the workload.
    pub name: String,
    /// Peak rates of the adapter.
    pub rates: Rates,
    /// The stages, in order.
    pub stages: Vec<StageBound>,
}

/// One stage of a frame.
#[derive(Debug, Default, PartialEq, Serialize)]
pub struct StageBound {
    /// Name of the stage.
    pub name: String,
    /// Invocations of compute and fragment shaders.
    pub invocations: u64,
    /// Minimum memory traffic of shaders, attachments and transfers, bytes.
    pub bytes: u64,
    /// Bytes that shaders load from and store to storage buffers.
    #[serde(rename = "asked")]
    pub requested_bytes: u64,
    /// Loads from storage buffers.
    pub loads: u64,
    /// Loaded or sampled texels.
    pub texels: u64,
    /// Atomic operations on storage buffers.
    pub atomics: u64,
    /// Arithmetic operations on scalars.
    pub operations: u64,
    /// Median time without instrumentation, milliseconds.
    pub time: f64,
}

impl StageBound {
    /// Creates the stage from its work and time in milliseconds. Attachments and transfers move `traffic_bytes` bytes.
    fn new(name: &str, done: &StageWork, traffic_bytes: u64, time: f64) -> Self {
        let counted = done.counted;
        Self {
            name: name.into(),
            invocations: counted.invocations,
            bytes: done.bytes + counted.texel_bytes + traffic_bytes,
            requested_bytes: done.requested_bytes,
            loads: counted.loads,
            texels: counted.texels,
            atomics: counted.atomics,
            operations: counted.operations,
            time,
        }
    }

    /// Returns the lower bound in milliseconds at `rates`, and the resource that limits it.
    fn bound(&self, rates: &Rates) -> (f64, &'static str) {
        let limits = [
            (self.bytes as f64 / rates.bytes(), "bytes"),
            (self.atomics as f64 / rates.atomics, "atomics"),
            (self.operations as f64 / rates.operations, "operations"),
            (self.loads as f64 / rates.loads, "loads"),
            (self.texels as f64 / rates.texels, "texels"),
        ];
        let (seconds, what) = limits.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("five limits");
        (seconds * 1e3, what)
    }
}

/// Measures the last state of `workload`.
pub fn measure(workload: &Workload, sitting: Sitting<'_>) -> Result<Roofline> {
    let (state, motion) = *workload.runs.last().context("a state to measure")?;
    let mut scene = Photographer::with_clamped_samples(&workload.preset, workload.size, workload.cards)?;
    let camera = workload::camera(&scene, workload.size, workload.distance);
    let run = workload::run(&mut scene, state, motion, &camera, sitting)?;
    drop(scene);
    let rates = rates::measure(&pollster::block_on(Gpu::open())?, sitting.clock)?;
    let done = count(workload, motion, &camera, sitting.clock)?;
    Ok(Roofline { name: format!("{}, {state}", workload.name), rates, stages: stages(&run, &done) })
}

/// Counts the work of the first measured frame.
fn count(
    workload: &Workload,
    motion: &str,
    camera: &Viewpoint,
    clock: Clock,
) -> Result<Vec<(&'static str, StageWork)>> {
    let mut gpu = pollster::block_on(Gpu::open())?;
    let meter = Meter::default();
    gpu.context = gpu.context.with_probe(Arc::new(meter.clone()));
    let mut scene = Photographer::on(gpu, &workload.preset, workload.size)?;
    play(&mut scene, motion, camera, clock, WARM_UP, &meter)?;
    meter.take(&scene.gpu.context)
}

/// Work of a frame on a GPU.
pub struct FrameWork {
    /// Its dispatches and draws, in order.
    pub commands: Vec<CommandWork>,
    /// Counts of what it recorded, by stage.
    pub recorded: Vec<StageCounts>,
    /// Its copies between CPU and GPU.
    pub host: HostTransfers,
}

/// Counts a frame of `workload` after `frames` frames, with the kernels that GPUs use.
pub fn frame(workload: &Workload, frames: u32, clock: Clock) -> Result<FrameWork> {
    let mut gpu = pollster::block_on(Gpu::open())?;
    let meter = Meter::default();
    let tier = Tier { software: false, ..gpu.context.tier() };
    gpu.context = gpu.context.with_tier(tier).with_probe(Arc::new(meter.clone()));
    let (_, motion) = *workload.runs.last().context("a state to measure")?;
    let mut scene = Photographer::on(gpu, &workload.counted_preset()?, workload.size)?;
    let camera = workload::camera(&scene, workload.size, workload.distance);
    let recorded = play(&mut scene, motion, &camera, clock, frames, &meter)?;
    let commands = meter.commands(&scene.gpu.context)?;
    // Each lap of a clock uploads uniforms, so transfers are those of a frame without. About every second frame has a
    // read-back.
    let motion = Motion::named(motion).context("a built-in motion")?;
    let mut host = HostTransfers::default();
    for frame in frames + 1..frames + 3 {
        meter.start(&scene.gpu.context);
        render(&mut scene, &motion, &camera, frame, None)?;
        let HostTransfers { uploads, read_backs } = meter.host_transfers();
        host.uploads = host.uploads.max(uploads);
        host.read_backs = host.read_backs.max(read_backs);
    }
    Ok(FrameWork { commands, recorded, host })
}

/// Name of a stage, and counts of its commands.
pub type StageCounts = (&'static str, Counts);

/// Renders frames in motion and counts the last, after `frames` others.
fn play(
    scene: &mut Photographer,
    motion: &str,
    camera: &Viewpoint,
    clock: Clock,
    frames: u32,
    meter: &Meter,
) -> Result<Vec<StageCounts>> {
    let motion = Motion::named(motion).context("a built-in motion")?;
    let start = motion.gesture(0.0, scene.character.neck());
    scene.reset(&start)?;
    let context = scene.gpu.context.clone();
    let mut counts = Vec::new();
    for frame in 0..=frames {
        if frame == frames {
            meter.start(&context);
        }
        // The laps of a clock also submit each part of a long frame on its own.
        let mut timings = Timings::by(clock);
        render(scene, &motion, camera, frame, Some(&mut timings))?;
        counts = timings.counts().to_vec();
    }
    Ok(counts)
}

/// Renders frame `frame` of a motion and waits for it.
fn render(
    scene: &mut Photographer,
    motion: &Motion,
    camera: &Viewpoint,
    frame: u32,
    mut timings: Option<&mut Timings>,
) -> Result<()> {
    let context = scene.gpu.context.clone();
    let pose = motion.gesture(f64::from(frame + 1) / FPS, scene.character.neck());
    scene.watch(camera);
    let mut encoder = context.device().create_command_encoder(&Default::default());
    scene.record_advance(&mut encoder, timings.as_deref_mut(), &pose, (1.0 / FPS) as f32)?;
    scene.record_draw(&mut encoder, timings, camera)?;
    context.queue().submit([encoder.finish()]);
    context.device().poll(wgpu::PollType::wait_indefinitely())?;
    Ok(())
}

/// Combines times and counts of the same stages.
fn stages(run: &Run, done: &[(&'static str, StageWork)]) -> Vec<StageBound> {
    let stage = |time: &StageTime| {
        let nothing = StageWork::default();
        let done = done.iter().find(|(name, _)| *name == time.name).map_or(&nothing, |(_, done)| done);
        let traffic_bytes = run.recorded.iter().find(|row| row.stage == time.name).map_or(0, |row| row.bytes);
        StageBound::new(&time.name, done, traffic_bytes, time.time.median)
    };
    run.stages.iter().map(stage).collect()
}

/// Formats the results as tables.
pub fn text(roofline: &Roofline) -> String {
    let head = [
        "stage",
        "invocations",
        "MB",
        "MB requested",
        "M loads",
        "M texels",
        "M atomics",
        "M operations",
        "lower bound",
        "by",
        "measured",
        "ratio",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    let millions = |count: u64| ms(count as f64 * 1e-6);
    let (mut lower_bound, mut measured) = (0.0, 0.0);
    for stage in &roofline.stages {
        let (bound, what) = stage.bound(&roofline.rates);
        lower_bound += bound;
        measured += stage.time;
        rows.push(vec![
            stage.name.clone(),
            tresses_scene::words::grouped(stage.invocations),
            millions(stage.bytes),
            millions(stage.requested_bytes),
            millions(stage.loads),
            millions(stage.texels),
            millions(stage.atomics),
            millions(stage.operations),
            ms(bound),
            what.into(),
            ms(stage.time),
            // A stage that does not run in every frame may be missing from the counted one.
            if bound > 0.0 { format!("{:.1}", stage.time / bound) } else { "-".into() },
        ]);
    }
    let mut sum = vec![String::new(); head.len()];
    sum[0] = "the frame".into();
    sum[8] = ms(lower_bound);
    sum[10] = ms(measured);
    sum[11] = format!("{:.1}", measured / f64::max(lower_bound, 1e-9));
    rows.push(sum);
    format!(
        "\nPeak rates\n{}\n{}: work of a frame, lower bound and measured time, milliseconds\n{}",
        roofline.rates.text(),
        roofline.name,
        table(&rows)
    )
}

#[cfg(test)]
mod tests {
    use super::{instrument::ShaderCounts, *};

    #[test]
    fn bound_is_the_slowest_resource() {
        let rates =
            Rates { copied: 2e9, streamed: 1e9, operations: 1e12, loads: 1e9, texels: 1e9, atomics: 1e6 };
        let counted =
            ShaderCounts { operations: 3_000_000_000, atomics: 1000, loads: 1000, ..ShaderCounts::default() };
        let done = StageWork { counted, requested_bytes: 9, bytes: 1_000_000 };
        // 3 ms of operations, 1 ms of atomics, bytes at the better of both rates.
        let stage = StageBound::new("bins", &done, 0, 6.0);
        assert_eq!(stage.bound(&rates), (3.0, "operations"));
        assert_eq!(StageBound::new("bins", &done, 9_000_000, 6.0).bound(&rates), (5.0, "bytes"));
        let slow = Rates { atomics: 1e5, ..rates };
        assert_eq!(stage.bound(&slow), (10.0, "atomics"));
        let idle = StageBound { name: "wind".into(), time: 1.0, ..StageBound::default() };
        let text = text(&Roofline { name: "a scene".into(), rates, stages: vec![stage, idle] });
        let last: Vec<_> = text.lines().last().expect("a sum").split_whitespace().collect();
        assert_eq!(last, ["the", "frame", "3.00", "7.00", "2.3"]);
        assert!(text.lines().any(|line| line.contains("bins") && line.contains("operations")));
        assert!(text.lines().any(|line| line.contains("wind") && line.ends_with(" -")), "{text}");
    }
}
