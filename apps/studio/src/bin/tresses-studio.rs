//! The studio as a standalone program. `tresses studio` opens the same window and has command-line options.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    match options().and_then(tresses_studio::run) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}", tresses_scene::words::sentence(&error));
            std::process::ExitCode::FAILURE
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
use tresses::groom::import::{self, FileKind};

/// Reads the command line: files of a groom and a head, and parameters such as `style.strands=5000`.
#[cfg(not(target_arch = "wasm32"))]
fn options() -> anyhow::Result<tresses_studio::Options> {
    let (mut grooms, mut heads, mut parameters) = (Vec::new(), Vec::new(), Vec::new());
    for word in std::env::args_os().skip(1) {
        let path = std::path::PathBuf::from(&word);
        let word = word.to_string_lossy().into_owned();
        match word.split_once('=').filter(|_| !path.exists()) {
            Some((name, value)) => parameters.push((name.to_owned(), value.to_owned())),
            None if word.starts_with('-') => anyhow::bail!(
                "{word}: give files and parameters such as style.strands=5000; `tresses studio` has more options"
            ),
            // The reader reports files that are missing.
            None => match std::fs::read(&path).ok().and_then(|bytes| import::kind(&path, &bytes)) {
                Some(FileKind::Mesh) => heads.push(path),
                _ => grooms.push(path),
            },
        }
    }
    let parameters = parameters.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    Ok(tresses_studio::Options { grooms, heads, ..tresses_studio::Options::of(parameters)? })
}

/// In a browser the page calls `start` instead.
#[cfg(target_arch = "wasm32")]
fn main() {}
