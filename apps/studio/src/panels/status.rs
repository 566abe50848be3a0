//! The status line: hints for the pointer, image size and frame time.

use crate::{pace::QualityLevel, panels::frames::Frames, renderer::StudioRenderer, theme};
use eframe::egui::{self, Align, Label, Layout, Panel, RichText, Ui};
use tresses_scene::words::grouped;

/// Shows the line with `hint`: help for the pointer, or the last result.
pub fn show(hint: &str, frames: &Frames, renderer: &StudioRenderer, ui: &mut Ui) {
    let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 4));
    Panel::bottom("status").frame(frame).show_separator_line(false).show(ui, |ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            right(frames, renderer, ui);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(hint).small().color(theme::QUIET)).truncate());
            });
        });
    });
}

fn right(frames: &Frames, renderer: &StudioRenderer, ui: &mut Ui) {
    let quiet = |text: String| RichText::new(text).small().color(theme::QUIET);
    let software = if renderer.gpu.context.tier().software { " · software" } else { "" };
    ui.label(quiet(format!("{}{software}", short(&renderer.gpu.info.name))))
        .on_hover_text(format!("{}\n{}", renderer.gpu.info.name, renderer.gpu.info.driver_info));
    let Some(show) = &renderer.show else { return };
    if let Some(ms) = frames.median() {
        ui.label(quiet(format!("{ms:.0} ms"))).on_hover_text("Median time of the last frames");
    }
    let Some(picture) = show.picture() else { return };
    let ([width, height], level) = (picture.size, &picture.level);
    let hair = match &renderer.cards {
        Some(cards) if cards.chain().shown().is_some() => cards.name(),
        _ => format!("{} strands", grouped(u64::from(picture.strands))),
    };
    let mut text = format!("{hair} · {width}×{height}");
    let coarse = ![QualityLevel::FULL, QualityLevel::STILL].contains(level);
    if coarse {
        text += &format!(" ({:.0} %)", level.scale * 100.0);
    } else if picture.ssaa > 1 {
        text += &format!(", {0}×{0} SSAA", picture.ssaa);
    }
    let text = if coarse { quiet(text).color(theme::ACCENT) } else { quiet(text) };
    let help = if coarse {
        let mut less = vec!["resolution and strands"];
        less.extend(level.slow.then_some("simulation rate"));
        format!(
            "Quality is reduced ({}) to keep frames below {:.0} ms. The image is refined when nothing moves. Turn this off under Time.",
            less.join(", "),
            renderer.pace.budget()
        )
    } else {
        "Drawn hair and image size".into()
    };
    ui.label(text).on_hover_text(help);
}

/// Returns an adapter's name without the part in parentheses.
fn short(name: &str) -> &str {
    name.split(" (").next().unwrap_or(name)
}
