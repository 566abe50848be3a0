//! The brush in the viewport: strokes of the pointer, and the ring around it.

use crate::{
    document::Document,
    groomer::{BrushKit, Groomer},
    messages::Messages,
    renderer::StudioRenderer,
    theme,
};
use eframe::egui::{Color32, Event, Key, Painter, Pos2, Rect, Response, Shape, Stroke, TouchPhase, Ui, pos2};
use tresses::{
    Camera,
    glam::{Vec2, Vec3},
    groom::edit::{Brush, BrushTool, StrokeSample},
    low_level::{BrushEffect, GrabTarget, MotionBrush, Ray},
};
use tresses_scene::camera::VERTICAL_FOV;
use web_time::Instant;

/// Points of the ring.
const RING: usize = 48;

/// Where the pointer is in the viewport.
#[derive(Clone, Copy)]
pub struct ViewportProjection<'a> {
    /// The camera and the character.
    pub renderer: &'a StudioRenderer,
    /// The viewport.
    pub rect: Rect,
}

impl ViewportProjection<'_> {
    /// Returns the ray from the eye through the pointer at `at`.
    fn ray(&self, at: Pos2) -> Ray {
        let p = (at - self.rect.center()) / (0.5 * self.rect.size());
        let (origin, direction) = self.renderer.orbit.ray(Vec2::new(p.x, -p.y));
        Ray { origin, direction }
    }

    /// Returns the sample of a pointer at `at`, in groom space.
    fn sample(&self, at: Pos2, pressure: f32) -> Option<StrokeSample> {
        let to_groom = self.renderer.show.as_ref()?.stage.character.head().inverse();
        let Ray { origin, direction } = self.ray(at);
        let ray = StrokeSample::ray(to_groom.point(origin), to_groom.rotation * direction);
        Some(StrokeSample { pressure, ..ray })
    }

    /// Returns the place of a point in groom space, if it is before the camera.
    fn project(&self, point: Vec3) -> Option<Pos2> {
        let head = self.renderer.show.as_ref()?.stage.character.head();
        let viewpoint = self.renderer.orbit.camera();
        let size = [self.rect.width().max(1.0) as u32, self.rect.height().max(1.0) as u32];
        let camera = Camera::look_at(viewpoint.eye, viewpoint.target, VERTICAL_FOV, size);
        let clip = camera.projection * camera.view * head.point(point).extend(1.0);
        let half = 0.5 * self.rect.size();
        let at = self.rect.center();
        (clip.w > 0.0).then(|| pos2(at.x + half.x * clip.x / clip.w, at.y - half.y * clip.y / clip.w))
    }
}

/// Handles the pointer as the brush of `tool`. Returns whether it works on the hair, so that the camera stays.
pub fn pointer(
    tool: BrushTool,
    kit: &BrushKit,
    document: &mut Document,
    renderer: &mut StudioRenderer,
    messages: &mut Messages,
    ui: &Ui,
    response: &Response,
) -> bool {
    let (pressed, down, escaped, shift, ctrl) = ui.input(|input| {
        let pointer = &input.pointer;
        (
            pointer.primary_pressed(),
            pointer.primary_down(),
            input.key_pressed(Key::Escape),
            input.modifiers.shift,
            input.modifiers.command,
        )
    });
    let Some(groomer) = &mut document.groomer else { return false };
    let started = Instant::now();
    let projection = ViewportProjection { renderer, rect: response.rect };
    let done = (|| -> anyhow::Result<()> {
        if pressed && response.contains_pointer() && !groomer.editor().is_active() {
            let from = ui.input(|input| input.pointer.press_origin());
            let sample = from.and_then(|from| projection.sample(from, pressure(ui)));
            if let Some(sample) = sample {
                groomer.press(&kit.acting(tool, shift, ctrl), &sample)?;
            }
        }
        if groomer.editor().is_active() {
            let moves = ui.input(|input| {
                let position = |event: &Event| match event {
                    Event::PointerMoved(at) => Some(*at),
                    _ => None,
                };
                let moves: Vec<_> = input.events.iter().filter_map(position).collect();
                // A still pointer lets time pass.
                if moves.is_empty() { input.pointer.latest_pos().into_iter().collect() } else { moves }
            });
            let force = pressure(ui);
            for sample in moves.into_iter().filter_map(|at| projection.sample(at, force)) {
                groomer.drag(sample)?;
            }
        }
        Ok(())
    })();
    if let Err(error) = done {
        messages.fail(error);
        groomer.cancel();
    }
    let active = groomer.editor().is_active();
    if active {
        groomer.milliseconds = started.elapsed().as_secs_f32() * 1e3;
        ui.ctx().request_repaint();
    }
    if active && escaped {
        groomer.cancel();
    } else if active && !down {
        document.end_stroke(messages);
    }
    active
}

