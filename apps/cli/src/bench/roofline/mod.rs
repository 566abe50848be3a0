//! What each stage must cost at least: what its shaders did in a frame, counted as they did it, over what the same
//! adapter can do at best, measured in the same run. `docs/roofline.md` explains the table.

mod instrument;
mod meter;
mod rates;

use super::{
    results::{Run, StageTime},
    sitting::Sitting,
    table::{ms, table},
    workload::{self, FPS, WARM_UP, Workload},
};
use crate::photographer::Photographer;
use anyhow::{Context, Result};
use meter::{Done, Meter};
use rates::Rates;
use serde::Serialize;
use std::sync::Arc;
use tresses::gpu::{Clock, Gpu};
use tresses_scene::{Motion, Viewpoint};

/// Stages and their limits.
#[derive(Debug, Default, Serialize)]
pub struct Roofline {
    /// What was drawn.
    pub name: String,
    /// What the adapter can do.
    pub rates: Rates,
    /// In order.
    pub stages: Vec<Stage>,
}

/// One stage of a frame.
#[derive(Debug, Default, PartialEq, Serialize)]
pub struct Stage {
    /// Its row of times.
    pub name: String,
    /// Invocations of compute and fragment shaders.
    pub invocations: u64,
    /// Bytes that memory must deliver and take once, by shaders, attachments and transfers.
    pub bytes: u64,
    /// Bytes of storage buffers that shaders ask for, as often as they do.
    pub asked: u64,
    /// Loads from storage buffers.
    pub loads: u64,
    /// Texels that are loaded or sampled.
    pub texels: u64,
    /// Atomics on storage buffers.
    pub atomics: u64,
    /// Arithmetic on single numbers.
    pub operations: u64,
    /// Milliseconds, the median of those measured without counting.
    pub time: f64,
}

impl Stage {
    /// `done` in `time` milliseconds; passes and transfers move `moved` bytes besides.
    fn new(name: &str, done: &Done, moved: u64, time: f64) -> Self {
        let counted = done.counted;
        Self {
            name: name.into(),
            invocations: counted.invocations,
            bytes: done.bytes + counted.texel_bytes + moved,
            asked: done.asked,
            loads: counted.loads,
            texels: counted.texels,
            atomics: counted.atomics,
            operations: counted.operations,
            time,
        }
    }

