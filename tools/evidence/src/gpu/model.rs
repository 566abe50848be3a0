//! A model of a frame on GPUs that are not there: from the work of each dispatch, counted on this machine's driver, and
//! from what a GPU's compiler makes of its kernel.
//!
//! A dispatch takes the largest of: its launch, since each depends on the one before; the latency of a wave, times the
//! rounds in which all its waves fit on the chip; its cycles on all SIMDs; its bytes; its atomics. Draws take the
//! largest of launch, bytes and fragments. A frame is their sum. The compiler estimates cycles with assumed turns of
//! each loop; they are scaled by the ratio of the operations that a thread really executed to those with these turns.

use super::compiler::KernelStats;
use crate::roofline::{CommandWork, expected::expected};
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use tresses::low_level::shaders;
use tresses_cli::bench::table::{ms, table};

/// A chip of the model.
#[derive(Clone, Copy, Debug)]
pub struct Chip {
    /// Its name.
    pub name: &'static str,
    /// SIMDs, each of which issues for one wave at a time.
    simds: f64,
    /// Cycles per second.
    clock: f64,
    /// Bytes per second.
    bytes: f64,
    /// Atomics on memory per second.
    atomics: f64,
    /// Fragments per second.
    fragments: f64,
}

/// Seconds of a dispatch or draw that depends on the one before.
const LAUNCH: f64 = 5e-6;
/// Threads per wave, as compiled.
const WAVE: f64 = 64.0;

/// The chips. The H100 runs other instructions; its figures assume the cycles of RDNA 3, and rasterize thirty times
/// slower than they compute.
pub const CHIPS: [Chip; 3] = [
    Chip { name: "laptop, 8 CU", simds: 16.0, clock: 2.4e9, bytes: 100e9, atomics: 10e9, fragments: 60e9 },
    Chip { name: "RX 7900 XTX", simds: 192.0, clock: 2.4e9, bytes: 960e9, atomics: 100e9, fragments: 400e9 },
    Chip { name: "H100-like", simds: 528.0, clock: 1.7e9, bytes: 3.3e12, atomics: 200e9, fragments: 13e9 },
];

/// A counted frame.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct CountedFrame {
    /// Name of the scene.
    pub scene: String,
    /// Its dispatches and draws, in order.
    pub commands: Vec<CountedCommand>,
    /// Copies and fills outside passes, by stage.
    pub transfers: BTreeMap<String, u32>,
    /// Bytes that attachments and transfers move, by stage.
    #[serde(rename = "moved")]
    pub traffic_bytes: BTreeMap<String, u64>,
}

/// A counted dispatch or draw.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct CountedCommand {
    /// Stage of the frame.
    pub stage: String,
    /// Module path of a dispatch's kernel; `None` for a draw.
    pub kernel: Option<String>,
    /// Threads or fragments.
    pub threads: u64,
    /// Arithmetic operations.
    pub operations: u64,
    /// Minimum memory traffic, bytes.
    pub bytes: u64,
    /// Atomic operations on memory.
    pub atomics: u64,
}

impl From<&CommandWork> for CountedCommand {
    fn from(command: &CommandWork) -> Self {
        let CommandWork { stage, kernel, work } = command;
        Self {
            stage: (*stage).into(),
            kernel: kernel.map(Into::into),
            threads: work.counted.invocations,
            operations: work.counted.operations,
            bytes: work.bytes + work.counted.texel_bytes,
            atomics: work.counted.atomics,
        }
    }
}

/// Everything that the model reads, as stored beside it.
#[derive(Debug, Deserialize, Serialize)]
pub struct Inputs {
    /// Driver whose compiler made `kernels`.
    pub driver: String,
    /// The kernels of the frames.
    pub kernels: Vec<KernelStats>,
    /// The frames.
    pub frames: Vec<CountedFrame>,
}

/// Returns the waves that fit on a SIMD at once, by registers and by workgroup memory: 64 kB for two SIMDs.
fn fitting(kernel: &KernelStats) -> f64 {
    let of_workgroup = (f64::from(kernel.threads) / WAVE).ceil();
    let by_memory = (65_536 / kernel.shared.max(1)) as f64 * of_workgroup / 2.0;
    f64::from(kernel.waves.max(1)).min(by_memory.max(0.5))
}

