//! Where the time goes.

use crate::{app::Studio, theme};
use eframe::egui::{RichText, Ui};

/// Shows it.
pub fn show(studio: &mut Studio, ui: &mut Ui) {
    let budget = studio.pace.budget();
    let text = studio.panels.frames.median().map_or(String::new(), |ms| format!("{ms:.1} ms"));
    ui.horizontal(|ui| {
        ui.label(RichText::new("Time of a frame").color(theme::QUIET));
        ui.label(text);
    });
    studio.panels.frames.plot(ui, budget).on_hover_text(format!(
        "Milliseconds of the last frames, from handing in to done; the line is at {budget:.0} ms"
    ));
    let mut automatic = studio.pace.automatic;
    let help = "Lowers resolution and strands until a frame fits, and raises them when there is room";
    if ui.checkbox(&mut automatic, "Keep frames short").on_hover_text(help).changed() {
        (studio.pace.automatic, studio.dirty) = (automatic, true);
    }
}
