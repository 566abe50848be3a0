//! Handles of the lights in the viewport: an icon at the place of each light, which a drag moves.

use crate::{
    document::Document,
    light_placement::{HandleDrag, LightPart, LightStage},
    orbit::Orbit,
    theme,
};
use eframe::egui::{Color32, CursorIcon, Id, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, vec2};
use tresses::glam;
use tresses_scene::settings::{LightEntry, LightKind};

/// Radius of a handle's icon, points.
const ICON: f32 = 7.0;
/// Radius of the handles of targets and ends, points.
const DOT: f32 = 4.0;

/// The lights in the viewport.
#[derive(Debug, Default)]
pub struct LightHandles {
    /// Index of the selected light.
    pub selected: Option<usize>,
    /// The drag that is under way.
    drag: Option<ActiveDrag>,
    /// Places of the handles of the lights in the window, points; `None` behind the camera.
    pub places: Vec<Option<Pos2>>,
}

/// A drag of a handle.
#[derive(Debug)]
struct ActiveDrag {
    index: usize,
    part: LightPart,
    /// The light before the drag.
    before: LightEntry,
    drag: HandleDrag,
    /// Last position of the pointer.
    pointer: Pos2,
}

impl LightHandles {
    /// Shows the handles over the viewport at `rect`, and moves the light whose handle is dragged.
    pub fn show(&mut self, orbit: &Orbit, document: &mut Document, ui: &Ui, rect: Rect) {
        let list = &document.settings.now().lights.list;
        let mut starts = false;
        self.selected = self.selected.filter(|selected| *selected < list.len());
        let stage = LightStage::of(orbit);
        let painter = ui.painter_at(rect);
        let project = |point: glam::Vec3| {
            let at = orbit.project(point)?;
            let half = 0.5 * rect.size();
            Some(rect.center() + vec2(half.x * at.x, -half.y * at.y))
        };
        let inner = rect.shrink(2.0 * ICON);
        let mut moved = None;
        self.places.clear();
        for (index, light) in list.iter().enumerate() {
            self.places.push(project(stage.handle(light, LightPart::Body)).map(|at| inner.clamp(at)));
            let is_selected = self.selected == Some(index);
            lines(light, is_selected, project, &painter);
            for part in parts(light, is_selected) {
                let point = stage.handle(light, part);
                // The handle of a light beside the view is at the edge.
                let Some(at) = project(point).map(|at| inner.clamp(at)) else { continue };
                let size = if part == LightPart::Body { ICON } else { DOT };
                let area = Rect::from_center_size(at, Vec2::splat(2.0 * size + 6.0));
                let response = ui.interact(area, Id::unique(("light", index, part)), Sense::click_and_drag());
                let is_hovered = response.hovered() || response.dragged();
                match part {
                    LightPart::Body => icon(light, at, is_selected, is_hovered, &painter),
                    _ => dot(at, is_hovered, &painter),
                }
                if response.clicked() || response.drag_started() {
                    self.selected = Some(index);
                }
                let pointer = ui.input(|input| input.pointer.latest_pos());
                if response.drag_started() {
                    // Start at the press: egui recognizes a drag only after a few points.
                    let pointer = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
                    let (before, drag) = (light.clone(), HandleDrag::default());
                    starts = true;
                    self.drag = Some(ActiveDrag { index, part, before, drag, pointer });
                }
                let own = |it: &&mut ActiveDrag| (it.index, it.part) == (index, part) && response.dragged();
                if let Some(it) = self.drag.as_mut().filter(own) {
                    it.move_to(pointer.unwrap_or(it.pointer), ui.input(|input| input.modifiers.shift));
                    let depth = orbit.depth(stage.handle(&it.before, part));
                    let meters = orbit.height_at(depth) / rect.height().max(1.0);
                    moved = Some((index, stage.dragged(&it.before, part, it.drag, meters)));
                }
                if is_hovered {
                    let held = response.dragged();
                    ui.ctx().set_cursor_icon(if held { CursorIcon::Grabbing } else { CursorIcon::Grab });
                }
                if !response.dragged() {
                    response.on_hover_text(help(light, index, part));
                }
            }
        }
        if !ui.input(|input| input.pointer.any_down()) {
            self.drag = None;
        }
        if let Some((index, light)) = moved {
            let mut settings = document.settings.now().clone();
            settings.lights.list[index] = light;
            if starts {
                // Each drag is an undo step.
                document.settings.settle();
            }
            document.change(settings, "Move light");
        }
    }

    /// Hides the handles.
    pub fn hide(&mut self) {
        self.places.clear();
        self.drag = None;
    }
}

impl ActiveDrag {
    /// Follows the pointer: in the plane of the view, or `away` from the camera for a pointer that moves up.
    fn move_to(&mut self, pointer: Pos2, away: bool) {
        let by = pointer - self.pointer;
        self.pointer = pointer;
        if away {
            self.drag.away -= by.y;
        } else {
            self.drag.across += glam::Vec2::new(by.x, by.y);
        }
    }
}

/// Returns the parts of `light` that have handles.
fn parts(light: &LightEntry, is_selected: bool) -> Vec<LightPart> {
    let mut parts = vec![LightPart::Body];
    if is_selected && light.kind.is_aimed() {
        parts.push(LightPart::Target);
    } else if is_selected && light.kind == LightKind::Tube {
        parts.extend([LightPart::End(0), LightPart::End(1)]);
    }
    parts
}

