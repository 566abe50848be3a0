//! A model of a frame on GPUs that are not there: from the work of each dispatch, counted on this machine's driver, and
//! from what a GPU's compiler makes of its kernel.
//!
//! A dispatch takes the largest of: its launch, since each depends on the one before; the latency of a wave, times the
//! rounds in which all its waves fit on the chip; its cycles on all SIMDs; its bytes, and the memory lines that they
//! lie in; its atomics, by where they land. Draws take the largest of launch, bytes and fragments. Copies and fills
//! take a launch each. A frame is their sum, with its uploads, its read-backs and, on chips where they cost time, its
//! encoders. The compiler estimates cycles with assumed turns of each loop; they are scaled by the ratio of the
//! operations that a thread really executed to those with these turns.

use super::{
    compiler::KernelStats,
    constants::{AtomicPattern, Chip, Constants},
};
use crate::roofline::{CommandWork, expected::expected};
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use tresses::low_level::{Counts, shaders};
use tresses_cli::bench::table::{ms, table};

/// Threads per wave, as compiled.
const WAVE: f64 = 64.0;

/// The chip whose stages are printed, by its position: the RX 7900 XTX.
const MAIN: usize = 1;

/// A counted frame.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct CountedFrame {
    /// Name of the scene.
    pub scene: String,
    /// Its dispatches and draws, in order.
    pub commands: Vec<CountedCommand>,
    /// Other recorded counts, by stage.
    pub recorded: BTreeMap<String, RecordedCounts>,
    /// Writes to buffers through the queue.
    pub uploads: u32,
    /// Copies to the CPU, each submitted on its own.
    pub read_backs: u32,
}

/// Counts that a stage recorded, besides its dispatches and draws.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct RecordedCounts {
    /// Indirect dispatches.
    pub indirect: u32,
    /// Passes, and runs of transfers between them: each is an encoder on Metal.
    pub encoders: u32,
    /// Copies and fills outside passes.
    pub transfers: u32,
    /// Bytes that attachments and transfers move.
    pub bytes: u64,
}

impl From<&Counts> for RecordedCounts {
    fn from(counts: &Counts) -> Self {
        Self {
            indirect: counts.indirect,
            encoders: counts.passes + counts.transfer_runs,
            transfers: counts.transfers,
            bytes: counts.bytes,
        }
    }
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
    /// Loads of texels.
    pub texels: u64,
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
            texels: work.counted.texels,
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

/// Seconds by what limits commands.
type Terms = BTreeMap<&'static str, f64>;

/// Adds the terms of `other`.
fn add(sum: &mut Terms, other: &Terms) {
    other.iter().for_each(|(term, seconds)| *sum.entry(term).or_default() += seconds);
}

/// Formats the percentages of terms, the largest first.
fn percentages(terms: &Terms) -> String {
    let sum: f64 = terms.values().sum();
    let mut shares: Vec<_> =
        terms.iter().map(|(term, seconds)| (100.0 * seconds / sum.max(1e-12), term)).collect();
    shares.sort_by(|a, b| b.0.total_cmp(&a.0));
    let shares = shares.iter().filter(|(share, _)| *share >= 0.5);
    shares.map(|(share, term)| format!("{term} {share:.0} %")).collect::<Vec<_>>().join(", ")
}

/// A stage of a frame.
#[derive(Clone, Debug, Default)]
struct StageTime {
    commands: u32,
    recorded: RecordedCounts,
    terms: Terms,
}

/// The model: kernels by name, each with the operations of a thread that the compiler's estimate assumes.
pub struct Model<'a> {
    inputs: &'a Inputs,
    constants: &'a Constants,
    kernels: HashMap<&'a str, (&'a KernelStats, f64)>,
}

