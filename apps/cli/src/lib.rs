//! The `tresses` command: renders, converts and inspects hair. Public are [`run`], and the pieces of `tresses bench`
//! for programs that measure more.

pub mod args;
mod bake;
pub mod bench;
mod cards;
mod compare;
mod convert;
mod crowd;
mod debug;
mod demo;
mod export;
mod files;
#[cfg(test)]
mod flag_tests;
mod flags;
mod gpu_report;
mod groom;
mod info;
mod interrupt;
mod knobs;
mod manuals;
mod mesa;
mod orient_args;
pub mod photographer;
mod picture;
mod preset;
mod preset_args;
pub mod progress;
mod render;
mod retarget;
mod sample;
mod settings_args;
mod studio;
mod timelapse;

use clap::{
    Parser,
    error::{ContextKind, ContextValue},
};
use std::process::ExitCode;

/// Simulates and renders hair in real time.
#[derive(Parser)]
#[command(name = "tresses", version, arg_required_else_help = true, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Draw a groom or a built-in style: an image, numbered frames, an animation or a video
    Render(Box<render::RenderArgs>),
    /// Draw the built-in character with moving hair: out/demo.png and out/demo.webp
    Demo(Box<demo::DemoArgs>),
    /// Open the studio: a window to move hair with the mouse, inspect it and change every parameter
    Studio(Box<studio::StudioArgs>),
    /// Report the contents of a groom and its problems
    Info(info::InfoArgs),
    /// Convert a groom to another format
    Convert(convert::ConvertArgs),
    /// Fit a groom that was made on one head to another
    Retarget(Box<retarget::RetargetArgs>),
    /// Write the strands of a groom or a built-in style as drawn at rest
    Export(Box<export::ExportArgs>),
    /// Apply recorded strokes of a brush to a groom or a built-in style, and write it as .groom
    Groom(Box<groom::GroomArgs>),
    /// Write sample grooms, a head and a character, to try the other commands on
    Sample(sample::SampleArgs),
    /// Bake a groom or a built-in style to textured cards, for engines and devices that do not draw strands
    Cards(Box<cards::CardsArgs>),
    /// Simulate hair and write it as an Alembic or USD cache
    Bake(Box<bake::BakeArgs>),
    /// Print the result of all options as a preset
    Preset(Box<preset::PresetCommandArgs>),
    /// List all parameters with their ranges and hints
    Knobs(knobs::KnobsArgs),
    /// Measure the GPU time of each stage on this machine
    Bench(bench::BenchArgs),
    /// Test and measure this machine's GPU, and write a report to send: out/gpu-report.html and its JSON
    Gpu(gpu_report::GpuArgs),
    /// Compare renders with path-traced ones of the same hair, camera and lights
    Compare(compare::CompareArgs),
    /// Print a completion script for a shell: bash, elvish, fish, powershell, zsh
    Completions(manuals::CompletionArgs),
    /// Write manual pages into a folder
    Man(manuals::ManArgs),
}

/// Checks the arguments of a command line, of which the first is the program's name, without running it.
///
/// # Errors
/// The first problem, as clap words it.
pub fn check(words: &[String]) -> Result<(), String> {
    use clap::error::ErrorKind::{DisplayHelp, DisplayVersion};
    match Cli::try_parse_from(words) {
        Err(error) if ![DisplayHelp, DisplayVersion].contains(&error.kind()) => Err(error.to_string()),
        _ => Ok(()),
    }
}

/// Runs the command with the arguments of this process.
pub fn run() -> ExitCode {
    mesa::silence();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return refuse(&error),
    };
    if !matches!(cli.command, Command::Studio(_)) {
        // The studio keeps the default action of Ctrl-C.
        interrupt::listen();
    }
    let result = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Demo(args) => demo::run(&args),
        Command::Studio(args) => studio::run(&args),
        Command::Info(args) => info::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Retarget(args) => retarget::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Groom(args) => groom::run(&args),
        Command::Sample(args) => sample::run(&args),
        Command::Cards(args) => cards::run(&args),
        Command::Bake(args) => bake::run(&args),
        Command::Preset(args) => preset::run(&args),
        Command::Knobs(args) => knobs::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Gpu(args) => gpu_report::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Completions(args) => manuals::completions(&args),
        Command::Man(args) => manuals::man(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tresses: {}", one_line(&tresses_scene::words::sentence(&error)));
            ExitCode::FAILURE
        }
    }
}

/// Prints help and version, and any other error as one sentence.
fn refuse(error: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind;
    match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // Ignore a closed pipe.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        _ => {
            let text = error.render().to_string();
            let sentence = text.split("\n\n").next().unwrap_or_default();
            let sentence = one_line(sentence.trim_start_matches("error: "));
            eprintln!("tresses: {sentence}{}", meant(error).unwrap_or_default());
            ExitCode::FAILURE
        }
    }
}

/// Returns the name that was probably meant, as the end of a sentence.
fn meant(error: &clap::Error) -> Option<String> {
    let kinds = [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand, ContextKind::SuggestedValue];
    let names = kinds.into_iter().find_map(|kind| error.get(kind))?;
    let names = match names {
        ContextValue::String(name) => name.clone(),
        ContextValue::Strings(names) => names.join(" or "),
        _ => return None,
    };
    Some(format!("; did you mean {names}?"))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Prints a line, and ignores a closed pipe.
macro_rules! say {
    ($($part:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stdout(), $($part)*);
    }};
}
use say;

#[cfg(test)]
mod tests {
    #[test]
    fn modules_have_no_circles() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs");
        let report = tresses_testing::Modules::read(&root).report();
        assert!(report.is_empty(), "{report}");
    }
}
