//! The wind dial: the head from above, turned with the camera, and a handle on the side that the wind comes from.

use crate::theme;
use eframe::egui::{
    Color32, CursorIcon, Painter, Pos2, RectAlign, Response, Sense, Shape, Stroke, Tooltip, Ui, Vec2, vec2,
};
use std::f32::consts::TAU;

/// Speed at the dial's rim, m/s.
const MAX_SPEED: f32 = 20.0;
/// Speed below which the wind is calm, m/s.
const CALM: f32 = 0.3;
/// Radius of the dial, points.
const RADIUS: f32 = 38.0;

/// Wind speed (m/s), and the direction it comes from (radians, from the front towards the head's left).
pub type DialWind = (f32, f32);

/// Shows the dial for a camera turned by `azimuth` about the head. Returns the new wind while the user drags the
/// handle.
pub fn show(ui: &mut Ui, wind: DialWind, azimuth: f32) -> Option<DialWind> {
    let size = Vec2::splat(2.0 * RADIUS + 8.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let center = rect.center();
    let handle = center + handle_offset(wind, azimuth);
    paint(ui.painter(), center, handle, wind, azimuth, &response);
    let new_wind = pull(&response, center, azimuth);
    let text = "Drag the handle toward the origin of the wind; farther from the center is stronger. A double click stops the wind.";
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    // Below the dial is the transport.
    let mut tooltip = Tooltip::for_enabled(&response);
    tooltip.popup = tooltip.popup.align(RectAlign::TOP_START).align_alternatives(&[RectAlign::TOP_END]);
    tooltip.show(|ui| ui.label(text));
    new_wind
}

fn pull(response: &Response, center: Pos2, azimuth: f32) -> Option<DialWind> {
    if response.double_clicked() {
        return Some((0.0, 0.0));
    }
    let at = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked())?;
    Some(wind_at(at - center, azimuth))
}

/// Returns the handle's offset from the dial's center. The camera is below the dial.
fn handle_offset((speed, direction): DialWind, azimuth: f32) -> Vec2 {
    let angle = direction - azimuth;
    // The square root gives low speeds more room.
    let far = RADIUS * (speed / MAX_SPEED).clamp(0.0, 1.0).sqrt();
    far * vec2(angle.sin(), angle.cos())
}

/// Returns the wind for a handle at offset `from` the center.
fn wind_at(from: Vec2, azimuth: f32) -> DialWind {
    let fraction = (from.length() / RADIUS).min(1.0);
    let speed = (MAX_SPEED * fraction * fraction * 10.0).round() / 10.0;
    if speed < CALM {
        return (0.0, 0.0);
    }
    let direction = (from.x.atan2(from.y) + azimuth + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
    (speed, direction)
}

fn paint(
    painter: &Painter,
    center: Pos2,
    handle: Pos2,
    (speed, _): DialWind,
    azimuth: f32,
    response: &Response,
) {
    let line = |alpha| Stroke::new(1.0, Color32::from_white_alpha(alpha));
    painter.circle(center, RADIUS, Color32::from_black_alpha(90), line(40));
    for speed in [1.25, 5.0] {
        painter.circle_stroke(center, RADIUS * f32::sqrt(speed / MAX_SPEED), line(16));
    }
    // The head from above; its nose points to the face.
    painter.circle(center, 7.0, Color32::from_white_alpha(28), line(70));
    let nose = vec2((-azimuth).sin(), (-azimuth).cos());
    painter.circle_filled(center + 8.0 * nose, 2.0, Color32::from_white_alpha(130));
    let color = if speed > 0.0 { theme::ACCENT } else { theme::QUIET };
    if speed > 0.0 {
        let along = (center - handle).normalized();
        let (tip, side) = (center - 10.0 * along, along.rot90());
        painter.line_segment([handle, tip], Stroke::new(2.0, color));
        let head = vec![tip + 5.0 * along, tip + 3.5 * side - 2.0 * along, tip - 3.5 * side - 2.0 * along];
        painter.add(Shape::convex_polygon(head, color, Stroke::NONE));
    }
    let large = if response.hovered() || response.dragged() { 5.5 } else { 4.5 };
    painter.circle_filled(handle, large, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wind_round_trips_through_the_handle() {
        for azimuth in [0.0, 0.7, 3.0, -2.0] {
            for direction in [-3.0, -1.0, 0.0, 0.5, 2.0] {
                let (speed, turn) = wind_at(handle_offset((5.0, direction), azimuth), azimuth);
                assert!((speed - 5.0).abs() < 0.06, "{speed}");
                assert!((turn - direction).abs() < 1e-3, "{turn} instead of {direction}");
            }
        }
        assert_eq!(wind_at(vec2(1.0, 1.0), 0.3), (0.0, 0.0));
        assert_eq!(wind_at(vec2(500.0, 0.0), 0.0).0, MAX_SPEED);
    }

    #[test]
    fn wind_towards_the_camera_comes_from_above_the_dial() {
        // The camera is in front of the face; wind from the back blows towards it.
        assert!(handle_offset((5.0, std::f32::consts::PI), 0.0).y < 0.0);
        // The head's left is at the camera's right.
        assert!(handle_offset((5.0, TAU / 4.0), 0.0).x > 0.0);
    }
}
