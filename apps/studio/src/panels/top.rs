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
            source_menu(document, messages, ui);
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

/// Shows the choice among the built-in styles.
fn source_menu(document: &mut Document, messages: &mut Messages, ui: &mut Ui) {
    // The hair being loaded, or else the hair on screen.
    let hair =
        document.job.as_ref().map(|job| &job.hair).or(document.shown.as_ref().map(|shown| &shown.hair));
    let current = hair.map(|hair| &hair.source);
    let name = current.map(HairSource::name).unwrap_or_default();
    let current_style = current.and_then(HairSource::style);
    let (is_built_in, is_on_file_head) =
        (current_style.is_some(), matches!(current, Some(HairSource::Head { .. })));
    let mut selected = None;
    ComboBox::from_id_salt("style")
        .selected_text(if is_built_in { format!("Style: {name}") } else { name.clone() })
        .width(150.0)
        .truncate()
        .show_ui(ui, |ui| {
            for style in Style::NAMES {
                if ui.selectable_label(current_style == Some(style), style).clicked() {
                    selected = current.map(|source| source.with_style(style));
                }
            }
            if let Some(style) = current_style.filter(|_| is_on_file_head) {
                ui.separator();
                if ui.selectable_label(false, "built-in head").clicked() {
                    selected = Some(HairSource::Style(style.into()));
                }
            }
        })
        .response
        .on_hover_text(if is_built_in { "Built-in styles".into() } else { name.clone() });
    if let Some(source) = selected {
        document.open(source, messages);
    }
}

/// Shows the buttons for undo and redo.
fn history(document: &mut Document, messages: &mut Messages, ui: &mut Ui) {
    let (undo_step, redo_step) =
        (document.settings.undoes().map(str::to_owned), document.settings.redoes().map(str::to_owned));
    let mut button = |text: &str, step: &Option<String>, key: &str| {
        let help = step
            .as_ref()
            .map_or_else(|| format!("Nothing to {}", text.to_lowercase()), |step| format!("{text}: {step}"));
        ui.add_enabled(step.is_some(), egui::Button::new(text))
            .on_hover_text(format!("{help}\n{key}"))
            .on_disabled_hover_text(help)
            .clicked()
    };
    // Redo comes first, as the layout runs from right to left.
    let (is_redo_clicked, is_undo_clicked) =
        (button("Redo", &redo_step, "Ctrl Shift Z"), button("Undo", &undo_step, "Ctrl Z"));
    if is_undo_clicked {
        document.undo(false, messages);
    }
    if is_redo_clicked {
        document.undo(true, messages);
    }
}

/// Shows the buttons that open and save a preset.
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
