//! All parameters of the table in `tresses_scene::knobs`.

use crate::{
    document::Document,
    light_placement::LightStage,
    orbit::Orbit,
    panels::{
        format::{NAME_WIDTH, short},
        icons::{self, Icon},
        lights,
    },
    theme,
};
use eframe::egui::{
    self, CollapsingHeader, ComboBox, Label, RichText, ScrollArea, Sense, Slider, TextEdit, Ui,
};
use tresses_scene::{
    Settings,
    knobs::{Choice, Knob, SECTIONS, Section, SliderScale, Value, ValueKind},
};

/// Keys of the sections that are open at start, the most used.
const OPEN: [&str; 2] = ["style", "shading"];

/// Shows the search field, the parameters, and the list of lights.
pub fn show(
    document: &mut Document,
    search: &mut String,
    (orbit, selected_light): (&Orbit, &mut Option<usize>),
    ui: &mut Ui,
) {
    // Right to left: the field takes the remaining width, so the panel does not grow.
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let clear = !search.is_empty();
        if clear && ui.small_button("x").on_hover_text("Show all parameters").clicked() {
            search.clear();
        }
        let edit = TextEdit::singleline(search).id_salt("search").hint_text("Search");
        let edit = edit.desired_width(ui.available_width());
        let edit = ui.add(edit).on_hover_text("Shows parameters whose name or hint contains these words; names from Blender, Unreal, XGen and Houdini work too");
        // Drop the focus once the user clicks elsewhere, so that undo applies to the document, not to the search text.
        if edit.has_focus() && !edit.contains_pointer() && ui.input(|input| input.pointer.any_pressed()) {
            edit.surrender_focus();
        }
    });
    ui.add_space(2.0);
    let words = search.to_lowercase();
    let mut settings = document.settings.now().clone();
    let resolved = settings.resolved(document.style().as_ref());
    let mut changed = None;
    ScrollArea::vertical().id_salt("knobs").auto_shrink(false).show(ui, |ui| {
        for section in SECTIONS {
            let read = section.knobs.iter().filter(|knob| knob.is_read(&settings));
            let found = read.filter(|knob| matches(knob, section, &words));
            let (advanced, first): (Vec<_>, Vec<_>) = found.partition(|knob| knob.advanced);
            let lists_lights = section.key == "lights" && finds_lights(&words);
            if first.is_empty() && advanced.is_empty() && !lists_lights {
                continue;
            }
            // Open the sections that have matches.
            let open = (!words.is_empty()).then_some(true);
            CollapsingHeader::new(RichText::new(section_title(section, &settings)).strong())
                .id_salt(section.key)
                .default_open(OPEN.contains(&section.key))
                .open(open)
                .show_unindented(ui, |ui| {
                    for knob in first {
                        if row(knob, &mut settings, &resolved, ui) {
                            changed = Some(knob.path);
                        }
                    }
                    if !advanced.is_empty() {
                        CollapsingHeader::new(titled("Advanced", advanced.iter().copied(), &settings))
                            .id_salt((section.key, "advanced"))
                            .open(open)
                            .show_unindented(ui, |ui| {
                                for knob in advanced {
                                    if row(knob, &mut settings, &resolved, ui) {
                                        changed = Some(knob.path);
                                    }
                                }
                            });
                    }
                    if lists_lights {
                        ui.add_space(4.0);
                        let stage = LightStage::of(orbit);
                        if let Some(change) = lights::show(&settings.lights.list, selected_light, &stage, ui)
                        {
                            settings.lights.list = change.list;
                            changed = Some(change.label);
                        }
                    }
                    ui.add_space(6.0);
                })
                .header_response
                .on_hover_text(section.about);
        }
    });
    if let Some(label) = changed {
        document.change(settings, label);
    }
}

/// Whether `words`, lowercase, find the list of lights.
fn finds_lights(words: &str) -> bool {
    const TEXT: &str = "lights list of lights add light lamp point spot rectangle area disc ring sphere tube";
    words.split_whitespace().all(|word| TEXT.contains(word))
}

/// Returns the title of a section.
fn section_title(section: &Section, settings: &Settings) -> String {
    let title = titled(section.title, section.knobs.iter(), settings);
    match settings.lights.list.len() {
        count if count > 0 && section.key == "lights" => format!("{title}, {count} added"),
        _ => title,
    }
}

