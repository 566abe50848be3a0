//! The studio as a program of its own; `tresses studio` is the same with a command line that explains itself.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    let grooms = std::env::args_os().skip(1).map(Into::into).collect();
    match tresses_studio::run(tresses_studio::Options { grooms, ..Default::default() }) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            std::process::ExitCode::FAILURE
        }
    }
}

/// A page starts itself.
#[cfg(target_arch = "wasm32")]
fn main() {}