    /// Milliseconds that it takes at least at `rates`, and what they are spent on.
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

/// What is measured of `workload`, whose last state counts.
pub fn measure(workload: &Workload, sitting: Sitting<'_>) -> Result<Roofline> {
    let (state, motion) = *workload.runs.last().context("a state to measure")?;
    let mut scene = Photographer::with_samples_at_most(&workload.preset, workload.size)?;
    let camera = workload::camera(&scene, workload.size, workload.distance);
    let run = workload::run(&mut scene, state, motion, &camera, sitting)?;
    drop(scene);
    let rates = rates::measure(&pollster::block_on(Gpu::open())?, sitting.clock)?;
    let done = count(workload, motion, &camera, sitting.clock)?;
    Ok(Roofline { name: format!("{}, {state}", workload.name), rates, stages: stages(&run, &done) })
}

/// What the first frame does that is measured.
fn count(
    workload: &Workload,
    motion: &str,
    camera: &Viewpoint,
    clock: Clock,
) -> Result<Vec<(&'static str, Done)>> {
    let meter = Meter::default();
    let mut gpu = pollster::block_on(Gpu::open())?;
    gpu.context = gpu.context.with_probe(Arc::new(meter.clone()));
    let mut scene = Photographer::on(gpu, &workload.preset, workload.size)?;
    scene.measure_by(clock);
    let motion = Motion::named(motion).context("a built-in motion")?;
    let pivot = scene.character.neck();
    scene.reset(&motion.gesture(0.0, pivot))?;
    for frame in 0..=WARM_UP {
        if frame == WARM_UP {
            meter.start(&scene.gpu.context);
        }
        let pose = motion.gesture(f64::from(frame + 1) / FPS, pivot);
        scene.measured_frame(&pose, (1.0 / FPS) as f32, camera)?;
    }
    meter.take(&scene.gpu.context)
}

/// Times and counts of the same stages side by side.
fn stages(run: &Run, done: &[(&'static str, Done)]) -> Vec<Stage> {
    let stage = |time: &StageTime| {
        let nothing = Done::default();
        let done = done.iter().find(|(name, _)| *name == time.name).map_or(&nothing, |(_, done)| done);
        let moved = run.recorded.iter().find(|row| row.stage == time.name).map_or(0, |row| row.bytes);
        Stage::new(&time.name, done, moved, time.time.median)
    };
    run.stages.iter().map(stage).collect()
}

/// As tables.
pub fn text(roofline: &Roofline) -> String {
    let head = [
        "stage",
        "invocations",
        "MB",
        "asked for",
        "M loads",
        "M texels",
        "M atomics",
        "M operations",
        "at least",
        "by",
        "measured",
        "ratio",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    let millions = |count: u64| ms(count as f64 * 1e-6);
    let (mut least, mut measured) = (0.0, 0.0);
    for stage in &roofline.stages {
        let (bound, what) = stage.bound(&roofline.rates);
        least += bound;
        measured += stage.time;
        rows.push(vec![
            stage.name.clone(),
            tresses_scene::words::grouped(stage.invocations),
            millions(stage.bytes),
            millions(stage.asked),
            millions(stage.loads),
            millions(stage.texels),
            millions(stage.atomics),
            millions(stage.operations),
            ms(bound),
            what.into(),
            ms(stage.time),
            // What is not due in each frame may not have been in the one that counted.
            if bound > 0.0 { format!("{:.1}", stage.time / bound) } else { "-".into() },
        ]);
    }
    let mut sum = vec![String::new(); head.len()];
    sum[0] = "the frame".into();
    sum[8] = ms(least);
    sum[10] = ms(measured);
    sum[11] = format!("{:.1}", measured / f64::max(least, 1e-9));
    rows.push(sum);
    format!(
        "\nAt best\n{}\n{}: what a frame does, what that takes at least, milliseconds\n{}",
        roofline.rates.text(),
        roofline.name,
        table(&rows)
    )
}

#[cfg(test)]
mod tests {
    use super::{instrument::Counted, *};

    #[test]
    fn a_stage_is_held_against_what_binds_it() {
        let rates =
            Rates { copied: 2e9, streamed: 1e9, operations: 1e12, loads: 1e9, texels: 1e9, atomics: 1e6 };
        let counted = Counted { operations: 3_000_000_000, atomics: 1000, loads: 1000, ..Counted::default() };
        let done = Done { counted, asked: 9, bytes: 1_000_000 };
        // 3 ms of operations, 1 of atomics; bytes at the better of both rates.
        let stage = Stage::new("bins", &done, 0, 6.0);
        assert_eq!(stage.bound(&rates), (3.0, "operations"));
        assert_eq!(Stage::new("bins", &done, 9_000_000, 6.0).bound(&rates), (5.0, "bytes"));
        let slow = Rates { atomics: 1e5, ..rates };
        assert_eq!(stage.bound(&slow), (10.0, "atomics"));
        let idle = Stage { name: "wind".into(), time: 1.0, ..Stage::default() };
        let text = text(&Roofline { name: "a scene".into(), rates, stages: vec![stage, idle] });
        let last: Vec<_> = text.lines().last().expect("a sum").split_whitespace().collect();
        assert_eq!(last, ["the", "frame", "3.00", "7.00", "2.3"]);
        assert!(text.lines().any(|line| line.contains("bins") && line.contains("operations")));
        assert!(text.lines().any(|line| line.contains("wind") && line.ends_with(" -")), "{text}");
    }
}
