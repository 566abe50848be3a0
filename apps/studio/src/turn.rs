//! Parameters are turned: what a change means for what is shown.

use crate::{
    app::Studio,
    files::Files,
    job::{Order, Source},
    pace::Level,
};
use eframe::egui;
use tresses::{
    draw::{Coverage, DrawOptions},
    gpu::Tier,
    groom::styles::Style,
};
use tresses_scene::{Settings, preset::Preset};

impl Studio {
    /// The built-in style that is shown, if it is one.
    pub(crate) fn style(&self) -> Option<Style> {
        self.shown.as_ref().and_then(|shown| shown.base.style().copied())
    }

    /// The settings are others from here on; `label` names the step for an undo.
    pub(crate) fn change(&mut self, context: &egui::Context, settings: Settings, label: &str) {
        let before = self.settings.now().clone();
        self.settings.change(settings, label);
        self.follow(context, &before);
    }

    /// Takes all parameters from the preset at `path`, and the hair that it is for.
    pub(crate) fn open_preset(&mut self, context: &egui::Context, path: &std::path::Path, text: &str) {
        match Preset::read(text, &path.display().to_string()) {
            Ok(Preset { source, settings, .. }) => {
                self.change(context, settings, "Preset");
                // Names of files in it are relative to it.
                let source = source.inside(path.parent().unwrap_or(std::path::Path::new("")));
                let mut said = format!("{} is applied", path.display());
                let left = source.companions();
                if !left.is_empty() {
                    said += &format!(", without its {}: the studio takes none yet", left.join(", "));
                }
                let files =
                    matches!(self.shown.as_ref().map(|shown| &shown.source), Some(Source::Files { .. }));
                match source.style {
                    // A look is tried on the hair that is there.
                    Some(style) if files => {
                        said += &format!(" to this groom; it was made for the style {style}")
                    }
                    Some(style) => self.open(context, Source::Style(style)),
                    None if source.grooms.is_empty() => {}
                    None => {
                        let files = Files::Disk { grooms: source.grooms, heads: source.heads };
                        self.open(context, Source::Files { files, options: Box::new(source.orientation) });
                    }
                }
                self.said = Some(said);
            }
            Err(error) => self.error = Some(error.to_string()),
        }
    }

    /// Takes the last change back.
    pub(crate) fn undo(&mut self, context: &egui::Context) {
        let before = self.settings.now().clone();
        if self.settings.undo().is_some() {
            self.follow(context, &before);
        }
    }

    /// Takes the last undo back.
    pub(crate) fn redo(&mut self, context: &egui::Context) {
        let before = self.settings.now().clone();
        if self.settings.redo().is_some() {
            self.follow(context, &before);
        }
    }

    /// Does what the way from `before` to the settings as they are takes.
    fn follow(&mut self, context: &egui::Context, before: &Settings) {
        let changes = self.settings.now().changes(before);
        self.dirty |= changes.any();
        // Those that take long wait until nobody turns any more.
        self.regrow |= changes.regrow;
        self.rebuild |= changes.rebuild;
        if changes.any() {
            context.request_repaint();
        }
    }

    /// Starts the long work that changes have left, unless a finger is still on them.
    pub(crate) fn work_off(&mut self, context: &egui::Context) {
        if context.input(|input| input.pointer.any_down()) {
            return;
        }
        self.settings.settle();
        if !(self.regrow || self.rebuild) || self.job.is_some() {
            return;
        }
        let Some(shown) = &self.shown else { return };
        let (source, base) = (shown.source.clone(), Some(shown.base.clone()));
        let renderer = self.renderer.clone().filter(|_| !self.rebuild);
        (self.regrow, self.rebuild) = (false, false);
        self.start(
            context,
            Order { source, base, renderer, settings: self.settings.now().clone(), keep: true },
        );
    }

    /// Gives the stage the settings as they are, drawn as `level` has it; before each frame.
    pub(crate) fn dress(&mut self, level: &Level) {
        let Some(show) = &mut self.show else { return };
        let (settings, stage) = (self.settings.now(), &mut show.stage);
        stage.take(settings);
        if level.few_lights {
            stage.lighting.rim = 0.0;
        }
        if level.coarse || self.gpu.tier.software {
            // Flat triangles shade themselves sooner, and so do the coarse maps of a software driver.
            stage.look.shadows.bias *= 2.0;
        }
        stage.set_coarse(level.coarse);
        if let Err(error) = stage.set_lod(level.lod(settings.lod.options())) {
            self.error = Some(format!("{error:#}"));
        }
        stage.show(self.view);
    }
}

/// How pictures are sampled: as `settings` say, and where they say nothing so that it is fast.
pub fn draw_options(settings: &Settings, tier: &Tier) -> tresses::Result<DrawOptions> {
    if settings.edges.samples.is_some() || settings.edges.coverage.is_some() {
        return settings.draw_options(tier.max_samples);
    }
    let shadow_resolution =
        if tier.software { settings.shadow_resolution.min(256) } else { settings.shadow_resolution };
    let samples = if tier.software { 1 } else { 4 };
    Ok(DrawOptions { samples, coverage: Coverage::SampleMask, shadow_resolution, ..Default::default() })
}
