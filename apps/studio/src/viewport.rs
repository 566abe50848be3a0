//! The viewport: shows the frame and handles the pointer.

use crate::{
    document::Document,
    groomer::BrushKit,
    head,
    messages::Messages,
    playback::Playback,
    renderer::StudioRenderer,
    stage::{CharacterDisplay, DisplayedFrame},
    strokes::{self, ViewportProjection},
    theme,
    tool::Tool,
};
use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, PointerButton, Pos2, Rect, Response, Sense, Ui, vec2,
};
use tresses::{
    glam::{Vec2, Vec3},
    groom::edit::BrushTool,
    low_level::{GrabTarget, Ray},
};
use tresses_scene::camera::Angle;

/// Zoom exponent per point of the wheel.
const WHEEL: f32 = 0.0025;
/// Rotation of the head per point of a drag, radians.
const RADIANS_PER_POINT: f32 = 0.008;
/// Radius of a pulled lock, meters.
const LOCK: f32 = 0.02;

/// The viewport's tool and pointer.
#[derive(Debug, Default)]
pub struct Viewport {
    /// The active tool.
    pub tool: Tool,
    /// The brushes.
    pub kit: BrushKit,
    /// Whether a brush was active in the last frame.
    grooms: bool,
    /// Last position of the pointer in a drag.
    pointer: Option<Pos2>,
    /// [Number](DisplayedFrame::number) of the displayed frame, or 0.
    pub displayed_frame: u64,
}

impl Viewport {
    /// Shows the frame and handles the pointer. While it `records`, the frame keeps its own aspect ratio. Returns the
    /// viewport's rectangle.
    pub fn show(
        &mut self,
        renderer: &mut StudioRenderer,
        document: &mut Document,
        records: bool,
        messages: &mut Messages,
        ui: &mut Ui,
    ) -> Rect {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        let area = rect.size() * ui.ctx().pixels_per_point();
        if area != renderer.area {
            (renderer.area, renderer.dirty) = (area, true);
        }
        renderer.orbit.set_aspect(rect.width() / rect.height().max(1.0));
        self.pointer(renderer, document, messages, ui, &response);
        let painter = ui.painter_at(rect);
        let picture = renderer.show.as_ref().and_then(CharacterDisplay::picture);
        let image_rect = picture.map(|picture| if records { fitted(picture, rect) } else { rect });
        if image_rect != Some(rect) {
            painter.rect_filled(rect, 0.0, Color32::from_rgb(0x24, 0x26, 0x29));
        }
        if let (Some(picture), Some(image_rect)) = (picture, image_rect) {
            painter.add(picture.image.at(image_rect));
        }
        if let Some(tool) = self.tool.brush().filter(|_| response.contains_pointer()) {
            let projection = ViewportProjection { renderer, rect };
            let live = renderer.playback.live;
            if strokes::ring(tool, &self.kit, live, document, projection, &painter, &response) {
                ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
            }
        }
        self.displayed_frame = picture.map_or(0, |picture| picture.number);
        rect
    }

    /// Agrees on whether hair moves: grooming begins with the motion paused, and playing it while a brush is active
    /// makes that live. Brushes that need hair at rest stop both.
    pub fn lead(&mut self, renderer: &mut StudioRenderer) {
        let Playback { live, play, .. } = &mut renderer.playback;
        let brush = self.tool.brush();
        if brush.is_some() && !self.grooms {
            (*live, play.playing) = (false, false);
        }
        self.grooms = brush.is_some();
        *live |= self.grooms && play.playing;
        *live &= brush.is_some_and(BrushTool::acts_in_motion);
        play.playing &= *live || !self.grooms;
    }

    /// Lets hair move under the brush, or ends that.
    pub fn set_live(&mut self, live: bool, renderer: &mut StudioRenderer) {
        renderer.playback.live = live;
        if !live {
            renderer.playback.play.playing = false;
        } else if !self.tool.brush().is_some_and(BrushTool::acts_in_motion) {
            self.tool = Tool::Brush(Default::default());
        }
    }

