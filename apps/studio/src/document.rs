//! The document: settings and hair with their history, the character made from them, and the job under way.

use crate::{
    files::Files,
    hair::{COLORS, Hair, Source},
    job::{Done, Job, Order, Shown},
    messages::Messages,
};
use eframe::egui;
use std::{path::Path, sync::Arc};
use tresses::{
    gpu::Gpu,
    groom::{import, styles::Style},
};
use tresses_scene::{Companion, Companions, History, Preset, Settings, Shelf, source};

/// Settings and hair, with undo.
pub struct Document {
    context: egui::Context,
    gpu: Gpu,
    /// The parameters and the hair, with their history.
    pub settings: History<Hair>,
    /// The character on the screen; `None` until the first job ends.
    pub shown: Option<Shown>,
    /// The job under way.
    pub job: Option<Job>,
    /// The color map that is being read: it becomes the hair color when it arrives.
    painted: Option<String>,
    /// Strands or pipelines are older than the settings; the next job makes them again.
    stale: bool,
    /// Whether the settings have changed since the last frame.
    pub dirty: bool,
}

impl Document {
    /// `hair` with `settings`, without a character and without a job.
    pub fn new(context: &egui::Context, gpu: Gpu, settings: Settings, hair: Hair) -> Self {
        Self {
            context: context.clone(),
            gpu,
            settings: History::new(settings, hair),
            shown: None,
            job: None,
            painted: None,
            stale: false,
            dirty: false,
        }
    }

    /// The hair that is shown, or will be when the work that is under way is done.
    pub fn wanted(&self) -> Hair {
        let coming = self.job.as_ref().map(|job| &job.hair);
        coming.or(self.shown.as_ref().map(|shown| &shown.hair)).cloned().unwrap_or_default()
    }

    /// Starts a job that reads `source` anew; the current character stays until it ends.
    pub fn open(&mut self, source: Source, messages: &mut Messages) {
        let companions = self.wanted().companions;
        self.make(Hair { source, companions }, true, messages);
    }

    /// Puts a file in its place beside the hair, or takes it away.
    pub fn put(
        &mut self,
        companion: &Companion,
        name: Option<String>,
        files: &Shelf,
        messages: &mut Messages,
    ) {
        let Hair { source, companions } = self.wanted();
        if companion.key == COLORS {
            self.painted.clone_from(&name);
        }
        let hair = Hair { source, companions: companions.with(companion, name, files) };
        if companion.kind.is_of_hair() {
            self.make(hair, false, messages);
        } else {
            self.light(hair, messages);
        }
    }

    /// Goes to `hair`, if it is not there already.
    fn go_to(&mut self, hair: Hair, messages: &mut Messages) {
        self.painted = None;
        if self.job.as_ref().is_some_and(|job| job.hair == hair) {
            return;
        }
        if self.shown.as_ref().is_some_and(|shown| shown.hair == hair) {
            // Whatever was on its way is wanted no longer, but for what settings have asked for.
            self.stale |= self.job.take().is_some();
            return;
        }
        self.light(hair, messages);
    }

    /// Starts to make `hair` ready: only its light where nothing else is another.
    fn light(&mut self, hair: Hair, messages: &mut Messages) {
        let same = self.shown.as_ref().is_some_and(|shown| shown.hair.is_lit_otherwise(&hair));
        if same && self.job.as_ref().is_none_or(Job::is_light) {
            messages.clear();
            self.job = Some(Job::light(&self.context, hair));
        } else {
            self.make(hair, false, messages);
        }
    }

    /// Starts to make `hair` ready; `fresh`: its files are read although they are those that are shown.
    pub fn make(&mut self, hair: Hair, fresh: bool, messages: &mut Messages) {
        let shown = self.shown.as_ref().filter(|shown| !fresh && shown.hair.source == hair.source);
        let base = shown.map(|shown| shown.base.clone());
        // Light stays if it is the same file.
        let same_light = |shown: &&Shown| {
            let light = |hair: &Hair| hair.companions.names().environment.clone();
            light(&shown.hair) == light(&hair) && !shown.hair.companions.files_differ(&hair.companions)
        };
        let surroundings = shown.filter(same_light).and_then(|shown| shown.surroundings.clone());
        self.stale = false;
        let settings = self.settings.now().clone();
        let keep = base.is_some();
        let order = Order { hair, base, surroundings, settings, keep };
        messages.clear();
        self.job = Some(Job::start(&self.context, self.gpu.clone(), order));
    }

