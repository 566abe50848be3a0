//! The top bar: what is shown, and actions on it.

use crate::{app::Studio, job::Source, theme};
use eframe::egui::{self, Align, ComboBox, Layout, Panel, RichText, Ui};
use tresses::groom::{formats, styles::Style};
use tresses_scene::preset::Preset;

/// Width of a window in which everything has its button, points.
const WIDE: f32 = 1000.0;

/// Shows it.
pub fn show(studio: &mut Studio, ui: &mut Ui) {
    let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 7));
    Panel::top("top").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new("Tresses").size(15.0).strong().color(theme::ACCENT));
            ui.add_space(10.0);
            source(studio, ui);
            if ui.ctx().content_rect().width() < WIDE {
                ui.menu_button("File", |ui| files(studio, ui));
            } else {
                files(studio, ui);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let text = if studio.panels.is_folded(ui.ctx()) { "Show panel" } else { "Hide panel" };
                if ui.button(text).on_hover_text("The panel at the side\nKey P").clicked() {
                    studio.panels.fold(ui.ctx());
                }
                history(studio, ui);
            });
        });
    });
}

/// What is opened and saved: in a row, or below each other in a menu.
fn files(studio: &mut Studio, ui: &mut Ui) {
    let [grooms, meshes] = [formats::GROOMS, formats::MESHES].map(|all| formats::listed(all, "or"));
    let help = format!(
        "A groom ({grooms}), a head for it ({meshes}), or both. Files can also be dropped on the window, as can maps (.png), environments (.hdr, .exr) and obstacles (.json)."
    );
    if ui.button("Open…").on_hover_text(help).clicked() {
        studio.dialogs.open(ui.ctx());
    }
    ui.separator();
    presets(studio, ui);
    if ui.button("Save picture…").on_hover_text("The current picture, as PNG").clicked() {
        studio.wants_picture = true;
    }
    let help = "The motion as an animated picture";
    let can = studio.show.is_some() && studio.recording.is_none();
    if ui.add_enabled(can, egui::Button::new("Record loop…")).on_hover_text(help).clicked() {
        studio.panels.record = true;
    }
}

fn source(studio: &mut Studio, ui: &mut Ui) {
    let shown = studio.job.as_ref().map(|job| &job.hair).or(studio.shown.as_ref().map(|shown| &shown.hair));
    let shown = shown.map(|hair| &hair.source);
    let name = shown.map(Source::name).unwrap_or_default();
    let built_in = matches!(shown, Some(Source::Style(_)));
    let mut chosen = None;
    ComboBox::from_id_salt("style")
        .selected_text(if built_in { format!("Style: {name}") } else { name.clone() })
        .width(150.0)
        .truncate()
        .show_ui(ui, |ui| {
            for style in Style::NAMES {
                if ui.selectable_label(built_in && style == name, style).clicked() {
                    chosen = Some(style);
                }
            }
        })
        .response
        .on_hover_text(if built_in { "The built-in styles".into() } else { name.clone() });
    if let Some(style) = chosen {
        studio.open(ui.ctx(), Source::Style(style.into()));
    }
}

fn history(studio: &mut Studio, ui: &mut Ui) {
    let (undoes, redoes) =
        (studio.settings.undoes().map(str::to_owned), studio.settings.redoes().map(str::to_owned));
    let mut button = |text: &str, what: &Option<String>, key: &str| {
        let help = what
            .as_ref()
            .map_or_else(|| format!("Nothing to {}", text.to_lowercase()), |what| format!("{text}: {what}"));
        ui.add_enabled(what.is_some(), egui::Button::new(text))
            .on_hover_text(format!("{help}\n{key}"))
            .on_disabled_hover_text(help)
            .clicked()
    };
    // From right to left.
    let (redo, undo) = (button("Redo", &redoes, "Ctrl Shift Z"), button("Undo", &undoes, "Ctrl Z"));
    if undo {
        studio.undo(ui.ctx());
    }
    if redo {
        studio.redo(ui.ctx());
    }
}

fn presets(studio: &mut Studio, ui: &mut Ui) {
    let help = "Loads all parameters from a file, as `tresses render --preset` does";
    if ui.button("Open preset…").on_hover_text(help).clicked() {
        studio.dialogs.preset(ui.ctx());
    }
    let help = "Saves all parameters, the hair and its files into a text file";
    if ui.button("Save preset…").on_hover_text(help).clicked() {
        let (settings, source) = (studio.settings.now().clone(), studio.wanted().named());
        let preset = Preset { settings, source, ..Default::default() };
        studio.dialogs.save(ui.ctx(), "Save the preset", "preset.toml", preset);
    }
}
