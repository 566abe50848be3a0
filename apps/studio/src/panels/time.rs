//! Frame time, and GPU time per stage.

use crate::{panels::frames::Frames, renderer::StudioRenderer, theme};
use eframe::egui::{Grid, RichText, Ui};

/// Shows the page.
pub fn show(frames: &Frames, renderer: &mut StudioRenderer, ui: &mut Ui) {
    let budget = renderer.pace.budget();
    let text = frames.median().map_or(String::new(), |ms| format!("{ms:.1} ms"));
    ui.horizontal(|ui| {
        ui.label(RichText::new("Frame time").color(theme::QUIET));
        ui.label(text);
    });
    let help = format!(
        "Milliseconds of the last frames, from submission to completion; the line is at {budget:.0} ms. \
         Waiting for other programs is included."
    );
    frames.plot(ui, budget).on_hover_text(help);
    let mut automatic = renderer.pace.automatic;
    let help = "Lowers resolution and detail to keep frames short, and raises them when there is time or nothing moves";
    if ui.checkbox(&mut automatic, "Keep frames short").on_hover_text(help).changed() {
        (renderer.pace.automatic, renderer.dirty) = (automatic, true);
    }
    ui.separator();
    stages(renderer, ui);
}

/// Shows the GPU time of each stage.
fn stages(renderer: &StudioRenderer, ui: &mut Ui) {
    let Some(show) = &renderer.show else { return };
    if !show.times_stages() {
        let why = if renderer.gpu.context.tier().software {
            "Software drivers do not report the time per stage; `tresses bench` measures each stage alone."
        } else {
            "This adapter has no timestamps, so the time per stage is unknown."
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
