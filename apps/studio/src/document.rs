//! The document: settings and hair with undo history, the character built from them, and the running job.

use crate::{
    files::Files,
    groomer::Groomer,
    hair::{COLORS, DocumentHair, HairSource},
    job::{DisplayedCharacter, Job, JobRequest, JobResult},
    journal::{Journal, LeftGroom},
    messages::Messages,
    renderer::StudioRenderer,
    stage::CharacterDisplay,
};
use eframe::egui;
use std::{path::Path, sync::Arc, time::Duration};
use tresses::{
    Gpu,
    glam::Vec3,
    groom::{
        cards::CardOptions,
        edit::{GroomDocument, GroomEditor},
        import,
        styles::Style,
    },
};
use tresses_scene::{Changes, Companion, CompanionFiles, History, Preset, Settings, Shelf, source};

/// Memory of groomed versions that undo keeps, bytes.
const UNDO_BYTES: usize = if cfg!(target_arch = "wasm32") { 96 << 20 } else { 256 << 20 };

/// Settings and hair, with undo.
pub struct Document {
    context: egui::Context,
    gpu: Gpu,
    /// Settings and hair, with undo history.
    pub settings: History<DocumentHair>,
    /// The character on the screen; `None` until the first job ends.
    pub shown: Option<DisplayedCharacter>,
    /// The running job.
    pub job: Option<Job>,
    /// Name of a color map that a job is loading. It becomes the hair color once loaded.
    painted: Option<String>,
    /// The hair under the brush, while there is one.
    pub groomer: Option<Groomer>,
    /// Copies of the last version of the hair under the brush.
    journal: Option<Journal>,
    /// Recovered hair, until it is saved or changed.
    recovered: Option<LeftGroom>,
    /// Work that changed settings need: a frame, and a job that rebuilds strands and pipelines.
    pub due: Changes,
}

impl Document {
    /// Creates a document with `hair` and `settings`, without a character or a job.
    pub fn new(context: &egui::Context, gpu: Gpu, settings: Settings, hair: DocumentHair) -> Self {
        Self {
            context: context.clone(),
            gpu,
            settings: History::new(settings, hair),
            shown: None,
            job: None,
            painted: None,
            groomer: None,
            journal: None,
            recovered: None,
            due: Changes::default(),
        }
    }

    /// Prepares the hair on the screen for brushes if one `is_active`, and puts the body to rest meanwhile unless it is
    /// [live](crate::playback::Playback::live).
    pub fn groom(&mut self, is_active: bool, renderer: &mut StudioRenderer, messages: &mut Messages) {
        let at_rest = is_active && !renderer.playback.live;
        if renderer.playback.at_rest != at_rest {
            renderer.playback.at_rest = at_rest;
            renderer.dirty = true;
            if let Some(groomer) = &mut self.groomer {
                groomer.pose_due |= at_rest;
            }
            if let Some(show) = &mut renderer.show {
                show.stage.character.reset();
                rest(show, at_rest, messages);
            }
        }
        if let Some(order) = self.order().filter(|_| is_active && self.groomer.is_none()) {
            messages.clear();
            self.job =
                Some(Job::start(&self.context, self.gpu.clone(), JobRequest { opens_editor: true, ..order }));
        }
    }

    /// Returns the order for the hair on the screen; `None` without hair, and while a job runs.
    fn order(&self) -> Option<JobRequest> {
        let shown = self.shown.as_ref().filter(|_| self.job.is_none())?;
        Some(JobRequest {
            hair: shown.hair.clone(),
            base: Some(shown.base.clone()),
            surroundings: shown.surroundings.clone(),
            settings: self.settings.now().clone(),
            keeps_camera_and_motion: true,
            opens_editor: false,
        })
    }

