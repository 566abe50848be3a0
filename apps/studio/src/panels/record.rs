//! Dialog that starts the recording of a loop.

use crate::{
    record::{LARGEST, LONGEST, RecordRequest},
    theme,
};
use eframe::egui::{self, Align2, ComboBox, DragValue, Grid, RichText, Ui, vec2};
use tresses_scene::picture::AnimationFormat;

/// Shows the dialog while it is `open`. Returns whether the recording of `wish` starts. The motion repeats after
/// `period` seconds.
pub fn show(open: &mut bool, wish: &mut RecordRequest, period: f64, ui: &Ui) -> bool {
    let mut starts = false;
    let window = egui::Window::new("Record a loop").collapsible(false).resizable(false);
    let window = window.anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0)).open(open);
    window.show(ui.ctx(), |ui| starts = inside(wish, period, ui));
    *open &= !starts;
    starts
}

fn inside(wish: &mut RecordRequest, period: f64, ui: &mut Ui) -> bool {
    let RecordRequest { seconds, fps, size, format } = wish;
    Grid::new("wish").num_columns(2).spacing([16.0, 6.0]).show(ui, |ui| {
        let quiet = |text: &str| RichText::new(text).color(theme::QUIET);
        ui.label(quiet("Length"));
        ui.horizontal(|ui| {
            let mut full_period = seconds.is_none();
            let help = "One period of the motion, so that the file loops";
            if ui
                .checkbox(&mut full_period, format!("One period ({period:.1} s)"))
                .on_hover_text(help)
                .changed()
            {
                *seconds = (!full_period).then_some(period);
            }
            if let Some(seconds) = seconds {
                ui.add(DragValue::new(seconds).range(0.1..=LONGEST).speed(0.05).suffix(" s"));
            }
        });
        ui.end_row();
        ui.label(quiet("Frames per second"));
        ui.add(DragValue::new(fps).range(1..=50));
        ui.end_row();
        ui.label(quiet("Size"));
        ui.horizontal(|ui| {
            ui.add(DragValue::new(&mut size[0]).range(16..=LARGEST));
            ui.label("×");
            ui.add(DragValue::new(&mut size[1]).range(16..=LARGEST).suffix(" pixels"));
        });
        ui.end_row();
        ui.label(quiet("File"));
        ComboBox::from_id_salt("format").selected_text(words(*format)).width(220.0).show_ui(ui, |ui| {
            for each in AnimationFormat::ALL {
                ui.selectable_value(format, *each, words(*each));
            }
        });
        ui.end_row();
    });
    ui.add_space(6.0);
    ui.button(format!("Record {} frames", wish.frames(period))).clicked()
}

fn words(format: AnimationFormat) -> &'static str {
    match format {
        #[cfg(not(target_arch = "wasm32"))]
        AnimationFormat::WebP => "WebP: small, true color",
        AnimationFormat::Gif => "GIF: shown everywhere, 256 colors",
        AnimationFormat::Apng => "APNG: lossless, large",
    }
}
