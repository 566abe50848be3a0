//! The top bar: choice of hair, and actions.

use crate::{
    dialog::Dialogs, document::Document, hair::HairSource, messages::Messages, panels::Panels,
    picture::Snapshot, theme,
};
use eframe::egui::{self, Align, ComboBox, Layout, Panel, RichText, Ui};
use tresses::groom::{formats, styles::Style};
use tresses_scene::preset::Preset;

/// Window width from which every action has its own button, points.
const WIDE: f32 = 1000.0;

/// Shows the bar. `can_record`: there is a character, and no loop is being recorded.
pub fn show(
    panels: &mut Panels,
    document: &mut Document,
    snapshot: &mut Snapshot,
    can_record: bool,
    dialogs: &Dialogs,
    messages: &mut Messages,
    ui: &mut Ui,
) {
    let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 7));
    Panel::top("top").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new("Tresses").size(15.0).strong().color(theme::ACCENT));
            ui.add_space(10.0);
            source(document, messages, ui);
            if ui.ctx().content_rect().width() < WIDE {
                ui.menu_button("File", |ui| files(panels, document, snapshot, can_record, dialogs, ui));
            } else {
                files(panels, document, snapshot, can_record, dialogs, ui);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let text = if panels.is_folded(ui.ctx()) { "Show panel" } else { "Hide panel" };
                if ui.button(text).on_hover_text("Side panel\nKey P").clicked() {
                    panels.fold(ui.ctx());
                }
                history(document, messages, ui);
            });
        });
    });
}

/// Shows the actions that open and save: in a row, or in a menu.
fn files(
    panels: &mut Panels,
    document: &Document,
    snapshot: &mut Snapshot,
    can_record: bool,
    dialogs: &Dialogs,
    ui: &mut Ui,
) {
    let [grooms, meshes] = [formats::GROOMS, formats::MESHES].map(|all| formats::listed(all, "or"));
    let help = format!(
        "A groom ({grooms}), a head for it ({meshes}), or both. Files can also be dropped on the window, as can maps (.png), environment maps (.hdr, .exr) and colliders (.json)."
    );
    if ui.button("Open…").on_hover_text(help).clicked() {
        dialogs.open();
    }
    ui.separator();
    presets(document, dialogs, ui);
    if ui.button("Save image…").on_hover_text("Saves the current image as PNG").clicked() {
        snapshot.is_requested = true;
    }
    let help = "Records the motion as an animated image";
    if ui.add_enabled(can_record, egui::Button::new("Record loop…")).on_hover_text(help).clicked() {
        panels.record = true;
    }
}

fn source(document: &mut Document, messages: &mut Messages, ui: &mut Ui) {
    let shown =
        document.job.as_ref().map(|job| &job.hair).or(document.shown.as_ref().map(|shown| &shown.hair));
    let shown = shown.map(|hair| &hair.source);
    let name = shown.map(HairSource::name).unwrap_or_default();
    let current = shown.and_then(HairSource::style);
    let (built_in, on_head) = (current.is_some(), matches!(shown, Some(HairSource::Head { .. })));
    let mut selected = None;
    ComboBox::from_id_salt("style")
        .selected_text(if built_in { format!("Style: {name}") } else { name.clone() })
        .width(150.0)
        .truncate()
        .show_ui(ui, |ui| {
            for style in Style::NAMES {
                if ui.selectable_label(current == Some(style), style).clicked() {
                    selected = shown.map(|source| source.with_style(style));
                }
            }
            if let Some(style) = current.filter(|_| on_head) {
                ui.separator();
                if ui.selectable_label(false, "built-in head").clicked() {
                    selected = Some(HairSource::Style(style.into()));
                }
            }
        })
        .response
        .on_hover_text(if built_in { "Built-in styles".into() } else { name.clone() });
    if let Some(source) = selected {
        document.open(source, messages);
    }
}

fn history(document: &mut Document, messages: &mut Messages, ui: &mut Ui) {
    let (undoes, redoes) =
        (document.settings.undoes().map(str::to_owned), document.settings.redoes().map(str::to_owned));
    let mut button = |text: &str, what: &Option<String>, key: &str| {
        let help = what
            .as_ref()
            .map_or_else(|| format!("Nothing to {}", text.to_lowercase()), |what| format!("{text}: {what}"));
        ui.add_enabled(what.is_some(), egui::Button::new(text))
            .on_hover_text(format!("{help}\n{key}"))
            .on_disabled_hover_text(help)
            .clicked()
    };
    // Right to left.
    let (redo, undo) = (button("Redo", &redoes, "Ctrl Shift Z"), button("Undo", &undoes, "Ctrl Z"));
    if undo {
        document.undo(false, messages);
    }
    if redo {
        document.undo(true, messages);
    }
}

fn presets(document: &Document, dialogs: &Dialogs, ui: &mut Ui) {
    let help = "Loads all parameters from a file, as `tresses render --preset` does";
    if ui.button("Open preset…").on_hover_text(help).clicked() {
        dialogs.preset();
    }
    let help = "Saves all parameters, the hair and the names of its files to a text file";
    if ui.button("Save preset…").on_hover_text(help).clicked() {
        let (settings, source) = (document.settings.now().clone(), document.requested_hair().named());
        let preset = Preset { settings, source, ..Default::default() };
        dialogs.save("Save the preset", "preset.toml", preset);
    }
}
