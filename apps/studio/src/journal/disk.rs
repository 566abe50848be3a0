//! The journal on disk.
//!
//! After each stroke a thread writes the version as a `.groom` file into the user's state folder. The file is written
//! under another name and renamed, so it is always whole. A lock beside it shows whether the studio that writes it still
//! runs. A studio that ends with everything saved removes both.

use super::age;
use std::{
    fs::{self, File, TryLockError},
    path::{Path, PathBuf},
    sync::mpsc::{self, Sender},
    thread::{self, JoinHandle},
    time::SystemTime,
};
use tresses::groom::edit::{GroomDocument, file::EXTENSION};

/// Extension of locks.
const LOCK: &str = "lock";

/// The journal of one studio.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// Locked while the studio runs.
    lock: Option<File>,
    writer: Option<(Sender<GroomDocument>, JoinHandle<()>)>,
    /// Hash of the last version that the user has saved.
    saved: Option<u64>,
    last: Option<u64>,
    /// Recovered hair, which the first version replaces.
    replaces: Option<LeftGroom>,
}

/// Groomed hair that an earlier studio has left.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftGroom {
    /// Its file.
    pub path: PathBuf,
    /// Name of the hair.
    pub name: String,
    /// Time of the last stroke.
    pub written: SystemTime,
}

/// Returns the folder of journals.
fn folder() -> PathBuf {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let state = set("XDG_STATE_HOME").or_else(|| set("LOCALAPPDATA"));
    let state = state.or_else(|| Some(set("HOME")?.join(".local/state")));
    state.unwrap_or_else(std::env::temp_dir).join("tresses/groom")
}

impl Journal {
    /// Creates the journal of hair named `name`, which replaces recovered hair. Nothing is written before the first
    /// version.
    pub fn new(name: &str, replaces: Option<LeftGroom>) -> Self {
        let stem: String =
            name.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).take(40).collect();
        let number = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_millis();
        let path = folder().join(format!("{stem}.{number:x}-{:x}.{EXTENSION}", std::process::id()));
        Self { path, lock: None, writer: None, saved: None, last: None, replaces }
    }

    /// Writes `document`, whose hash is `hash`, in the background.
    ///
    /// # Errors
    /// Fails if the folder cannot be written to.
    pub fn keep(&mut self, document: &GroomDocument, hash: u64) -> std::io::Result<()> {
        if self.lock.is_none() {
            fs::create_dir_all(folder())?;
            let lock = File::create(self.path.with_extension(LOCK))?;
            lock.try_lock().map_err(|error| match error {
                TryLockError::Error(error) => error,
                TryLockError::WouldBlock => std::io::ErrorKind::ResourceBusy.into(),
            })?;
            self.lock = Some(lock);
        }
        let (sender, _) = self.writer.get_or_insert_with(|| {
            let (sender, receiver) = mpsc::channel::<GroomDocument>();
            let (path, mut replaces) = (self.path.clone(), self.replaces.take());
            let work = move || {
                while let Ok(mut document) = receiver.recv() {
                    // Only the newest version counts.
                    while let Ok(newer) = receiver.try_recv() {
                        document = newer;
                    }
                    match write(&path, &document.write()) {
                        Ok(()) => replaces.take().iter().for_each(LeftGroom::remove),
                        Err(error) => eprintln!("{}: {error}", path.display()),
                    }
                }
            };
            (sender, thread::spawn(work))
        });
        self.last = Some(hash);
        sender.send(document.clone()).map_err(|_| std::io::ErrorKind::BrokenPipe.into())
    }

    /// Notes that the user has saved the version with this hash.
    pub fn saved(&mut self, hash: u64) {
        self.saved = Some(hash);
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        if let Some((sender, thread)) = self.writer.take() {
            drop(sender);
            let _ = thread.join();
        }
        if self.lock.take().is_some() {
            let _ = fs::remove_file(self.path.with_extension(LOCK));
            if self.saved == self.last {
                let _ = fs::remove_file(&self.path);
            }
        }
    }
}

/// Writes a file so that it is whole or not there.
fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let part = path.with_extension("part");
    fs::write(&part, bytes)?;
    fs::rename(part, path)
}

/// Calls `tell` with the newest groomed hair that a studio has left which no longer runs, if there is any.
pub fn find(tell: impl FnOnce(LeftGroom) + 'static) {
    if let Some(left) = left() {
        tell(left);
    }
}

fn left() -> Option<LeftGroom> {
    let files = fs::read_dir(folder()).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let orphan = |path: PathBuf| {
        let is_groom = path.extension().is_some_and(|extension| extension == EXTENSION);
        let lock = File::open(path.with_extension(LOCK));
        let runs = lock.is_ok_and(|lock| matches!(lock.try_lock(), Err(TryLockError::WouldBlock)));
        if !is_groom || runs {
            return None;
        }
        let name = path.file_name()?.to_string_lossy().split('.').next()?.to_owned();
        let written = fs::metadata(&path).ok()?.modified().ok()?;
        Some(LeftGroom { path, name, written })
    };
    files.filter_map(orphan).max_by_key(|left| left.written)
}

impl LeftGroom {
    /// Returns how long ago the last stroke was, in words.
    pub fn age(&self) -> String {
        age(self.written.elapsed().unwrap_or_default())
    }

    /// Reads the hair.
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    pub fn read(&self) -> anyhow::Result<GroomDocument> {
        Ok(GroomDocument::read(&self.path, &fs::read(&self.path)?)?)
    }

    /// Removes the files.
    pub fn remove(&self) {
        for path in [self.path.clone(), self.path.with_extension(LOCK)] {
            let _ = fs::remove_file(path);
        }
    }
}
