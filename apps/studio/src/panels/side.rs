//! The side panel, one page at a time.

use crate::{
    dialog::Dialogs,
    document::Document,
    messages::Messages,
    panels::{Panels, cards, files, groom, inside, knobs, time},
    renderer::StudioRenderer,
};
use eframe::egui::{self, Panel, Ui};

/// Page of the side panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SidePage {
    /// Debug views.
    Inside,
    /// Parameters.
    #[default]
    Knobs,
    /// The groom.
    Groom,
    /// Cards.
    Cards,
    /// Maps, obstacles, environments.
    Files,
    /// Timings.
    Time,
}

impl SidePage {
    const ALL: [(Self, &str, &str); 6] = [
        (Self::Knobs, "Parameters", "All parameters"),
        (Self::Groom, "Groom", "Contents, problems found, unit and axes"),
        (Self::Cards, "Cards", "Bake textured cards for other engines"),
        (Self::Files, "Files", "Scalp maps, colliders, environment maps"),
        (Self::Inside, "Debug", "Debug views: guides, grids, terms of the shading"),
        (Self::Time, "Time", "Frame time and GPU time per stage"),
    ];
}

/// Shows the panel.
pub fn show(
    panels: &mut Panels,
    document: &mut Document,
    renderer: &mut StudioRenderer,
    dialogs: &Dialogs,
    messages: &mut Messages,
    ui: &mut Ui,
) {
    if panels.is_folded(ui.ctx()) {
        return;
    }
    let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 8));
    // Leave room for the viewport in narrow windows.
    let widest = (0.55 * ui.available_width()).clamp(280.0, 520.0);
    let default_width = (0.31 * ui.available_width()).clamp(348.0, 404.0);
    Panel::right("side").frame(frame).default_size(default_width).size_range(280.0..=widest).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (page, name, help) in SidePage::ALL {
                ui.selectable_value(&mut panels.page, page, name).on_hover_text(help);
            }
        });
        ui.separator();
        match panels.page {
            SidePage::Knobs => {
                let lights = (&renderer.orbit, &mut panels.lights.selected);
                knobs::show(document, &mut panels.search, lights, ui);
            }
            SidePage::Inside => inside::show(renderer, ui),
            SidePage::Groom => groom::show(document, renderer, messages, ui),
            SidePage::Cards => cards::show(&mut panels.cards, document, renderer, dialogs, messages, ui),
            SidePage::Files => files::show(document, dialogs, messages, ui),
            SidePage::Time => time::show(&panels.frames, renderer, ui),
        }
    });
}
