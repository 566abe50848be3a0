//! Controls of a skinned character: its animations, their time, and its morph targets.

use crate::{messages::Messages, renderer::StudioRenderer, theme};
use eframe::egui::{ComboBox, RichText, Slider, Ui};

/// Range of morph-target weights.
const WEIGHTS: std::ops::RangeInclusive<f32> = -1.0..=2.0;

/// Shows the animation and its time, if the character has any.
pub fn time(renderer: &mut StudioRenderer, messages: &mut Messages, ui: &mut Ui) {
    let Some(show) = &mut renderer.show else { return };
    let time = show.stage.character.time();
    let Some(living) = show.stage.character.rig_mut().filter(|living| living.animations().next().is_some())
    else {
        return;
    };
    let mut to = None;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Animation").color(theme::QUIET));
        let before = living.animation().map(str::to_string);
        let mut selected = before.clone();
        let choice =
            ComboBox::from_id_salt("animation").selected_text(selected.as_deref().unwrap_or("at rest"));
        let choice = choice.show_ui(ui, |ui| {
            ui.selectable_value(&mut selected, None, "at rest");
            for name in living.animations() {
                ui.selectable_value(&mut selected, Some(name.to_string()), name);
            }
        });
        choice.response.on_hover_text("Animation of the body; the motion below also turns the head");
        if selected != before {
            if let Err(error) = living.set_animation(selected.as_deref()) {
                messages.fail(error);
            }
            to = Some(0.0);
            renderer.playback.play.playing |= selected.is_some();
        }
        if let Some(length) = living.duration().filter(|length| *length > 0.0) {
            let mut at = time.rem_euclid(f64::from(length));
            ui.spacing_mut().slider_width = (ui.available_width() - 110.0).max(80.0);
            let slider = Slider::new(&mut at, 0.0..=f64::from(length)).fixed_decimals(2).suffix(" s");
            let slider = ui.add(slider).on_hover_text(format!("Time of the animation, of {length:.2} s"));
            if slider.changed() {
                to = Some(at);
            }
        }
    });
    if let Some(to) = to {
        show.stage.character.seek(to);
        renderer.dirty = true;
    }
}

/// Shows the morph targets, if the character has any.
pub fn shapes(renderer: &mut StudioRenderer, ui: &mut Ui) {
    let Some(living) = renderer.show.as_mut().and_then(|show| show.stage.character.rig_mut()) else { return };
    let names: Vec<String> = living.shapes().map(str::to_string).collect();
    if names.is_empty() {
        return;
    }
    ui.separator();
    ui.label(RichText::new("Blend shapes").strong());
    for (number, name) in names.iter().enumerate() {
        let set = living.shape(number);
        let mut weight = set.unwrap_or(0.0);
        ui.horizontal(|ui| {
            let slider = ui.add(Slider::new(&mut weight, WEIGHTS).fixed_decimals(2).text(name));
            let slider =
                slider.on_hover_text("Weight of the blend shape. Moving the slider overrides the motion.");
            if slider.changed() && living.set_shape(name, weight).is_ok() {
                renderer.dirty = true;
            }
            if set.is_some()
                && ui
                    .small_button("release")
                    .on_hover_text("Lets motions control the blend shape again")
                    .clicked()
            {
                living.free_shape(number);
                renderer.dirty = true;
            }
        });
    }
}