    /// Puts guides that the brush has moved into the hair of `renderer`. No frame may be in flight.
    pub fn pose(&mut self, renderer: &mut StudioRenderer, messages: &mut Messages) {
        let Some(groomer) = &mut self.groomer else { return };
        let Some(show) = &mut renderer.show else { return };
        if !renderer.playback.at_rest || show.frames == 0 {
            return;
        }
        // Hair with other lengths is made anew.
        let shown = self.shown.as_ref().and_then(|shown| shown.hair.source.document());
        let is_pose = shown.is_some_and(|shown| shown.is_pose_of(groomer.document()));
        if !is_pose || !groomer.take_pose_due() {
            return;
        }
        if let Err(error) = show.stage.character.hair_mut().pose_guides(groomer.editor().positions()) {
            messages.fail(error);
        }
    }

    /// Gives the groom the shapes of simulated guides, as one step of the history.
    pub fn keep_shape(&mut self, guides: &[Vec3], messages: &mut Messages) {
        match self.groomer.as_mut().map(|groomer| groomer.keep(guides)) {
            Some(Ok(Some(document))) => {
                self.step(document, "Keep shape");
                self.keep(messages);
                messages.notice = Some("The hair keeps this shape, and is at rest".into());
            }
            Some(Err(error)) => messages.fail(error),
            _ => messages.notice = Some("The hair has this shape already".into()),
        }
    }

    /// Records a version as a step of the history.
    fn step(&mut self, document: GroomDocument, label: &str) {
        let now = self.settings.hair();
        let source = HairSource::Edited { name: now.source.name(), document };
        let hair = DocumentHair { source, companion_files: now.companion_files.clone() };
        self.settings.change_both(self.settings.now().clone(), hair, label);
        self.settings.limit(UNDO_BYTES, |older, newer| {
            let pair = older.source.document().zip(newer.source.document());
            pair.map_or(0, |(older, newer)| older.unshared_bytes(newer))
        });
    }

    /// Ends the stroke of the brush, as one step of the history.
    pub fn end_stroke(&mut self, messages: &mut Messages) {
        let Some((document, label)) = self.groomer.as_mut().and_then(Groomer::release) else { return };
        self.step(document, &label);
        self.keep(messages);
    }

    /// Writes the hair under the brush to the journal.
    fn keep(&mut self, messages: &mut Messages) {
        let Some(groomer) = &self.groomer else { return };
        let name = self.settings.hair().source.name();
        let recovered = &mut self.recovered;
        let journal = self.journal.get_or_insert_with(|| Journal::new(&name, recovered.take()));
        if let Err(error) = journal.keep(groomer.document(), groomer.hash()) {
            messages.error =
                Some(format!("the journal cannot be written, so a crash loses this groom: {error}"));
        }
    }

    /// Opens groomed hair that an earlier studio has left.
    ///
    /// # Errors
    /// Fails if its file cannot be read.
    pub fn recover(&mut self, left: &LeftGroom, messages: &mut Messages) -> anyhow::Result<()> {
        let source = HairSource::Edited { name: left.name.clone(), document: left.read()? };
        self.open(source, messages);
        self.recovered = Some(left.clone());
        Ok(())
    }

    /// Notes that the user saves the hair under the brush.
    pub fn saves_groom(&mut self) {
        self.recovered.take().iter().for_each(LeftGroom::remove);
        if let (Some(journal), Some(groomer)) = (&mut self.journal, &self.groomer) {
            journal.saved(groomer.hash());
        }
    }

    /// Returns the hair of the running job, else the hair on the screen.
    pub fn requested_hair(&self) -> DocumentHair {
        let coming = self.job.as_ref().map(|job| &job.hair);
        coming.or(self.shown.as_ref().map(|shown| &shown.hair)).cloned().unwrap_or_default()
    }

    /// Starts a job that reads `source` again. The current character stays until the job ends.
    pub fn open(&mut self, source: HairSource, messages: &mut Messages) {
        let companion_files = self.requested_hair().companion_files;
        self.make(DocumentHair { source, companion_files }, true, messages);
    }

