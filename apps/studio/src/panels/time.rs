//! Where the time goes.

use crate::{app::Studio, theme};
use eframe::egui::{Grid, RichText, Ui};

/// Shows it.
pub fn show(studio: &mut Studio, ui: &mut Ui) {
    let budget = studio.pace.budget();
    let text = studio.panels.frames.median().map_or(String::new(), |ms| format!("{ms:.1} ms"));
    ui.horizontal(|ui| {
        ui.label(RichText::new("Time of a frame").color(theme::QUIET));
        ui.label(text);
    });
    let help = format!(
        "Milliseconds of the last frames, from handing in to done; the line is at {budget:.0} ms. \
         Waiting for others on the same machine is in it."
    );
    studio.panels.frames.plot(ui, budget).on_hover_text(help);
    let mut automatic = studio.pace.automatic;
    let help = "Lowers resolution and detail until a frame fits, and raises them when there is time or nothing moves";
    if ui.checkbox(&mut automatic, "Keep frames short").on_hover_text(help).changed() {
        (studio.pace.automatic, studio.dirty) = (automatic, true);
    }
    ui.separator();
    stages(studio, ui);
}

/// The stages on the GPU.
fn stages(studio: &Studio, ui: &mut Ui) {
    let Some(show) = &studio.show else { return };
    if !show.times_stages() {
        let why = if studio.gpu.tier.software {
            "A software driver does not report the time of single stages; `tresses bench` measures them one by one."
        } else {
            "This adapter has no timestamps: the time of single stages is unknown."
        };
        ui.label(RichText::new(why).color(theme::QUIET));
        return;
    }
    let total: f64 = show.stages().iter().map(|row| row.1).sum();
    Grid::new("stages").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (name, ms) in show.stages().iter().copied().chain([("all", total)]) {
            ui.label(RichText::new(name).color(theme::QUIET));
            ui.label(format!("{ms:.3} ms"));
            ui.end_row();
        }
    });
}
