//! Companion files of the groom: scalp maps, obstacles, environments. Each row has the file name and a button that
//! removes it.

use crate::{
    dialog::Dialogs,
    document::Document,
    messages::Messages,
    panels::{
        icons::{self, Icon},
        knobs,
    },
    theme,
};
use eframe::egui::{self, Align, Button, Layout, RichText, ScrollArea, Ui};
use tresses::groom::scalp::ScalpMap;
use tresses_scene::{
    Companion, Shelf,
    knobs::SECTIONS,
    settings::HairColor,
    source::{COMPANION_FILES, CompanionKind},
};

/// Width of the titles, points.
const TITLES: f32 = 112.0;

/// Groups of rows: title, hint, and kinds of files.
const GROUPS: [(&str, &str, &[CompanionKind]); 4] = [
    (
        "Light",
        "An equirectangular environment map that lights the hair (.hdr, .exr)",
        &[CompanionKind::Surroundings],
    ),
    (
        "Maps on the scalp",
        "Images (.png) of the scalp from above: the top is the front, the right is the head's left",
        &[CompanionKind::Map, CompanionKind::Colors],
    ),
    ("Strands", "Drawn curls and painted levels of detail", &[CompanionKind::Curve, CompanionKind::Levels]),
    (
        "Collisions and ties",
        "Colliders besides the head, and ties that hold the hair",
        &[CompanionKind::Colliders, CompanionKind::Ties],
    ),
];

/// The user's action in a row.
enum RowAction {
    /// Choose a file in a dialog.
    Choose,
    /// Use a built-in map.
    Named(String),
    /// Remove the file.
    Remove,
}

/// Shows the rows.
pub fn show(document: &mut Document, dialogs: &Dialogs, messages: &mut Messages, ui: &mut Ui) {
    let companion_files = document.requested_hair().companion_files;
    let mut wish = None;
    ScrollArea::vertical().id_salt("files").auto_shrink(false).show(ui, |ui| {
        for (title, help, kinds) in GROUPS {
            ui.label(RichText::new(title).strong()).on_hover_text(help);
            for companion in COMPANION_FILES.iter().filter(|companion| kinds.contains(&companion.kind)) {
                let name = companion_files.name(companion);
                if let Some(action) = row(companion, name.as_deref(), ui) {
                    wish = Some((companion, action));
                }
                if name.is_some() {
                    more(document, companion, ui);
                }
            }
            ui.add_space(8.0);
        }
        let help = "Files, and presets that name them, can also be dropped on the window.";
        ui.label(RichText::new(help).small().color(theme::QUIET));
    });
    match wish {
        None => {}
        Some((companion, RowAction::Choose)) => dialogs.companion(companion),
        Some((companion, RowAction::Named(name))) => {
            document.put(companion, Some(name), &Shelf::default(), messages);
        }
        Some((companion, RowAction::Remove)) => document.put(companion, None, &Shelf::default(), messages),
    }
}

fn row(companion: &Companion, name: Option<&str>, ui: &mut Ui) -> Option<RowAction> {
    let mut wish = None;
    ui.horizontal(|ui| {
        let size = egui::vec2(TITLES, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(TITLES);
            let color = if name.is_some() { theme::ACCENT } else { theme::TEXT };
            ui.label(RichText::new(companion.title).color(color)).on_hover_text(companion.hint);
        });
        let width = ui.available_width() - 26.0;
        let text =
            name.map_or(RichText::new("none").color(theme::QUIET), |name| RichText::new(file_name(name)));
        let button = Button::new(text).truncate().min_size(egui::vec2(width, 0.0));
        let help = name.unwrap_or(companion.hint);
        ui.scope(|ui| {
            ui.set_max_width(width);
            if companion.kind == CompanionKind::Map {
                let (response, _) = egui::containers::menu::MenuButton::from_button(button)
                    .ui(ui, |ui| wish = menu(name, ui));
                response.on_hover_text(help);
            } else if ui.add(button).on_hover_text(format!("{help}\nClick to choose a file")).clicked() {
                wish = Some(RowAction::Choose);
            }
        });
        if name.is_some() && icons::small(ui, Icon::Cross).on_hover_text("Remove").clicked() {
            wish = Some(RowAction::Remove);
        }
    });
    wish
}

/// Shows the menu of a map: an image file, or a built-in map.
fn menu(name: Option<&str>, ui: &mut Ui) -> Option<RowAction> {
    let mut wish = None;
    if ui.button("Image…").clicked() {
        wish = Some(RowAction::Choose);
    }
    ui.separator();
    for prefix in ["", "not-"] {
        for map in ScalpMap::NAMES {
            let each = format!("{prefix}{map}");
            if ui.selectable_label(name == Some(&each), &each).clicked() {
                wish = Some(RowAction::Named(each));
            }
        }
    }
    if wish.is_some() {
        ui.close();
    }
    wish
}

/// Shows the settings of a companion file, or why it has no effect.
fn more(document: &mut Document, companion: &Companion, ui: &mut Ui) {
    let mut settings = document.settings.now().clone();
    match companion.kind {
        CompanionKind::Surroundings => {
            let resolved = settings.resolved(document.style().as_ref());
            let all = SECTIONS.iter().flat_map(|section| section.knobs);
            for knob in all.filter(|knob| knob.path.starts_with("lights.environment")) {
                if knobs::row(knob, &mut settings, &resolved, ui) {
                    document.change(settings.clone(), knob.path);
                }
            }
        }
        CompanionKind::Colors if settings.shading.color != HairColor::File => {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new("The map is hidden: Color is not file.").color(theme::ACCENT));
                if ui.small_button("Show the map").clicked() {
                    settings.shading.color = HairColor::File;
                    document.change(settings, "Color");
                }
            });
        }
        _ => {}
    }
}

/// Returns the last component of a path.
pub fn file_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_companion_has_one_row() {
        for companion in &COMPANION_FILES {
            let rows = GROUPS.iter().filter(|group| group.2.contains(&companion.kind)).count();
            assert_eq!(rows, 1, "{}", companion.key);
        }
        let knobs = SECTIONS.iter().flat_map(|section| section.knobs);
        assert_eq!(knobs.filter(|knob| knob.path.starts_with("lights.environment")).count(), 2);
        assert_eq!(
            (file_name("a/b.png:r"), file_name("noise"), file_name("c:\\d.png")),
            ("b.png:r", "noise", "d.png")
        );
    }
}
