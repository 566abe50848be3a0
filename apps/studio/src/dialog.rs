//! Files by dialog: the desktop's own, asked beside the window, which goes on.

use crate::{files::Files, task};
use eframe::egui::{self, DroppedFileHandle};
use rfd::AsyncFileDialog;
use std::{
    borrow::Cow,
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};
use tresses::groom::import::{self, Kind};

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

    /// Asks for a groom, a head, or both.
    pub fn open(&self, context: &egui::Context) {
        let (dialogs, context) = (self.clone(), context.clone());
        task::spawn(move || async move {
            let ask = AsyncFileDialog::new().set_title("Open a groom, a head, or both");
            let Some(files) = ask.add_filter("Grooms and heads", &GROOMS).pick_files().await else { return };
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
            let Some(file) = ask.pick_file().await else { return };
            dialogs.tell(&context, sorted(vec![(path_of(&file), file.read().await)]));
        });
    }

    /// Asks where `bytes` shall go, with `name` as a proposal.
    pub fn save(&self, context: &egui::Context, title: &str, name: &str, bytes: Vec<u8>) {
        let (dialogs, context) = (self.clone(), context.clone());
        let (title, name) = (title.to_owned(), name.to_owned());
        task::spawn(move || async move {
            let Some(file) = AsyncFileDialog::new().set_title(title).set_file_name(name).save_file().await
            else {
                return;
            };
            let answer = match file.write(&bytes).await {
                Ok(()) => Answer::Wrote(format!("{} is written", file.file_name())),
                Err(error) => Answer::Failed(format!("{} cannot be written: {error}", file.file_name())),
            };
            dialogs.tell(&context, answer);
        });
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
