//! Cards: options of a bake, the levels with their accuracy, and the file.

use crate::{
    cards::{CardForm, CardPreview},
    dialog::Dialogs,
    document::Document,
    messages::Messages,
    renderer::StudioRenderer,
    theme,
};
use eframe::egui::{ComboBox, DragValue, Grid, RichText, ScrollArea, Slider, TextEdit, Ui};
use tresses::groom::cards::{CardLevel, CardOptions};
use tresses_scene::words::grouped;

/// Sizes of textures to choose from, texels.
const SIZES: [u32; 5] = [512, 1024, 2048, 4096, 8192];

/// Shows the page.
pub fn show(
    form: &mut CardForm,
    document: &mut Document,
    renderer: &mut StudioRenderer,
    dialogs: &Dialogs,
    messages: &mut Messages,
    ui: &mut Ui,
) {
    ScrollArea::vertical().id_salt("cards").auto_shrink(false).show(ui, |ui| {
        let options = choices(form, ui);
        let works = document.job.is_some();
        match options {
            Err(error) => {
                ui.label(RichText::new(error.to_string()).color(theme::ALARM));
            }
            Ok(options) => {
                ui.add_enabled_ui(!works && document.shown.is_some(), |ui| {
                    let help = "Takes about 20 seconds for 20,000 strands";
                    if ui.button("Bake").on_hover_text(help).clicked() {
                        document.bake(options, messages);
                    }
                });
            }
        }
        let Some(preview) = &mut renderer.cards else { return };
        ui.separator();
        let Some(show) = &mut renderer.show else { return };
        let mut level = preview.chain().shown();
        levels(preview, &mut level, ui);
        if level != preview.chain().shown() {
            preview.by_size = false;
            show.give_up();
            renderer.dirty |= preview.show(show, level);
        }
        ui.add_space(6.0);
        let help = "Shows the coarsest level that may replace the strands at this size";
        let text = format!("Level for this size, {:.0} pixels", show.hair_size());
        renderer.dirty |= ui.checkbox(&mut preview.by_size, text).on_hover_text(help).changed();
        let mut distance = renderer.orbit.camera().distance();
        let slider = Slider::new(&mut distance, 0.2..=40.0)
            .logarithmic(true)
            .custom_formatter(|meters, _| format!("{meters:.2}"))
            .suffix(" m")
            .text("Distance");
        if ui.add(slider).changed() {
            renderer.orbit.set_distance(distance);
            renderer.dirty = true;
        }
        ui.add_space(6.0);
        let help = "All levels and textures, with the body and its skeleton";
        if ui.button("Save .glb").on_hover_text(help).clicked() {
            match preview.baked.glb(document.settings.now()) {
                Ok(bytes) => dialogs.save("Save cards", "hair.glb", bytes),
                Err(error) => messages.fail(error),
            }
        }
        for note in &preview.chain().cards.notes {
            ui.add_space(4.0);
            ui.label(RichText::new(note).color(theme::ACCENT));
        }
    });
}

/// Shows the options, and returns them.
fn choices(form: &mut CardForm, ui: &mut Ui) -> anyhow::Result<CardOptions> {
    Grid::new("card options").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        let title = |ui: &mut Ui, name: &str| ui.label(RichText::new(name).color(theme::QUIET));
        title(ui, "Levels");
        let help =
            "Number of cards of each level, falling; helmet at the end adds an opaque shell for far heads";
        ui.add(TextEdit::singleline(&mut form.levels).desired_width(170.0)).on_hover_text(help);
        ui.end_row();
        title(ui, "Texture");
        let help = "Edge of the textures, which all levels share";
        let choice = ComboBox::from_id_salt("texture").selected_text(form.texture.to_string()).width(80.0);
        choice
            .show_ui(ui, |ui| {
                for size in SIZES {
                    ui.selectable_value(&mut form.texture, size, size.to_string());
                }
            })
            .response
            .on_hover_text(help);
        ui.end_row();
        title(ui, "Bones");
        let help = "Chains of bones in the file, for spring bones of engines; 32 suit long hair";
        ui.add(DragValue::new(&mut form.bones).range(0..=CardOptions::MAX_CHAINS)).on_hover_text(help);
        ui.end_row();
    });
    form.options()
}

/// Shows strands and levels to choose from.
fn levels(preview: &CardPreview, shown: &mut Option<usize>, ui: &mut Ui) {
    let quiet = |text: String| RichText::new(text).color(theme::QUIET);
    Grid::new("card levels").num_columns(4).spacing([14.0, 4.0]).show(ui, |ui| {
        ui.label("");
        for (title, help) in [
            ("Triangles", "Triangles of the level"),
            ("Agrees", "Agreement of its opacity with that of the strands, seen from 14 sides (soft IoU)"),
            ("Below", "Size of the hair, in pixels, below which the level may replace the strands"),
        ] {
            ui.label(quiet(title.into()).small()).on_hover_text(help);
        }
        ui.end_row();
        ui.radio_value(shown, None, "Strands")
            .on_hover_text(format!("{} strands", grouped(preview.baked.strands as u64)));
        ui.end_row();
        for (i, level) in preview.chain().cards.levels.iter().enumerate() {
            let can = preview.chain().can_show(i);
            ui.add_enabled_ui(can, |ui| {
                let help = "A helmet is only in the file";
                ui.radio_value(shown, Some(i), level.name()).on_disabled_hover_text(help);
            });
            ui.label(grouped(level.mesh.triangles.len() as u64));
            ui.label(format!("{:.0} %", 100.0 * level.accuracy.soft_iou));
            ui.label(below(level));
            ui.end_row();
        }
    });
}

fn below(level: &CardLevel) -> String {
    match level.accuracy.switch {
        size if size > 0.0 => format!("{size:.0} px"),
        _ => "never".into(),
    }
}
