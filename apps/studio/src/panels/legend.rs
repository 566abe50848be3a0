//! What the colours of a view stand for, at the bottom of the picture.

use crate::{app::Studio, theme};
use eframe::egui::{Color32, Mesh, RichText, Sense, Ui, pos2, vec2};
use tresses::draw::debug::ramp;

/// Pieces of the bar.
const PIECES: u32 = 32;

/// Whether there is something to show.
pub fn wanted(studio: &Studio) -> bool {
    studio.view.is_some()
}

/// Shows the name of the view and its scale.
pub fn show(studio: &Studio, ui: &mut Ui) {
    let Some(shown) = &studio.view else { return };
    let physics = studio.show.as_ref().map(|show| &show.stage.physics);
    ui.vertical_centered(|ui| {
        ui.set_max_width(300.0);
        ui.label(RichText::new(shown.view.label()).strong()).on_hover_text(shown.view.hint());
        if let Some(why) = physics.and_then(|physics| shown.view.missing(physics)) {
            ui.label(RichText::new(format!("There is nothing to show: {why}")).color(theme::ACCENT));
            return;
        }
        let Some(scale) = shown.scale() else { return };
        bar(ui);
        ui.label(RichText::new(scale.title).small().color(theme::QUIET));
        ui.label(RichText::new(format!("{}  to  {}", scale.low, scale.high)).small());
    });
}

fn bar(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(260.0, 8.0), Sense::hover());
    let mut mesh = Mesh::default();
    for i in 0..=PIECES {
        let t = i as f32 / PIECES as f32;
        let [r, g, b] = ramp(t).to_array().map(|v| (linear_to_srgb(v) * 255.0).round() as u8);
        let x = rect.left() + t * rect.width();
        for y in [rect.top(), rect.bottom()] {
            mesh.colored_vertex(pos2(x, y), Color32::from_rgb(r, g, b));
        }
        if i > 0 {
            let n = 2 * i;
            mesh.add_triangle(n - 2, n - 1, n);
            mesh.add_triangle(n - 1, n, n + 1);
        }
    }
    ui.painter().add(mesh);
}

fn linear_to_srgb(v: f32) -> f32 {
    let v = v.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}
