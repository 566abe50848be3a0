//! The studio application: its parts, and one frame of the window.

mod receive;

use crate::{
    answer::Answer,
    cards::CardPreview,
    device,
    dialog::Dialogs,
    document::Document,
    events::EventQueue,
    files::Files,
    hair::{DocumentHair, HairSource},
    hosted::Host,
    job::Job,
    journal::{self, LeftGroom},
    loss::{self, DeviceLoss},
    messages::Messages,
    options::Options,
    panels::{self, Panels, overlay::Overlay},
    picture::Snapshot,
    record::LoopRecorder,
    renderer::StudioRenderer,
    stage::CharacterDisplay,
    state::{self, GroomState, LightEntryState, State},
    theme,
    tool::Tool,
    viewport::{self, Viewport},
};
use anyhow::{Context, Result};
use eframe::egui;
use std::time::Duration;
use tresses::groom::styles::Style;

/// The studio.
pub struct Studio {
    document: Document,
    renderer: StudioRenderer,
    viewport: Viewport,
    recorder: LoopRecorder,
    snapshot: Snapshot,
    pub(crate) dialogs: Dialogs,
    messages: Messages,
    panels: Panels,
    /// Whether the panels are hidden, as in an embedded viewer.
    hides_panels: bool,
    /// The host page.
    pub(crate) host: Host,
    /// Pointer events deferred to the next frame.
    waiting: EventQueue,
    /// Device loss or errors that the driver reported.
    lost: DeviceLoss,
    /// Groomed hair that an earlier studio has left.
    left: Option<LeftGroom>,
}

impl Studio {
    /// Opens an empty studio in a new window and starts its first job.
    ///
    /// # Errors
    /// Fails if the window has no GPU.
    pub fn new(context: &eframe::CreationContext<'_>, options: Options) -> Result<Self> {
        let state = context.wgpu_render_state.clone().context("the window has no suitable GPU")?;
        let context = &context.egui_ctx;
        theme::apply(context);
        let gpu = device::gpu(&state);
        let lost = DeviceLoss::default();
        loss::listen(gpu.context.device(), context, &lost);
        let source = if let Some((name, document)) = options.edited {
            HairSource::Edited { name, document }
        } else {
            let style = options.style.unwrap_or_else(|| Style::default().name().into());
            let on_disk = !options.grooms.is_empty() || !options.heads.is_empty();
            let disk = on_disk.then_some(Files::Disk { grooms: options.grooms, heads: options.heads });
            match options.given.or(disk) {
                Some(files) => HairSource::of_files(files, &style, Box::new(options.import)),
                None => HairSource::Style(style),
            }
        };
        let hair = DocumentHair { source, companion_files: options.companion_files };
        let mut messages = Messages::default();
        let mut document = Document::new(context, gpu.clone(), options.settings, hair.clone());
        document.make(hair, true, &mut messages);
        messages.error = options.trouble;
        let dialogs = Dialogs::new(context);
        if !options.hides_panels {
            let dialogs = dialogs.clone();
            journal::find(move |left| dialogs.tell(Answer::Left(left)));
        }
        Ok(Self {
            document,
            renderer: StudioRenderer::new(context, state, gpu),
            viewport: Viewport::default(),
            recorder: LoopRecorder::default(),
            snapshot: Snapshot::default(),
            dialogs,
            messages,
            panels: Panels::default(),
            hides_panels: options.hides_panels,
            host: Host::default(),
            waiting: EventQueue::default(),
            lost,
            left: None,
        })
    }

