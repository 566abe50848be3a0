//! Files that appear complete or not at all: written beside their place under a temporary name, and moved there.

use anyhow::{Context, Result};
use std::{
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

/// The temporary files that there are.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // A panic elsewhere leaves a list that is still true.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file that is gone once this is dropped.
pub struct Temporary {
    file: Option<tempfile::NamedTempFile>,
    path: PathBuf,
}

impl Temporary {
    fn new(folder: &Path) -> std::io::Result<Self> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".tresses-").suffix(".part");
        #[cfg(unix)]
        {
            // Temporary files are private by default; these become the user's, under the umask.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        // Made and listed in one go, as far as whoever ends the program can see.
        let mut list = unfinished();
        let file = builder.tempfile_in(folder)?;
        let path = file.path().to_owned();
        list.push(path.clone());
        Ok(Self { file: Some(file), path })
    }

    /// For what becomes `path`.
    pub fn beside(path: &Path) -> Result<Self> {
        Self::new(path.parent().unwrap_or(Path::new(""))).with_context(|| path.display().to_string())
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds `bytes` and moves it to `path`, replacing what is there.
    pub fn complete(mut self, bytes: &[u8], path: &Path) -> std::io::Result<()> {
        let Some(mut file) = self.file.take() else { return Ok(()) };
        file.write_all(bytes)?;
        file.flush()?;
        let _list = unfinished();
        file.persist(path).map(drop).map_err(|error| error.error)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        drop(self.file.take());
        unfinished().retain(|path| *path != self.path);
    }
}

/// Fails when no file can be made in `folder`.
pub fn probe(folder: &Path) -> Result<()> {
    Temporary::new(folder)
        .map(drop)
        .with_context(|| format!("{}: no file can be created there", folder.display()))
}

/// Writes `bytes` to `path`, replacing what is there.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let temporary = Temporary::new(path.parent().unwrap_or(Path::new("")));
    temporary.and_then(|file| file.complete(bytes, path)).with_context(|| path.display().to_string())
}

/// What a file is written through, piece by piece.
pub type Pieces<'a> = BufWriter<&'a mut tempfile::NamedTempFile>;

/// Writes to `path` what `write` makes piece by piece, replacing what is there once it is done.
pub fn stream(path: &Path, write: impl FnOnce(Pieces<'_>) -> Result<()>) -> Result<()> {
    let name = || path.display().to_string();
    let mut temporary = Temporary::beside(path)?;
    if let Some(file) = &mut temporary.file {
        write(BufWriter::new(file))?;
    }
    temporary.complete(&[], path).with_context(name)
}

/// Removes what is not complete, and ends the program with `code`. Until it has ended no file is begun or completed.
pub fn leave(code: i32) -> ! {
    let list = unfinished();
    for path in list.iter() {
        // One that is gone already is no harm, and nobody is left to hear of another.
        let _ = std::fs::remove_file(path);
    }
    // Not through the handlers of a driver, whose threads are still at work: a software driver crashes in them.
    signal_hook::low_level::exit(code)
}