/// Seconds of a stage, by what limits its commands.
#[derive(Clone, Debug, Default)]
struct StageTime {
    commands: u32,
    limits: BTreeMap<&'static str, f64>,
}

/// The model: kernels by name, each with the operations of a thread that the compiler's estimate assumes.
pub struct Model<'a> {
    inputs: &'a Inputs,
    kernels: HashMap<&'a str, (&'a KernelStats, f64)>,
}

impl<'a> Model<'a> {
    /// Creates the model.
    ///
    /// # Errors
    /// Fails for a kernel that is no longer there.
    pub fn new(inputs: &'a Inputs) -> Result<Self> {
        let mut kernels = HashMap::new();
        for kernel in &inputs.kernels {
            let source = shaders::all().iter().find(|(name, _)| *name == kernel.name);
            let (_, source) = source.with_context(|| format!("there is no kernel {}", kernel.name))?;
            kernels.insert(&*kernel.name, (kernel, expected(source)?));
        }
        Ok(Self { inputs, kernels })
    }

    /// Returns the seconds of a command on `chip`, and what limits it.
    fn command(&self, command: &CountedCommand, chip: &Chip) -> (f64, &'static str) {
        let mut limits = vec![
            (LAUNCH, "launch"),
            (command.bytes as f64 / chip.bytes, "bytes"),
            (command.atomics as f64 / chip.atomics, "atomics"),
        ];
        let kernel = command.kernel.as_deref().and_then(|name| self.kernels.get(name));
        match kernel.filter(|_| command.threads > 0) {
            Some((kernel, expected)) => {
                let threads = f64::from(kernel.threads.max(1));
                let workgroups = command.threads as f64 / threads;
                let waves = workgroups * (threads / WAVE).ceil();
                let iteration_ratio = command.operations as f64 / command.threads as f64 / expected.max(1.0);
                let rounds = (waves / (chip.simds * fitting(kernel))).max(1.0);
                limits.push((kernel.latency as f64 * iteration_ratio * rounds / chip.clock, "latency"));
                // The compiler's figure is for waves whose threads are all used.
                let cycles = kernel.throughput as f64 * command.threads as f64 / WAVE;
                limits.push((cycles * iteration_ratio / chip.simds / chip.clock, "cycles"));
            }
            None => limits.push((command.threads as f64 / chip.fragments, "fragments")),
        }
        limits.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("limits")
    }

    /// Returns the stages of a frame on `chip`, in order.
    fn stages(&self, frame: &CountedFrame, chip: &Chip) -> Vec<(String, StageTime)> {
        let mut stages: Vec<(String, StageTime)> = Vec::new();
        for command in &frame.commands {
            let index = stages.iter().position(|(name, _)| *name == command.stage).unwrap_or_else(|| {
                stages.push((command.stage.clone(), StageTime::default()));
                stages.len() - 1
            });
            let (seconds, limit) = self.command(command, chip);
            stages[index].1.commands += 1;
            *stages[index].1.limits.entry(limit).or_default() += seconds;
        }
        for (name, stage) in &mut stages {
            let transfers = frame.transfers.get(name).copied().unwrap_or(0);
            let traffic_seconds = frame.traffic_bytes.get(name).copied().unwrap_or(0) as f64 / chip.bytes;
            stage.commands += transfers;
            *stage.limits.entry("launch").or_default() += LAUNCH * f64::from(transfers);
            *stage.limits.entry("bytes").or_default() += traffic_seconds;
        }
        stages
    }

    /// Returns the milliseconds of a frame on `chip`.
    pub fn milliseconds(&self, frame: &CountedFrame, chip: &Chip) -> f64 {
        let stages = self.stages(frame, chip);
        1e3 * stages.iter().flat_map(|(_, stage)| stage.limits.values()).sum::<f64>()
    }

    /// Rows of all frames on all chips, milliseconds, with a head.
    pub fn frames(&self) -> Vec<Vec<String>> {
        let mut rows = vec![vec!["scene".to_owned(), "dispatches and draws".into()]];
        rows[0].extend(CHIPS.iter().map(|chip| chip.name.to_owned()));
        rows.extend(self.inputs.frames.iter().map(|frame| {
            let times = CHIPS.iter().map(|chip| ms(self.milliseconds(frame, chip)));
            [frame.scene.clone(), frame.commands.len().to_string()].into_iter().chain(times).collect()
        }));
        rows
    }

