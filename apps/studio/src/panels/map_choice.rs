//! Dialog that asks which scalp map a dropped image is.

use crate::{document::Document, messages::Messages, panels::files::file_name, theme};
use eframe::egui::{self, Align2, Key, RichText, Ui, vec2};
use tresses_scene::{
    Companion, Shelf,
    source::{COMPANION_FILES, CompanionKind},
};

/// Channels of an image: suffix of the file name, and label.
const CHANNELS: [(&str, &str); 4] = [("", "gray"), (":r", "red"), (":g", "green"), (":b", "blue")];

/// A dropped image whose kind is unknown.
#[derive(Debug)]
pub struct MapChoice {
    name: String,
    /// Holds the image if its file is in memory. Otherwise it is read from disk.
    files: Shelf,
    /// Index into [`CHANNELS`].
    channel: usize,
}

impl MapChoice {
    /// Creates the dialog for the image `name`.
    pub fn new(name: String, files: Shelf) -> Self {
        Self { name, files, channel: 0 }
    }

    /// Returns the image's name as the file of `companion`. For a map, it ends with the suffix of the chosen channel.
    fn name_as(&self, companion: &Companion) -> String {
        let channel = if companion.kind == CompanionKind::Colors { "" } else { CHANNELS[self.channel].0 };
        format!("{}{channel}", self.name)
    }
}

/// Shows the dialog for the first image. Removes the image from `choices` when the user has answered or canceled.
pub fn show(choices: &mut Vec<MapChoice>, document: &mut Document, messages: &mut Messages, ui: &Ui) {
    let Some(choice) = choices.first_mut() else { return };
    let (mut open, mut selected) = (true, None);
    let window = egui::Window::new("Which map is this?").collapsible(false).resizable(false).open(&mut open);
    window.anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0)).show(ui.ctx(), |ui| selected = contents(choice, ui));
    let canceled = !open || ui.input(|input| input.key_pressed(Key::Escape));
    if selected.is_none() && !canceled {
        return;
    }
    let choice = choices.remove(0);
    if let Some(companion) = selected {
        document.put(companion, Some(choice.name_as(companion)), &choice.files, messages);
    }
}

/// Returns the scalp map that the user clicked.
fn contents(choice: &mut MapChoice, ui: &mut Ui) -> Option<&'static Companion> {
    ui.set_width(300.0);
    ui.add(egui::Label::new(RichText::new(file_name(&choice.name)).strong()).truncate())
        .on_hover_text(&choice.name);
    let mut selected = None;
    let maps = |kind: CompanionKind| COMPANION_FILES.iter().filter(move |companion| companion.kind == kind);
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Channel").color(theme::QUIET));
        for (i, (_, name)) in CHANNELS.iter().enumerate() {
            let help = if i == 0 { "Mean of all channels" } else { "Only this channel" };
            ui.selectable_value(&mut choice.channel, i, *name).on_hover_text(help);
        }
    });
    ui.horizontal_wrapped(|ui| {
        for companion in maps(CompanionKind::Map) {
            if ui.button(companion.title).on_hover_text(companion.hint).clicked() {
                selected = Some(companion);
            }
        }
    });
    ui.separator();
    for companion in maps(CompanionKind::Colors) {
        if ui.button(companion.title).on_hover_text(companion.hint).clicked() {
            selected = Some(companion);
        }
    }
    selected
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses_scene::{companion_files::MapSource, source::companion};

    #[test]
    fn channel_suffix_matches_the_command_line() {
        let choice = MapChoice { channel: 2, ..MapChoice::new("maps/d.png".into(), Shelf::default()) };
        let map = choice.name_as(companion("density_map").unwrap());
        assert_eq!(map.parse(), Ok(MapSource::Picture("maps/d.png".into(), Some(1))));
        assert_eq!(choice.name_as(companion("color_map").unwrap()), "maps/d.png");
    }
}
