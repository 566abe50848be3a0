//! A small rolling plot of what frames took.

use crate::theme;
use eframe::egui::{self, Color32, Rect, Sense, Stroke, Ui, pos2, vec2};
use std::collections::VecDeque;

/// Frames that are remembered.
const MANY: usize = 120;

/// Milliseconds of the last frames.
#[derive(Debug, Default)]
pub struct Frames(VecDeque<f32>);

impl Frames {
    /// One more frame.
    pub fn push(&mut self, milliseconds: f32) {
        if self.0.len() == MANY {
            self.0.pop_front();
        }
        self.0.push_back(milliseconds);
    }

    /// The median, once there are frames.
    pub fn median(&self) -> Option<f32> {
        let mut sorted: Vec<f32> = self.0.iter().copied().collect();
        sorted.sort_by(f32::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// Draws them, with a line at `budget` milliseconds.
    pub fn plot(&self, ui: &mut Ui, budget: f32) -> egui::Response {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 54.0), Sense::hover());
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 4.0, Color32::from_rgb(0x12, 0x13, 0x14));
        let most = self.0.iter().copied().fold(1.5 * budget, f32::max);
        let high = |ms: f32| rect.bottom() - rect.height() * ms / most;
        let width = rect.width() / MANY as f32;
        for (i, ms) in self.0.iter().enumerate() {
            let left = rect.right() - (self.0.len() - i) as f32 * width;
            let bar =
                Rect::from_min_max(pos2(left, high(*ms)), pos2(left + (width - 0.5).max(0.5), rect.bottom()));
            let color = if *ms > budget { theme::ACCENT } else { Color32::from_rgb(0x6b, 0x8f, 0xa8) };
            painter.rect_filled(bar, 0.0, color);
        }
        painter.hline(rect.x_range(), high(budget), Stroke::new(1.0, theme::QUIET.gamma_multiply(0.6)));
        response
    }
}