    /// Rows of the stages of a frame on `chip`: commands, milliseconds, and what limits most of them, with a head.
    pub fn stage_rows(&self, frame: &CountedFrame, chip: &Chip) -> Vec<Vec<String>> {
        let mut rows = vec![["stage", "commands", "ms", "limited by"].map(String::from).to_vec()];
        for (name, stage) in self.stages(frame, chip) {
            let sum: f64 = stage.limits.values().sum();
            let dominant = stage.limits.iter().max_by(|a, b| a.1.total_cmp(b.1));
            let limit = dominant.map_or("-", |(name, _)| name);
            rows.push(vec![name, stage.commands.to_string(), format!("{:.3}", 1e3 * sum), limit.into()]);
        }
        rows
    }

    /// Formats all results as text.
    pub fn text(&self) -> String {
        let mut text =
            format!("\nA model, not a measurement. Milliseconds per frame.\n{}", table(&self.frames()));
        for frame in &self.inputs.frames {
            text += &format!(
                "\n{}, {}\n{}",
                frame.scene,
                CHIPS[1].name,
                table(&self.stage_rows(frame, &CHIPS[1]))
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One kernel, whose loops turn as often as the compiler assumes.
    fn inputs(threads: u64, change: impl FnOnce(&mut CountedCommand)) -> Inputs {
        let (name, source) =
            shaders::all().iter().find(|(name, _)| *name == "light::ambient::settle").unwrap();
        let expected = expected(source).unwrap();
        let mut command = CountedCommand {
            stage: "ambient".into(),
            kernel: Some((*name).into()),
            threads,
            operations: (expected * threads as f64) as u64,
            ..CountedCommand::default()
        };
        change(&mut command);
        let kernel = KernelStats {
            name: (*name).into(),
            threads: 64,
            waves: 10,
            latency: 24_000,
            throughput: 1200,
            ..KernelStats::default()
        };
        let frame =
            CountedFrame { scene: "a scene".into(), commands: vec![command], ..CountedFrame::default() };
        Inputs { driver: "a driver".into(), kernels: vec![kernel], frames: vec![frame] }
    }

    fn limit(inputs: &Inputs) -> (f64, &'static str) {
        Model::new(inputs).unwrap().command(&inputs.frames[0].commands[0], &CHIPS[1])
    }

    #[test]
    fn a_command_takes_the_longest_of_its_limits() {
        let near = |found: (f64, &str), seconds: f64, what: &str| {
            assert!((found.0 / seconds - 1.0).abs() < 0.01 && found.1 == what, "{found:?}");
        };
        // 10 microseconds for one wave alone, as for as many as fit.
        near(limit(&inputs(64, |_| {})), 10e-6, "latency");
        near(limit(&inputs(64 * 1920, |_| {})), 10e-6, "latency");
        near(limit(&inputs(64 * 3840, |_| {})), 20e-6, "latency");
        near(limit(&inputs(64, |command| command.operations *= 10)), 100e-6, "latency");
        let mut busy = inputs(64 * 3840, |_| {});
        busy.kernels[0].throughput = 4800;
        near(limit(&busy), 40e-6, "cycles");
        near(limit(&inputs(0, |_| {})), LAUNCH, "launch");
        near(limit(&inputs(64, |command| command.bytes = 96_000_000)), 100e-6, "bytes");
        near(limit(&inputs(64, |command| command.atomics = 10_000_000)), 100e-6, "atomics");
        near(limit(&inputs(40_000_000, |command| command.kernel = None)), 100e-6, "fragments");
    }

    #[test]
    fn a_frame_is_the_sum_of_its_commands_and_transfers() {
        let mut inputs = inputs(64, |_| {});
        inputs.frames[0].transfers.insert("ambient".into(), 2);
        let model = Model::new(&inputs).unwrap();
        assert!((model.milliseconds(&inputs.frames[0], &CHIPS[1]) - 0.02).abs() < 1e-4);
        assert!(model.text().contains("a scene"));
    }
}
