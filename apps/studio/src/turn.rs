//! Changes of parameters, and their effect on what is shown.

use crate::{app::Studio, files::Files, hair::Hair, job::Source, pace::Level};
use eframe::egui;
use std::{path::Path, sync::Arc};
use tresses::{
    draw::Coverage,
    gpu::Tier,
    groom::{import, styles::Style},
    view::ViewOptions,
};
use tresses_scene::{
    Companions, Settings, Shelf,
    preset::{self, Preset},
};

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

    /// Takes all parameters from the preset at `path`, the hair that it is for, and what stands beside it;
    /// `files` are there as bytes.
    pub(crate) fn open_preset(&mut self, context: &egui::Context, path: &Path, text: &str, files: Shelf) {
        let preset = match Preset::read(text, &path.display().to_string()) {
            Ok(preset) => preset,
            Err(error) => {
                self.error = Some(error.to_string());
                return;
            }
        };
        self.change(context, preset.settings, "Preset");
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
        // Those of another hair go with it.
        let companions = match hair.is_some() || companions.all().next().is_some() {
            true => companions,
            false => before.companions.clone(),
        };
        let hair = Hair { source: hair.unwrap_or(before.source.clone()), companions };
        if hair != before {
            self.go_to(context, hair);
        }
        self.said = Some(said);
    }

    /// Takes the last change back.
    pub(crate) fn undo(&mut self, context: &egui::Context) {
        let before = self.settings.now().clone();
        if self.settings.undo().is_some() {
            self.follow(context, &before);
            self.go_to(context, self.settings.hair().clone());
        }
    }

    /// Takes the last undo back.
    pub(crate) fn redo(&mut self, context: &egui::Context) {
        let before = self.settings.now().clone();
        if self.settings.redo().is_some() {
            self.follow(context, &before);
            self.go_to(context, self.settings.hair().clone());
        }
    }

    /// Does what the way from `before` to the settings as they are takes.
    pub(crate) fn follow(&mut self, context: &egui::Context, before: &Settings) {
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
        let hair = shown.hair.clone();
        self.make(context, hair, false);
    }

    /// Gives the stage the settings as they are, drawn as `level` has it; before each frame.
    pub(crate) fn dress(&mut self, level: &Level) {
        let Some(show) = &mut self.show else { return };
        let stage = &mut show.stage;
        let dressed = level.dress(stage, self.settings.now());
        if let Err(error) = dressed.and_then(|()| stage.show(self.view)) {
            self.error = Some(format!("{error:#}"));
        }
    }
}

/// Groom and head of a preset: where it says they are or, in a browser, among the bytes that came with it.
fn groom(source: &preset::Source, given: &Shelf) -> Option<Files> {
    if !cfg!(target_arch = "wasm32") {
        return Some(Files::Disk { grooms: source.grooms.clone(), heads: source.heads.clone() });
    }
    let there = source.grooms.iter().chain(&source.heads).all(|path| given.holds(path));
    there.then(|| {
        let files = given.given().into_iter().filter(|(name, bytes)| import::kind(name, bytes).is_some());
        Files::Given(Arc::new(files.map(|(name, bytes)| (name, bytes.into_owned().into())).collect()))
    })
}

/// How pictures are sampled: as `settings` say, and where they say nothing so that it is fast.
pub fn draw_options(settings: &Settings, tier: &Tier) -> tresses::Result<ViewOptions> {
    if settings.gives("edges.samples") || settings.gives("edges.coverage") {
        return settings.draw_options(tier.max_samples);
    }
    let fast = ViewOptions { samples: 4, coverage: Coverage::SampleMask, ..Default::default() };
    let Settings { shadow_resolution, strand_map, ambient_cells, .. } = *settings;
    Ok(if tier.software {
        // An eighth of the cells, whose work does not fall with the strands.
        let (shadow_resolution, ambient_cells) = (shadow_resolution.min(256), ambient_cells.min(12));
        ViewOptions { samples: 1, shadow_resolution, strand_map, ambient_cells, ..fast }
    } else {
        ViewOptions { shadow_resolution, strand_map, ambient_cells, ..fast }
    })
}
