//! The list of lights in the section *Lights* of the parameters.

use crate::{
    light_handles::title,
    light_placement::LightStage,
    panels::{
        format::{NAME_WIDTH, short},
        icons::{self, Icon},
    },
    theme,
};
use eframe::egui::{ComboBox, DragValue, Label, RichText, TextEdit, Ui, vec2};
use tresses::glam::Vec3;
use tresses_scene::{
    knobs::{
        Unit,
        light_list::{LightField, LightFieldKind, fields},
    },
    settings::{LightEntry, LightKind},
};

/// Keys that the line of a light shows; the others are below it.
const LINE: [&str; 3] = ["on", "color", "intensity"];

/// Range that a light gets when it is limited, meters.
const RANGE: f32 = 2.0;

/// A change of the list.
#[derive(Debug, PartialEq)]
pub struct ListChange {
    /// The new list.
    pub list: Vec<LightEntry>,
    /// Name of the undo step.
    pub label: &'static str,
}

/// Shows the list, with the values of the `selected` light. Returns the changed list.
pub fn show(
    list: &[LightEntry],
    selected: &mut Option<usize>,
    stage: &LightStage,
    ui: &mut Ui,
) -> Option<ListChange> {
    let mut new = list.to_vec();
    let mut label = None;
    for (index, light) in list.iter().enumerate() {
        ui.push_id(("light", index), |ui| match line(light, index, selected, ui) {
            Some(Some(changed)) => (new[index], label) = (changed, Some("Light")),
            Some(None) => {
                new.remove(index);
                *selected = None;
                label = Some("Remove light");
            }
            None => {}
        });
        if label.is_none() && *selected == Some(index) {
            let changed = ui.push_id(("values", index), |ui| values(light, stage, ui)).inner;
            if let Some(changed) = changed {
                (new[index], label) = (changed, Some("Light"));
            }
        }
        if label == Some("Remove light") {
            break;
        }
    }
    ui.menu_button("Add light", |ui| {
        let mut add = |name: &str, light: &dyn Fn() -> LightEntry, ui: &mut Ui| {
            if ui.button(name).clicked() {
                new.push(light());
                *selected = Some(list.len());
                label = Some("Add light");
                ui.close();
            }
        };
        for kind in LightKind::ALL {
            let name = kind.name();
            let name = format!("{}{}", name[..1].to_uppercase(), &name[1..]);
            add(&name, &|| stage.new_light(kind), ui);
            if kind == LightKind::Disc {
                add("Ring", &|| stage.new_ring(), ui);
            }
        }
    })
    .response
    .on_hover_text("Adds a light in front of the upper left of the head. Drag its handle in the view.");
    label.map(|label| ListChange { list: new, label })
}

/// Shows the line of a light. Returns the changed light, or `Some(None)` if it is removed.
fn line(
    light: &LightEntry,
    index: usize,
    selected: &mut Option<usize>,
    ui: &mut Ui,
) -> Option<Option<LightEntry>> {
    let mut changed = light.clone();
    let mut removed = false;
    ui.horizontal(|ui| {
        ui.checkbox(&mut changed.is_on, "").on_hover_text("On");
        let size = vec2(NAME_WIDTH - 28.0, ui.spacing().interact_size.y);
        let is_selected = *selected == Some(index);
        let name = ui.allocate_ui(size, |ui| {
            ui.set_min_width(size.x);
            ui.selectable_label(is_selected, title(light, index)).on_hover_text("Shows its values")
        });
        if name.inner.clicked() {
            *selected = (!is_selected).then_some(index);
        }
        for field in fields(light.kind).filter(|field| ["color", "intensity"].contains(&field.key)) {
            widget(field, &mut changed, ui);
        }
        removed = icons::small(ui, Icon::Cross).on_hover_text("Remove the light").clicked();
    });
    if removed {
        return Some(None);
    }
    (changed != *light).then(|| accepted(changed)).flatten().map(Some)
}

/// Shows the values of a light below its line. Returns the changed light.
fn values(light: &LightEntry, stage: &LightStage, ui: &mut Ui) -> Option<LightEntry> {
    let mut changed = light.clone();
    let mut kind = light.kind;
    row("Shape", "Shape of the light; another one keeps its place", ui, |ui| {
        ComboBox::from_id_salt("shape").selected_text(kind.name()).show_ui(ui, |ui| {
            for each in LightKind::ALL {
                ui.selectable_value(&mut kind, each, each.name());
            }
        });
    });
    if kind != light.kind {
        return accepted(stage.reshaped(light, kind));
    }
    for field in fields(light.kind).filter(|field| !LINE.contains(&field.key)) {
        row(field.label, field.hint, ui, |ui| widget(field, &mut changed, ui));
    }
    ui.add_space(4.0);
    if changed.inner > changed.outer {
        // The angle that the user changes takes the other along.
        let is_inner = changed.inner != light.inner;
        let angle = if is_inner { changed.inner } else { changed.outer };
        (changed.inner, changed.outer) = (angle, angle);
    }
    (changed != *light).then(|| accepted(changed)).flatten()
}