/// Pushes moving hair with the brush of `tool` while the primary button is down. Returns whether it is.
pub fn push(
    tool: BrushTool,
    kit: &BrushKit,
    document: &Document,
    renderer: &mut StudioRenderer,
    messages: &mut Messages,
    ui: &Ui,
    response: &Response,
) -> bool {
    let is_down = response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_down());
    let projection = ViewportProjection { renderer, rect: response.rect };
    let ray = |at: Pos2| projection.ray(at);
    let (pressed, from, to, ctrl) = ui.input(|input| {
        let pointer = &input.pointer;
        let [from, to] = [pointer.press_origin(), pointer.latest_pos()].map(|at| at.map(ray));
        (pointer.primary_pressed(), from, to, input.modifiers.command)
    });
    let brush = kit.acting(tool, false, ctrl);
    let mirror_x = document.groomer.as_ref().map_or(0.0, |groomer| groomer.document().mirror_x());
    let strength = brush.strength * pressure(ui);
    let Some(character) = renderer.show.as_mut().map(|show| &mut show.stage.character) else { return false };
    let head = character.head();
    let hair = character.hair_mut();
    let Some(ray) = to.filter(|_| is_down) else {
        hair.release();
        return false;
    };
    let done = match (motion_effect(&brush), from) {
        (Some(effect), _) => {
            let mirror = (head.point(Vec3::X * mirror_x), head.rotation * Vec3::X);
            let mirror = brush.mirror.then_some(mirror);
            let (radius, root_tip) = (brush.radius, brush.root_tip);
            hair.brush(&MotionBrush { effect, radius, strength, root_tip, mirror }, &ray)
        }
        (None, Some(from)) if pressed => hair.grab(&from, brush.radius),
        _ => hair.drag_to(&GrabTarget::Ray(ray)),
    };
    if let Err(error) = done {
        messages.fail(error);
    }
    ui.ctx().request_repaint();
    true
}

/// Returns the effect of `brush` on moving hair; `None` for a grab.
fn motion_effect(brush: &Brush) -> Option<BrushEffect> {
    match (brush.acts(), brush.inverted) {
        (BrushTool::Puff, _) => Some(BrushEffect::Puff),
        (BrushTool::Lay, _) => Some(BrushEffect::Lay),
        (BrushTool::Pinch, _) => Some(BrushEffect::Pinch),
        (BrushTool::Spread, _) => Some(BrushEffect::Spread),
        (BrushTool::Blow, false) => Some(BrushEffect::Blow),
        (BrushTool::Blow, true) => Some(BrushEffect::Draw),
        (BrushTool::Grab, _) => None,
        _ => Some(BrushEffect::Comb),
    }
}

/// Returns the pressure of the pen or finger; 1 for a mouse, and for hardware that does not tell.
fn pressure(ui: &Ui) -> f32 {
    let force = |event: &Event| match event {
        Event::Touch { force, phase: TouchPhase::Start | TouchPhase::Move, .. } => *force,
        _ => None,
    };
    #[cfg(target_arch = "wasm32")]
    let pen = crate::pen::pressure();
    #[cfg(not(target_arch = "wasm32"))]
    let pen = None;
    // The least lets a pen begin a stroke.
    pen.or_else(|| ui.input(|input| input.events.iter().rev().find_map(force)))
        .filter(|force| *force > 0.0)
        .map_or(1.0, |force| force.clamp(0.1, 1.0))
}

/// Paints the line or the outline of a cut, and its mirror image.
fn cut_path(
    groomer: &Groomer,
    (tool, mirror): (BrushTool, bool),
    projection: ViewportProjection<'_>,
    painter: &Painter,
) {
    let distance =
        (projection.renderer.orbit.camera().eye - projection.renderer.orbit.camera().target).length();
    let mirror_x = groomer.document().mirror_x();
    for flip in [false, true].into_iter().take(1 + usize::from(mirror)) {
        let point = |sample: &StrokeSample| {
            let p = sample.origin + sample.direction * distance;
            projection.project(if flip { Vec3::new(2.0 * mirror_x - p.x, p.y, p.z) } else { p })
        };
        let points: Vec<Pos2> = groomer.editor().drawn().iter().filter_map(point).collect();
        let color = if flip { theme::QUIET } else { Color32::WHITE };
        for (width, color) in [(3.0, Color32::from_black_alpha(140)), (1.5, color)] {
            let stroke = Stroke::new(width, color);
            painter.add(match tool {
                BrushTool::Lasso => Shape::closed_line(points.clone(), stroke),
                _ => Shape::line(points.clone(), stroke),
            });
        }
    }
}