/// Returns the name of a light for people. `index` counts from 0.
pub fn title(light: &LightEntry, index: usize) -> String {
    match light.name.as_str() {
        "" => {
            let name =
                if light.kind == LightKind::Disc && light.hole > 0.0 { "ring" } else { light.kind.name() };
            format!("{}{} {}", name[..1].to_uppercase(), &name[1..], index + 1)
        }
        name => name.into(),
    }
}

fn help(light: &LightEntry, index: usize, part: LightPart) -> String {
    let title = title(light, index);
    match part {
        LightPart::Body if light.kind == LightKind::Distant => {
            format!("{title}: drag it around the head")
        }
        LightPart::Body => format!("{title}: drag to move it, with Shift towards you or away"),
        LightPart::Target => format!("Target of {title}: drag to aim it"),
        LightPart::End(_) => format!("End of {title}: drag to move it"),
    }
}

fn color(light: &LightEntry) -> Color32 {
    let [r, g, b] = light.color;
    if light.is_on { Color32::from_rgb(r, g, b) } else { Color32::from_rgb(r / 3, g / 3, b / 3) }
}

/// Draws the line to the target of a selected light, and the axis of a tube.
fn lines(
    light: &LightEntry,
    is_selected: bool,
    project: impl Fn(glam::Vec3) -> Option<Pos2>,
    painter: &Painter,
) {
    let (ends, stroke) = match light.kind {
        LightKind::Tube => (light.ends, Stroke::new(2.0, color(light))),
        kind if kind.is_aimed() && is_selected => {
            ([light.position, light.target], Stroke::new(1.0, theme::ACCENT.gamma_multiply(0.7)))
        }
        _ => return,
    };
    if let [Some(from), Some(to)] = ends.map(project) {
        painter.line_segment([from, to], Stroke::new(stroke.width + 1.5, Color32::from_black_alpha(120)));
        painter.line_segment([from, to], stroke);
    }
}

fn dot(at: Pos2, is_hovered: bool, painter: &Painter) {
    let radius = if is_hovered { DOT + 1.0 } else { DOT };
    painter.circle(at, radius, theme::ACCENT, Stroke::new(1.5, Color32::from_black_alpha(160)));
}

/// Draws the icon of a light: rays around a distant light, and the outline of the shape of others.
fn icon(light: &LightEntry, at: Pos2, is_selected: bool, is_hovered: bool, painter: &Painter) {
    let fill = color(light);
    let edge = if is_selected { theme::ACCENT } else { Color32::from_black_alpha(180) };
    let stroke = Stroke::new(if is_hovered || is_selected { 2.0 } else { 1.5 }, edge);
    let radius = if is_hovered { ICON + 1.0 } else { ICON };
    match light.kind {
        LightKind::Distant => {
            for i in 0..8 {
                let along = Vec2::angled(i as f32 * std::f32::consts::FRAC_PI_4);
                painter
                    .line_segment([at + radius * along, at + (radius + 4.0) * along], Stroke::new(2.0, fill));
            }
            painter.circle(at, 0.7 * radius, fill, stroke);
        }
        LightKind::Rectangle => {
            let area = Rect::from_center_size(at, Vec2::splat(1.8 * radius));
            painter.rect(area, 2.0, fill, stroke, eframe::egui::StrokeKind::Outside);
        }
        LightKind::Spot => {
            let corners = [vec2(0.0, -1.1), vec2(1.0, 0.8), vec2(-1.0, 0.8)];
            let corners = corners.map(|corner| at + radius * corner).to_vec();
            painter.add(Shape::convex_polygon(corners, fill, stroke));
        }
        LightKind::Disc if light.hole > 0.0 => {
            painter.circle_stroke(at, 0.8 * radius, Stroke::new(5.0, edge));
            painter.circle_stroke(at, 0.8 * radius, Stroke::new(3.0, fill));
        }
        LightKind::Tube => {
            let area = Rect::from_center_size(at, vec2(1.8 * radius, 0.9 * radius));
            painter.rect(area, 4.0, fill, stroke, eframe::egui::StrokeKind::Outside);
        }
        LightKind::Point | LightKind::Disc | LightKind::Sphere => {
            painter.circle(at, radius, fill, stroke);
            if light.kind == LightKind::Point {
                painter.circle_filled(at, 1.5, Color32::from_black_alpha(180));
            }
        }
    }
    if !light.is_on {
        let across = vec2(radius, -radius);
        painter.line_segment([at - across, at + across], Stroke::new(2.0, theme::ALARM));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn shift_drags_in_depth() {
        let mut drag = ActiveDrag {
            index: 0,
            part: LightPart::Body,
            before: LightEntry::default(),
            drag: HandleDrag::default(),
            pointer: pos2(10.0, 10.0),
        };
        drag.move_to(pos2(14.0, 5.0), false);
        drag.move_to(pos2(20.0, 2.0), true);
        assert_eq!((drag.drag.across, drag.drag.away), (glam::Vec2::new(4.0, -5.0), 3.0));
    }

    #[test]
    fn lights_without_names_have_titles() {
        let tube = LightEntry::new(LightKind::Tube);
        assert_eq!(title(&tube, 2), "Tube 3");
        assert_eq!(title(&LightEntry { hole: 0.1, ..LightEntry::new(LightKind::Disc) }, 0), "Ring 1");
        assert_eq!(title(&LightEntry { name: "Window".into(), ..tube.clone() }, 2), "Window");
        assert_eq!((parts(&tube, false).len(), parts(&tube, true).len()), (1, 3));
    }
}
