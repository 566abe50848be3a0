//! Controls over the viewport: tools, views, progress, errors.

use crate::{
    dialog::Dialogs,
    document::Document,
    groomer::BrushKit,
    job::Job,
    journal::LeftGroom,
    orbit::Orbit,
    panels::{self, keys::VIEWS, palette},
    record::Recording,
    renderer::StudioRenderer,
    theme::{self, plate},
    tool::Tool,
    viewport::Viewport,
};
use eframe::egui::{
    Align, Align2, Area, Id, Label, Layout, Order, ProgressBar, Rect, RichText, Ui, Vec2, vec2,
};
use std::time::Duration;
use tresses::groom::edit::BrushTool;

/// Distance from the viewport's edges, points.
const GAP: f32 = 12.0;

/// Width and height of the wind dial with its margins, points.
const DIAL: f32 = 130.0;

/// Viewport height below which the dial does not fit under the tools, points.
const LOW: f32 = 290.0;

/// Height of the strip with the settings of a brush, points.
const STRIP: f32 = 48.0;

/// Maximum width of the hair's name in the progress of a job, points.
const WORDS: f32 = 260.0;

/// Controls over the viewport, each shown by its own function.
pub struct Overlay<'a> {
    ui: &'a Ui,
    /// The viewport.
    rect: Rect,
    /// Height of the strip at the bottom, points.
    strip: f32,
}

impl<'a> Overlay<'a> {
    /// Creates the controls over the viewport at `rect`; with room for a strip at the bottom if a brush `grooms`.
    pub fn new(ui: &'a Ui, rect: Rect, grooms: bool) -> Self {
        Self { ui, rect, strip: if grooms { STRIP } else { 0.0 } }
    }

    fn area(&self, name: &str, anchor: Align2, offset: Vec2) -> Area {
        let area = Area::new(Id::unique(("overlay", name))).order(Order::Middle).pivot(anchor);
        area.fixed_pos(anchor.pos_in_rect(&self.rect.shrink(GAP)) + offset).constrain_to(self.rect)
    }

    fn at<R>(&self, name: &str, anchor: Align2, offset: Vec2, show: impl FnOnce(&mut Ui) -> R) -> R {
        let area = self.area(name, anchor, offset);
        area.show(self.ui.ctx(), |ui| plate().show(ui, show).inner).inner
    }

    /// Shows the tools: the palette of brushes while one is active.
    pub fn tools(
        &self,
        viewport: &mut Viewport,
        document: &mut Document,
        renderer: &mut StudioRenderer,
        dialogs: &Dialogs,
    ) {
        self.at("tools", Align2::LEFT_TOP, Vec2::ZERO, |ui| match viewport.tool.brush() {
            Some(brush) => self.brushes(brush, viewport, (document, renderer), dialogs, ui),
            None => hands(viewport, document, renderer, dialogs, ui),
        });
    }

    /// Shows the palette of brushes.
    fn brushes(
        &self,
        brush: BrushTool,
        viewport: &mut Viewport,
        (document, renderer): (&mut Document, &mut StudioRenderer),
        dialogs: &Dialogs,
        ui: &mut Ui,
    ) {
        if let Some(selected) = palette::show(brush, renderer.playback.live, self.rect, ui) {
            viewport.tool = Tool::Brush(selected);
        }
        ui.separator();
        ui.horizontal_wrapped(|ui| {
            ui.set_max_width(palette::width(self.rect));
            ui.spacing_mut().item_spacing.x = 4.0;
            let help = "The hair moves, and brushes push it\nKey Space";
            if ui.selectable_label(renderer.playback.live, "Live").on_hover_text(help).clicked() {
                viewport.set_live(!renderer.playback.live, renderer);
            }
            if renderer.playback.live {
                keep_button(renderer, dialogs, ui);
            }
            panels::brush::save(document, dialogs, ui);
            if ui.button("Done").on_hover_text("Ends grooming\nKeys Ctrl G").clicked() {
                viewport.tool = Tool::Hand;
            }
        });
    }

