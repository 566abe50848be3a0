//! The studio as a standalone program. `tresses studio` opens the same window and has command-line options.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    let grooms: Vec<std::path::PathBuf> = std::env::args_os().skip(1).map(Into::into).collect();
    if let Some(option) = grooms.iter().find(|groom| groom.to_string_lossy().starts_with('-')) {
        eprintln!(
            "{}: options are not supported, only groom files; use `tresses studio` for options",
            option.display()
        );
        return std::process::ExitCode::FAILURE;
    }
    match tresses_studio::run(tresses_studio::Options { grooms, ..Default::default() }) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}", tresses_scene::words::sentence(&error));
            std::process::ExitCode::FAILURE
        }
    }
}

/// In a browser the page calls `start` instead.
#[cfg(target_arch = "wasm32")]
fn main() {}
