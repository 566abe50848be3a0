//! The `tresses` command: grooms in, pictures of moving hair out.

mod args;
mod bake;
mod bench;
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
mod info;
mod interrupt;
mod knobs;
mod manuals;
mod orient_args;
mod photographer;
mod picture;
mod preset;
mod preset_args;
mod progress;
mod render;
mod settings_args;
mod studio;

use clap::{
    Parser,
    error::{ContextKind, ContextValue},
};
use std::process::ExitCode;

/// Real-time hair: grooms in, moving shaded hair out.
#[derive(Parser)]
#[command(name = "tresses", version, arg_required_else_help = true, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Draw a groom or a built-in style: a picture, numbered frames, an animation or a film
    Render(Box<render::Args>),
    /// Show the built-in character with moving hair: out/demo.png and out/demo.webp
    Demo(Box<demo::Args>),
    /// Open the studio: a window to move hair in with the mouse, to inspect it and to change every parameter
    Studio(Box<studio::Args>),
    /// Report what is in a groom and what is wrong with it
    Info(info::Args),
    /// Write a groom in another format
    Convert(convert::Args),
    /// Write the strands of a groom or a built-in style as they are drawn at rest
    Export(Box<export::Args>),
    /// Simulate hair and write it as an Alembic cache, frame by frame
    Bake(Box<bake::Args>),
    /// Print the result of all options as a preset
    Preset(Box<preset::Args>),
    /// List every parameter with its range and what it does
    Knobs(knobs::Args),
    /// Measure the time of each stage on the GPU of this machine
    Bench(bench::Args),
    /// Compare pictures with path-traced ones of the same hair, camera and lights
    Compare(compare::Args),
    /// Print what a shell runs to complete this command's words: bash, elvish, fish, powershell, zsh
    Completions(manuals::CompletionArgs),
    /// Write manual pages into a folder
    Man(manuals::ManArgs),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return refuse(&error),
    };
    if !matches!(cli.command, Command::Studio(_)) {
        // A window simply ends.
        interrupt::listen();
    }
    let result = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Demo(args) => demo::run(&args),
        Command::Studio(args) => studio::run(&args),
        Command::Info(args) => info::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Export(args) => export::run(&args),
        Command::Bake(args) => bake::run(&args),
        Command::Preset(args) => preset::run(&args),
        Command::Knobs(args) => knobs::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Completions(args) => manuals::completions(&args),
        Command::Man(args) => manuals::man(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tresses: {}", one_line(&sentence(&error)));
            ExitCode::FAILURE
        }
    }
}

/// The causes in one sentence; one whose text the sentence already has adds nothing.
fn sentence(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |sentence, cause| {
        let cause = cause.to_string();
        match sentence.as_str() {
            "" => cause,
            known if known.contains(&cause) => sentence,
            known => format!("{known}: {cause}"),
        }
    })
}

/// Help and version are no mistakes; all else is one sentence.
fn refuse(error: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind;
    match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // A closed pipe is the reader's choice.
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

/// The name that was probably meant, as the end of a sentence.
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

/// Prints a line; a closed pipe is the reader's choice.
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
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/main.rs");
        let report = tresses_modules::Modules::read(&root).report();
        assert!(report.is_empty(), "{report}");
    }
}
