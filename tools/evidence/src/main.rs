//! Measurements behind the documentation: the page of benchmarks, the roofline of each stage, the costs of the parts of
//! the simulation, the kernels as GPUs' compilers see them, and a model of frames on GPUs. `tresses bench` measures whole scenes.

mod benchmarks;
mod costs;
mod gpu;
mod record;
mod roofline;

use anyhow::Result;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::path::PathBuf;
use tresses::low_level::wall;
use tresses_cli::{
    args::Size,
    bench::{Sitting, TimingArgs, workload},
    progress,
};

/// Measures the parts of Tresses on this machine.
#[derive(Parser)]
#[command(name = "tresses-evidence", max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    what: Measurement,
    #[command(flatten)]
    timing: TimingArgs,
}

#[derive(Subcommand)]
enum Measurement {
    /// The lower bound of each stage's time, from the work of its shaders and the peak rates of the adapter, and its
    /// actual time (docs/research/roofline.md)
    Roofline {
        /// Hair and settings [default: the built-in long style]
        #[arg(long, value_name = "FILE")]
        preset: Option<PathBuf>,
        /// Image size for that preset, pixels
        #[arg(long, value_name = "WxH", requires = "preset", default_value = "1280x720")]
        size: Size,
        /// Distance of the camera from that preset's hair, meters [default: a portrait's]
        #[arg(long, requires = "preset")]
        distance: Option<f32>,
    },
    /// The parts of the simulation, and their ratios (docs/validation/motion.md)
    Costs,
    /// Frames, strand counts, memory and start-up, as the page docs/benchmarks.md
    Benchmarks(benchmarks::PageArgs),
    /// Registers, spills and waves of each compute kernel, by GPUs' compilers without the GPUs; fails when one spills more
    /// than is known. Needs the drivers of scripts/gpu-compilers, in TRESSES_GPU_COMPILERS or target/tools; for AMD alone,
    /// an installed RADV, or the one that TRESSES_RADV names
    Kernels {
        /// Chips, as MAKER:NAME: amd, intel, nvidia, qualcomm, apple; names as in Mesa [default: some of each]
        #[arg(long, value_name = "CHIP")]
        chip: Vec<String>,
        /// Print all kernels, instead of those with the most registers
        #[arg(long)]
        all: bool,
        /// Compile on the adapter of this process; for this program's own use
        #[arg(long, hide = true)]
        compile: bool,
    },
    /// The processor's part of a frame, on a device without a driver: time to record and submit it, heap allocations
    Record,
    /// A model of frames on four GPUs, from the work of their dispatches and what a GPU's compiler makes of them
    Model {
        /// File of the model's inputs
        #[arg(long, value_name = "FILE", default_value = gpu::INPUTS)]
        inputs: PathBuf,
        /// Count the frames and compile the kernels anew, and write the file
        #[arg(long)]
        write: bool,
        /// Print the section of docs/benchmarks.md
        #[arg(long, conflicts_with_all = ["inputs", "write"])]
        markdown: bool,
    },
}

fn main() -> Result<()> {
    // The options of the measurement may also follow the subcommand.
    let matches = Cli::command().mut_args(|arg| arg.global(true)).get_matches();
    let Cli { what, timing } = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match what {
        Measurement::Kernels { compile: true, .. } => return gpu::compiler::print(),
        Measurement::Kernels { chip, all, .. } => return gpu::print_kernels(chip, all, timing.json),
        Measurement::Record => return record::print(timing.frames.unwrap_or(100), timing.json),
        Measurement::Model { markdown: true, .. } => {
            print!("{}", benchmarks::model()?);
            return Ok(());
        }
        Measurement::Model { inputs, write, .. } => return gpu::print_model(&inputs, write, timing.json),
        _ => {}
    }
    let adapter = timing.adapter()?;
    let frames = timing.frames.unwrap_or(30);
    let runs = match &what {
        Measurement::Roofline { .. } => 1,
        Measurement::Costs => costs::RUNS,
        Measurement::Benchmarks(_) => benchmarks::RUNS,
        Measurement::Kernels { .. } | Measurement::Record | Measurement::Model { .. } => {
            unreachable!("returned above")
        }
    };
    let bar = progress::frames("measuring", runs * u64::from(frames));
    let sitting = Sitting { frames, clock: timing.clock().unwrap_or(wall), bar: &bar };
    let (text, json) = match what {
        Measurement::Roofline { preset, size, distance } => {
            let workload = match preset {
                Some(path) => workload::of_preset(&path, size, (distance, None))?,
                None => workload::long(),
            };
            let roofline = roofline::measure(&workload, sitting)?;
            (roofline::text(&roofline), serde_json::to_value(roofline)?)
        }
        Measurement::Costs => {
            let costs = costs::measure(sitting)?;
            (costs.text(), serde_json::to_value(costs)?)
        }
        Measurement::Benchmarks(args) => benchmarks::run(&args, &timing, &adapter, sitting)?,
        Measurement::Kernels { .. } | Measurement::Record | Measurement::Model { .. } => {
            unreachable!("returned above")
        }
    };
    bar.finish_and_clear();
    if timing.json {
        let report = serde_json::json!({ "adapter": adapter, "result": json });
        println!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        println!("{}{}", adapter.text(), text.trim_end());
    }
    Ok(())
}
