//! The `tresses` command.

mod convert;
mod info;
mod orient_args;

use clap::{Parser, Subcommand};

/// Grooms in, moving hair out.
#[derive(Parser)]
#[command(name = "tresses", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Info(info::Args),
    Convert(convert::Args),
}

fn main() -> std::process::ExitCode {
    let result = match Cli::parse().command {
        Command::Info(args) => info::run(args),
        Command::Convert(args) => convert::run(args),
    };
    match result {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tresses: {error}");
            std::process::ExitCode::FAILURE
        }
    }
}