    /// Closes a window whose device is lost; [`crate::run`] opens another. Returns whether the window closes: nothing
    /// can be drawn then.
    #[cfg(not(target_arch = "wasm32"))]
    fn close_if_device_lost(&self, context: &egui::Context) -> bool {
        let frames = self.renderer.show.as_ref().map_or(0, |show| show.frames);
        loss::lose_for_tests(self.renderer.gpu.context.device(), frames);
        loss::remember(self.again());
        let is_lost = self.lost.is_lost();
        if is_lost {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        is_lost
    }

    /// Returns options that open the studio again with the same hair and settings.
    #[cfg(not(target_arch = "wasm32"))]
    fn again(&self) -> Options {
        let hair = self.document.requested_hair();
        let named = hair.named();
        Options {
            grooms: named.grooms,
            heads: named.heads,
            style: named.style,
            import: named.orientation,
            companion_files: hair.companion_files,
            settings: self.document.settings.now().clone(),
            hides_panels: self.hides_panels,
            given: None,
            edited: match hair.source {
                HairSource::Edited { name, document } => Some((name, document)),
                _ => None,
            },
            trouble: None,
        }
    }

    /// Handles keys and shows the panels around the viewport.
    fn frame(&mut self, ui: &mut egui::Ui) {
        let Self { document, renderer, viewport, snapshot, dialogs, messages, panels, .. } = self;
        let records = self.recorder.is_recording();
        panels::keys::answer(panels, document, renderer, viewport, (dialogs, messages), ui.ctx());
        let can_record = renderer.show.is_some() && !records;
        panels::top::show(panels, document, snapshot, can_record, dialogs, messages, ui);
        let hint = if renderer.show.is_some() { viewport.tool.hint(renderer.playback.live) } else { "" };
        let hint = messages.notice.as_deref().unwrap_or(hint);
        panels::status::show(hint, &panels.frames, renderer, ui);
        panels::transport::show(renderer, records, messages, ui);
        panels::side::show(panels, document, renderer, dialogs, messages, ui);
    }

    /// Shows the viewport and the controls over it.
    fn picture(&mut self, ui: &mut egui::Ui) {
        let Self { document, renderer, viewport, recorder, messages, panels, .. } = self;
        let rect = viewport.show(renderer, document, recorder.is_recording(), messages, ui);
        if let Some(sentence) = self.lost.sentence() {
            viewport::alarm(&sentence, ui, rect);
            return;
        }
        let shown = renderer.show.is_some();
        let grooms = viewport.tool.brush().is_some();
        if shown && !self.hides_panels && !grooms && !recorder.is_recording() {
            panels.lights.show(&renderer.orbit, document, ui, rect);
        } else {
            panels.lights.hide();
        }
        let over = Overlay::new(ui, rect, grooms);
        if shown && !self.hides_panels {
            over.tools(viewport, document, renderer, &self.dialogs);
            over.views(renderer);
            match viewport.tool.brush() {
                Some(tool) => over.brush(tool, &mut viewport.kit, document, &self.dialogs),
                None => over.wind(&renderer.orbit, document),
            }
        }
        if let Some(job) = &document.job {
            over.job(job, shown);
        }
        if recorder.recording.as_ref().is_some_and(|recording| over.recording(recording)) {
            recorder.stop(renderer, messages);
        }
        if let Some(parts) = renderer.refined().filter(|_| !recorder.is_recording()) {
            over.refined(parts);
        }
        match &mut messages.error {
            None => over.legend(renderer),
            error => over.error(error),
        }
        self.recover(ui, rect);
    }

    /// Offers groomed hair that an earlier studio has left, until the user answers or begins to groom.
    fn recover(&mut self, ui: &egui::Ui, rect: egui::Rect) {
        if self.document.groomer.is_some() {
            self.left = None;
        }
        let Some(left) = self.left.as_ref().filter(|_| self.document.shown.is_some()) else { return };
        let Some(recovers) = Overlay::new(ui, rect, self.viewport.tool.brush().is_some()).recovery(left)
        else {
            return;
        };
        match recovers.then(|| self.document.recover(left, &mut self.messages)) {
            Some(Ok(())) => self.viewport.tool = Tool::Brush(Default::default()),
            Some(Err(error)) => self.messages.fail(error),
            None => left.remove(),
        }
        self.left = None;
    }

    /// Shows the dialogs inside the window.
    fn windows(&mut self, ui: &egui::Ui) {
        let Self { document, renderer, recorder, messages, panels, .. } = self;
        if panels.record && !recorder.is_recording() {
            let period = renderer.period();
            if panels::record::show(&mut panels.record, &mut recorder.wish, period, ui) {
                recorder.start(renderer, &self.dialogs, messages);
            }
        }
        panels::map_choice::show(&mut panels.map_choices, document, messages, ui);
    }

    /// Draws the next frame: of the hair, of a recording, or of an image to save. Does nothing while a frame is in
    /// flight.
    fn draw(&mut self, context: &egui::Context) {
        let Self { document, renderer, viewport, recorder, messages, .. } = self;
        viewport.lead(renderer);
        document.groom(viewport.tool.brush().is_some(), renderer, messages);
        renderer.dirty |= std::mem::take(&mut document.due.frame) | renderer.orbit.is_gliding();
        renderer.orbit.advance(context.input(|input| input.stable_dt));
        let due = renderer.dirty || renderer.playback.is_due();
        if !due {
            renderer.playback.rest();
        }
        if self.lost.sentence().is_some() || renderer.area.min_elem() < 1.0 {
            return;
        }
        if !renderer.is_free(due) {
            return;
        }
        document.pose(renderer, messages);
        let settings = document.settings.now();
        if !recorder.go_on(renderer, settings, messages)
            && !self.snapshot.save(renderer, settings, &self.dialogs, messages)
        {
            renderer.draw_next(due, document.job.is_some(), settings, messages);
        }
    }

    /// Publishes the state for the host page and for tests.
    fn publish(&self, context: &egui::Context) {
        let Self { document, renderer, .. } = self;
        let (show, shown, records) =
            (renderer.show.as_ref(), document.shown.as_ref(), self.recorder.is_recording());
        let (picture, lost) = (show.and_then(CharacterDisplay::picture), self.lost.sentence());
        let state = State {
            frames: show.map_or(0, |show| show.frames),
            displayed_frame: self.viewport.displayed_frame,
            painted: context.cumulative_frame_nr(),
            strands: show.map_or(0, |show| show.facts().strands),
            file: shown.map(|shown| shown.hair.source.name()).unwrap_or_default(),
            companion_files: shown.map_or_else(Vec::new, |shown| {
                shown.hair.companion_files.all().map(|(what, name)| format!("{}: {name}", what.key)).collect()
            }),
            recovers: self.left.is_some(),
            groom: document.groomer.as_ref().map(GroomState::of),
            live: renderer.playback.live,
            cards: renderer.cards.as_ref().map(CardPreview::name).unwrap_or_default(),
            lights: LightEntryState::list(&document.settings.now().lights.list, &self.panels.lights.places),
            step: document.job.as_ref().map(Job::step).unwrap_or_default().into(),
            lost: lost.is_some(),
            error: self.messages.error.clone().or(lost).unwrap_or_default(),
            playing: renderer.playback.play.playing,
            time: renderer.playback.play.time,
            size: picture.map_or([0; 2], |picture| picture.size),
            ssaa: picture.map_or(0, |picture| picture.ssaa),
            drawn: picture.map_or(0, |picture| picture.strands),
            parts: renderer.refined().filter(|_| !records).map_or([0; 2], <[usize; 2]>::from),
            pointer: context.input(|input| input.pointer.latest_pos()).map(Into::into),
            distance: renderer.orbit.camera().distance(),
            milliseconds: show.map_or(0.0, |show| show.milliseconds),
            adapter: renderer.gpu.info.name.clone(),
            pending: document.works()
                || renderer.dirty
                || records
                || renderer.may_refine(document.job.is_some())
                || renderer.playback.is_due()
                || renderer.orbit.is_gliding()
                || show.is_some_and(CharacterDisplay::is_in_flight),
        };
        if let Some(tell) = &self.host.tell {
            tell(&state);
        }
        state::publish(state);
    }
}

impl eframe::App for Studio {
    fn raw_input_hook(&mut self, context: &egui::Context, input: &mut egui::RawInput) {
        if self.waiting.exchange(&mut input.events) {
            context.request_repaint();
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        #[cfg(not(target_arch = "wasm32"))]
        if self.close_if_device_lost(&context) {
            return;
        }
        self.receive(&context);
        if let Some(ms) = self.renderer.land(self.recorder.is_recording()) {
            self.panels.frames.push(ms);
        }
        if !self.hides_panels {
            self.frame(ui);
        }
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui));
        if !self.hides_panels {
            self.windows(ui);
        }
        self.document.work_off(&mut self.messages);
        self.draw(&context);
        if self.document.job.is_some() {
            // The overlay counts the job's seconds.
            context.request_repaint_after(Duration::from_millis(500));
        }
        self.publish(&context);
    }

    fn clear_color(&self, _: &egui::Visuals) -> [f32; 4] {
        theme::PANEL.to_normalized_gamma_f32()
    }
}