    /// Sets the companion file, or removes it if `name` is `None`.
    pub fn put(
        &mut self,
        companion: &Companion,
        name: Option<String>,
        files: &Shelf,
        messages: &mut Messages,
    ) {
        let DocumentHair { source, companion_files } = self.requested_hair();
        if companion.key == COLORS {
            self.painted.clone_from(&name);
        }
        let hair = DocumentHair { source, companion_files: companion_files.with(companion, name, files) };
        if companion.kind.is_of_hair() {
            self.make(hair, false, messages);
        } else {
            self.light(hair, messages);
        }
    }

    /// Starts a job for `hair` unless it is already shown or loading.
    fn go_to(&mut self, hair: DocumentHair, messages: &mut Messages) {
        self.painted = None;
        if let (Some(groomer), Some(document)) = (&mut self.groomer, hair.source.document())
            && document.is_version_of(groomer.document())
            && self.shown.as_ref().is_some_and(|shown| shown.hair.companion_files == hair.companion_files)
        {
            // The guides are put into the hair at once; it is made anew once the brush rests.
            match groomer.go_to(document.clone()) {
                Ok(()) => self.due.frame = true,
                Err(error) => messages.fail(error),
            }
            return self.keep(messages);
        }
        if self.job.as_ref().is_some_and(|job| job.hair == hair) {
            return;
        }
        if self.shown.as_ref().is_some_and(|shown| shown.hair == hair) {
            // Discard the running job, but keep the rebuild that changed settings need.
            self.due.rebuild |= self.job.take().is_some();
            return;
        }
        self.light(hair, messages);
    }

    /// Starts a job for `hair`. If only the environment differs, the job loads just that.
    fn light(&mut self, hair: DocumentHair, messages: &mut Messages) {
        let same = self.shown.as_ref().is_some_and(|shown| shown.hair.is_lit_otherwise(&hair));
        if same && self.job.as_ref().is_none_or(Job::loads_environment) {
            messages.clear();
            self.job = Some(Job::load_environment(&self.context, hair));
        } else {
            self.make(hair, false, messages);
        }
    }

    /// Starts a job that builds `hair`. `fresh` reads its files again even if they are already shown.
    pub fn make(&mut self, hair: DocumentHair, fresh: bool, messages: &mut Messages) {
        let shown = self.shown.as_ref().filter(|shown| !fresh && shown.hair.source == hair.source);
        let base = match (shown, hair.source.document()) {
            (Some(shown), _) => Some(shown.base.clone()),
            (None, Some(document)) if !fresh => {
                let version = |shown: &&DisplayedCharacter| shown.hair.source.is_version_of(&hair.source);
                let shown = self.shown.as_ref().filter(version);
                shown.map(|shown| Arc::new(shown.base.with_document(document.clone())))
            }
            _ => None,
        };
        let shown = shown.or(self.shown.as_ref().filter(|_| base.is_some()));
        // Reuse the environment if its file is the same.
        let same_light = |shown: &&DisplayedCharacter| {
            let light = |hair: &DocumentHair| hair.companion_files.names().environment.clone();
            light(&shown.hair) == light(&hair)
                && !shown.hair.companion_files.files_differ(&hair.companion_files)
        };
        let surroundings = shown.filter(same_light).and_then(|shown| shown.surroundings.clone());
        self.due.rebuild = false;
        let settings = self.settings.now().clone();
        let keep = base.is_some();
        let order = JobRequest {
            hair,
            base,
            surroundings,
            settings,
            keeps_camera_and_motion: keep,
            opens_editor: false,
        };
        messages.clear();
        self.job = Some(Job::start(&self.context, self.gpu.clone(), order));
    }

    /// Starts to bake cards of the hair on the screen.
    pub fn bake(&mut self, options: CardOptions, messages: &mut Messages) {
        let Some(order) = self.order() else { return };
        messages.clear();
        self.job = Some(Job::bake_cards(&self.context, self.gpu.clone(), order, options));
    }