    /// The result of a job that has ended, and its hair. After an error the document returns to the hair on the screen.
    pub fn take_done(&mut self, messages: &mut Messages) -> Option<(Hair, Done)> {
        let done = self.job.as_ref()?.take()?;
        let Job { hair, .. } = self.job.take()?;
        let error = match done {
            Ok(done) => return Some((hair, done)),
            Err(error) => error,
        };
        self.painted = None;
        match &self.shown {
            Some(shown) => self.settings.set_hair(shown.hair.clone()),
            // An empty window shows the built-in hair.
            None if hair != Hair::default() => self.make(Hair::default(), true, messages),
            None => {}
        }
        messages.fail(error);
        None
    }

    /// `hair` is shown from here on, which is a step that can be undone. Colours that were painted for it are
    /// seen at once, whatever colour it had: that belongs to the same step.
    pub fn arrived(&mut self, hair: &Hair) {
        let painted = self.painted.take();
        if self.shown.is_none() {
            // The first is where one begins.
            self.settings.set_hair(hair.clone());
            return;
        }
        let label = hair.step_from(self.settings.hair());
        let before = self.settings.now().clone();
        self.settings.change_both(hair.seen_with(&before, painted.as_deref()), hair.clone(), &label);
        self.follow(&before);
    }

    /// The built-in style that is shown, if it is one.
    pub fn style(&self) -> Option<Style> {
        self.shown.as_ref().and_then(|shown| shown.base.style().copied())
    }

    /// The settings are others from here on; `label` names the step for an undo.
    pub fn change(&mut self, settings: Settings, label: &str) {
        let before = self.settings.now().clone();
        self.settings.change(settings, label);
        self.follow(&before);
    }

    /// Takes parameters, hair and companions from the preset at `path` with the content `text`; `files` came with it as
    /// bytes.
    pub fn open_preset(&mut self, path: &Path, text: &str, files: Shelf, messages: &mut Messages) {
        let preset = match Preset::read(text, &path.display().to_string()) {
            Ok(preset) => preset,
            Err(error) => return messages.fail(error),
        };
        self.change(preset.settings, "Preset");
        // Names of files in it are relative to it.
        let source = preset.source.inside(path.parent().unwrap_or(Path::new("")));
        let mut said = format!("{} is applied", path.display());
        let before = self.wanted();
        let on_files = matches!(before.source, Source::Files { .. });
        let hair = match &source.style {
            // A look is tried on the hair that is there.
            Some(style) if on_files => {
                said += &format!(" to this groom; it was made for the style {style}");
                None
            }
            Some(style) => Some(Source::Style(style.clone())),
            None if source.grooms.is_empty() => None,
            None => match groom(&source, &files) {
                Some(files) => Some(Source::Files { files, options: Box::new(source.orientation.clone()) }),
                None => {
                    said += " to this hair; its groom has to be given with it";
                    None
                }
            },
        };
        let companions = Companions::of(&source, files);
        // Other hair replaces the companions too.
        let companions = match hair.is_some() || companions.all().next().is_some() {
            true => companions,
            false => before.companions.clone(),
        };
        let hair = Hair { source: hair.unwrap_or(before.source.clone()), companions };
        if hair != before {
            self.go_to(hair, messages);
        }
        messages.said = Some(said);
    }

    /// Takes the last change back, or the last undo where that is to be done `again`.
    pub fn undo(&mut self, again: bool, messages: &mut Messages) {
        let before = self.settings.now().clone();
        let step = if again { self.settings.redo() } else { self.settings.undo() };
        if step.is_some() {
            self.follow(&before);
            self.go_to(self.settings.hair().clone(), messages);
        }
    }

    /// Marks frame and job as due where the settings differ from `before`.
    fn follow(&mut self, before: &Settings) {
        let changes = self.settings.now().changes(before);
        self.dirty |= changes.any();
        // A job waits until the pointer is up.
        self.stale |= changes.regrow || changes.rebuild;
        if changes.any() {
            self.context.request_repaint();
        }
    }

    /// Starts the long work that changes have left, unless a finger is still on them.
    pub fn work_off(&mut self, messages: &mut Messages) {
        if self.context.input(|input| input.pointer.any_down()) {
            return;
        }
        self.settings.settle();
        if !self.stale || self.job.is_some() {
            return;
        }
        let Some(shown) = &self.shown else { return };
        let hair = shown.hair.clone();
        self.make(hair, false, messages);
    }
}

/// Groom and head of a preset: where it says they are or, in a browser, among the bytes that came with it.
fn groom(source: &source::Source, given: &Shelf) -> Option<Files> {
    if !cfg!(target_arch = "wasm32") {
        return Some(Files::Disk { grooms: source.grooms.clone(), heads: source.heads.clone() });
    }
    let there = source.grooms.iter().chain(&source.heads).all(|path| given.holds(path));
    there.then(|| {
        let files = given.given().into_iter().filter(|(name, bytes)| import::kind(name, bytes).is_some());
        Files::Given(Arc::new(files.map(|(name, bytes)| (name, bytes.into_owned().into())).collect()))
    })
}
