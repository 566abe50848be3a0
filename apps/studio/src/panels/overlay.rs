//! What lies on the picture: the palette, the views, what is being done, what went wrong.

use crate::{
    app::Studio,
    panels::{self, keys::VIEWS},
    theme,
    tool::Tool,
    viewport::plate,
};
use eframe::egui::{Align, Align2, Area, Id, Layout, Order, ProgressBar, Rect, RichText, Ui, vec2};

/// Distance from the picture's edges, points.
const GAP: f32 = 12.0;

/// What the wind's dial takes of the width and height, with room around it, points.
const DIAL: f32 = 130.0;

/// Shows all of it over the picture at `rect`.
pub fn show(studio: &mut Studio, ui: &mut Ui, rect: Rect) {
    let at = |name: &str, anchor: Align2, offset| {
        Area::new(Id::unique(("overlay", name)))
            .order(Order::Middle)
            .pivot(anchor)
            .fixed_pos(anchor.pos_in_rect(&rect.shrink(GAP)) + offset)
            .constrain_to(rect)
    };
    if studio.show.is_some() {
        at("tools", Align2::LEFT_TOP, vec2(0.0, 0.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| tools(studio, ui)));
        // The panels of grids stand at the right.
        at("views", Align2::CENTER_TOP, vec2(0.0, 0.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| views(studio, ui)));
    }
    if studio.show.is_some() {
        at("wind", Align2::LEFT_BOTTOM, vec2(0.0, 0.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| wind(studio, ui)));
    }
    if studio.job.is_some() {
        let (anchor, offset) = if studio.show.is_some() {
            (Align2::CENTER_TOP, vec2(0.0, 44.0))
        } else {
            (Align2::CENTER_CENTER, vec2(0.0, 0.0))
        };
        at("job", anchor, offset).show(ui.ctx(), |ui| plate().show(ui, |ui| job(studio, ui)));
    }
    if studio.recording.is_some() {
        at("recording", Align2::CENTER_TOP, vec2(0.0, 84.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| recording(studio, ui)));
    }
    if studio.show.is_some() && panels::legend::wanted(studio) && studio.error.is_none() {
        at("legend", Align2::CENTER_BOTTOM, vec2(0.0, 0.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| panels::legend::show(studio, ui)));
    }
    if studio.error.is_some() {
        // Beside the wind's dial, or above it where there is no room.
        let beside = rect.width() - 2.0 * DIAL;
        let (lift, width) = if beside > 320.0 { (0.0, beside) } else { (DIAL, 0.9 * rect.width()) };
        at("error", Align2::CENTER_BOTTOM, vec2(0.0, -lift)).show(ui.ctx(), |ui| {
            ui.set_max_width(width);
            plate().show(ui, |ui| error(studio, ui));
        });
    }
}

fn tools(studio: &mut Studio, ui: &mut Ui) {
    ui.with_layout(Layout::top_down_justified(Align::Center), |ui| {
        ui.set_width(64.0);
        for (tool, name, key, help) in Tool::ALL {
            let button = ui.selectable_label(studio.tool == tool, name);
            if button.on_hover_text(format!("{help}\nKey {}", key.name())).clicked() {
                studio.tool = tool;
            }
        }
        ui.separator();
        let help = "Drops a ball on the head, which rolls off through the hair\nKey B";
        if ui.button("Ball").on_hover_text(help).clicked() {
            studio.drop_ball();
        }
    });
}

fn views(studio: &mut Studio, ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (view, name, key, help) in VIEWS {
            let button = ui.selectable_label(studio.orbit.framed() == Some(view), name);
            if button.on_hover_text(format!("{help}\nKey {}", key.name())).clicked() {
                studio.orbit.frame(view);
                studio.dirty = true;
            }
        }
    });
}

fn wind(studio: &mut Studio, ui: &mut Ui) {
    let mut settings = studio.settings.now().clone();
    let camera = studio.orbit.camera();
    let back = camera.eye - camera.target;
    ui.vertical_centered(|ui| {
        ui.set_max_width(84.0);
        let now = (settings.wind.speed, settings.wind.direction);
        if let Some((speed, direction)) = panels::wind::show(ui, now, back.x.atan2(back.z)) {
            (settings.wind.speed, settings.wind.direction) = (speed, direction);
            studio.change(ui.ctx(), settings, "Wind");
        }
        let text = if now.0 > 0.0 { format!("Wind {:.1} m/s", now.0) } else { "Calm".into() };
        ui.label(RichText::new(text).small().color(theme::QUIET));
    });
}

fn job(studio: &Studio, ui: &mut Ui) {
    let Some(job) = &studio.job else { return };
    ui.horizontal(|ui| {
        // Nothing that moves by itself: on a software driver it would take the time of the work.
        let bar =
            ProgressBar::new(job.fraction()).desired_width(90.0).desired_height(6.0).fill(theme::ACCENT);
        ui.add(bar);
        ui.label(format!("{}: {}", job.source.name(), job.step()));
        ui.label(RichText::new(format!("{:.0} s", job.begun.elapsed().as_secs_f32())).color(theme::QUIET));
    });
}

fn recording(studio: &mut Studio, ui: &mut Ui) {
    let Some(recording) = &studio.recording else { return };
    let (fraction, step) = (recording.fraction(), recording.step());
    ui.horizontal(|ui| {
        ui.add(ProgressBar::new(fraction).desired_width(90.0).desired_height(6.0).fill(theme::ACCENT));
        ui.label(step);
        if ui.small_button("Stop").on_hover_text("Throws away what is recorded").clicked() {
            studio.stop_recording();
        }
    });
}

fn error(studio: &mut Studio, ui: &mut Ui) {
    let Some(text) = studio.error.clone() else { return };
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(text).color(theme::ALARM));
        if ui.small_button("OK").on_hover_text("Takes this sentence away").clicked() {
            studio.error = None;
        }
    });
}
