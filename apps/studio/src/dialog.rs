//! Files by dialog: the desktop's own, asked beside the window, which goes on.

use crate::task;
use eframe::egui;
use rfd::AsyncFileDialog;
use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

/// What a person chose.
#[derive(Clone, Debug)]
pub enum Answer {
    /// Groom and head files to open.
    Open(Vec<PathBuf>),
    /// A preset to open.
    Preset(PathBuf),
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
            let ask = ask.add_filter("Grooms and heads", &GROOMS);
            let Some(files) = ask.pick_files().await else { return };
            dialogs.tell(&context, Answer::Open(files.iter().map(|file| file.path().to_path_buf()).collect()));
        });
    }

    /// Asks for a preset.
    pub fn preset(&self, context: &egui::Context) {
        let (dialogs, context) = (self.clone(), context.clone());
        task::spawn(move || async move {
            let ask = AsyncFileDialog::new().set_title("Open a preset").add_filter("Presets", &["toml"]);
            let Some(file) = ask.pick_file().await else { return };
            dialogs.tell(&context, Answer::Preset(file.path().to_path_buf()));
        });
    }

    /// Asks where `bytes` shall go, with `name` as a proposal.
    pub fn save(&self, context: &egui::Context, title: &str, name: &str, bytes: Vec<u8>) {
        let (dialogs, context) = (self.clone(), context.clone());
        let (title, name) = (title.to_owned(), name.to_owned());
        task::spawn(move || async move {
            let Some(file) = AsyncFileDialog::new().set_title(title).set_file_name(name).save_file().await else {
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
