//! Controls over the picture: the palette, the views, progress, errors.

use crate::{
    app::Studio,
    panels::{self, keys::VIEWS},
    theme,
    tool::Tool,
    viewport::plate,
};
use eframe::egui::{Align, Align2, Area, Id, Label, Layout, Order, ProgressBar, Rect, RichText, Ui, vec2};
use std::time::Duration;

/// Distance from the picture's edges, points.
const GAP: f32 = 12.0;

/// What the wind's dial takes of the width and height, with room around it, points.
const DIAL: f32 = 130.0;

/// The height of a picture that has room for the dial under the tools, points.
const LOW: f32 = 290.0;

/// How wide the words about long work may be, points.
const WORDS: f32 = 260.0;

/// Shows all of it over the picture at `rect`.
pub fn show(studio: &mut Studio, ui: &mut Ui, rect: Rect) {
    let at = |name: &str, anchor: Align2, offset| {
        Area::new(Id::unique(("overlay", name)))
            .order(Order::Middle)
            .pivot(anchor)
            .fixed_pos(anchor.pos_in_rect(&rect.shrink(GAP)) + offset)
            .constrain_to(rect)
    };
    if studio.show.is_some() && !studio.bare {
        at("tools", Align2::LEFT_TOP, vec2(0.0, 0.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| tools(studio, ui)));
        // The panels of grids stand at the right.
        at("views", Align2::CENTER_TOP, vec2(0.0, 0.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| views(studio, ui)));
    }
    let (dial, free) = (dial(rect), free(rect));
    if studio.show.is_some() && !studio.bare {
        at("wind", dial, vec2(0.0, 0.0)).show(ui.ctx(), |ui| plate().show(ui, |ui| wind(studio, ui)));
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
    if let Some((done, all)) = studio.refined() {
        at("refined", Align2::RIGHT_TOP, vec2(0.0, 44.0))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| refined(ui, done, all)));
    }
    if studio.show.is_some() && panels::legend::wanted(studio) && studio.error.is_none() {
        at("legend", free.anchor, vec2(0.0, -free.lift))
            .show(ui.ctx(), |ui| plate().show(ui, |ui| panels::legend::show(studio, ui, free.width)));
    }
    if studio.error.is_some() {
        at("error", free.anchor, vec2(0.0, -free.lift)).show(ui.ctx(), |ui| {
            ui.set_max_width(free.width);
            plate().show(ui, |ui| error(studio, ui));
        });
    }
}

/// Where the wind's dial is: under the tools, or beside them where the picture is low.
fn dial(rect: Rect) -> Align2 {
    if rect.height() < LOW { Align2::RIGHT_BOTTOM } else { Align2::LEFT_BOTTOM }
}

/// Where there is room for words at the bottom of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Free {
    anchor: Align2,
    /// How far above the bottom, points.
    lift: f32,
    /// How wide they may be, points.
    width: f32,
}

/// In the middle, else beside the dial, else above it.
fn free(rect: Rect) -> Free {
    let (middle, beside) = (rect.width() - 2.0 * DIAL, rect.width() - DIAL - GAP);
    let other = if dial(rect) == Align2::LEFT_BOTTOM { Align2::RIGHT_BOTTOM } else { Align2::LEFT_BOTTOM };
    if middle > 320.0 {
        Free { anchor: Align2::CENTER_BOTTOM, lift: 0.0, width: middle }
    } else if beside > 180.0 {
        Free { anchor: other, lift: 0.0, width: beside }
    } else {
        Free { anchor: Align2::CENTER_BOTTOM, lift: DIAL, width: 0.9 * rect.width() }
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
        // The step is worth more than the name.
        ui.label(job.step());
        let seconds = format!("{:.0} s", job.begun.elapsed().as_secs_f32());
        ui.label(RichText::new(seconds).color(theme::QUIET));
        ui.scope(|ui| {
            ui.set_max_width(WORDS);
            ui.add(Label::new(RichText::new(job.hair.source.name()).color(theme::QUIET)).truncate());
        });
    });
}

fn recording(studio: &mut Studio, ui: &mut Ui) {
    let Some(recording) = &studio.recording else { return };
    let (fraction, step) = (recording.fraction(), recording.step());
    ui.horizontal(|ui| {
        ui.add(ProgressBar::new(fraction).desired_width(90.0).desired_height(6.0).fill(theme::ACCENT));
        ui.label(step);
        if ui.small_button("Stop").on_hover_text("Discards the recording").clicked() {
            studio.stop_recording();
        }
    });
}

/// How far the picture is that nothing but its quality is waited for.
fn refined(ui: &mut Ui, done: usize, all: usize) {
    ui.horizontal(|ui| {
        let bar = ProgressBar::new(done as f32 / all as f32).desired_width(90.0).desired_height(6.0);
        ui.add(bar.fill(theme::ACCENT));
        ui.label(RichText::new(format!("finer: part {} of {all}", (done + 1).min(all))).color(theme::QUIET));
    });
    // Its parts are counted.
    ui.ctx().request_repaint_after(Duration::from_millis(250));
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

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn words_and_dial_have_room_in_any_window() {
        for size in [
            vec2(1080.0, 790.0),
            vec2(500.0, 300.0),
            vec2(480.0, 220.0),
            vec2(432.0, 500.0),
            vec2(260.0, 400.0),
        ] {
            let rect = Rect::from_min_size(pos2(0.0, 36.0), size);
            let inner = rect.shrink(GAP);
            let place = |anchor: Align2, lift: f32, size| {
                anchor.anchor_size(anchor.pos_in_rect(&inner) - vec2(0.0, lift), size)
            };
            let dial = place(dial(rect), 0.0, vec2(DIAL - 2.0 * GAP, DIAL - GAP));
            let free = free(rect);
            let words = place(free.anchor, free.lift, vec2(free.width, 60.0));
            assert!(!dial.intersects(words), "{size}: {dial} {words}");
            assert!(free.width > 170.0 && rect.contains_rect(words), "{size}: {words}");
            let tools = place(Align2::LEFT_TOP, 0.0, vec2(76.0, 134.0));
            assert!(!dial.intersects(tools), "{size}: {dial} {tools}");
        }
    }
}