    /// Shows the named views, centered at the top.
    pub fn views(&self, renderer: &mut StudioRenderer) {
        self.at("views", Align2::CENTER_TOP, Vec2::ZERO, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for (view, name, key, help) in VIEWS {
                    let button = ui.selectable_label(renderer.orbit.framed() == Some(view), name);
                    if button.on_hover_text(format!("{help}\nKey {}", key.name())).clicked() {
                        renderer.orbit.frame(view);
                        renderer.dirty = true;
                    }
                }
            });
        });
    }

    /// Shows the settings of the brush of `tool`, below the head.
    pub fn brush(&self, tool: BrushTool, kit: &mut BrushKit, document: &mut Document, dialogs: &Dialogs) {
        self.at("brush", Align2::CENTER_BOTTOM, Vec2::ZERO, |ui| {
            ui.set_max_width(self.rect.width() - 4.0 * GAP);
            let mut brush = kit.brush(tool);
            panels::brush::show(&mut brush, document, dialogs, ui);
            kit.set(brush);
        });
    }

    /// Shows the wind dial.
    pub fn wind(&self, orbit: &Orbit, document: &mut Document) {
        let mut settings = document.settings.now().clone();
        let camera = orbit.camera();
        let back = camera.eye - camera.target;
        self.at("wind", dial(self.rect), Vec2::ZERO, |ui| {
            ui.vertical_centered(|ui| {
                ui.set_max_width(84.0);
                let now = (settings.wind_speed(), settings.wind_direction);
                if let Some((speed, direction)) = panels::wind::show(ui, now, back.x.atan2(back.z)) {
                    settings.set_wind_speed(speed);
                    settings.wind_direction = direction;
                    document.change(settings, "Wind");
                }
                let text = if now.0 > 0.0 { format!("Wind {:.1} m/s", now.0) } else { "Calm".into() };
                ui.label(RichText::new(text).small().color(theme::QUIET));
            });
        });
    }

    /// Shows the progress of a job, in the center until a character is `shown`.
    pub fn job(&self, job: &Job, shown: bool) {
        let (anchor, offset) =
            if shown { (Align2::CENTER_TOP, vec2(0.0, 44.0)) } else { (Align2::CENTER_CENTER, Vec2::ZERO) };
        self.at("job", anchor, offset, |ui| {
            ui.horizontal(|ui| {
                // No animation: with a software driver it would compete with the job.
                bar(ui, job.fraction());
                // The step comes before the name, which is truncated.
                ui.label(job.step());
                let seconds = format!("{:.0} s", job.started.elapsed().as_secs_f32());
                ui.label(RichText::new(seconds).color(theme::QUIET));
                ui.scope(|ui| {
                    ui.set_max_width(WORDS);
                    ui.add(Label::new(RichText::new(job.hair.source.name()).color(theme::QUIET)).truncate());
                });
            });
        });
    }

    /// Shows the progress of a recording. Returns whether the user stops it.
    pub fn recording(&self, recording: &Recording) -> bool {
        self.at("recording", Align2::CENTER_TOP, vec2(0.0, 84.0), |ui| {
            let stop = ui.horizontal(|ui| {
                bar(ui, recording.fraction());
                ui.label(recording.step());
                ui.small_button("Stop").on_hover_text("Stop and discard the recording").clicked()
            });
            stop.inner
        })
    }

    /// Shows the progress of a refinement: finished parts, and all parts.
    pub fn refined(&self, (done, all): (usize, usize)) {
        self.at("refined", Align2::RIGHT_TOP, vec2(0.0, 44.0), |ui| {
            ui.horizontal(|ui| {
                bar(ui, done as f32 / all as f32);
                let text = format!("refining: part {} of {all}", (done + 1).min(all));
                ui.label(RichText::new(text).color(theme::QUIET));
            });
            // Update the number of finished parts.
            ui.ctx().request_repaint_after(Duration::from_millis(250));
        });
    }

    /// Shows the legend of the debug view, if one is active.
    pub fn legend(&self, renderer: &StudioRenderer) {
        if renderer.show.is_some() && renderer.debug.is_some() {
            let free = free(self.rect);
            let lift = vec2(0.0, -free.lift - self.strip);
            self.at("legend", free.anchor, lift, |ui| panels::legend::show(renderer, ui, free.width));
        }
    }

    /// Asks whether groomed hair that an earlier studio has left is recovered. Returns the answer.
    pub fn recovery(&self, left: &LeftGroom) -> Option<bool> {
        self.at("recovery", Align2::CENTER_BOTTOM, vec2(0.0, -self.strip), |ui| {
            let buttons = ui.horizontal(|ui| {
                ui.label(format!("A groom was not saved: {}, {}.", left.name, left.age()));
                let recover = ui.button("Recover").on_hover_text("Opens it");
                let discard = ui.button("Discard").on_hover_text("Deletes it");
                recover.clicked().then_some(true).or(discard.clicked().then_some(false))
            });
            buttons.inner
        })
    }

    /// Shows the last error with a button that dismisses it.
    pub fn error(&self, error: &mut Option<String>) {
        let Some(text) = error.clone() else { return };
        let free = free(self.rect);
        let show = |ui: &mut Ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(text).color(theme::ALARM));
                if ui.small_button("OK").on_hover_text("Dismiss the message").clicked() {
                    *error = None;
                }
            });
        };
        self.area("error", free.anchor, vec2(0.0, -free.lift - self.strip)).show(self.ui.ctx(), |ui| {
            ui.set_max_width(free.width);
            plate().show(ui, show);
        });
    }
}

