//! File dialogs. They do not block the window.

use crate::{
    answer::{Answer, Read},
    sort, task,
};
use eframe::egui::{self, DroppedFileHandle};
use rfd::AsyncFileDialog;
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};
use tresses::groom::formats;
use tresses_scene::{Companion, Preset, preset::Extent};
use web_time::Instant;

/// Data to save.
#[derive(Clone, Debug)]
pub enum SaveData {
    /// Bytes that do not depend on the file's location.
    Bytes(Vec<u8>),
    /// A preset. It stores file names relative to its own location.
    Preset(Box<Preset>),
}

impl From<Vec<u8>> for SaveData {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Bytes(bytes)
    }
}

impl From<Preset> for SaveData {
    fn from(preset: Preset) -> Self {
        Self::Preset(Box::new(preset))
    }
}

impl SaveData {
    /// Returns the bytes to write to `path`.
    fn bytes(&self, path: &Path) -> std::io::Result<Cow<'_, [u8]>> {
        match self {
            Self::Bytes(bytes) => Ok(Cow::Borrowed(bytes)),
            // A browser has file names but no folders that they could be relative to.
            Self::Preset(preset) if cfg!(target_arch = "wasm32") => {
                Ok(Cow::Owned(preset.write(Extent::Changed).into_bytes()))
            }
            Self::Preset(preset) => {
                preset.text_at(path, Extent::Changed).map(|text| text.into_bytes().into())
            }
        }
    }

    #[cfg_attr(target_arch = "wasm32", allow(dead_code))] // Unit tests do not run in a browser.
    fn write(&self, path: &Path) -> std::io::Result<()> {
        std::fs::write(path, self.bytes(path)?)
    }
}

/// Opens dialogs and queues their answers for a window.
#[derive(Clone)]
pub struct Dialogs {
    queue: Arc<Mutex<Vec<Answer>>>,
    context: egui::Context,
}

impl Dialogs {
    /// Creates the queue for the window of `context`.
    pub fn new(context: &egui::Context) -> Self {
        Self { queue: Arc::default(), context: context.clone() }
    }

    /// Takes all answers queued since the last call.
    pub fn take(&self) -> Vec<Answer> {
        std::mem::take(&mut *self.queue.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Queues an answer and wakes the window.
    pub fn tell(&self, answer: Answer) {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner).push(answer);
        self.context.request_repaint();
    }

    /// Reports an error if the dialog requested at `request_time` did not open.
    fn nothing(&self, request_time: Instant) {
        if no_dialog(request_time) {
            let help = "drop files on the window or name them on the command line";
            self.tell(Answer::Failed(format!("{MISSING}: {help}")));
        }
    }

    /// Opens the file dialog that `build` returns, reads the selected files, and queues the actions of `sort`.
    fn open_dialog(
        &self,
        build: impl FnOnce() -> AsyncFileDialog + Send + 'static,
        sort: impl FnOnce(Vec<Read>) -> Vec<Answer> + Send + 'static,
    ) {
        let dialogs = self.clone();
        task::spawn(move || async move {
            let request_time = Instant::now();
            let Some(files) = build().pick_files().await else {
                dialogs.nothing(request_time);
                return;
            };
            let mut read = Vec::new();
            for file in &files {
                read.push((path_of(file), file.read().await));
            }
            for answer in sort(read) {
                dialogs.tell(answer);
            }
        });
    }

    /// Opens a dialog for a groom, a head, or both.
    pub fn open(&self) {
        let build = || {
            let dialog = AsyncFileDialog::new().set_title("Open a groom, a head, or both");
            dialog.add_filter("Grooms and heads", &[formats::GROOMS, formats::MESHES].concat())
        };
        self.open_dialog(build, |files| sort::files(files, sort::IN_MEMORY));
    }

    /// Opens a dialog for a preset.
    pub fn preset(&self) {
        let build = || AsyncFileDialog::new().set_title("Open a preset").add_filter("Presets", &["toml"]);
        self.open_dialog(build, |files| sort::files(files, sort::IN_MEMORY));
    }

    /// Opens a dialog for a companion file of the hair.
    pub fn companion(&self, companion: &'static Companion) {
        let build = move || {
            let mut endings = companion.kind.extensions().to_vec();
            if sort::IN_MEMORY {
                // The studio cannot open files that this file names, so the user must choose them too.
                endings.extend(companion.kind.needs());
            }
            AsyncFileDialog::new().set_title(companion.title).add_filter(companion.title, &endings)
        };
        self.open_dialog(build, move |files| vec![sort::for_companion(companion, files, sort::IN_MEMORY)]);
    }

    /// Reads and sorts files dropped on the window: grooms, heads, presets, maps, obstacles, environments.
    pub fn dropped(&self, files: Vec<DroppedFileHandle>) {
        let dialogs = self.clone();
        task::spawn(move || async move {
            let mut read = Vec::new();
            for file in files {
                #[cfg(target_arch = "wasm32")]
                let bytes = file.bytes_async().await;
                #[cfg(not(target_arch = "wasm32"))]
                let bytes = file.bytes();
                match bytes {
                    Ok(bytes) => read.push((file.path().to_path_buf(), bytes)),
                    Err(error) => {
                        let name = file.path().display();
                        dialogs.tell(Answer::Failed(format!("{name} cannot be read: {error}")));
                        return;
                    }
                }
            }
            for answer in sort::files(read, sort::IN_MEMORY) {
                dialogs.tell(answer);
            }
        });
    }

    /// Opens a save dialog for `content` with `name` as the suggested name.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn save(&self, title: &str, name: &str, content: impl Into<SaveData>) {
        let content = content.into();
        let dialogs = self.clone();
        let (title, name) = (title.to_owned(), name.to_owned());
        task::spawn(move || async move {
            let request_time = Instant::now();
            let dialog = AsyncFileDialog::new().set_title(title).set_file_name(&name);
            let answer = match dialog.save_file().await {
                Some(file) => write(&file, &name, &content),
                None if no_dialog(request_time) => write_to_current_folder(&name, &content),
                None => return,
            };
            dialogs.tell(answer);
        });
    }