/// Paints values from -1 to 1 at the roots of guides, given with the normals of the skin: from blue over white to
/// orange, which color-blind people can tell apart.
fn dots(
    guides: &[(Vec3, Vec3, f32)],
    (projection, direction): (ViewportProjection<'_>, Vec3),
    painter: &Painter,
) {
    for (root, _, value) in guides.iter().filter(|(_, normal, _)| normal.dot(direction) < 0.0) {
        let end = match *value < 0.0 {
            true => Color32::from_rgb(0x2b, 0x7b, 0xe0),
            false => Color32::from_rgb(0xf0, 0x8a, 0x1d),
        };
        if let Some(at) = projection.project(*root) {
            painter.circle_filled(at, 3.0, Color32::from_black_alpha(140));
            painter.circle_filled(at, 2.2, Color32::WHITE.lerp_to_gamma(end, value.abs()));
        }
    }
}

/// Paints guides that the stroke plants, and the roots that it removes.
fn root_marks(groomer: &Groomer, projection: ViewportProjection<'_>, painter: &Painter) {
    let (planted, removed) = groomer.editor().root_marks();
    for line in planted {
        let points: Vec<Pos2> = line.iter().filter_map(|p| projection.project(*p)).collect();
        painter.add(Shape::line(points, Stroke::new(1.0, theme::ACCENT)));
    }
    for at in removed.into_iter().filter_map(|root| projection.project(root)) {
        painter.circle_filled(at, 1.5, theme::ALARM);
    }
}

/// Paints the brush at the pointer: a ring in the plane of the image, with an inner ring where the effect is half, and
/// its mirror image. Returns whether there is hair or skin under it.
pub fn ring(
    tool: BrushTool,
    kit: &BrushKit,
    live: bool,
    document: &Document,
    projection: ViewportProjection<'_>,
    painter: &Painter,
    response: &Response,
) -> bool {
    let Some(groomer) = &document.groomer else { return false };
    let Some(sample) = response.hover_pos().and_then(|at| projection.sample(at, 1.0)) else { return false };
    let brush = kit.brush(tool);
    if tool.draws() {
        cut_path(groomer, (tool, brush.mirror), projection, painter);
        return true;
    }
    let at = match groomer.editor().brush_at() {
        Some((at, radius)) => Some((at, radius)),
        None => groomer
            .editor()
            .hit(tool, &sample)
            // Moving hair may be anywhere.
            .or_else(|| live.then(|| projection.renderer.orbit.camera().distance()))
            .map(|depth| (sample.origin + sample.direction * depth, brush.radius)),
    };
    let Some((center, radius)) = at else { return false };
    root_marks(groomer, projection, painter);
    let guides: Vec<(Vec3, Vec3, f32)> = match tool {
        // From a fifth to five times.
        BrushTool::Stiffness => {
            let normalized = |stiffness: f32| (stiffness.max(1e-3).ln() / 5f32.ln()).clamp(-1.0, 1.0);
            let all = groomer.editor().stiffness().into_iter();
            all.map(|(root, normal, stiffness)| (root, normal, normalized(stiffness))).collect()
        }
        BrushTool::Clump | BrushTool::Curl | BrushTool::Frizz => groomer.editor().amounts(tool),
        BrushTool::Hold => {
            let held = groomer.editor().held().filter(|(.., held)| *held);
            held.map(|(root, normal, _)| (root, normal, 1.0)).collect()
        }
        _ => Vec::new(),
    };
    dots(&guides, (projection, sample.direction), painter);
    let right = sample.direction.cross(Vec3::Y).normalize_or(Vec3::X);
    let up = right.cross(sample.direction);
    let mirror_x = groomer.document().mirror_x();
    let mirrored = |p: Vec3| Vec3::new(2.0 * mirror_x - p.x, p.y, p.z);
    let circle = |radius: f32, flip: bool| -> Option<Vec<Pos2>> {
        let point = |i: usize| {
            let angle = std::f32::consts::TAU * i as f32 / RING as f32;
            let p = center + (right * angle.cos() + up * angle.sin()) * radius;
            projection.project(if flip { mirrored(p) } else { p })
        };
        (0..RING).map(point).collect()
    };
    // (1 − x²)² is a half at 0.54 radii.
    for (scale, width, flip) in [(1.0, 1.5, false), (0.54, 0.8, false), (1.0, 0.8, true)] {
        if flip && !brush.mirror {
            continue;
        }
        if let Some(points) = circle(scale * radius, flip) {
            let color = if flip { theme::QUIET } else { Color32::WHITE };
            painter.add(Shape::closed_line(
                points.clone(),
                Stroke::new(width + 1.5, Color32::from_black_alpha(140)),
            ));
            painter.add(Shape::closed_line(points, Stroke::new(width, color)));
        }
    }
    true
}
