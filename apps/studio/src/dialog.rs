//! File dialogs of the desktop, which do not block the window.

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

/// What is saved.
#[derive(Clone, Debug)]
pub enum Content {
    /// The same wherever it goes.
    Bytes(Vec<u8>),
    /// A preset, in which the names of files are relative to where it is.
    Preset(Box<Preset>),
}

impl From<Vec<u8>> for Content {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Bytes(bytes)
    }
}

impl From<Preset> for Content {
    fn from(preset: Preset) -> Self {
        Self::Preset(Box::new(preset))
    }
}

impl Content {
    /// What is written to `path`.
    fn bytes(&self, path: &Path) -> std::io::Result<Cow<'_, [u8]>> {
        match self {
            Self::Bytes(bytes) => Ok(Cow::Borrowed(bytes)),
            // A browser has names, and no folders that they could be relative to.
            Self::Preset(preset) if cfg!(target_arch = "wasm32") => {
                Ok(Cow::Owned(preset.write(Extent::Changed).into_bytes()))
            }
            Self::Preset(preset) => {
                preset.text_at(path, Extent::Changed).map(|text| text.into_bytes().into())
            }
        }
    }

    #[cfg_attr(target_arch = "wasm32", allow(dead_code))] // No test runs there.
    fn write(&self, path: &Path) -> std::io::Result<()> {
        std::fs::write(path, self.bytes(path)?)
    }
}

/// Answers on their way to a window.
#[derive(Clone)]
pub struct Dialogs {
    answers: Arc<Mutex<Vec<Answer>>>,
    context: egui::Context,
}

impl Dialogs {
    /// Dialogs of the window of `context`.
    pub fn new(context: &egui::Context) -> Self {
        Self { answers: Arc::default(), context: context.clone() }
    }

    /// What has been answered since the last call.
    pub fn take(&self) -> Vec<Answer> {
        std::mem::take(&mut *self.answers.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Tells the window.
    pub fn tell(&self, answer: Answer) {
        self.answers.lock().unwrap_or_else(PoisonError::into_inner).push(answer);
        self.context.request_repaint();
    }

    /// Says so if the dialog that was asked for at `asked` did not open.
    fn nothing(&self, asked: Instant) {
        if no_dialog(asked) {
            let help = "drop files on the window or name them on the command line";
            self.tell(Answer::Failed(format!("{MISSING}: {help}")));
        }
    }

    /// Asks for files, and tells what is to be done with them.
    fn ask(
        &self,
        ask: impl FnOnce() -> AsyncFileDialog + Send + 'static,
        sort: impl FnOnce(Vec<Read>) -> Vec<Answer> + Send + 'static,
    ) {
        let dialogs = self.clone();
        task::spawn(move || async move {
            let asked = Instant::now();
            let Some(files) = ask().pick_files().await else {
                dialogs.nothing(asked);
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

    /// Asks for a groom, a head, or both.
    pub fn open(&self) {
        let ask = || {
            let ask = AsyncFileDialog::new().set_title("Open a groom, a head, or both");
            ask.add_filter("Grooms and heads", &[formats::GROOMS, formats::MESHES].concat())
        };
        self.ask(ask, |files| sort::files(files, sort::IN_MEMORY));
    }

    /// Asks for a preset.
    pub fn preset(&self) {
        let ask = || AsyncFileDialog::new().set_title("Open a preset").add_filter("Presets", &["toml"]);
        self.ask(ask, |files| sort::files(files, sort::IN_MEMORY));
    }

    /// Asks for a file beside the hair.
    pub fn companion(&self, companion: &'static Companion) {
        let ask = move || {
            let mut endings = companion.kind.extensions().to_vec();
            if sort::IN_MEMORY {
                // What it names is not found otherwise.
                endings.extend(companion.kind.needs());
            }
            AsyncFileDialog::new().set_title(companion.title).add_filter(companion.title, &endings)
        };
        self.ask(ask, move |files| vec![sort::chosen(companion, files, sort::IN_MEMORY)]);
    }

    /// Takes what was dropped on the window: a groom, a head, a preset, maps, obstacles, surroundings.
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

    /// Asks where `content` shall go, with `name` as a proposal.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn save(&self, title: &str, name: &str, content: impl Into<Content>) {
        let content = content.into();
        let dialogs = self.clone();
        let (title, name) = (title.to_owned(), name.to_owned());
        task::spawn(move || async move {
            let asked = Instant::now();
            let ask = AsyncFileDialog::new().set_title(title).set_file_name(&name);
            let answer = match ask.save_file().await {
                Some(file) => write(&file, &name, &content),
                None if no_dialog(asked) => write_here(&name, &content),
                None => return,
            };
            dialogs.tell(answer);
        });
    }

    /// Offers `content` for download as `name`: where it goes is the browser's business.
    #[cfg(target_arch = "wasm32")]
    pub fn save(&self, _: &str, name: &str, content: impl Into<Content>) {
        let done = content.into().bytes(Path::new(name)).map(|bytes| crate::page::download(name, &bytes));
        self.tell(match done {
            Ok(Ok(())) => Answer::Wrote(format!("{name} is handed to the browser as a download")),
            Ok(Err(error)) => Answer::Failed(format!("{name} cannot be downloaded: {error:?}")),
            Err(error) => Answer::Failed(format!("{name} cannot be written: {error}")),
        });
    }
}

/// Whether a dialog that was asked for at `asked` cannot have been seen: nothing could have opened it, or
/// nobody is so quick to close one. (The toolkit does not tell one from the other.)
fn no_dialog(asked: Instant) -> bool {
    cfg!(not(target_arch = "wasm32")) && (asked.elapsed() < Duration::from_millis(500) || !has_dialogs())
}

/// Whether there may be somebody to open dialogs: on Linux a desktop portal, for which there must be a
/// session's bus, or zenity.
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

/// What is missing when no dialog opens.
const MISSING: &str = "no file dialogs are available (on Linux install a desktop portal or zenity)";

/// Writes `bytes` where the person wants them; names without an ending get that of `name`.
#[cfg(not(target_arch = "wasm32"))]
fn write(file: &rfd::FileHandle, name: &str, content: &Content) -> Answer {
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
        Ok(()) => Answer::Wrote(format!("{} is written", path.display())),
        Err(error) => Answer::Failed(format!("{} cannot be written: {error}", path.display())),
    }
}

/// Without a dialog: writes `content` into the folder that the studio was started in, over no other file.
#[cfg(not(target_arch = "wasm32"))]
fn write_here(name: &str, content: &Content) -> Answer {
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

/// Where a file is; in a browser its name.
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
    fn without_a_dialog_no_file_is_overwritten() {
        let folder = std::env::temp_dir().join(format!("tresses-dialog-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let name = folder.join("preset.toml");
        for (i, bytes) in [b"first", b"other"].into_iter().enumerate() {
            let Answer::Wrote(said) = write_here(name.to_str().unwrap(), &bytes.to_vec().into()) else {
                panic!("{i}")
            };
            assert!(said.contains(MISSING));
        }
        assert_eq!(std::fs::read(&name).unwrap(), b"first");
        assert_eq!(std::fs::read(folder.join("preset-1.toml")).unwrap(), b"other");
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(matches!(write_here(name.to_str().unwrap(), &b"x".to_vec().into()), Answer::Failed(_)));
    }
}
