//! GPUs that are not there: what their compiler makes of each kernel, and a model of a frame on them.

pub mod compiler;
mod kernels;
mod model;

pub use model::{CHIPS, Inputs, Model};

use crate::roofline;
use anyhow::{Context, Result};
use model::{CountedCommand, CountedFrame};
use std::path::Path;
use tresses::low_level::wall;
use tresses_cli::{
    args::Size,
    bench::workload::{self, Workload},
};

/// Where the inputs of the model lie, from the root of the repository.
pub const INPUTS: &str = "tools/evidence/gpu-model.json";
/// The inputs of the model in the repository.
pub const STORED: &str = include_str!("../../gpu-model.json");

/// Frames before the counted one: after them, the tile lists of a view have their size.
const BEFORE: u32 = 5;

/// Compiles the kernels for `families` and prints them.
///
/// # Errors
/// Fails if a kernel spills.
pub fn print_kernels(mut families: Vec<String>, all: bool, json: bool) -> Result<()> {
    if compiler::driver().is_none() {
        println!(
            "not run: RADV, Mesa's Vulkan driver for AMD, is not installed, and TRESSES_RADV does not name one"
        );
        return Ok(());
    }
    if families.is_empty() {
        families = kernels::FAMILIES.map(String::from).to_vec();
    }
    let (chips, missing) = kernels::compile(&families)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&chips)?);
    } else {
        chips.iter().for_each(|chip| println!("{}", kernels::text(chip, all).trim_end()));
        missing.iter().for_each(|line| println!("\n{line}"));
    }
    kernels::check(&chips)
}

/// Prints the model of the inputs at `path`. With `write`, counts and compiles them first.
///
/// # Errors
/// Fails without the file; with `write`, without RADV or an adapter.
pub fn print_model(path: &Path, write: bool, json: bool) -> Result<()> {
    if write {
        let text = serde_json::to_string(&inputs()?)?;
        // A line per command and kernel, for short differences.
        let text = text.replace("{\"stage\"", "\n{\"stage\"").replace("{\"name\"", "\n{\"name\"");
        std::fs::write(path, text + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let inputs: Inputs = serde_json::from_str(&text)?;
    let model = Model::new(&inputs)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&model.frames())?);
    } else {
        println!("{}", model.text().trim_end());
    }
    Ok(())
}

/// Counts frames on this machine and compiles their kernels for RDNA 3, or RDNA 2 where RADV does not know it.
fn inputs() -> Result<Inputs> {
    let compiled =
        compiler::compile("navi31")?.map_or_else(|| compiler::compile("navi21"), |it| Ok(Some(it)))?;
    let compiler::CompiledKernels { driver, mut kernels } = compiled.context("RADV knows no such chip")?;
    let frames = scenes().iter().map(counted).collect::<Result<Vec<_>>>()?;
    let used = |name: &str| {
        frames.iter().flat_map(|frame| &frame.commands).any(|command| command.kernel.as_deref() == Some(name))
    };
    kernels.retain(|kernel| used(&kernel.name));
    Ok(Inputs { driver, kernels, frames })
}

/// The scenes of the model: the default look, the two scenes of the 2008 talk, a groom with every strand simulated if
/// its file is there, and many strands.
fn scenes() -> Vec<Workload> {
    let mut many = workload::long();
    many.name = "100,000 strands of the style long".into();
    many.preset = workload::style(Some(100_000), workload::TILES);
    many.size = Size { width: 1920, height: 1080 };
    let mut scenes = vec![workload::long()];
    // The model has kernels only, no rasterizer.
    scenes.extend(workload::seed().into_iter().filter(|scene| scene.name.ends_with("tiles")));
    scenes.extend(workload::peer(&[], &[]).into_iter().flatten().skip(1));
    scenes.push(many);
    scenes
}

fn counted(workload: &Workload) -> Result<CountedFrame> {
    eprintln!("counting: {}", workload.name);
    let (commands, recorded) = roofline::commands(workload, BEFORE, wall)?;
    let by_stage = |value: &dyn Fn(&tresses::low_level::Counts) -> u64| {
        recorded.iter().map(|(stage, counts)| ((*stage).to_owned(), value(counts))).collect::<Vec<_>>()
    };
    let transfers = by_stage(&|counts| counts.transfers.into());
    Ok(CountedFrame {
        scene: format!("{}, {}×{}", workload.name, workload.size.width, workload.size.height),
        commands: commands.iter().map(CountedCommand::from).collect(),
        transfers: transfers.into_iter().map(|(stage, count)| (stage, count as u32)).collect(),
        traffic_bytes: by_stage(&|counts| counts.bytes).into_iter().collect(),
    })
}
