//! Legend of the debug view, at the bottom of the viewport.

use crate::{renderer::StudioRenderer, theme};
use eframe::egui::{Align2, Color32, Mesh, Pos2, Rect, RichText, Sense, TextStyle, Ui, pos2, vec2};
use tresses::low_level::ramp;
use tresses_scene::picture::encoded;

/// Maximum width, points.
const WIDTH: f32 = 280.0;

/// Segments of the color bar.
const PIECES: u32 = 32;

/// Shows name and scale of the view, at most `max_width` points wide.
pub fn show(renderer: &StudioRenderer, ui: &mut Ui, max_width: f32) {
    let Some(shown) = &renderer.debug else { return };
    let physics = renderer.show.as_ref().map(|show| &show.stage.character.physics);
    ui.vertical_centered(|ui| {
        ui.set_max_width(max_width.min(WIDTH));
        ui.label(RichText::new(shown.view.label()).strong()).on_hover_text(shown.view.hint());
        if let Some(why) = physics.and_then(|physics| shown.view.missing(physics)) {
            ui.label(RichText::new(format!("Nothing to show: {why}")).color(theme::ACCENT));
            return;
        }
        let Some(scale) = shown.scale() else { return };
        let bar = bar(ui);
        // Numbers under the ends of the bar.
        let (row, _) = ui.allocate_exact_size(vec2(bar.width(), 14.0), Sense::hover());
        let font = TextStyle::Small.resolve(ui.style());
        let put = |at: Pos2, anchor: Align2, text: &str, color| {
            ui.painter().text(at, anchor, text, font.clone(), color);
        };
        put(row.left_center(), Align2::LEFT_CENTER, &scale.low.to_string(), theme::TEXT);
        put(row.center(), Align2::CENTER_CENTER, scale.title, theme::QUIET);
        put(row.right_center(), Align2::RIGHT_CENTER, &scale.high.to_string(), theme::TEXT);
    });
}

fn bar(ui: &mut Ui) -> Rect {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 8.0), Sense::hover());
    let mut mesh = Mesh::default();
    for i in 0..=PIECES {
        let t = i as f32 / PIECES as f32;
        let [r, g, b] = ramp(t).to_array().map(|v| (encoded(v.clamp(0.0, 1.0)) * 255.0).round() as u8);
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
    rect
}
