//! Debug views of the library.

use crate::{renderer::StudioRenderer, theme};
use eframe::egui::{self, RichText, ScrollArea, Slider, Ui};
use tresses::low_level::{DebugDisplay, DebugView};

/// The debug views by topic. A test checks that each view is in one group.
const GROUPS: [(&str, &[DebugView]); 4] = [
    ("Guides", &[DebugView::Guides, DebugView::Speed, DebugView::Strain]),
    (
        "Strands",
        &[
            DebugView::Locks,
            DebugView::Strands,
            DebugView::Tangents,
            DebugView::FirstHit,
            DebugView::Detail,
            DebugView::Overdraw,
        ],
    ),
    (
        "Grids and colliders",
        &[DebugView::Density, DebugView::Push, DebugView::Wind, DebugView::Colliders, DebugView::Distance],
    ),
    (
        "Light",
        &[
            DebugView::Reflection,
            DebugView::Transmission,
            DebugView::Inner,
            DebugView::Multiple,
            DebugView::Sky,
            DebugView::Direct,
            DebugView::Shadow,
        ],
    ),
];

/// Shows the list of views.
pub fn show(renderer: &mut StudioRenderer, ui: &mut Ui) {
    let now = renderer.debug.map(|shown| shown.view);
    let mut selected = None;
    if ui.selectable_label(now.is_none(), "No debug view").on_hover_text("Shows the rendered hair").clicked()
    {
        selected = Some(None);
    }
    ui.add_space(4.0);
    ScrollArea::vertical().id_salt("views").auto_shrink(false).show(ui, |ui| {
        for (title, views) in GROUPS {
            ui.label(RichText::new(title).small().color(theme::QUIET));
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = egui::vec2(4.0, 4.0);
                for view in views {
                    let button = egui::Button::selectable(now == Some(*view), view.label());
                    if ui.add(button).on_hover_text(view.hint()).clicked() {
                        selected = Some(if now == Some(*view) { None } else { Some(*view) });
                    }
                }
            });
            ui.add_space(6.0);
        }
        scale(renderer, ui);
    });
    if let Some(view) = selected {
        renderer.debug = view.map(DebugDisplay::new);
        renderer.dirty = true;
    }
}

/// Shows the active view's hint and a slider for the top of its scale.
fn scale(renderer: &mut StudioRenderer, ui: &mut Ui) {
    let Some(shown) = &mut renderer.debug else { return };
    ui.separator();
    ui.label(shown.view.hint());
    let (Some(scale), Some(default_scale)) = (shown.scale(), shown.view.scale()) else { return };
    ui.label(RichText::new(format!("{}: {} to", scale.title, scale.low)).color(theme::QUIET));
    let mut high = scale.high;
    let slider =
        Slider::new(&mut high, 0.01 * default_scale.high..=100.0 * default_scale.high).logarithmic(true);
    let slider = ui.add(slider).on_hover_text("Value of the brightest color. A double click resets it.");
    if slider.changed() {
        (shown.high, renderer.dirty) = (Some(high), true);
    }
    if slider.double_clicked() {
        (shown.high, renderer.dirty) = (None, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_of_the_library_is_offered_once() {
        for view in DebugView::ALL {
            let count = GROUPS.iter().flat_map(|(_, views)| *views).filter(|v| **v == view).count();
            assert_eq!(count, 1, "{view:?}");
        }
    }
}