/// Returns a title with the number of changed parameters.
fn titled<'a>(title: &str, knobs: impl Iterator<Item = &'a Knob>, settings: &Settings) -> String {
    match knobs.filter(|knob| !knob.is_default(settings)).count() {
        0 => title.into(),
        changed => format!("{title} ({changed} changed)"),
    }
}

fn matches(knob: &Knob, section: &Section, words: &str) -> bool {
    let Knob { path, label, hint, aliases, .. } = knob;
    let text = format!("{} {path} {label} {hint} {aliases}", section.title).to_lowercase();
    words.split_whitespace().all(|word| text.contains(word))
}

/// Shows one parameter. Returns whether it has changed.
pub fn row(knob: &Knob, settings: &mut Settings, resolved: &Settings, ui: &mut Ui) -> bool {
    let value = knob.get(settings);
    let mut new = None;
    ui.horizontal(|ui| {
        let default = knob.is_default(settings);
        let color = if default { theme::TEXT } else { theme::ACCENT };
        let size = egui::vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        let name = ui
            .allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.set_min_width(NAME_WIDTH);
                let label = Label::new(RichText::new(knob.label).color(color)).truncate();
                ui.add(label.sense(Sense::click()))
            })
            .inner
            .on_hover_text(help(knob));
        if name.double_clicked() {
            new = Some(knob.default());
        }
        let shown = if value == Value::Auto { knob.get(resolved) } else { value };
        if let Some(edited) = widget(knob, shown, value == Value::Auto, ui) {
            new = Some(edited);
        }
        if !default {
            let text = format!("Reset to {}", knob.text(knob.default()));
            if icons::small(ui, Icon::Undo).on_hover_text(text).clicked() {
                new = Some(knob.default());
            }
        }
    });
    let Some(new) = new.filter(|new| *new != value) else { return false };
    // A slider's end, rounded to single precision, may exceed the range.
    let is_set = knob.set(settings, new).is_ok();
    if ["renderer.kind", "renderer.coverage"].contains(&knob.path) {
        settings.fit_renderer();
    }
    is_set
}

fn help(knob: &Knob) -> String {
    let (range, default) = (knob.range(), knob.text(knob.default()));
    format!(
        "{}\n\nAllowed: {range}. Default: {default}.\nDouble-click the name to reset it.\n{}",
        knob.hint, knob.path
    )
}

/// Shows the widget of a parameter and returns a new value. `auto` marks a value that the user has not set.
fn widget(knob: &Knob, value: Value, auto: bool, ui: &mut Ui) -> Option<Value> {
    if auto {
        ui.visuals_mut().override_text_color = Some(theme::QUIET);
    }
    // The suffix is the unit, and a mark for automatic values.
    let mark = |unit: &str| match (unit, auto) {
        ("", false) => String::new(),
        ("", true) => " auto".into(),
        ("°" | "%", false) => unit.to_owned(),
        (unit, false) => format!(" {unit}"),
        (unit, true) => format!(" {unit} auto"),
    };
    ui.spacing_mut().slider_width = (ui.available_width() - 114.0).max(40.0);
    match (knob.kind, value) {
        (ValueKind::Number { unit, min, max, scale }, Value::Number(number)) => {
            let mut shown = knob.shown(number);
            let before = short(shown);
            let slider = Slider::new(&mut shown, min..=max)
                .logarithmic(scale == SliderScale::Log)
                .smallest_positive((max * 1e-5).max(1e-9))
                // Do not round: showing a value must not change it.
                .max_decimals(17)
                .custom_formatter(|shown, _| short(shown))
                .suffix(mark(unit.symbol));
            let slider = ui.add(slider).on_hover_text(knob.hint);
            // After focus without an edit, the widget returns its text, which has fewer digits.
            let is_edited = slider.changed() && (slider.dragged() || short(shown) != before);
            is_edited.then(|| Value::Number(knob.inner(shown.clamp(min, max))))
        }
        (ValueKind::Integer { unit, min, max, step }, Value::Integer(mut number)) => {
            let slider = Slider::new(&mut number, min..=max)
                .logarithmic(max > 1000)
                .step_by(step.into())
                .suffix(mark(unit.symbol));
            ui.add(slider).on_hover_text(knob.hint).changed().then_some(Value::Integer(number))
        }
        (ValueKind::Toggle, Value::Toggle(mut on)) => {
            ui.checkbox(&mut on, "").on_hover_text(knob.hint).changed().then_some(Value::Toggle(on))
        }
        (ValueKind::Color, Value::Color(mut rgb)) => {
            let changed = ui.color_edit_button_srgb(&mut rgb).on_hover_text(knob.hint).changed();
            changed.then_some(Value::Color(rgb))
        }
        (ValueKind::Choice(choices), value) => choice(knob, choices, value, auto, ui),
        // An automatic value that is unknown, such as one stored in the file.
        (kind, _) => ui
            .button("auto")
            .on_hover_text("Value of the file or the style; click to set another")
            .clicked()
            .then(|| match kind {
                ValueKind::Number { min, max, .. } => {
                    Value::Number(knob.inner((min * max.max(0.0)).sqrt().clamp(min, max)))
                }
                ValueKind::Integer { min, .. } => Value::Integer(min),
                ValueKind::Toggle => Value::Toggle(true),
                ValueKind::Color => Value::Color([128, 96, 64]),
                ValueKind::Choice(choices) => Value::Choice(choices[0].name),
            }),
    }
}

