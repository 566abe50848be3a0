//! Files by dialog: the desktop's own, asked beside the window, which goes on.

use crate::{files::Files, task};
use eframe::egui::{self, DroppedFileHandle};
use rfd::AsyncFileDialog;
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};
use tresses::groom::import::{self, Kind};
use web_time::Instant;

/// What a person chose.
#[derive(Clone, Debug)]
pub enum Answer {
    /// Groom and head files to open.
    Open(Files),
    /// The text of a preset, and where it is from.
    Preset(PathBuf, String),
    /// Something was written.
    Wrote(String),
    /// Something went wrong.
    Failed(String),
}

/// Extensions of grooms and heads.
const GROOMS: [&str; 6] = ["hair", "tfx", "obj", "gltf", "glb", "tfxmesh"];

/// Answers on their way.
#[derive(Clone, Default)]
pub struct Dialogs(Arc<Mutex<Vec<Answer>>>);

impl Dialogs {
    /// What has been answered since the last call.
    pub fn take(&self) -> Vec<Answer> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Tells the window.
    pub fn tell(&self, context: &egui::Context, answer: Answer) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(answer);
        context.request_repaint();
    }

    /// Says so if the dialog that was asked for at `asked` did not open.
    fn nothing(&self, context: &egui::Context, asked: Instant) {
        if no_dialog(asked) {
            let help = "drop files on the window or name them on the command line";
            self.tell(context, Answer::Failed(format!("{MISSING}: {help}")));
        }
    }

    /// Asks for a groom, a head, or both.
    pub fn open(&self, context: &egui::Context) {
        let (dialogs, context) = (self.clone(), context.clone());
        task::spawn(move || async move {
            let ask = AsyncFileDialog::new().set_title("Open a groom, a head, or both");
            let asked = Instant::now();
            let Some(files) = ask.add_filter("Grooms and heads", &GROOMS).pick_files().await else {
                dialogs.nothing(&context, asked);
                return;
            };
            let mut read = Vec::new();
            for file in &files {
                read.push((path_of(file), file.read().await));
            }
            dialogs.tell(&context, sorted(read));
        });
    }

    /// Takes what was dropped on the window: a groom, a head, both, or a preset.
    pub fn dropped(&self, context: &egui::Context, files: Vec<DroppedFileHandle>) {
        let (dialogs, context) = (self.clone(), context.clone());
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
                        dialogs.tell(&context, Answer::Failed(format!("{name} cannot be read: {error}")));
                        return;
                    }
                }
            }
            dialogs.tell(&context, sorted(read));
        });
    }

    /// Asks for a preset.
    pub fn preset(&self, context: &egui::Context) {
        let (dialogs, context) = (self.clone(), context.clone());
        task::spawn(move || async move {
            let ask = AsyncFileDialog::new().set_title("Open a preset").add_filter("Presets", &["toml"]);
            let asked = Instant::now();
            let Some(file) = ask.pick_file().await else {
                dialogs.nothing(&context, asked);
                return;
            };
            dialogs.tell(&context, sorted(vec![(path_of(&file), file.read().await)]));
        });
    }

    /// Asks where `bytes` shall go, with `name` as a proposal.
    pub fn save(&self, context: &egui::Context, title: &str, name: &str, bytes: Vec<u8>) {
        let (dialogs, context) = (self.clone(), context.clone());
        let (title, name) = (title.to_owned(), name.to_owned());
        task::spawn(move || async move {
            let asked = Instant::now();
            let ask = AsyncFileDialog::new().set_title(title).set_file_name(&name);
            let answer = match ask.save_file().await {
                Some(file) => write(&file, &name, &bytes).await,
                None if no_dialog(asked) => write_here(&name, &bytes),
                None => return,
            };
            dialogs.tell(&context, answer);
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
const MISSING: &str = "this desktop opens no dialogs for files (on Linux install a desktop portal or zenity)";

/// Writes `bytes` where the person wants them; names without an ending get that of `name`.
#[cfg(not(target_arch = "wasm32"))]
async fn write(file: &rfd::FileHandle, name: &str, bytes: &[u8]) -> Answer {
    let mut path = file.path().to_path_buf();
    if path.extension().is_none()
        && let Some(ending) = Path::new(name).extension()
    {
        path.set_extension(ending);
    }
    wrote(&path, std::fs::write(&path, bytes))
}

/// Offers `bytes` for download.
#[cfg(target_arch = "wasm32")]
async fn write(file: &rfd::FileHandle, name: &str, bytes: &[u8]) -> Answer {
    wrote(Path::new(name), file.write(bytes).await)
}

fn wrote(path: &Path, result: std::io::Result<()>) -> Answer {
    match result {
        Ok(()) => Answer::Wrote(format!("{} is written", path.display())),
        Err(error) => Answer::Failed(format!("{} cannot be written: {error}", path.display())),
    }
}

/// Without a dialog: writes `bytes` into the folder that the studio was started in, over no other file.
fn write_here(name: &str, bytes: &[u8]) -> Answer {
    let name = Path::new(name);
    let (stem, ending) = (name.with_extension(""), name.extension().unwrap_or_default());
    let numbered = |i: u32| match i {
        0 => name.to_path_buf(),
        i => PathBuf::from(format!("{}-{i}", stem.display())).with_extension(ending),
    };
    let folder = std::env::current_dir().unwrap_or_default();
    let path = (0..).map(|i| folder.join(numbered(i))).find(|path| !path.exists());
    let path = path.unwrap_or_else(|| folder.join(name));
    match wrote(&path, std::fs::write(&path, bytes)) {
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

/// What is done with files of these names and bytes. On a desktop, readers go to the disk again: there they
/// find the companions that nobody names.
fn sorted(files: Vec<(PathBuf, Vec<u8>)>) -> Answer {
    if let [(path, bytes)] = files.as_slice()
        && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
    {
        return match String::from_utf8(bytes.clone()) {
            Ok(text) => Answer::Preset(path.clone(), text),
            Err(_) => Answer::Failed(format!("{} is no text in UTF-8", path.display())),
        };
    }
    if cfg!(target_arch = "wasm32") {
        let given = files.into_iter().map(|(path, bytes)| (path, Cow::Owned(bytes))).collect();
        return Answer::Open(Files::Given(Arc::new(given)));
    }
    let (mut grooms, mut heads) = (Vec::new(), Vec::new());
    for (path, bytes) in files {
        match import::kind(&path, &bytes) {
            Some(Kind::Mesh) => heads.push(path),
            Some(Kind::Companion) => {}
            // Of one that no reader takes the reader says so.
            Some(Kind::Groom) | None => grooms.push(path),
        }
    }
    Answer::Open(Files::Disk { grooms, heads })
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
            let Answer::Wrote(said) = write_here(name.to_str().unwrap(), bytes) else { panic!("{i}") };
            assert!(said.contains(MISSING));
        }
        assert_eq!(std::fs::read(&name).unwrap(), b"first");
        assert_eq!(std::fs::read(folder.join("preset-1.toml")).unwrap(), b"other");
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(matches!(write_here(name.to_str().unwrap(), b"x"), Answer::Failed(_)));
    }
}