/// Shows the tools besides brushes.
fn hands(
    Viewport { tool, .. }: &mut Viewport,
    document: &Document,
    renderer: &mut StudioRenderer,
    dialogs: &Dialogs,
    ui: &mut Ui,
) {
    ui.with_layout(Layout::top_down_justified(Align::Center), |ui| {
        ui.set_width(72.0);
        for (each, name, key, help) in Tool::ALL {
            let button = ui.selectable_label(*tool == each, name);
            if button.on_hover_text(format!("{help}\nKey {}", key.name())).clicked() {
                *tool = each;
            }
        }
        ui.separator();
        let help = "Drops a ball on the head, which rolls off through the hair\nKey B";
        if ui.button("Ball").on_hover_text(help).clicked() {
            renderer.drop_ball();
        }
        let help = "Brushes that comb, cut and plant hair\nKeys Ctrl G";
        if ui.button("Groom").on_hover_text(help).clicked() {
            *tool = Tool::Brush(Default::default());
        }
        if document.groomer.is_some() {
            keep_button(renderer, dialogs, ui);
        }
    });
}

/// Shows the button that keeps the shape of moving hair.
fn keep_button(renderer: &StudioRenderer, dialogs: &Dialogs, ui: &mut Ui) {
    let help = "The groomed hair keeps the shape that it has now, pulled or blown\nKeys Shift Space";
    if ui.button("Keep").on_hover_text(help).clicked() {
        panels::keep(renderer, dialogs);
    }
}

/// Returns the corner of the wind dial: under the tools, or opposite them in a low viewport.
fn dial(rect: Rect) -> Align2 {
    if rect.height() < LOW { Align2::RIGHT_BOTTOM } else { Align2::LEFT_BOTTOM }
}

/// Position for messages at the bottom of the viewport.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Free {
    anchor: Align2,
    /// Distance from the bottom, points.
    lift: f32,
    /// Maximum width, points.
    width: f32,
}

/// Returns the position for messages: in the center if it is wide enough, else beside the dial, else above it.
fn free(rect: Rect) -> Free {
    let (centered_width, side_width) = (rect.width() - 2.0 * DIAL, rect.width() - DIAL - GAP);
    let other = if dial(rect) == Align2::LEFT_BOTTOM { Align2::RIGHT_BOTTOM } else { Align2::LEFT_BOTTOM };
    if centered_width > 320.0 {
        Free { anchor: Align2::CENTER_BOTTOM, lift: 0.0, width: centered_width }
    } else if side_width > 180.0 {
        Free { anchor: other, lift: 0.0, width: side_width }
    } else {
        Free { anchor: Align2::CENTER_BOTTOM, lift: DIAL, width: 0.9 * rect.width() }
    }
}

/// Shows a progress bar for `fraction`, 0 to 1.
fn bar(ui: &mut Ui, fraction: f32) {
    ui.add(ProgressBar::new(fraction).desired_width(90.0).desired_height(6.0).fill(theme::ACCENT));
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn messages_dial_and_tools_do_not_overlap() {
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
