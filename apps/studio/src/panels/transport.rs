//! The transport: play, step, reset, speed, and the motion.

use crate::{
    messages::Messages,
    panels::{
        body,
        icons::{self, Icon},
    },
    play::SPEEDS,
    renderer::StudioRenderer,
    theme,
};
use eframe::egui::{self, Button, DragValue, Panel, RichText, Slider, Ui};
use tresses_scene::motion::NAMES;

/// Width of the speed slider with its label, points.
const SLIDER: f32 = 250.0;

/// Shows the transport. `records`: a loop is being recorded.
pub fn show(renderer: &mut StudioRenderer, records: bool, messages: &mut Messages, ui: &mut Ui) {
    let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 7));
    Panel::bottom("transport").frame(frame).show(ui, |ui| {
        body::time(renderer, messages, ui);
        ui.horizontal(|ui| {
            let play = &mut renderer.playback.play;
            let (icon, help) = if play.playing { (Icon::Pause, "Pause") } else { (Icon::Play, "Play") };
            if icons::button(ui, icon).on_hover_text(format!("{help}\nKey Space")).clicked() {
                play.playing = !play.playing;
            }
            if icons::button(ui, Icon::Step)
                .on_hover_text("Advance by 1/60 s, then pause\nKey . (period)")
                .clicked()
            {
                play.step();
            }
            if icons::button(ui, Icon::Rewind).on_hover_text("Reset hair and motion\nKey R").clicked() {
                play.reset();
            }
            let help = "Stops the motion and renders the image at full quality, however long it takes\nKey F";
            let finish = ui.add_enabled(!records && renderer.can_finish(), Button::new("Finish image"));
            if finish.on_hover_text(help).clicked() {
                renderer.finish();
            }
            let play = &mut renderer.playback.play;
            ui.separator();
            ui.label(RichText::new("Motion").color(theme::QUIET));
            for name in NAMES {
                let help = match name {
                    "still" => "The head holds still",
                    "walk" => "A walk in place",
                    "dance" => "The whole body dances, with jaw and brows",
                    "nod" => "The head nods repeatedly",
                    "turn" => "The head turns to both sides repeatedly",
                    _ => "The head shakes repeatedly",
                };
                if ui.selectable_label(play.name == name, name).on_hover_text(help).clicked() {
                    play.set_motion(name);
                    play.playing = true;
                }
            }
            ui.separator();
            let roomy = ui.available_width() > SLIDER;
            if roomy {
                ui.label(RichText::new("Speed").color(theme::QUIET));
            }
            let slider = match roomy {
                true => ui.add(
                    Slider::new(&mut play.speed, SPEEDS).logarithmic(true).fixed_decimals(2).suffix(" ×"),
                ),
                false => ui.add(
                    DragValue::new(&mut play.speed).range(SPEEDS).speed(0.01).fixed_decimals(2).suffix(" ×"),
                ),
            };
            let slider =
                slider.on_hover_text("Simulated seconds per real second. A double click resets it to 1.");
            if slider.double_clicked() {
                play.speed = 1.0;
            }
        });
    });
}