    /// Returns the result of a finished job and its hair. After an error the document reverts to the hair on the
    /// screen.
    pub fn take_done(&mut self, messages: &mut Messages) -> Option<(DocumentHair, JobResult)> {
        let done = self.job.as_ref()?.take()?;
        let Job { hair, .. } = self.job.take()?;
        let error = match done {
            Ok(done) => return Some((hair, done)),
            Err(error) => error,
        };
        self.painted = None;
        match &self.shown {
            Some(shown) => self.settings.set_hair(shown.hair.clone()),
            // An empty window falls back to the built-in hair.
            None if hair != DocumentHair::default() => self.make(DocumentHair::default(), true, messages),
            None => {}
        }
        messages.fail(error);
        None
    }

    /// Takes the editor of hair that has just been prepared, whose style is part of its strands from now on. Closes the
    /// one of other hair.
    ///
    /// Returns whether it has closed one.
    pub fn open_editor(&mut self, hair: &DocumentHair, editor: Option<(GroomEditor, Settings)>) -> bool {
        if let Some((editor, settings)) = editor {
            let label = hair.step_from(self.settings.hair());
            self.settings.change_both(settings, hair.clone(), &label);
            self.groomer = Some(Groomer::new(editor));
            self.journal = None;
        } else if !self.is_version(hair) {
            return self.groomer.take().is_some();
        } else if let Some(groomer) = &mut self.groomer {
            // The hair on the screen is new, and may be older than the last stroke.
            groomer.pose_due = true;
        }
        false
    }

    /// Whether `hair` is a version of the hair under the brush.
    fn is_version(&self, hair: &DocumentHair) -> bool {
        let of = |document: &GroomDocument| {
            self.groomer.as_ref().is_some_and(|it| document.is_version_of(it.document()))
        };
        hair.source.document().is_some_and(of)
    }

    /// Records `hair` as the shown hair, as one undo step. If a color map was loaded for it, the same step switches the
    /// hair color to that map.
    pub fn arrived(&mut self, hair: &DocumentHair) {
        let painted = self.painted.take();
        if self.is_version(hair) && self.settings.hair().companion_files == hair.companion_files {
            // The history has it, and may have newer ones.
            return;
        }
        if self.shown.is_none() {
            // The first hair is the start of the history, not an undo step.
            self.settings.set_hair(hair.clone());
            return;
        }
        let label = hair.step_from(self.settings.hair());
        let before = self.settings.now().clone();
        self.settings.change_both(
            hair.settings_with_color_map(&before, painted.as_deref()),
            hair.clone(),
            &label,
        );
        self.follow(&before);
    }

    /// Returns the built-in style on the screen, if it is one.
    pub fn style(&self) -> Option<Style> {
        self.shown.as_ref().and_then(|shown| shown.base.style().copied())
    }

    /// Changes the settings. `label` names the undo step.
    pub fn change(&mut self, settings: Settings, label: &str) {
        let before = self.settings.now().clone();
        self.settings.change(settings, label);
        self.follow(&before);
    }

