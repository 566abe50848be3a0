//! `tresses completions` and `tresses man`: shell completions and manual pages, generated from the command's options.

use crate::Cli;
use anyhow::{Context, Result};
use clap::CommandFactory;
use clap_complete::Shell;
use std::{io::Write, path::PathBuf};

/// Options of `tresses completions`.
#[derive(clap::Args, Debug)]
pub struct CompletionArgs {
    /// Shell to generate the script for
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Options of `tresses man`.
#[derive(clap::Args, Debug)]
pub struct ManArgs {
    /// Folder for the pages, such as ~/.local/share/man/man1
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

/// Runs `tresses completions`.
pub fn completions(args: &CompletionArgs) -> Result<()> {
    // Ignore a closed pipe.
    let _ = std::io::stdout().write_all(&script(args.shell));
    Ok(())
}

/// Returns the completion script of `shell`.
fn script(shell: Shell) -> Vec<u8> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "tresses", &mut script);
    script
}

/// Runs `tresses man`.
pub fn man(args: &ManArgs) -> Result<()> {
    let folder = args.folder.display();
    std::fs::create_dir_all(&args.folder).with_context(|| format!("cannot create the folder {folder}"))?;
    clap_mangen::generate_to(Cli::command().disable_help_subcommand(true), &args.folder)
        .with_context(|| format!("cannot write pages into {folder}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn completions_contain_commands_and_flags() {
        for shell in Shell::value_variants() {
            let text = String::from_utf8(script(*shell)).unwrap();
            for word in ["render", "bake", "curl", "melanin", "wind"] {
                assert!(text.contains(word), "{shell} does not know {word}");
            }
            assert!(!text.contains("no-such-flag"));
        }
    }

    #[test]
    fn every_command_has_a_manual_page() {
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
        // A file in place of the folder.
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let error = man(&ManArgs { folder: file.join("man1") }).unwrap_err();
        assert!(error.to_string().contains("cannot create the folder"), "{error}");
    }
}