fn choice(knob: &Knob, choices: &[Choice], value: Value, auto: bool, ui: &mut Ui) -> Option<Value> {
    let text = match value {
        Value::Choice(name) if auto => format!("{name} (auto)"),
        Value::Choice(name) => name.into(),
        _ => "auto".into(),
    };
    let mut selected = None;
    let width = (ui.available_width() - 24.0).clamp(60.0, 150.0);
    ComboBox::from_id_salt(knob.path)
        .selected_text(text)
        .width(width)
        .show_ui(ui, |ui| {
            if knob.automatic && ui.selectable_label(auto, "auto").clicked() {
                selected = Some(Value::Auto);
            }
            for Choice { name, hint } in choices {
                let label = ui.selectable_label(!auto && value == Value::Choice(name), *name);
                if label.on_hover_text(*hint).clicked() {
                    selected = Some(Value::Choice(name));
                }
            }
        })
        .response
        .on_hover_text(knob.hint);
    selected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn showing_a_parameter_keeps_its_value() {
        let settings = tresses_scene::Settings::default().resolved(Some(&Default::default()));
        let context = eframe::egui::Context::default();
        // Two frames: some widgets respond in the next frame.
        for _ in 0..2 {
            let mut output = context.run_ui(Default::default(), |ui| {
                for knob in SECTIONS.iter().flat_map(|section| section.knobs) {
                    let value = knob.get(&settings);
                    let new = ui.push_id(knob.path, |ui| widget(knob, value, false, ui)).inner;
                    assert!(new.is_none_or(|new| new == value), "{}: {value:?} to {new:?}", knob.path);
                }
            });
            // Nothing is painted.
            output.textures_delta.clear();
        }
    }

    #[test]
    fn common_parameters_are_open_at_start() {
        for key in OPEN {
            assert!(SECTIONS[..3].iter().any(|section| section.key == key), "{key}");
        }
        let seen: Vec<_> = SECTIONS.iter().filter(|section| OPEN.contains(&section.key)).collect();
        let first = seen.iter().flat_map(|section| section.knobs).filter(|knob| !knob.advanced);
        let first: Vec<_> = first.map(|knob| knob.path).collect();
        for path in ["style.strands", "style.length", "style.width", "style.curl", "shading.color"] {
            assert!(first.contains(&path), "{path}");
        }
        assert!(first.iter().all(|path| !path.ends_with("seed")), "{first:?}");
    }

    #[test]
    fn search_matches_names_and_hints() {
        let section = &SECTIONS[0];
        let knob = &section.knobs[0];
        assert!(matches(knob, section, "") && matches(knob, section, &knob.label.to_lowercase()));
        assert!(!matches(knob, section, "xyzzy"));
        assert!(
            finds_lights("") && finds_lights("add light") && finds_lights("ring") && !finds_lights("drag")
        );
        let simulation = SECTIONS.iter().find(|section| section.key == "simulation").unwrap();
        let drag = simulation.knobs.iter().find(|knob| knob.key() == "drag").unwrap();
        assert!(matches(drag, simulation, "air resistance"));
    }
}