    /// Applies parameters, hair and companions of a preset. `text` is its content, `path` its location, and `files` the
    /// files dropped with it.
    pub fn open_preset(&mut self, path: &Path, text: &str, files: Shelf, messages: &mut Messages) {
        let preset = match Preset::read(text, &path.display().to_string()) {
            Ok(preset) => preset,
            Err(error) => return messages.fail(error),
        };
        self.change(preset.settings, "Preset");
        // File names in a preset are relative to it.
        let source = preset.source.inside(path.parent().unwrap_or(Path::new("")));
        let mut notice = format!("{} is loaded", path.display());
        let before = self.requested_hair();
        let on_files = matches!(before.source, HairSource::Files { .. });
        let hair = match &source.style {
            // A preset for a style is applied to the current groom.
            Some(style) if on_files => {
                notice += &format!(" for the current groom; the preset was made for style {style}");
                None
            }
            Some(style) => Some(HairSource::Style(style.clone())),
            None if source.grooms.is_empty() => None,
            None => match groom(&source, &files) {
                Some(files) => {
                    Some(HairSource::Files { files, options: Box::new(source.orientation.clone()) })
                }
                None => {
                    notice += " for the current hair; to load its groom, drop both together";
                    None
                }
            },
        };
        let companion_files = CompanionFiles::of(&source, files);
        // New hair also replaces the companions.
        let companion_files = match hair.is_some() || companion_files.all().next().is_some() {
            true => companion_files,
            false => before.companion_files.clone(),
        };
        let hair = DocumentHair { source: hair.unwrap_or(before.source.clone()), companion_files };
        if hair != before {
            self.go_to(hair, messages);
        }
        messages.notice = Some(notice);
    }

    /// Undoes the last change, or redoes it if `again`.
    pub fn undo(&mut self, again: bool, messages: &mut Messages) {
        let before = self.settings.now().clone();
        let step = if again { self.settings.redo() } else { self.settings.undo() };
        if step.is_some() {
            self.follow(&before);
            self.go_to(self.settings.hair().clone(), messages);
        }
    }

    /// Marks a frame and a job as due if the settings differ from `before`.
    fn follow(&mut self, before: &Settings) {
        let changes = self.settings.now().changes(before);
        self.due.frame |= changes.any();
        // A job waits until the pointer is released.
        self.due.rebuild |= changes.regrow || changes.rebuild;
        if changes.any() {
            self.context.request_repaint();
        }
    }

    /// Whether a job runs, or is due once the brush rests.
    pub fn works(&self) -> bool {
        let shown = self.shown.as_ref().and_then(|shown| shown.hair.source.document());
        let is_old =
            shown.zip(self.groomer.as_ref()).is_some_and(|(shown, it)| it.settles(Some(shown)).is_some());
        self.job.is_some() || is_old
    }

    /// Starts the job that changed settings need, once the pointer is released.
    pub fn work_off(&mut self, messages: &mut Messages) {
        if self.context.input(|input| input.pointer.any_down()) {
            return;
        }
        self.settings.settle();
        let Some(shown) = self.shown.as_ref().filter(|_| self.job.is_none()) else { return };
        let mut hair = shown.hair.clone();
        if let Some(groomer) = &self.groomer
            && let HairSource::Edited { document, .. } = &mut hair.source
            && let Some(wait) = groomer.settles(Some(document))
        {
            if wait > 0.0 && !self.due.rebuild {
                return self.context.request_repaint_after(Duration::from_secs_f32(wait));
            }
            document.clone_from(groomer.document());
            return self.make(hair, false, messages);
        }
        if self.due.rebuild {
            self.make(hair, false, messages);
        }
    }
}

/// Stops the animation of the body of `show` if it `rests`.
fn rest(show: &mut CharacterDisplay, rests: bool, messages: &mut Messages) {
    let Some(rig) = show.stage.character.rig_mut().filter(|_| rests) else { return };
    if let Err(error) = rig.set_animation(None) {
        messages.fail(error);
    }
}

/// Returns the groom and head of a preset: paths on a desktop, bytes from `given` in a browser.
fn groom(source: &source::PresetSource, given: &Shelf) -> Option<Files> {
    if !cfg!(target_arch = "wasm32") {
        return Some(Files::Disk { grooms: source.grooms.clone(), heads: source.heads.clone() });
    }
    let are_given = source.grooms.iter().chain(&source.heads).all(|path| given.holds(path));
    are_given.then(|| {
        let files = given.given().into_iter().filter(|(name, bytes)| import::kind(name, bytes).is_some());
        Files::Given(Arc::new(files.map(|(name, bytes)| (name, bytes.into_owned().into())).collect()))
    })
}