    /// Downloads `content` as `name` through the browser.
    #[cfg(target_arch = "wasm32")]
    pub fn save(&self, _: &str, name: &str, content: impl Into<SaveData>) {
        let done = content.into().bytes(Path::new(name)).map(|bytes| crate::page::download(name, &bytes));
        self.tell(match done {
            Ok(Ok(())) => Answer::Wrote(format!("{name} is downloaded by the browser")),
            Ok(Err(error)) => Answer::Failed(format!("{name} cannot be downloaded: {error:?}")),
            Err(error) => Answer::Failed(format!("{name} cannot be saved: {error}")),
        });
    }
}

/// Whether the dialog requested at `request_time` did not open: the system has none, or the request ended faster than a
/// user could close a dialog. (The toolkit does not distinguish the two.)
fn no_dialog(request_time: Instant) -> bool {
    cfg!(not(target_arch = "wasm32"))
        && (request_time.elapsed() < Duration::from_millis(500) || !has_dialogs())
}

/// Whether the system can open file dialogs. On Linux that takes zenity or a desktop portal, which needs a session bus.
fn has_dialogs() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let set = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let bus = set("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
    let zenity = set("PATH")
        .is_some_and(|paths| std::env::split_paths(&paths).any(|folder| folder.join("zenity").is_file()));
    bus || zenity || set("DBUS_SESSION_BUS_ADDRESS").is_some()
}

/// Error text for a system without file dialogs.
const MISSING: &str = "no file dialogs are available (on Linux install a desktop portal or zenity)";

/// Writes `content` to the chosen file. A name without an extension gets the extension of `name`.
#[cfg(not(target_arch = "wasm32"))]
fn write(file: &rfd::FileHandle, name: &str, content: &SaveData) -> Answer {
    let mut path = file.path().to_path_buf();
    if path.extension().is_none()
        && let Some(ending) = Path::new(name).extension()
    {
        path.set_extension(ending);
    }
    wrote(&path, content.write(&path))
}

#[cfg(not(target_arch = "wasm32"))]
fn wrote(path: &Path, result: std::io::Result<()>) -> Answer {
    match result {
        Ok(()) => Answer::Wrote(format!("{} is saved", path.display())),
        Err(error) => Answer::Failed(format!("{} cannot be saved: {error}", path.display())),
    }
}

/// Writes `content` to the current folder, for systems without dialogs. Never overwrites a file.
#[cfg(not(target_arch = "wasm32"))]
fn write_to_current_folder(name: &str, content: &SaveData) -> Answer {
    let name = Path::new(name);
    let (stem, ending) = (name.with_extension(""), name.extension().unwrap_or_default());
    let numbered = |i: u32| match i {
        0 => name.to_path_buf(),
        i => PathBuf::from(format!("{}-{i}", stem.display())).with_extension(ending),
    };
    let folder = std::env::current_dir().unwrap_or_default();
    let path = (0..).map(|i| folder.join(numbered(i))).find(|path| !path.exists());
    let path = path.unwrap_or_else(|| folder.join(name));
    match wrote(&path, content.write(&path)) {
        Answer::Wrote(sentence) => Answer::Wrote(format!("{sentence}: {MISSING}")),
        failed => failed,
    }
}

/// Returns a file's path; in a browser, its name.
fn path_of(file: &rfd::FileHandle) -> PathBuf {
    #[cfg(target_arch = "wasm32")]
    return file.file_name().into();
    #[cfg(not(target_arch = "wasm32"))]
    file.path().to_path_buf()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saving_without_a_dialog_keeps_existing_files() {
        let folder = std::env::temp_dir().join(format!("tresses-dialog-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let name = folder.join("preset.toml");
        for (i, bytes) in [b"first", b"other"].into_iter().enumerate() {
            let Answer::Wrote(said) = write_to_current_folder(name.to_str().unwrap(), &bytes.to_vec().into())
            else {
                panic!("{i}")
            };
            assert!(said.contains(MISSING));
        }
        assert_eq!(std::fs::read(&name).unwrap(), b"first");
        assert_eq!(std::fs::read(folder.join("preset-1.toml")).unwrap(), b"other");
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(matches!(
            write_to_current_folder(name.to_str().unwrap(), &b"x".to_vec().into()),
            Answer::Failed(_)
        ));
    }
}
