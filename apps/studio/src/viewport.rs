//! The viewport: the picture, and the pointer in it.

use crate::{
    app::Studio,
    head, panels,
    stage::{Picture, Show},
    theme,
    tool::Tool,
};
use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, PointerButton, Pos2, Rect, Response, Sense, Ui, vec2,
};
use tresses::{
    glam::{Vec2, Vec3},
    simulate::grab::{Ray, Target},
};
use tresses_scene::camera::Angle;

/// Zoom per point of a wheel.
const WHEEL: f32 = 0.0025;
/// Radians of the head per point of a drag.
const TURN: f32 = 0.008;
/// Radius of a lock that is pulled, metres.
const LOCK: f32 = 0.02;

/// Shows the picture and takes what the pointer does.
pub fn show(studio: &mut Studio, ui: &mut Ui) {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    let area = rect.size() * ui.ctx().pixels_per_point();
    if area != studio.area {
        (studio.area, studio.dirty) = (area, true);
    }
    studio.orbit.set_aspect(rect.width() / rect.height().max(1.0));
    pointer(studio, ui, &response);
    let painter = ui.painter_at(rect);
    let picture = studio.show.as_ref().and_then(Show::picture);
    let place = picture.map(|picture| fitted(studio, picture, rect));
    if place != Some(rect) {
        painter.rect_filled(rect, 0.0, Color32::from_rgb(0x24, 0x26, 0x29));
    }
    if let (Some(picture), Some(place)) = (picture, place) {
        painter.add(picture.seen.at(place));
    }
    studio.seen = picture.map_or(0, |picture| picture.number);
    if let Some(sentence) = studio.lost() {
        message(ui, rect, &sentence, theme::ALARM);
    } else {
        panels::overlay::show(studio, ui, rect);
    }
}

/// Where the picture goes: everywhere, unless one of another form is recorded.
fn fitted(studio: &Studio, picture: &Picture, rect: Rect) -> Rect {
    if studio.recording.is_none() {
        return rect;
    }
    let [width, height] = picture.size.map(|side| side as f32);
    let scale = (rect.width() / width).min(rect.height() / height);
    Rect::from_center_size(rect.center(), scale * vec2(width, height))
}

fn message(ui: &Ui, rect: Rect, text: &str, color: Color32) {
    let painter = ui.painter_at(rect);
    let galley = painter.layout(text.into(), FontId::proportional(15.0), color, 0.7 * rect.width());
    let place = Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size());
    painter.rect_filled(place.expand2(vec2(18.0, 12.0)), 6.0, Color32::from_black_alpha(200));
    painter.galley(place.min, galley, color);
}

/// Where in the picture `at` is, -1 to 1 from left to right and from bottom to top.
fn place(rect: Rect, at: Pos2) -> Vec2 {
    let p = (at - rect.center()) / (0.5 * rect.size());
    Vec2::new(p.x, -p.y)
}

/// How far the head under the pointer is, metres.
fn head_under(studio: &Studio, rect: Rect, at: Pos2) -> Option<f32> {
    let stage = &studio.show.as_ref()?.stage;
    let (eye, direction) = studio.orbit.ray(place(rect, at));
    head::hit(stage.field.as_ref()?, &stage.head(), eye, direction)
}

