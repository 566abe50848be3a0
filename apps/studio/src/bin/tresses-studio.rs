//! The studio as a program of its own; `tresses studio` is the same with a command line that explains itself.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    let grooms: Vec<std::path::PathBuf> = std::env::args_os().skip(1).map(Into::into).collect();
    if let Some(option) = grooms.iter().find(|groom| groom.to_string_lossy().starts_with('-')) {
        eprintln!("{}: only the files of one groom; `tresses studio` takes options", option.display());
        return std::process::ExitCode::FAILURE;
    }
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