impl<'a> Model<'a> {
    /// Creates the model.
    ///
    /// # Errors
    /// Fails for a kernel that is no longer there, and for one of whose atomics the constants do not say where they
    /// land.
    pub fn new(inputs: &'a Inputs, constants: &'a Constants) -> Result<Self> {
        let mut kernels = HashMap::new();
        for kernel in &inputs.kernels {
            let source = shaders::all().iter().find(|(name, _)| *name == kernel.name);
            let (_, source) = source.with_context(|| format!("there is no kernel {}", kernel.name))?;
            kernels.insert(&*kernel.name, (kernel, expected(&shaders::for_gpu(source))?));
        }
        for command in inputs.frames.iter().flat_map(|frame| &frame.commands).filter(|it| it.atomics > 0) {
            let name = command.kernel.as_deref().unwrap_or("a draw");
            let pattern = constants.atomics.get(name);
            pattern.with_context(|| {
                format!("{name} has atomics, but {} has no row for them", Constants::FILE)
            })?;
        }
        Ok(Self { inputs, constants, kernels })
    }

    /// The chip of [`stage_rows`](Self::stage_rows).
    pub fn main_chip(&self) -> &Chip {
        &self.constants.chips[MAIN]
    }

    /// Returns the seconds of a command on `chip`, and what limits it.
    fn command(&self, command: &CountedCommand, chip: &Chip) -> (f64, &'static str) {
        let name = command.kernel.as_deref().unwrap_or_default();
        let atomics = match self.constants.atomics.get(name) {
            Some(AtomicPattern::Word) => chip.word,
            Some(AtomicPattern::Line) => chip.line,
            Some(AtomicPattern::Scattered) | None => chip.scattered,
        };
        let mut limits = vec![
            (chip.launch, "launch"),
            (command.bytes as f64 / chip.bytes, "bytes"),
            (self.constants.line_bytes(name, command.bytes, command.texels) / chip.bytes, "partial lines"),
            (command.atomics as f64 / atomics, "atomics"),
        ];
        match self.kernels.get(name).filter(|_| command.threads > 0) {
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
        // Of equal limits the first: bytes on whole lines are limited by bytes.
        limits.into_iter().rev().max_by(|a, b| a.0.total_cmp(&b.0)).expect("limits")
    }

    /// Returns the stages of a frame on `chip`, in order.
    fn stages(&self, frame: &CountedFrame, chip: &Chip) -> Vec<(String, StageTime)> {
        let mut stages: Vec<(String, StageTime)> = Vec::new();
        let index_of = |stages: &mut Vec<(String, StageTime)>, name: &str| {
            stages.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                stages.push((name.into(), StageTime::default()));
                stages.len() - 1
            })
        };
        for command in &frame.commands {
            let index = index_of(&mut stages, &command.stage);
            let (seconds, limit) = self.command(command, chip);
            stages[index].1.commands += 1;
            *stages[index].1.terms.entry(limit).or_default() += seconds;
        }
        for (name, recorded) in frame.recorded.iter().filter(|(_, it)| **it != RecordedCounts::default()) {
            let index = index_of(&mut stages, name);
            let stage = &mut stages[index].1;
            stage.recorded = *recorded;
            stage.commands += recorded.transfers;
            let more = [
                ("launch", chip.launch * f64::from(recorded.transfers)),
                ("bytes", recorded.bytes as f64 / chip.bytes),
                ("switches", chip.switch * f64::from(recorded.encoders)),
            ];
            add(&mut stage.terms, &more.into());
        }
        stages
    }

    /// Returns the terms of a frame on `chip`.
    fn terms(&self, frame: &CountedFrame, chip: &Chip) -> Terms {
        let mut sum = Terms::from(host_terms(frame, chip));
        self.stages(frame, chip).iter().for_each(|(_, stage)| add(&mut sum, &stage.terms));
        sum
    }

    /// Returns the milliseconds of a frame on `chip`.
    pub fn milliseconds(&self, frame: &CountedFrame, chip: &Chip) -> f64 {
        1e3 * self.terms(frame, chip).values().sum::<f64>()
    }

    /// Rows of all frames: milliseconds on all chips, those to aim for on the main one, and what limits them there,
    /// with a head.
    pub fn frames(&self) -> Vec<Vec<String>> {
        let (chips, main) = (&self.constants.chips, self.main_chip());
        let names = chips.iter().map(|chip| chip.name.clone());
        let more = ["goal", "limited by"].map(|name| format!("{name}, {}", main.name));
        let mut rows = vec![["scene".to_owned()].into_iter().chain(names).chain(more).collect()];
        rows.extend(self.inputs.frames.iter().map(|frame| {
            let times = chips.iter().map(|chip| ms(self.milliseconds(frame, chip)));
            let goal = self.constants.goal(&frame.scene).map_or("-".into(), ms);
            let more = [goal, percentages(&self.terms(frame, main))];
            [frame.scene.clone()].into_iter().chain(times).chain(more).collect()
        }));
        rows
    }

    /// Rows of all frames: numbers of commands, encoders, and copies between CPU and GPU, with a head.
    pub fn counts(&self) -> Vec<Vec<String>> {
        let head =
            ["dispatches", "indirect", "draws", "copies and fills", "encoders", "uploads", "read-backs"];
        let row =
            |scene: &str, cells: [String; 7]| [scene.into()].into_iter().chain(cells).collect::<Vec<_>>();
        let mut rows = vec![row("scene", head.map(Into::into))];
        rows.extend(self.inputs.frames.iter().map(|frame| {
            let commands = frame.commands.len() as u32;
            let draws = frame.commands.iter().filter(|command| command.kernel.is_none()).count() as u32;
            let sum = |of: fn(&RecordedCounts) -> u32| frame.recorded.values().map(of).sum::<u32>();
            let (indirect, transfers) = (sum(|it| it.indirect), sum(|it| it.transfers));
            let (encoders, uploads, read_backs) = (sum(|it| it.encoders), frame.uploads, frame.read_backs);
            let counts = [commands - draws, indirect, draws, transfers, encoders, uploads, read_backs];
            row(&frame.scene, counts.map(|count| count.to_string()))
        }));
        rows
    }

    /// Rows of a frame on the main chip, with a head: its stages, its copies between CPU and GPU, their sum and, not in
    /// the sum, wgpu's validation of indirect dispatches.
    pub fn stage_rows(&self, frame: &CountedFrame) -> Vec<Vec<String>> {
        let chip = self.main_chip();
        let row = |name: &str, commands: u32, recorded: RecordedCounts, terms: &Terms| {
            let counts = [commands, recorded.indirect, recorded.encoders].map(|count| count.to_string());
            let sum = format!("{:.3}", 1e3 * terms.values().sum::<f64>());
            [name.to_owned()].into_iter().chain(counts).chain([sum, percentages(terms)]).collect::<Vec<_>>()
        };
        let mut rows = vec![
            ["stage", "commands", "indirect", "encoders", "ms", "limited by"].map(String::from).to_vec(),
        ];
        let (mut commands, mut recorded) = (0, RecordedCounts::default());
        for (name, stage) in self.stages(frame, chip) {
            commands += stage.commands;
            recorded.indirect += stage.recorded.indirect;
            recorded.encoders += stage.recorded.encoders;
            rows.push(row(&name, stage.commands, stage.recorded, &stage.terms));
        }
        for (term, count) in host_terms(frame, chip).into_iter().zip([frame.uploads, frame.read_backs]) {
            rows.push(row(term.0, count, RecordedCounts::default(), &[term].into()));
        }
        rows.push(row("the frame", commands, recorded, &self.terms(frame, chip)));
        // One dependent dispatch more: one of its two barriers is the one before the indirect dispatch.
        let validation = ("launch", chip.launch * f64::from(recorded.indirect));
        let name = "validation (instances of hosts, browsers)";
        rows.push(row(name, recorded.indirect, RecordedCounts::default(), &[validation].into()));
        rows
    }

    /// Formats all results as text.
    pub fn text(&self) -> String {
        let mut text = format!(
            "\nA model, not a measurement. Milliseconds per frame.\n{}\nWhat a frame records\n{}",
            table(&self.frames()),
            table(&self.counts())
        );
        for frame in &self.inputs.frames {
            let rows = table(&self.stage_rows(frame));
            text += &format!("\n{}, {}\n{rows}", frame.scene, self.main_chip().name);
        }
        text
    }
}

