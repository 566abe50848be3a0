//! Events between frames: files, commands, and finished jobs.

use super::Studio;
use crate::{
    answer::Answer,
    files::Files,
    hair::{DocumentHair, HairSource},
    hosted::Command,
    job::{JobResult, PreparedCharacter},
    panels::map_choice::MapChoice,
    tool::Tool,
};
use eframe::egui;
use std::sync::Arc;
use tresses::groom::{import::ImportOptions, styles::Style};
use tresses_scene::EnvironmentMap;

impl Studio {
    /// Handles the result of a finished job, queued answers, and dropped files.
    pub(super) fn receive(&mut self, context: &egui::Context) {
        match self.document.take_done(&mut self.messages) {
            Some((_, JobResult::Hair(ready))) => self.present(*ready),
            Some((hair, JobResult::Light(surroundings))) => self.light_up(hair, surroundings),
            Some((_, JobResult::Cards(baked))) => {
                self.recorder.stop(&mut self.renderer, &mut self.messages);
                self.renderer.preview(*baked);
            }
            None => {}
        }
        for answer in self.dialogs.take() {
            let Self { document, messages, .. } = self;
            match answer {
                Answer::Open(files) => self.open_files(files),
                Answer::Preset(path, text, files) => document.open_preset(&path, &text, files, messages),
                Answer::Companion(companion, name, files) => {
                    document.put(companion, Some(name), &files, messages)
                }
                Answer::Picture(name, files) => self.panels.map_choices.push(MapChoice::new(name, files)),
                Answer::Do(command) => self.obey(command),
                Answer::Kept(guides) => {
                    document.keep_shape(&guides, messages);
                    if self.renderer.playback.live {
                        self.viewport.set_live(false, &mut self.renderer);
                    }
                }
                Answer::Left(left) => self.left = Some(left),
                Answer::Wrote(sentence) => messages.notice = Some(sentence),
                Answer::Failed(sentence) => messages.error = Some(sentence),
            }
        }
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.dialogs.dropped(dropped);
        }
    }

    /// Opens a groom, a head, or both. A head alone goes under the current groom or built-in style.
    fn open_files(&mut self, mut files: Files) {
        let requested_source = self.document.requested_hair().source;
        let mut choice = Box::<ImportOptions>::default();
        if let Files::Disk { grooms, .. } = &mut files
            && grooms.is_empty()
            && let HairSource::Files { files: Files::Disk { grooms: shown, .. }, options } = &requested_source
        {
            (*grooms, choice) = (shown.clone(), options.clone());
        }
        let source =
            HairSource::of_files(files, requested_source.style().unwrap_or(Style::default().name()), choice);
        self.document.open(source, &mut self.messages);
    }

    /// Shows a new character.
    fn present(&mut self, ready: PreparedCharacter) {
        // The recording shows the previous hair.
        self.recorder.stop(&mut self.renderer, &mut self.messages);
        let PreparedCharacter { mut stage, shown, keeps_camera_and_motion: keep, editor } = ready;
        if self.document.open_editor(&shown.hair, editor) {
            // The brush would prepare the other hair at once, as another step.
            self.viewport.tool = Tool::Hand;
        }
        self.document.arrived(&shown.hair);
        if !keep {
            self.renderer.orbit.show(stage.subject());
            self.renderer.playback.play.reset();
            self.renderer.playback.ball = None;
        } else if let Some(show) = &self.renderer.show {
            stage.character.continue_from(&show.stage.character);
        }
        self.renderer.present(stage);
        self.document.shown = Some(shown);
        self.snapshot.kept = false;
        self.animate();
    }

    /// Lights the character with `surroundings`, or with the photographer's lights if there are none.
    fn light_up(&mut self, hair: DocumentHair, surroundings: Option<Arc<EnvironmentMap>>) {
        self.document.arrived(&hair);
        let (Some(shown), Some(show)) = (&mut self.document.shown, &mut self.renderer.show) else { return };
        show.stage.set_surroundings(surroundings.clone());
        (shown.hair, shown.surroundings) = (hair, surroundings);
        self.renderer.dirty = true;
    }

    /// Executes a command of the host.
    fn obey(&mut self, command: Command) {
        self.renderer.dirty = true;
        match command {
            Command::Set(setting) => {
                let mut settings = self.document.settings.now().clone();
                match setting.apply(&mut settings) {
                    Ok(()) => self.document.change(settings, setting.label()),
                    Err(error) => self.messages.fail(error),
                }
            }
            Command::Playing(playing) => self.renderer.playback.play.playing = playing,
            Command::Motion(name) => {
                self.renderer.playback.play.set_motion(name);
                self.renderer.playback.play.playing = true;
            }
            Command::Animation(name) => {
                self.host.animation = Some(name);
                if self.document.job.is_none() {
                    self.animate();
                }
            }
            Command::Camera(angle) => self.renderer.orbit.frame(angle),
        }
    }

    fn animate(&mut self) {
        self.host.animate(&mut self.renderer, &mut self.messages);
    }
}