/// Returns a light that is valid.
fn accepted(light: LightEntry) -> Option<LightEntry> {
    light.check().is_ok().then_some(light)
}

fn row(name: &str, hint: &str, ui: &mut Ui, show: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        let size = vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        ui.allocate_ui(size, |ui| {
            ui.set_min_width(NAME_WIDTH);
            ui.add(Label::new(RichText::new(format!("    {name}")).color(theme::TEXT)).truncate())
        })
        .response
        .on_hover_text(hint);
        show(ui);
    });
}

/// Shows the widget of a key.
fn widget(field: &LightField, light: &mut LightEntry, ui: &mut Ui) {
    match &field.kind {
        LightFieldKind::Number { unit, min, max, field: access, .. } => {
            let value = (access.get_mut)(light);
            if field.key == "range" {
                let mut is_limited = value.is_finite();
                if ui.checkbox(&mut is_limited, "").on_hover_text(field.hint).changed() {
                    *value = if is_limited { RANGE } else { f32::INFINITY };
                }
                if !is_limited {
                    ui.label(RichText::new("unlimited").color(theme::QUIET));
                    return;
                }
            }
            number(value, *unit, (*min, *max), field.hint, ui);
        }
        LightFieldKind::Position(access) => {
            let point: &mut Vec3 = (access.get_mut)(light);
            ui.spacing_mut().item_spacing.x = 3.0;
            for (coordinate, name) in
                [&mut point.x, &mut point.y, &mut point.z].into_iter().zip(["x", "y", "z"])
            {
                let meters = Unit { symbol: "", si: 1.0 };
                number(coordinate, meters, (-1000.0, 1000.0), &format!("{name}, meters"), ui);
            }
        }
        LightFieldKind::Color(access) => {
            ui.color_edit_button_srgb((access.get_mut)(light)).on_hover_text(field.hint);
        }
        LightFieldKind::Toggle(access) => {
            ui.checkbox((access.get_mut)(light), "").on_hover_text(field.hint);
        }
        LightFieldKind::Text(access) => text((access.get_mut)(light), field.hint, ui),
    }
}

/// Shows a number; a drag changes it by a hundredth of its size per point.
fn number(value: &mut f32, unit: Unit, (min, max): (f64, f64), hint: &str, ui: &mut Ui) {
    let mut shown = unit.shown(*value);
    let before = short(shown);
    let size = shown.abs();
    let least = if unit.symbol == "°" { 0.25 } else { 0.001 };
    let drag = DragValue::new(&mut shown)
        .range(min..=max)
        .speed((0.01 * size).max(least))
        .update_while_editing(false)
        // Do not round: showing a value must not change it.
        .max_decimals(17)
        .custom_formatter(|shown, _| short(shown))
        .suffix(match unit.symbol {
            "" | "°" => unit.symbol.to_owned(),
            symbol => format!(" {symbol}"),
        });
    let response = ui.add(drag).on_hover_text(hint);
    // After focus without an edit, the widget returns its text, which has fewer digits.
    if response.changed() && (response.dragged() || short(shown) != before) {
        *value = unit.inner(shown);
    }
}

