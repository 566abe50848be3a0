//! Atomic file output: files are written under a temporary name in the same folder, then renamed.

use anyhow::{Context, Result};
use std::{
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

/// Paths of the existing temporary files.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // The list stays valid if another thread panics.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file, deleted on drop.
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
            // By default temporary files are private. Apply the umask instead.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        // Create and list the file under one lock, so that `leave` deletes every file.
        let mut list = unfinished();
        let file = builder.tempfile_in(folder)?;
        let path = file.path().to_owned();
        list.push(path.clone());
        Ok(Self { file: Some(file), path })
    }

    /// Creates a temporary file in the folder of `path`.
    pub fn in_folder_of(path: &Path) -> Result<Self> {
        Self::new(path.parent().unwrap_or(Path::new(""))).with_context(|| path.display().to_string())
    }

    /// Returns the path of the temporary file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends `bytes` and moves the file to `path`, replacing an existing file.
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

/// Fails if no file can be created in `folder`.
pub fn probe(folder: &Path) -> Result<()> {
    Temporary::new(folder)
        .map(drop)
        .with_context(|| format!("{}: cannot create files in this folder", folder.display()))
}

/// Creates the folder of the output `path`, and checks that files can be written there.
pub fn prepare(path: &Path) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot create the folder", folder.display()))?;
    probe(folder)
}

/// Writes `bytes` to `path`, replacing an existing file.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let temporary = Temporary::new(path.parent().unwrap_or(Path::new("")));
    temporary.and_then(|file| file.complete(bytes, path)).with_context(|| path.display().to_string())
}

/// Writer of a temporary file.
pub type Pieces<'a> = BufWriter<&'a mut tempfile::NamedTempFile>;

/// Writes a file through `write`, then moves it to `path`, replacing an existing file.
pub fn stream(path: &Path, write: impl FnOnce(Pieces<'_>) -> Result<()>) -> Result<()> {
    let name = || path.display().to_string();
    let mut temporary = Temporary::in_folder_of(path)?;
    if let Some(file) = &mut temporary.file {
        write(BufWriter::new(file))?;
    }
    temporary.complete(&[], path).with_context(name)
}

/// Deletes temporary files and exits with `code`. The lock keeps other threads from creating or completing files until
/// the exit.
pub fn leave(code: i32) -> ! {
    let list = unfinished();
    for path in list.iter() {
        // Ignore errors: the file may be gone already, and the program is about to end.
        let _ = std::fs::remove_file(path);
    }
    // Skip exit handlers: those of a software driver crash while its threads are running.
    signal_hook::low_level::exit(code)
}