    fn pointer(
        &mut self,
        renderer: &mut StudioRenderer,
        document: &mut Document,
        messages: &mut Messages,
        ui: &Ui,
        response: &Response,
    ) {
        let rect = response.rect;
        if response.is_pointer_button_down_on() {
            // Keys belong to the tools again.
            ui.memory_mut(|memory| memory.focused().into_iter().for_each(|id| memory.surrender_focus(id)));
        }
        let (shift, press, now, touch) = ui.input(|input| {
            (
                input.modifiers.shift,
                input.pointer.press_origin(),
                input.pointer.latest_pos(),
                input.multi_touch(),
            )
        });
        // Start at the press: egui recognizes a drag only after a few points.
        let from = if response.drag_started() { press } else { self.pointer };
        self.pointer = now.filter(|_| response.dragged());
        let delta =
            from.zip(self.pointer).map_or(Vec2::ZERO, |(from, to)| Vec2::new(to.x - from.x, to.y - from.y));
        let strokes = self.tool.brush().is_some_and(|tool| match renderer.playback.live {
            true => strokes::push(tool, &self.kit, document, renderer, messages, ui, response),
            false => strokes::pointer(tool, &self.kit, document, renderer, messages, ui, response),
        });
        if response.drag_started_by(PointerButton::Primary)
            && self.tool == Tool::Hand
            && let Some(depth) = press.and_then(|at| head_distance(renderer, rect, at))
        {
            renderer.playback.hand.take(depth);
        }
        if strokes {
            // The brush has the pointer.
        } else if let Some(touch) = touch {
            renderer.playback.hand.release();
            renderer.orbit.zoom(touch.zoom_delta);
            let by = touch.translation_delta;
            renderer.orbit.pan(Vec2::new(by.x, by.y), rect.height());
            // The pointer position does not show the motion of every finger.
            renderer.dirty = true;
        } else if response.dragged_by(PointerButton::Primary) {
            if let Some(depth) = renderer.playback.hand.held() {
                if shift {
                    renderer.playback.hand.rotate(delta * RADIANS_PER_POINT);
                } else {
                    let (right, up) = renderer.orbit.plane();
                    let meters = renderer.orbit.height_at(depth) / rect.height();
                    let by: Vec3 = (right * delta.x - up * delta.y) * meters;
                    renderer.playback.hand.drag(by);
                }
            } else if self.tool == Tool::Lock {
                // Handled in `lock`.
            } else if shift {
                renderer.orbit.pan(delta, rect.height());
            } else {
                renderer.orbit.rotate(delta);
            }
            renderer.dirty |= delta != Vec2::ZERO;
        } else if response.dragged_by(PointerButton::Secondary) {
            renderer.orbit.rotate(delta);
            renderer.dirty |= delta != Vec2::ZERO;
        } else if response.dragged_by(PointerButton::Middle) {
            renderer.orbit.pan(delta, rect.height());
            renderer.dirty |= delta != Vec2::ZERO;
        }
        if self.tool.brush().is_none() {
            lock(self.tool, renderer, messages, ui, response);
        }
        if renderer.playback.hand.held().is_some() && !response.dragged_by(PointerButton::Primary) {
            renderer.playback.hand.release();
        }
        if response.double_clicked() {
            renderer.orbit.frame(Angle::default());
            renderer.dirty = true;
        }
        hover(renderer, self.tool, &mut self.kit, ui, response);
    }
}

/// Fits a frame of another aspect ratio into `rect`.
fn fitted(picture: &DisplayedFrame, rect: Rect) -> Rect {
    let [width, height] = picture.size.map(|side| side as f32);
    let scale = (rect.width() / width).min(rect.height() / height);
    Rect::from_center_size(rect.center(), scale * vec2(width, height))
}

/// Shows `sentence` over the frame at `rect`, after a device loss or error.
pub fn alarm(sentence: &str, ui: &Ui, rect: Rect) {
    let painter = ui.painter_at(rect);
    let galley =
        painter.layout(sentence.into(), FontId::proportional(15.0), theme::ALARM, 0.7 * rect.width());
    let text_rect = Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size());
    painter.rect_filled(text_rect.expand2(vec2(18.0, 12.0)), 6.0, Color32::from_black_alpha(200));
    painter.galley(text_rect.min, galley, theme::ALARM);
}

/// Returns the normalized device coordinates of `at`: -1 to 1, right and up.
fn to_ndc(rect: Rect, at: Pos2) -> Vec2 {
    let p = (at - rect.center()) / (0.5 * rect.size());
    Vec2::new(p.x, -p.y)
}

/// Returns the distance to the head under the pointer, meters.
fn head_distance(renderer: &StudioRenderer, rect: Rect, at: Pos2) -> Option<f32> {
    let stage = &renderer.show.as_ref()?.stage;
    let (eye, direction) = renderer.orbit.ray(to_ndc(rect, at));
    head::hit(stage.character.field()?, &stage.character.head(), eye, direction)
}

/// Pulls a lock.
fn lock(tool: Tool, renderer: &mut StudioRenderer, messages: &mut Messages, ui: &Ui, response: &Response) {
    let rect = response.rect;
    let ray = |at: Pos2| {
        let (origin, direction) = renderer.orbit.ray(to_ndc(rect, at));
        Ray { origin, direction }
    };
    let begins = tool == Tool::Lock && response.drag_started_by(PointerButton::Primary);
    let from = ui.input(|input| input.pointer.press_origin()).map(ray);
    let to = ui.input(|input| input.pointer.latest_pos()).map(ray);
    let Some(hair) = renderer.show.as_mut().map(|show| show.stage.character.hair_mut()) else { return };
    if !response.dragged_by(PointerButton::Primary) {
        hair.release();
        return;
    }
    let done = match (begins.then_some(from).flatten(), to) {
        (Some(from), _) => hair.grab(&from, LOCK),
        (None, Some(to)) => hair.drag_to(&GrabTarget::Ray(to)),
        (None, None) => Ok(()),
    };
    if let Err(error) = done {
        messages.fail(error);
    }
}

fn hover(renderer: &mut StudioRenderer, tool: Tool, kit: &mut BrushKit, ui: &Ui, response: &Response) {
    if !response.contains_pointer() {
        return;
    }
    let (wheel, pinch, fingers) =
        ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta(), input.multi_touch().is_some()));
    // `pointer` handles pinches of fingers.
    if fingers {
        return;
    }
    // egui turns Ctrl and the wheel into a pinch.
    if tool.brush().is_some() && ui.input(|input| input.modifiers.command) {
        kit.scale(pinch);
        return;
    }
    if wheel != 0.0 || pinch != 1.0 {
        renderer.orbit.zoom((wheel * WHEEL).exp() * pinch);
        renderer.dirty = true;
    }
    let icon = if renderer.playback.hand.held().is_some() {
        CursorIcon::Grabbing
    } else if response.dragged() {
        CursorIcon::Move
    } else if tool == Tool::Hand
        && response.hover_pos().is_some_and(|at| head_distance(renderer, response.rect, at).is_some())
    {
        CursorIcon::Grab
    } else {
        CursorIcon::Default
    };
    ui.ctx().set_cursor_icon(icon);
}
