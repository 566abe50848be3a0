//! The `tresses` command.

fn main() -> std::process::ExitCode {
    tresses_cli::run()
}
