//! The strip below the head: the settings of the brush. Also the button that saves.

use crate::{dialog::Dialogs, document::Document, groomer::Groomer, theme};
use eframe::egui::{ComboBox, DragValue, RichText, Slider, Ui};
use tresses::groom::edit::{Brush, BrushRegion, BrushTool, CurlType, Falloff};

/// Shows the strip.
pub fn show(brush: &mut Brush, document: &Document, dialogs: &Dialogs, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        // Fields instead of sliders: the strip lies over the hair.
        ui.spacing_mut().slider_width = 0.0;
        if !brush.tool.draws() {
            let help = "Keys [ and ], or Ctrl and the wheel";
            number(&mut brush.radius, "Radius", 1e3, 1.0..=150.0, " mm", help, ui);
        }
        match brush.tool {
            BrushTool::Plant => {
                number(&mut brush.length, "Length", 1e3, 2.0..=1000.0, " mm", "Length of new hair", ui);
                let help = "New strands per square centimeter; a head of 24,000 strands has 40";
                number(&mut brush.density, "Density", 1.0, 1.0..=300.0, " /cm²", help, ui);
            }
            BrushTool::Refine => {}
            BrushTool::Curl => {
                percent(&mut brush.strength, "Strength", "Share of the full effect", ui);
                let types = [
                    (CurlType::Waves, "waves", "Loose flat waves"),
                    (CurlType::Ringlets, "ringlets", "As wide as a piece of chalk"),
                    (CurlType::Coils, "coils", "As wide as a pencil"),
                ];
                choice("Which curls", &mut brush.curls, &types, ui);
            }
            BrushTool::Color => {
                percent(&mut brush.strength, "Strength", "Share of the full effect", ui);
                ui.color_edit_button_rgb(&mut brush.color).on_hover_text("Color of the hair");
            }
            _ => percent(&mut brush.strength, "Strength", "Share of the full effect", ui),
        }
        if matches!(brush.tool, BrushTool::Plant | BrushTool::Refine) {
            let help = "Distance between guides: strands follow these";
            number(&mut brush.spacing, "Guides every", 1e3, 1.0..=50.0, " mm", help, ui);
        } else if brush.tool == BrushTool::Color
            || !(brush.tool.acts_on_roots() || brush.tool.paints() || brush.tool.draws())
        {
            let help =
                "Where along the hair the brush acts: 0 everywhere, above 0 more at the tip, below 0 more at the root";
            number(&mut brush.root_tip, "Root, tip", 1e2, -100.0..=100.0, " %", help, ui);
        }
        ui.checkbox(&mut brush.mirror, "Symmetry").on_hover_text("The brush acts on both sides of the head");
        let regions = [
            (BrushRegion::Shell, "near side", "Hair under the brush on the near side of the head"),
            (BrushRegion::Ball, "ball", "Hair in a ball around the middle of the brush"),
            (BrushRegion::Through, "through", "All hair under the brush, also on the far side"),
        ];
        choice("Which hair the brush reaches", &mut brush.region, &regions, ui);
        let help = "Falloff, share and what hair keeps; strokes as a file";
        ui.menu_button("More", |ui| more(brush, document, dialogs, ui)).response.on_hover_text(help);
    });
}

/// Shows the button that saves the groom.
pub fn save(document: &mut Document, dialogs: &Dialogs, ui: &mut Ui) {
    let Some(groomer) = &document.groomer else { return };
    if ui.button("Save…").on_hover_text("Hair and head as a .groom file, to go on later").clicked() {
        let name = document.settings.hair().source.name();
        let stem = name.split('.').next().unwrap_or("hair");
        dialogs.save("Save groom", &format!("{stem}.groom"), groomer.document().write());
        document.saves_groom();
    }
}

fn percent(value: &mut f32, name: &str, help: &str, ui: &mut Ui) {
    number(value, name, 1e2, 0.0..=100.0, " %", help, ui);
}

