//! `tresses completions` and `tresses man`: what shells and manuals know of the command, made of its own options.

use crate::Cli;
use anyhow::{Context, Result};
use clap::CommandFactory;
use clap_complete::Shell;
use std::{io::Write, path::PathBuf};

/// The options of `tresses completions`.
#[derive(clap::Args, Debug)]
pub struct CompletionArgs {
    /// The shell that is to complete
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// The options of `tresses man`.
#[derive(clap::Args, Debug)]
pub struct ManArgs {
    /// The folder that the pages are written into, such as ~/.local/share/man/man1
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

/// Runs `tresses completions`.
pub fn completions(args: &CompletionArgs) -> Result<()> {
    // A closed pipe is the reader's choice.
    let _ = std::io::stdout().write_all(&script(args.shell));
    Ok(())
}

/// What `shell` has to run to complete the command.
fn script(shell: Shell) -> Vec<u8> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "tresses", &mut script);
    script
}

/// Runs `tresses man`.
pub fn man(args: &ManArgs) -> Result<()> {
    let folder = args.folder.display();
    std::fs::create_dir_all(&args.folder).with_context(|| format!("cannot make the folder {folder}"))?;
    clap_mangen::generate_to(Cli::command().disable_help_subcommand(true), &args.folder)
        .with_context(|| format!("cannot write pages into {folder}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_shell_knows_every_command_and_flags_of_the_table() {
        for shell in Shell::value_variants() {
            let text = String::from_utf8(script(*shell)).unwrap();
            for word in ["render", "bake", "curl", "melanin", "wind"] {
                assert!(text.contains(word), "{shell} does not know {word}");
            }
            assert!(!text.contains("no-such-flag"));
        }
    }

    #[test]
    fn every_command_has_a_page_with_its_options() {
        let folder = tempfile::tempdir().unwrap();
        man(&ManArgs { folder: folder.path().join("man1") }).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join("man1").join(name)).unwrap();
        for subcommand in Cli::command().get_subcommands() {
            let name = subcommand.get_name();
            let text = read(&format!("tresses-{name}.1"));
            assert!(text.contains(".TH") && text.contains(&format!("tresses\\-{name}")), "{name}: {text}");
        }
        assert!(read("tresses-render.1").contains("\\-\\-melanin"));
        assert!(read("tresses.1").contains("bake"));
        // A file where the folder should be.
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let error = man(&ManArgs { folder: file.join("man1") }).unwrap_err();
        assert!(error.to_string().contains("cannot make the folder"), "{error}");
    }
}
