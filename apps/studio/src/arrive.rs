//! Events from outside the window's frames: files, and long operations that have finished.

use crate::{
    app::{Shown, Studio},
    device,
    dialog::Answer,
    files::Files,
    hair::Hair,
    job::{Done, Job, Order, Ready, Source},
    panels,
    stage::Show,
};
use eframe::egui;
use std::sync::Arc;
use tresses::groom::import::ImportOptions;
use tresses_scene::Surroundings;

impl Studio {
    /// Starts long work.
    pub(crate) fn start(&mut self, context: &egui::Context, order: Order) {
        (self.error, self.said) = (None, None);
        self.job = Some(Job::start(context, device::gpu(&self.state), order));
    }

    /// Opens a groom, a head for the groom that is shown, or both.
    fn open_files(&mut self, context: &egui::Context, mut files: Files) {
        let mut choice = Box::<ImportOptions>::default();
        if let Files::Disk { grooms, .. } = &mut files
            && grooms.is_empty()
        {
            let Hair { source: Source::Files { files: Files::Disk { grooms: shown, .. }, options }, .. } =
                self.wanted()
            else {
                self.error = Some("a head needs a groom: open a groom first, or both together".into());
                return;
            };
            (*grooms, choice) = (shown, options);
        }
        self.open(context, Source::Files { files, options: choice });
    }

    /// What long work has come to, and what was dropped on the window.
    pub(crate) fn receive(&mut self, context: &egui::Context) {
        if let Some(done) = self.job.as_ref().and_then(Job::take)
            && let Some(Job { hair, .. }) = self.job.take()
        {
            match done {
                Ok(Done::Hair(ready)) => self.present(context, *ready),
                Ok(Done::Light(surroundings)) => self.light_up(context, hair, surroundings),
                Err(error) => {
                    self.painted = None;
                    match &self.shown {
                        Some(shown) => self.settings.set_hair(shown.hair.clone()),
                        // A window that has nothing to show yet shows what is built in.
                        None if hair != Hair::default() => self.make(context, Hair::default(), true),
                        None => {}
                    }
                    self.error = Some(format!("{error:#}"));
                }
            }
        }
        for answer in self.dialogs.take() {
            match answer {
                Answer::Open(files) => self.open_files(context, files),
                Answer::Preset(path, text, files) => self.open_preset(context, &path, &text, files),
                Answer::Companion(companion, name, files) => self.put(context, companion, Some(name), &files),
                Answer::Picture(name, files) => self.panels.asked.push(panels::ask::Asked::new(name, files)),
                Answer::Do(command) => self.do_for_host(context, command),
                Answer::Wrote(sentence) => self.said = Some(sentence),
                Answer::Failed(sentence) => self.error = Some(sentence),
            }
        }
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.dialogs.dropped(context, dropped);
        }
    }

    /// Shows what has become ready.
    fn present(&mut self, context: &egui::Context, ready: Ready) {
        // Of hair that is no longer there.
        self.stop_recording();
        let Ready { mut stage, hair, base, surroundings, notes, keep } = ready;
        self.arrived(context, &hair);
        self.pipelines = Some(stage.pipelines.clone());
        if !keep {
            self.orbit.show(stage.subject());
            self.play.reset();
            self.ball = None;
        } else if let Some(show) = &self.show {
            stage.seek(show.stage.time());
            if let (Some(now), Some(before)) = (&mut stage.living, &show.stage.living) {
                now.go_on(before);
            }
        }
        match &mut self.show {
            Some(show) => show.replace(stage),
            None => self.show = Some(Show::new(stage, &self.state)),
        }
        self.shown = Some(Shown { hair, notes, base, surroundings });
        (self.dirty, self.kept) = (true, false);
        self.animate();
    }

    /// Shows what is shown in the light of `surroundings`, or of a photographer.
    fn light_up(&mut self, context: &egui::Context, hair: Hair, surroundings: Option<Arc<Surroundings>>) {
        self.arrived(context, &hair);
        let (Some(shown), Some(show)) = (&mut self.shown, &mut self.show) else { return };
        show.stage.set_surroundings(surroundings.clone());
        (shown.hair, shown.surroundings) = (hair, surroundings);
        self.dirty = true;
    }
}
