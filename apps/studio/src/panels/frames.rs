//! A rolling plot of frame times.

use crate::theme;
use eframe::egui::{self, Align2, Color32, Rect, Sense, Stroke, TextStyle, Ui, pos2, vec2};
use std::collections::VecDeque;

/// Number of frames in the plot.
const MANY: usize = 120;

/// Width of the axis labels, points.
const AXIS: f32 = 52.0;

/// Durations of the last frames, milliseconds.
#[derive(Debug, Default)]
pub struct Frames(VecDeque<f32>);

impl Frames {
    /// Adds a frame.
    pub fn push(&mut self, milliseconds: f32) {
        if self.0.len() == MANY {
            self.0.pop_front();
        }
        self.0.push_back(milliseconds);
    }

    /// Returns the median, if there are frames.
    pub fn median(&self) -> Option<f32> {
        let mut sorted: Vec<f32> = self.0.iter().copied().collect();
        sorted.sort_by(f32::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// Draws the plot, with a line at `budget` milliseconds.
    pub fn plot(&self, ui: &mut Ui, budget: f32) -> egui::Response {
        let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), 72.0), Sense::hover());
        let painter = ui.painter_at(area);
        let rect = Rect::from_min_max(pos2(area.left() + AXIS, area.top()), area.max);
        painter.rect_filled(rect, 4.0, Color32::from_rgb(0x12, 0x13, 0x14));
        let longest = self.0.iter().copied().fold(1.5 * budget, f32::max);
        let step = step(longest);
        let max_ms = 1.08 * longest;
        let high = |ms: f32| rect.bottom() - rect.height() * ms / max_ms;
        let width = rect.width() / MANY as f32;
        for (i, ms) in self.0.iter().enumerate() {
            let left = rect.right() - (self.0.len() - i) as f32 * width;
            let bar =
                Rect::from_min_max(pos2(left, high(*ms)), pos2(left + (width - 0.5).max(0.5), rect.bottom()));
            let color = if *ms > budget { theme::ACCENT } else { Color32::from_rgb(0x6b, 0x8f, 0xa8) };
            painter.rect_filled(bar, 0.0, color);
        }
        painter.hline(rect.x_range(), high(budget), Stroke::new(1.0, theme::QUIET.gamma_multiply(0.6)));
        let font = TextStyle::Small.resolve(ui.style());
        let text = |ms: f32, anchor: Align2, words: String| {
            painter.text(pos2(rect.left() - 5.0, high(ms)), anchor, words, font.clone(), theme::QUIET);
        };
        text(0.0, Align2::RIGHT_BOTTOM, "0".into());
        let marks = (1..).map(|i| i as f32 * step).take_while(|ms| *ms <= longest);
        for ms in marks {
            painter.hline(rect.x_range(), high(ms), Stroke::new(1.0, Color32::from_white_alpha(14)));
            text(ms, Align2::RIGHT_CENTER, format!("{ms} ms"));
        }
        response
    }
}

/// Returns the axis step in milliseconds: 1, 2 or 5 times a power of ten, for two or three marks.
fn step(max_ms: f32) -> f32 {
    let min_step = max_ms / 3.5;
    let power = 10f32.powf(min_step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .map(|digit| digit * power)
        .into_iter()
        .find(|step| *step >= min_step)
        .unwrap_or(min_step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_has_few_round_marks() {
        for most in [0.3, 16.7, 50.0, 120.0, 121.0, 999.0, 12345.0] {
            let step = step(most);
            assert!((1.0..=3.6).contains(&(most / step)), "{most}: {step}");
        }
        assert_eq!((step(120.0), step(50.0), step(1000.0)), (50.0, 20.0, 500.0));
    }

    #[test]
    fn median_covers_the_last_frames() {
        let mut frames = Frames::default();
        assert_eq!(frames.median(), None);
        for ms in 0..2 * MANY {
            frames.push(ms as f32);
        }
        assert_eq!((frames.median(), frames.0.len()), (Some(1.5 * MANY as f32), MANY));
    }
}
