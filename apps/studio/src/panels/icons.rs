//! Buttons with painted icons: the fonts lack some of the symbols.

use crate::theme;
use eframe::egui::{Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, pos2, vec2};
use std::f32::consts::PI;

/// An icon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// A triangle.
    Play,
    /// Two bars.
    Pause,
    /// A triangle and a bar.
    Step,
    /// A bar and a triangle that points left.
    Rewind,
    /// A counterclockwise arrow.
    Undo,
    /// An X.
    Cross,
}

/// Shows a button with the icon.
pub fn button(ui: &mut Ui, icon: Icon) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(34.0, 26.0), Sense::click());
    let visuals = ui.style().interact(&response);
    ui.painter().rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    paint(ui.painter(), icon, Rect::from_center_size(rect.center(), Vec2::splat(12.0)), visuals.text_color());
    response
}

/// Shows a small button without a background.
pub fn small(ui: &mut Ui, icon: Icon) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(16.0), Sense::click());
    let color = if response.hovered() { theme::ACCENT } else { theme::QUIET };
    paint(ui.painter(), icon, Rect::from_center_size(rect.center(), Vec2::splat(10.0)), color);
    response
}

fn paint(painter: &Painter, icon: Icon, at: Rect, color: Color32) {
    let triangle = |from: f32, to: f32| {
        let corners = vec![pos2(from, at.top()), pos2(to, at.center().y), pos2(from, at.bottom())];
        painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
    };
    let bar = |x: f32| {
        painter.rect_filled(Rect::from_min_max(pos2(x, at.top()), pos2(x + 3.0, at.bottom())), 0.0, color);
    };
    match icon {
        Icon::Play => triangle(at.left() + 1.0, at.right()),
        Icon::Pause => {
            bar(at.left() + 1.5);
            bar(at.right() - 4.5);
        }
        Icon::Step => {
            triangle(at.left(), at.right() - 4.0);
            bar(at.right() - 3.0);
        }
        Icon::Rewind => {
            bar(at.left());
            triangle(at.right(), at.left() + 4.0);
        }
        Icon::Undo => turning(painter, at, color),
        Icon::Cross => {
            let (at, stroke) = (at.shrink(1.0), Stroke::new(1.5, color));
            painter.line_segment([at.left_top(), at.right_bottom()], stroke);
            painter.line_segment([at.left_bottom(), at.right_top()], stroke);
        }
    }
}

/// Paints three quarters of a circle with an arrow head.
fn turning(painter: &Painter, at: Rect, color: Color32) {
    let radius = 0.42 * at.width();
    let point = |angle: f32| -> Pos2 { at.center() + radius * vec2(angle.cos(), angle.sin()) };
    let line: Vec<Pos2> = (0..=18).map(|i| point(-0.75 * PI + 1.5 * PI * i as f32 / 18.0)).collect();
    let tip = line[0];
    painter.add(Shape::line(line, Stroke::new(1.4, color)));
    let head = vec![tip + vec2(-2.4, 2.6), tip + vec2(-1.6, -3.4), tip + vec2(3.4, 0.4)];
    painter.add(Shape::convex_polygon(head, color, Stroke::NONE));
}