/// Shows a text, which changes once the user leaves the field.
fn text(value: &mut String, hint: &str, ui: &mut Ui) {
    let id = ui.scope_id().with("text");
    let mut edited = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| value.clone());
    let response = ui.add(TextEdit::singleline(&mut edited).desired_width(140.0)).on_hover_text(hint);
    if response.lost_focus() {
        *value = edited.split_whitespace().collect::<Vec<_>>().join(" ");
    }
    // Both would lock the context.
    let has_focus = response.has_focus();
    ui.data_mut(|data| {
        if has_focus {
            data.insert_temp(id, edited);
        } else {
            data.remove::<String>(id);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::Orbit;
    use eframe::egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, pos2};
    use tresses_scene::camera::Angle;

    fn stage() -> LightStage {
        let subject = (Vec3::new(-0.15, -0.2, -0.15), Vec3::new(0.15, 0.2, 0.15));
        LightStage::of(&Orbit::new(Angle::Front, subject))
    }

    /// A panel without a window.
    struct Panel {
        context: Context,
        list: Vec<LightEntry>,
        selected: Option<usize>,
        labels: Vec<&'static str>,
    }

    impl Panel {
        fn new(list: Vec<LightEntry>) -> Self {
            Self { context: Context::default(), list, selected: None, labels: Vec::new() }
        }

        /// Shows a frame with these events. Returns all texts and their places.
        fn frame(&mut self, events: Vec<Event>) -> Vec<(String, Rect)> {
            let screen = Rect::from_min_size(Pos2::ZERO, vec2(420.0, 900.0));
            let input = RawInput { screen_rect: Some(screen), events, ..Default::default() };
            let Self { context, list, selected, labels } = self;
            let mut output = context.clone().run_ui(input, |ui| {
                if let Some(change) = show(list, selected, &stage(), ui) {
                    assert_ne!(change.list, *list, "{}", change.label);
                    *list = change.list;
                    labels.push(change.label);
                }
            });
            output.textures_delta.clear();
            let text = |shape: &eframe::egui::epaint::ClippedShape| match &shape.shape {
                eframe::egui::Shape::Text(text) => {
                    Some((text.galley.text().to_owned(), text.visual_bounding_rect()))
                }
                _ => None,
            };
            output.shapes.iter().filter_map(text).collect()
        }

        fn click(&mut self, at: Pos2) {
            let button = |pressed| Event::PointerButton {
                pos: at,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            };
            self.frame(vec![Event::PointerMoved(at)]);
            self.frame(vec![button(true)]);
            self.frame(vec![button(false)]);
            self.frame(Vec::new());
        }

        fn click_text(&mut self, text: &str) {
            let shown = self.frame(Vec::new());
            let found = shown.iter().find(|(found, _)| found.trim() == text);
            let at = found.unwrap_or_else(|| panic!("{text} is not in {shown:?}")).1.center();
            self.click(at);
        }
    }

    #[test]
    fn showing_lights_keeps_their_values() {
        let mut list: Vec<_> = LightKind::ALL.map(|kind| stage().new_light(kind)).into();
        list[1].position = Vec3::new(0.123_456_79, 1.0 / 3.0, -0.7);
        list[2].range = 2.345_678;
        let mut panel = Panel::new(list.clone());
        for selected in 0..list.len() {
            panel.selected = Some(selected);
            for _ in 0..3 {
                panel.frame(Vec::new());
            }
        }
        assert!(panel.list == list && panel.labels.is_empty(), "{:?}", panel.labels);
    }

    #[test]
    fn lights_are_added_selected_and_removed() {
        let mut panel = Panel::new(Vec::new());
        panel.click_text("Add light");
        panel.click_text("Ring");
        assert_eq!((panel.labels.clone(), panel.selected), (vec!["Add light"], Some(0)));
        assert!(panel.list[0].kind == LightKind::Disc && panel.list[0].hole > 0.0);
        // The values of the selected light are shown, with those of its shape only.
        let keys: Vec<_> =
            panel.frame(Vec::new()).into_iter().map(|(text, _)| text.trim().to_owned()).collect();
        assert!(keys.contains(&"Hole".into()) && !keys.contains(&"Roll".into()), "{keys:?}");
        panel.click_text("Add light");
        panel.click_text("Point");
        assert_eq!((panel.list.len(), panel.selected), (2, Some(1)));
        panel.click_text("Ring 1");
        assert_eq!(panel.selected, Some(0));
        let (_, name) = panel.frame(Vec::new()).into_iter().find(|(text, _)| text == "Ring 1").unwrap();
        // The checkbox is to the left of the name.
        panel.click(pos2(name.left() - 18.0, name.center().y));
        assert!(!panel.list[0].is_on && panel.list[1].is_on, "{:?}", panel.labels);
        let before = panel.list[1].clone();
        let width = (name.right() as i32..420).step_by(4).map(|x| pos2(x as f32, name.center().y));
        for at in width.rev() {
            if panel.list.len() == 2 {
                panel.click(at);
            }
        }
        assert_eq!(panel.list, [before]);
        assert_eq!(panel.labels.last(), Some(&"Remove light"));
    }

    #[test]
    fn shape_is_chosen_from_a_list() {
        let mut panel = Panel::new(vec![stage().new_light(LightKind::Point)]);
        panel.selected = Some(0);
        panel.click_text("point");
        panel.click_text("spot");
        assert_eq!((panel.list[0].kind, panel.labels.clone()), (LightKind::Spot, vec!["Light"]));
        assert_eq!(panel.list[0].position, stage().new_light(LightKind::Point).position);
    }
}
