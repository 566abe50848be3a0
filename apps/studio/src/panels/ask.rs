//! The small window that asks which map a dropped picture is.

use crate::{document::Document, messages::Messages, panels::files::last, theme};
use eframe::egui::{self, Align2, Key, RichText, Ui, vec2};
use tresses_scene::{
    Companion, Shelf,
    source::{COMPANIONS, Kind},
};

/// The channels of a picture: what follows its name, and what that is called.
const CHANNELS: [(&str, &str); 4] = [("", "grey"), (":r", "red"), (":g", "green"), (":b", "blue")];

/// A picture that may be any map.
#[derive(Debug)]
pub struct Asked {
    name: String,
    files: Shelf,
    /// Of [`CHANNELS`].
    channel: usize,
}

impl Asked {
    /// The picture called `name`.
    pub fn new(name: String, files: Shelf) -> Self {
        Self { name, files, channel: 0 }
    }

    /// How it is named as one of the maps.
    fn name_as(&self, companion: &Companion) -> String {
        let channel = if companion.kind == Kind::Colors { "" } else { CHANNELS[self.channel].0 };
        format!("{}{channel}", self.name)
    }
}

/// Shows it, for one picture after the other.
pub fn show(questions: &mut Vec<Asked>, document: &mut Document, messages: &mut Messages, ui: &Ui) {
    let Some(asked) = questions.first_mut() else { return };
    let (mut open, mut chosen) = (true, None);
    let window = egui::Window::new("Which map is it?").collapsible(false).resizable(false).open(&mut open);
    window.anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0)).show(ui.ctx(), |ui| chosen = inside(asked, ui));
    let cancelled = !open || ui.input(|input| input.key_pressed(Key::Escape));
    if chosen.is_none() && !cancelled {
        return;
    }
    let asked = questions.remove(0);
    if let Some(companion) = chosen {
        document.put(companion, Some(asked.name_as(companion)), &asked.files, messages);
    }
}

fn inside(asked: &mut Asked, ui: &mut Ui) -> Option<&'static Companion> {
    ui.set_width(300.0);
    ui.add(egui::Label::new(RichText::new(last(&asked.name)).strong()).truncate()).on_hover_text(&asked.name);
    let mut chosen = None;
    let maps = |kind: Kind| COMPANIONS.iter().filter(move |companion| companion.kind == kind);
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Channel").color(theme::QUIET));
        for (i, (_, name)) in CHANNELS.iter().enumerate() {
            let help = if i == 0 { "The mean of its colours" } else { "This channel alone" };
            ui.selectable_value(&mut asked.channel, i, *name).on_hover_text(help);
        }
    });
    ui.horizontal_wrapped(|ui| {
        for companion in maps(Kind::Map) {
            if ui.button(companion.title).on_hover_text(companion.hint).clicked() {
                chosen = Some(companion);
            }
        }
    });
    ui.separator();
    for companion in maps(Kind::Colors) {
        if ui.button(companion.title).on_hover_text(companion.hint).clicked() {
            chosen = Some(companion);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses_scene::{companions::MapSource, source::companion};

    #[test]
    fn a_channel_is_named_as_the_command_names_it() {
        let asked = Asked { channel: 2, ..Asked::new("maps/d.png".into(), Shelf::default()) };
        let map = asked.name_as(companion("density_map").unwrap());
        assert_eq!(map.parse(), Ok(MapSource::Picture("maps/d.png".into(), Some(1))));
        assert_eq!(asked.name_as(companion("color_map").unwrap()), "maps/d.png");
    }
}
