//! GPUs that this machine does not have: their compiler's statistics for each kernel, and a model of the frame time.

pub mod compiler;
mod constants;
mod kernels;
mod model;

pub use constants::Constants;
pub use model::{Inputs, Model};

use crate::roofline::{self, FrameWork};
use anyhow::{Context, Result, ensure};
use model::{CountedCommand, CountedFrame};
use std::path::Path;
use tresses::low_level::wall;
use tresses_cli::{
    args::Size,
    bench::workload::{self, Workload},
};

/// Path of the model's inputs, relative to the root of the repository.
pub const INPUTS: &str = "tools/evidence/gpu-model.json";
/// The committed inputs of the model, JSON.
pub const STORED: &str = include_str!("../../gpu-model.json");

/// Frames rendered before the counted one, so that the tile lists of a view have reached their size.
const UNCOUNTED_FRAMES: u32 = 5;

/// Compiles the kernels for the chips `names` (empty for the default ones) and prints their statistics. Each table has
/// the kernels with the most registers, or every kernel with `all`. Names the chips whose driver is missing.
///
/// # Errors
/// Fails if a kernel does not compile, or spills more registers than is known.
pub fn print_kernels(mut names: Vec<String>, all: bool, json: bool) -> Result<()> {
    if names.is_empty() {
        names = kernels::CHIPS.map(String::from).to_vec();
    }
    let (chips, missing) = kernels::compile(&names)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&chips)?);
    } else {
        chips.iter().for_each(|chip| println!("{}", kernels::text(chip, all).trim_end()));
        missing.iter().for_each(|line| println!("\n{line}"));
    }
    kernels::check(&chips)
}

/// Prints the model of the inputs at `path`. With `write`, first counts frames, compiles kernels and writes the inputs.
///
/// # Errors
/// Fails without the file; with `write`, without a driver of AMD or an adapter.
pub fn print_model(path: &Path, write: bool, json: bool) -> Result<()> {
    if write {
        let text = serde_json::to_string(&inputs()?)?;
        // One line per command and kernel keeps diffs short.
        let text = text.replace("{\"stage\"", "\n{\"stage\"").replace("{\"name\"", "\n{\"name\"");
        std::fs::write(path, text + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let inputs: Inputs = serde_json::from_str(&text)?;
    let constants = Constants::read()?;
    let model = Model::new(&inputs, &constants)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&model.frames())?);
    } else {
        println!("{}", model.text().trim_end());
    }
    Ok(())
}

/// Counts frames on this machine and compiles their kernels for RDNA 3, or for RDNA 2 if RADV does not support RDNA 3.
fn inputs() -> Result<Inputs> {
    let (compiled, missing) = kernels::compile(&["amd:navi31", "amd:navi21"].map(String::from))?;
    let compiled = compiled.into_iter().next().with_context(|| missing.join(", "))?;
    let compiler::CompiledKernels { driver, mut kernels, .. } = compiled;
    let frames = scenes().iter().map(count_frame).collect::<Result<Vec<_>>>()?;
    let is_used = |name: &str| {
        frames.iter().flat_map(|frame| &frame.commands).any(|command| command.kernel.as_deref() == Some(name))
    };
    kernels.retain(|kernel| is_used(&kernel.name));
    Ok(Inputs { driver, kernels, frames })
}

/// Returns the scenes of the model: the default look, the two scenes of the 2008 talk, a groom with every strand
/// simulated if its file exists, a style with 100,000 strands, and the default look in wind and at 4K.
fn scenes() -> Vec<Workload> {
    let mut wind = workload::long();
    wind.name = "The style long in wind of 8 m/s".into();
    wind.preset.settings.set_wind_speed(8.0);
    let mut large = workload::long();
    large.size = Size { width: 3840, height: 2160 };
    let mut many_strands = workload::long();
    many_strands.name = "100,000 strands of the style long".into();
    many_strands.preset = workload::style(Some(100_000), workload::TILES);
    many_strands.size = Size { width: 1920, height: 1080 };
    let mut scenes = vec![workload::long()];
    // The model has kernels only, no rasterizer.
    scenes.extend(workload::seed().into_iter().filter(|scene| scene.name.ends_with("tiles")));
    scenes.extend(workload::peer(&[], &[]).into_iter().flatten().skip(1));
    scenes.extend([many_strands, wind, large]);
    scenes
}

/// Renders frames of `workload` and counts the commands and transfers of the last.
fn count_frame(workload: &Workload) -> Result<CountedFrame> {
    eprintln!("counting: {}", workload.name);
    let FrameWork { commands, recorded, host } = roofline::frame(workload, UNCOUNTED_FRAMES, wall)?;
    let counted: u32 = recorded.iter().map(|(_, counts)| counts.dispatches + counts.draws).sum();
    ensure!(
        counted as usize == commands.len(),
        "{counted} commands were recorded, {} counted",
        commands.len()
    );
    Ok(CountedFrame {
        scene: format!("{}, {}×{}", workload.name, workload.size.width, workload.size.height),
        commands: commands.iter().map(CountedCommand::from).collect(),
        recorded: recorded.iter().map(|(stage, counts)| ((*stage).to_owned(), counts.into())).collect(),
        uploads: host.uploads,
        read_backs: host.read_backs,
    })
}