/// Seconds of a frame's copies between CPU and GPU: uploads and read-backs.
fn host_terms(frame: &CountedFrame, chip: &Chip) -> [(&'static str, f64); 2] {
    [
        ("uploads", chip.upload * f64::from(frame.uploads)),
        ("read-backs", chip.submission * f64::from(frame.read_backs)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Constants of the stored file, with these changes.
    fn constants(change: impl FnOnce(&mut Constants)) -> Constants {
        let mut constants = Constants::read().unwrap();
        change(&mut constants);
        constants
    }

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

    /// The limit of the command of `inputs`.
    fn limit_with(inputs: &Inputs, constants: &Constants) -> (f64, &'static str) {
        let model = Model::new(inputs, constants).unwrap();
        model.command(&inputs.frames[0].commands[0], model.main_chip())
    }

    fn limit(inputs: &Inputs) -> (f64, &'static str) {
        limit_with(
            inputs,
            &constants(|it| {
                it.atomics.insert(SETTLE.into(), AtomicPattern::Line);
            }),
        )
    }

    const SETTLE: &str = "light::ambient::settle";

    fn near(found: (f64, &str), seconds: f64, what: &str) {
        assert!(
            (found.0 / seconds - 1.0).abs() < 0.01 && found.1 == what,
            "{found:?}, not {seconds} by {what}"
        );
    }

    #[test]
    fn a_command_takes_the_longest_of_its_limits() {
        // 10 microseconds for one wave alone, as for as many as fit.
        near(limit(&inputs(64, |_| {})), 10e-6, "latency");
        near(limit(&inputs(64 * 1920, |_| {})), 10e-6, "latency");
        near(limit(&inputs(64 * 3840, |_| {})), 20e-6, "latency");
        near(limit(&inputs(64, |command| command.operations *= 10)), 100e-6, "latency");
        let mut busy = inputs(64 * 3840, |_| {});
        busy.kernels[0].throughput = 4800;
        near(limit(&busy), 40e-6, "cycles");
        near(limit(&inputs(0, |_| {})), 5e-6, "launch");
        near(limit(&inputs(64, |command| command.bytes = 96_000_000)), 100e-6, "bytes");
        near(limit(&inputs(64, |command| command.atomics = 10_000_000)), 100e-6, "atomics");
        near(limit(&inputs(40_000_000, |command| command.kernel = None)), 100e-6, "fragments");
    }

    #[test]
    fn atomics_cost_by_where_they_land() {
        let inputs = inputs(64, |command| command.atomics = 10_000_000);
        let on = |pattern| {
            limit_with(
                &inputs,
                &constants(|it| {
                    it.atomics.insert(SETTLE.into(), pattern);
                }),
            )
        };
        near(on(AtomicPattern::Line), 100e-6, "atomics");
        near(on(AtomicPattern::Word), 250e-6, "atomics");
        near(on(AtomicPattern::Scattered), 250e-6, "atomics");
        assert!(Model::new(&inputs, &constants(|_| {})).is_err(), "no row for its atomics");
        let apple = constants(|it| {
            it.atomics.insert(SETTLE.into(), AtomicPattern::Word);
        });
        let model = Model::new(&inputs, &apple).unwrap();
        let seconds = model.command(&inputs.frames[0].commands[0], &apple.chips[3]).0;
        assert!((seconds / (10e6 / 1.4e9) - 1.0).abs() < 0.01, "one word on Apple: {seconds}");
    }

    #[test]
    fn bytes_on_partly_used_lines_count_as_whole_lines() {
        let bytes = inputs(64, |command| command.bytes = 96_000_000);
        near(
            limit_with(
                &bytes,
                &constants(|it| {
                    it.lines.insert(SETTLE.into(), 0.25);
                }),
            ),
            400e-6,
            "partial lines",
        );
        let texels = inputs(64, |command| command.texels = 12_000_000);
        near(limit_with(&texels, &constants(|_| {})), 10e-6, "latency");
        let walked = constants(|it| it.set_texels(SETTLE, 4.0, 0.5));
        near(limit_with(&texels, &walked), 100e-6, "partial lines");
    }

    /// Milliseconds of the stored chip number `chip`, for a frame of one dispatch of 10 µs.
    fn milliseconds(chip: usize, change: impl FnOnce(&mut CountedFrame)) -> f64 {
        let mut inputs = inputs(64, |_| {});
        change(&mut inputs.frames[0]);
        let constants = constants(|_| {});
        let model = Model::new(&inputs, &constants).unwrap();
        model.milliseconds(&inputs.frames[0], &constants.chips[chip])
    }

    #[test]
    fn a_frame_is_the_sum_of_its_commands_and_transfers() {
        let recorded = |recorded| {
            move |frame: &mut CountedFrame| {
                frame.recorded.insert("ambient".into(), recorded);
            }
        };
        let close =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-4, "{found}, not {expected}");
        close(milliseconds(MAIN, |_| {}), 0.01);
        close(
            milliseconds(MAIN, recorded(RecordedCounts { transfers: 2, ..RecordedCounts::default() })),
            0.02,
        );
        close(
            milliseconds(MAIN, recorded(RecordedCounts { bytes: 96_000_000, ..RecordedCounts::default() })),
            0.11,
        );
        // A stage without dispatches.
        let clears = |frame: &mut CountedFrame| {
            frame
                .recorded
                .insert("view".into(), RecordedCounts { transfers: 1, ..RecordedCounts::default() });
        };
        close(milliseconds(MAIN, clears), 0.015);
        close(milliseconds(MAIN, |frame| frame.uploads = 40), 0.05);
        close(milliseconds(MAIN, |frame| frame.read_backs = 1), 0.02);
        // Switches cost time on Apple only: 8 µs.
        let encoders = || recorded(RecordedCounts { encoders: 5, ..RecordedCounts::default() });
        close(milliseconds(MAIN, encoders()), 0.01);
        close(milliseconds(3, encoders()) - milliseconds(3, |_| {}), 0.04);
    }

    #[test]
    fn validation_is_a_row_outside_of_the_sum() {
        let mut inputs = inputs(64, |_| {});
        let recorded = RecordedCounts { indirect: 3, encoders: 7, ..RecordedCounts::default() };
        inputs.frames[0].recorded.insert("ambient".into(), recorded);
        inputs.frames[0].uploads = 10;
        let constants = constants(|_| {});
        let model = Model::new(&inputs, &constants).unwrap();
        let rows = model.stage_rows(&inputs.frames[0]);
        let row = |name: &str| {
            rows.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{name}: {rows:?}"))[1..]
                .join("|")
        };
        assert_eq!(row("ambient"), "1|3|7|0.010|latency 100 %");
        assert_eq!(row("uploads"), "10|0|0|0.010|uploads 100 %");
        assert_eq!(row("the frame"), "1|3|7|0.020|latency 50 %, uploads 50 %");
        assert_eq!(row("validation (instances of hosts, browsers)"), "3|0|0|0.015|launch 100 %");
        assert_eq!(model.counts()[1][1..].join("|"), "1|3|0|0|7|10|0");
        assert_eq!(model.frames()[1][2], "0.020");
        assert!(model.text().contains("a scene"));
    }
}