fn pointer(studio: &mut Studio, ui: &Ui, response: &Response) {
    let rect = response.rect;
    let (shift, press, now, touch) = ui.input(|input| {
        (input.modifiers.shift, input.pointer.press_origin(), input.pointer.latest_pos(), input.multi_touch())
    });
    // From where it was pressed: a drag is known as one only after a few points.
    let from = if response.drag_started() { press } else { studio.pointer };
    studio.pointer = now.filter(|_| response.dragged());
    let delta =
        from.zip(studio.pointer).map_or(Vec2::ZERO, |(from, to)| Vec2::new(to.x - from.x, to.y - from.y));
    if response.drag_started_by(PointerButton::Primary)
        && studio.tool == Tool::Hand
        && let Some(depth) = press.and_then(|at| head_under(studio, rect, at))
    {
        studio.hand.take(depth);
    }
    if let Some(touch) = touch {
        studio.hand.release();
        studio.orbit.zoom(touch.zoom_delta);
        let by = touch.translation_delta;
        studio.orbit.pan(Vec2::new(by.x, by.y), rect.height());
        // Any of the fingers may be the one that moves.
        studio.dirty = true;
    } else if response.dragged_by(PointerButton::Primary) {
        if let Some(depth) = studio.hand.held() {
            if shift {
                studio.hand.turn(delta * TURN);
            } else {
                let (right, up) = studio.orbit.plane();
                let metres = studio.orbit.height_at(depth) / rect.height();
                let by: Vec3 = (right * delta.x - up * delta.y) * metres;
                studio.hand.drag(by);
            }
        } else if studio.tool == Tool::Lock {
            // See `lock`.
        } else if shift {
            studio.orbit.pan(delta, rect.height());
        } else {
            studio.orbit.turn(delta);
        }
        studio.dirty |= delta != Vec2::ZERO;
    } else if response.dragged_by(PointerButton::Secondary) {
        studio.orbit.turn(delta);
        studio.dirty |= delta != Vec2::ZERO;
    } else if response.dragged_by(PointerButton::Middle) {
        studio.orbit.pan(delta, rect.height());
        studio.dirty |= delta != Vec2::ZERO;
    }
    lock(studio, ui, response, press);
    if studio.hand.held().is_some() && !response.dragged_by(PointerButton::Primary) {
        studio.hand.release();
    }
    if response.double_clicked() {
        studio.orbit.frame(Angle::default());
        studio.dirty = true;
    }
    hover(studio, ui, response);
}

/// Pulls a lock.
fn lock(studio: &mut Studio, ui: &Ui, response: &Response, press: Option<Pos2>) {
    let rect = response.rect;
    let ray = |studio: &Studio, at: Pos2| {
        let (origin, direction) = studio.orbit.ray(place(rect, at));
        Ray { origin, direction }
    };
    let begins = studio.tool == Tool::Lock && response.drag_started_by(PointerButton::Primary);
    let from = press.map(|at| ray(studio, at));
    let to = ui.input(|input| input.pointer.latest_pos()).map(|at| ray(studio, at));
    let Some(hair) = studio.show.as_mut().map(|show| &mut show.stage.hair) else { return };
    if !response.dragged_by(PointerButton::Primary) {
        hair.release();
        return;
    }
    let done = match (begins.then_some(from).flatten(), to) {
        (Some(from), _) => hair.grab(&from, LOCK),
        (None, Some(to)) => hair.drag_to(&Target::Ray(to)),
        (None, None) => Ok(()),
    };
    if let Err(error) = done {
        studio.error = Some(error.to_string());
    }
}

fn hover(studio: &mut Studio, ui: &Ui, response: &Response) {
    if !response.contains_pointer() {
        return;
    }
    let (wheel, pinch, fingers) =
        ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta(), input.multi_touch().is_some()));
    // Fingers have zoomed already, in `pointer`.
    if fingers {
        return;
    }
    if wheel != 0.0 || pinch != 1.0 {
        studio.orbit.zoom((wheel * WHEEL).exp() * pinch);
        studio.dirty = true;
    }
    let icon = if studio.hand.held().is_some() {
        CursorIcon::Grabbing
    } else if response.dragged() {
        CursorIcon::Move
    } else if studio.tool == Tool::Hand
        && response.hover_pos().is_some_and(|at| head_under(studio, response.rect, at).is_some())
    {
        CursorIcon::Grab
    } else {
        CursorIcon::Default
    };
    ui.ctx().set_cursor_icon(icon);
}

/// A dark backdrop for controls on the picture.
pub fn plate() -> egui::Frame {
    egui::Frame::new()
        .fill(Color32::from_rgba_unmultiplied(0x16, 0x17, 0x19, 205))
        .corner_radius(6.0)
        .inner_margin(egui::Margin::symmetric(6, 6))
}