/// Shows a number. `factor` converts it to `unit`, in which `range` is.
fn number(
    value: &mut f32,
    name: &str,
    factor: f32,
    range: std::ops::RangeInclusive<f32>,
    unit: &str,
    help: &str,
    ui: &mut Ui,
) {
    let mut shown = *value * factor;
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(theme::QUIET)).on_hover_text(help);
        let mut changed = false;
        if ui.spacing().slider_width > 0.0 {
            let slider = Slider::new(&mut shown, range.clone()).show_value(false);
            changed = ui.add(slider).on_hover_text(help).changed();
        }
        let field = DragValue::new(&mut shown).range(range).speed(0.5).max_decimals(0).suffix(unit);
        changed |= ui.add(field).on_hover_text(help).changed();
        if changed {
            *value = shown / factor;
        }
    });
}

/// Shows values to choose from.
fn choice<T: PartialEq + Copy>(help: &str, value: &mut T, all: &[(T, &str, &str)], ui: &mut Ui) {
    let now = all.iter().find(|(each, ..)| each == value).map_or("", |(_, name, _)| name);
    let shown = ComboBox::from_id_salt(help).selected_text(now).width(86.0).show_ui(ui, |ui| {
        for (each, name, help) in all {
            ui.selectable_value(value, *each, *name).on_hover_text(*help);
        }
    });
    shown.response.on_hover_text(help);
}

/// Shows the groups of hair, of which the brush acts on one or all, and another for new hair.
fn layers(brush: &mut Brush, groomer: &Groomer, ui: &mut Ui) {
    let groups = &groomer.groups();
    let free = groups.last().map_or(1, |last| last + 1);
    let name = |layer: Option<i32>| match layer {
        None => "all hair".into(),
        Some(group) if groups.contains(&group) => format!("group {group}"),
        Some(group) => format!("new group {group}"),
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new("Layer").color(theme::QUIET));
        let shown = ComboBox::from_id_salt("layer").selected_text(name(brush.layer)).show_ui(ui, |ui| {
            for layer in std::iter::once(None).chain(groups.iter().copied().map(Some)).chain([Some(free)]) {
                ui.selectable_value(&mut brush.layer, layer, name(layer));
            }
        });
        let help = "Groups of hair, which files keep apart. The brush acts on this one, and plants in it";
        shown.response.on_hover_text(help);
    });
}

/// Shows the rare settings, and a button that saves the strokes.
fn more(brush: &mut Brush, document: &Document, dialogs: &Dialogs, ui: &mut Ui) {
    ui.spacing_mut().slider_width = 90.0;
    let falloffs = [
        (Falloff::Smooth, "smooth", "Less towards the edge"),
        (Falloff::Sharp, "sharp", "Only near the middle"),
        (Falloff::Flat, "flat", "The same everywhere under the brush"),
    ];
    ui.horizontal(|ui| {
        ui.label(RichText::new("Falloff").color(theme::QUIET));
        choice("How the effect falls off from the middle to the edge", &mut brush.falloff, &falloffs, ui);
    });
    ui.spacing_mut().slider_width = 90.0;
    percent(&mut brush.guide_fraction, "Share of hair", "Share of the hair that takes part", ui);
    percent(&mut brush.keep_shape, "Keep shape", "How far hair keeps its shape beside the brush", ui);
    let help = "Share of its distance from the skin that hair keeps, so that it is not pasted to the head";
    percent(&mut brush.keep_volume, "Keep volume", help, ui);
    if matches!(brush.tool, BrushTool::Smooth | BrushTool::Plant) {
        let help = "How far hair takes on the shape of its neighbors";
        percent(&mut brush.neighbors, "Neighbors", help, ui);
    }
    let Some(groomer) = &document.groomer else { return };
    layers(brush, groomer, ui);
    let help = "The strokes as a .jsonl file, which tresses groom --strokes applies again";
    if ui.button("Save strokes…").on_hover_text(help).clicked() {
        dialogs.save("Save strokes", "strokes.jsonl", groomer.script().write().into_bytes());
    }
}
