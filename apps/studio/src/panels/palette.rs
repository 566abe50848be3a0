//! The palette of brushes: a picture, a word and a key each, in groups.

use crate::{groomer, theme, tool::Tool};
use eframe::egui::{Align2, Color32, FontId, Grid, Painter, Rect, Response, ScrollArea, Sense, Stroke, Ui};
use eframe::egui::{Pos2, Shape, pos2, vec2};
use tresses::groom::edit::BrushTool;

/// Size of a button with a word, and without, points.
const WIDE: f32 = 88.0;
const NARROW: f32 = 30.0;
const HEIGHT: f32 = 25.0;
/// Distance between columns, points.
const SPACE: f32 = 3.0;
/// Side of a picture, points.
const PICTURE: f32 = 17.0;
/// Width of the viewport below which words do not fit, points.
const MIN_LABELED_WIDTH: f32 = 560.0;
/// Tools with which groups begin.
const GROUPS: [BrushTool; 3] = [BrushTool::Cut, BrushTool::Plant, BrushTool::Clump];

/// Lines and rings of a picture, in a unit square with y downwards.
struct Sketch {
    lines: &'static [&'static [[f32; 2]]],
    /// Center and radius.
    rings: &'static [([f32; 2], f32)],
    dots: &'static [([f32; 2], f32)],
}

/// Returns the width of the palette in a viewport of this size, points.
pub fn width(viewport: Rect) -> f32 {
    2.0 * button_width(viewport) + SPACE
}

fn button_width(viewport: Rect) -> f32 {
    if viewport.width() < MIN_LABELED_WIDTH { NARROW } else { WIDE }
}

/// Shows the palette in a viewport of this size. Returns the tool that the user chooses. `live` grays tools that need
/// hair at rest.
pub fn show(active: BrushTool, live: bool, viewport: Rect, ui: &mut Ui) -> Option<BrushTool> {
    let width = button_width(viewport);
    let mut selected = None;
    let max_height = (viewport.height() - 110.0).max(120.0);
    ScrollArea::vertical().max_height(max_height).show(ui, |ui| {
        let mut rest = &Tool::BRUSHES[..];
        while let Some(first) = rest.first() {
            let next = |(tool, ..): &(BrushTool, _, _)| GROUPS.contains(tool) && *tool != first.0;
            let (group, others) = rest.split_at(rest.iter().position(next).unwrap_or(rest.len()));
            rest = others;
            Grid::new(("brushes", groomer::title(first.0))).spacing(vec2(SPACE, 2.0)).show(ui, |ui| {
                for (index, (tool, key, help)) in group.iter().enumerate() {
                    let is_off = live && !tool.acts_in_motion();
                    let response = button(ui, *tool, (*tool == active, is_off), width);
                    let note = if is_off { "\nWorks on hair at rest, and stops the motion" } else { "" };
                    let title = groomer::title(*tool);
                    let text = format!("{title}: {}\nKey {}{note}", sentence(help), key.name());
                    if response.on_hover_text(text).clicked() {
                        selected = Some(*tool);
                    }
                    if index % 2 == 1 {
                        ui.end_row();
                    }
                }
            });
            if !rest.is_empty() {
                ui.separator();
            }
        }
    });
    selected
}

/// Returns `help` with a small first letter.
fn sentence(help: &str) -> String {
    let mut letters = help.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// Shows the button of a tool, which may be active, or off while hair moves.
fn button(ui: &mut Ui, tool: BrushTool, (is_active, is_off): (bool, bool), width: f32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::click());
    let visuals = ui.style().interact_selectable(&response, is_active);
    if is_active || response.hovered() {
        ui.painter().rect_filled(rect, visuals.corner_radius, visuals.bg_fill);
    }
    let color = if is_off { theme::QUIET.gamma_multiply(0.6) } else { visuals.text_color() };
    let at = pos2(rect.left() + 0.5 * NARROW, rect.center().y);
    paint(ui.painter(), tool, Rect::from_center_size(at, vec2(PICTURE, PICTURE)), color);
    if width > NARROW {
        let label_position = pos2(rect.left() + NARROW, rect.center().y);
        let font = FontId::proportional(12.5);
        ui.painter().text(label_position, Align2::LEFT_CENTER, groomer::title(tool), font, color);
    }
    response
}

/// Paints the picture of a tool.
fn paint(painter: &Painter, tool: BrushTool, at: Rect, color: Color32) {
    let point = |[x, y]: [f32; 2]| -> Pos2 { at.left_top() + vec2(x, y) * at.size() };
    let stroke = Stroke::new(1.3, color);
    let Sketch { lines, rings, dots } = sketch(tool);
    for line in lines {
        painter.add(Shape::line(line.iter().copied().map(point).collect(), stroke));
    }
    for (center, radius) in rings {
        painter.circle_stroke(point(*center), radius * at.width(), stroke);
    }
    for (center, radius) in dots {
        painter.circle_filled(point(*center), radius * at.width(), color);
    }
}

const fn lines(lines: &'static [&'static [[f32; 2]]]) -> Sketch {
    Sketch { lines, rings: &[], dots: &[] }
}

/// Returns the picture of a tool.
fn sketch(tool: BrushTool) -> Sketch {
    match tool {
        // A comb.
        BrushTool::Comb => lines(&[
            &[[0.05, 0.25], [0.95, 0.25]],
            &[[0.1, 0.25], [0.1, 0.75]],
            &[[0.3, 0.25], [0.3, 0.75]],
            &[[0.5, 0.25], [0.5, 0.75]],
            &[[0.7, 0.25], [0.7, 0.75]],
            &[[0.9, 0.25], [0.9, 0.75]],
        ]),
        // A strand that bends to a hand.
        BrushTool::Grab => Sketch {
            lines: &[&[[0.1, 0.95], [0.15, 0.6], [0.35, 0.4], [0.6, 0.3]]],
            rings: &[([0.75, 0.25], 0.2)],
            dots: &[([0.75, 0.25], 0.07)],
        },
        // A wave, and a line.
        BrushTool::Smooth => lines(&[
            &[[0.05, 0.3], [0.2, 0.1], [0.35, 0.45], [0.5, 0.1], [0.65, 0.45], [0.8, 0.1], [0.95, 0.3]],
            &[[0.05, 0.75], [0.95, 0.75]],
        ]),
        // Hair that rises from the skin.
        BrushTool::Puff => lines(&[
            &[[0.05, 0.92], [0.95, 0.92]],
            &[[0.25, 0.9], [0.2, 0.4], [0.3, 0.15]],
            &[[0.5, 0.9], [0.5, 0.05]],
            &[[0.36, 0.22], [0.5, 0.05], [0.64, 0.22]],
            &[[0.75, 0.9], [0.8, 0.4], [0.7, 0.15]],
        ]),
        // Hair along the skin.
        BrushTool::Lay => lines(&[
            &[[0.05, 0.92], [0.95, 0.92]],
            &[[0.08, 0.9], [0.15, 0.65], [0.4, 0.6], [0.95, 0.6]],
            &[[0.78, 0.45], [0.95, 0.6], [0.78, 0.75]],
            &[[0.08, 0.6], [0.15, 0.35], [0.4, 0.3], [0.7, 0.3]],
        ]),
        BrushTool::Pinch => lines(&[
            &[[0.05, 0.05], [0.4, 0.45], [0.42, 0.95]],
            &[[0.95, 0.05], [0.6, 0.45], [0.58, 0.95]],
            &[[0.5, 0.05], [0.5, 0.95]],
        ]),
        BrushTool::Spread => lines(&[
            &[[0.42, 0.05], [0.4, 0.55], [0.05, 0.95]],
            &[[0.58, 0.05], [0.6, 0.55], [0.95, 0.95]],
            &[[0.5, 0.05], [0.5, 0.95]],
        ]),
        // A nozzle and streams of air.
        BrushTool::Blow => lines(&[
            &[[0.05, 0.3], [0.3, 0.38], [0.3, 0.62], [0.05, 0.7], [0.05, 0.3]],
            &[[0.45, 0.3], [0.6, 0.18], [0.75, 0.3], [0.95, 0.15]],
            &[[0.45, 0.5], [0.6, 0.42], [0.75, 0.55], [0.95, 0.45]],
            &[[0.45, 0.72], [0.6, 0.65], [0.75, 0.8], [0.95, 0.72]],
        ]),
        // Scissors.
        BrushTool::Cut => Sketch {
            lines: &[&[[0.3, 0.68], [0.75, 0.05]], &[[0.7, 0.68], [0.25, 0.05]]],
            rings: &[([0.22, 0.8], 0.16), ([0.78, 0.8], 0.16)],
            dots: &[],
        },
        // Strands that end at a line.
        BrushTool::Line => lines(&[
            &[[0.2, 0.05], [0.2, 0.6]],
            &[[0.5, 0.05], [0.5, 0.6]],
            &[[0.8, 0.05], [0.8, 0.6]],
            &[[0.0, 0.7], [0.3, 0.7]],
            &[[0.4, 0.7], [0.65, 0.7]],
            &[[0.75, 0.7], [1.0, 0.7]],
        ]),
        // A loop with a rope.
        BrushTool::Lasso => lines(&[
            &[
                [0.35, 0.62],
                [0.1, 0.5],
                [0.08, 0.25],
                [0.3, 0.08],
                [0.65, 0.08],
                [0.92, 0.25],
                [0.88, 0.5],
                [0.6, 0.63],
                [0.35, 0.62],
            ],
            &[[0.35, 0.62], [0.25, 0.75], [0.4, 0.85], [0.3, 0.98]],
        ]),
        // A strand beside a double arrow.
        BrushTool::Length => lines(&[
            &[[0.25, 0.05], [0.3, 0.4], [0.2, 0.7], [0.25, 0.95]],
            &[[0.7, 0.05], [0.7, 0.95]],
            &[[0.52, 0.22], [0.7, 0.05], [0.88, 0.22]],
            &[[0.52, 0.78], [0.7, 0.95], [0.88, 0.78]],
        ]),
        // A strand on skin, and a plus.
        BrushTool::Plant => lines(&[
            &[[0.05, 0.92], [0.95, 0.92]],
            &[[0.3, 0.9], [0.25, 0.5], [0.4, 0.15]],
            &[[0.55, 0.45], [0.95, 0.45]],
            &[[0.75, 0.25], [0.75, 0.65]],
        ]),
        BrushTool::Remove => lines(&[
            &[[0.05, 0.92], [0.95, 0.92]],
            &[[0.3, 0.9], [0.25, 0.5], [0.4, 0.15]],
            &[[0.55, 0.45], [0.95, 0.45]],
        ]),
        // A root that moves along the skin.
        BrushTool::Slide => Sketch {
            lines: &[
                &[[0.05, 0.78], [0.95, 0.78]],
                &[[0.2, 0.75], [0.15, 0.4], [0.25, 0.1]],
                &[[0.4, 0.55], [0.9, 0.55]],
                &[[0.74, 0.39], [0.9, 0.55], [0.74, 0.71]],
            ],
            rings: &[],
            dots: &[([0.2, 0.78], 0.1)],
        },
        // Hair to both sides of a line.
        BrushTool::Part => lines(&[
            &[[0.5, 0.0], [0.5, 1.0]],
            &[[0.42, 0.15], [0.2, 0.25], [0.08, 0.5]],
            &[[0.42, 0.5], [0.2, 0.6], [0.08, 0.85]],
            &[[0.58, 0.15], [0.8, 0.25], [0.92, 0.5]],
            &[[0.58, 0.5], [0.8, 0.6], [0.92, 0.85]],
        ]),
        // A strand between others, with the points of a guide.
        BrushTool::Refine => Sketch {
            lines: &[
                &[[0.15, 0.95], [0.15, 0.05]],
                &[[0.5, 0.95], [0.5, 0.05]],
                &[[0.85, 0.95], [0.85, 0.05]],
            ],
            rings: &[],
            dots: &[([0.5, 0.1], 0.1), ([0.5, 0.5], 0.1), ([0.5, 0.9], 0.1)],
        },
        // Strands that meet at the tip.
        BrushTool::Clump => lines(&[
            &[[0.05, 0.05], [0.3, 0.4], [0.48, 0.95]],
            &[[0.35, 0.05], [0.42, 0.4], [0.5, 0.95]],
            &[[0.65, 0.05], [0.58, 0.4], [0.5, 0.95]],
            &[[0.95, 0.05], [0.7, 0.4], [0.52, 0.95]],
        ]),
        // A coil.
        BrushTool::Curl => lines(&[&[
            [0.5, 0.0],
            [0.85, 0.12],
            [0.7, 0.28],
            [0.25, 0.25],
            [0.2, 0.38],
            [0.75, 0.42],
            [0.8, 0.56],
            [0.3, 0.56],
            [0.2, 0.7],
            [0.7, 0.74],
            [0.8, 0.86],
            [0.5, 1.0],
        ]]),
        // Zigzags.
        BrushTool::Frizz => lines(&[
            &[[0.2, 0.0], [0.3, 0.2], [0.12, 0.35], [0.3, 0.5], [0.12, 0.7], [0.25, 1.0]],
            &[[0.5, 0.0], [0.6, 0.15], [0.42, 0.35], [0.6, 0.55], [0.42, 0.75], [0.55, 1.0]],
            &[[0.8, 0.0], [0.9, 0.2], [0.72, 0.35], [0.9, 0.5], [0.72, 0.7], [0.85, 1.0]],
        ]),
        // A thin strand and a thick one.
        BrushTool::Width => Sketch {
            lines: &[
                &[[0.2, 0.05], [0.2, 0.95]],
                &[[0.6, 0.05], [0.6, 0.95], [0.9, 0.95], [0.9, 0.05], [0.6, 0.05]],
            ],
            rings: &[],
            dots: &[],
        },
        // A rod that bends a little, and one that bends much.
        BrushTool::Stiffness => Sketch {
            lines: &[
                &[[0.08, 0.3], [0.5, 0.3], [0.92, 0.22]],
                &[[0.08, 0.3], [0.5, 0.4], [0.8, 0.65], [0.88, 0.95]],
            ],
            rings: &[],
            dots: &[([0.08, 0.3], 0.1)],
        },
        // A drop.
        BrushTool::Color => lines(&[&[
            [0.5, 0.02],
            [0.7, 0.35],
            [0.82, 0.62],
            [0.72, 0.86],
            [0.5, 0.96],
            [0.28, 0.86],
            [0.18, 0.62],
            [0.3, 0.35],
            [0.5, 0.02],
        ]]),
        // A lock.
        BrushTool::Hold => lines(&[
            &[[0.15, 0.45], [0.85, 0.45], [0.85, 0.95], [0.15, 0.95], [0.15, 0.45]],
            &[[0.3, 0.45], [0.3, 0.2], [0.4, 0.06], [0.6, 0.06], [0.7, 0.2], [0.7, 0.45]],
        ]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_brush_is_in_the_palette_once_with_a_picture_and_a_key() {
        for (tool, _) in BrushTool::ALL {
            let rows: Vec<_> = Tool::BRUSHES.iter().filter(|(each, ..)| *each == tool).collect();
            assert_eq!(rows.len(), 1, "{tool:?}");
            let keys = Tool::BRUSHES.iter().filter(|(_, key, _)| *key == rows[0].1).count();
            assert_eq!(keys, 1, "{tool:?}");
            let Sketch { lines, .. } = sketch(tool);
            let points: Vec<_> = lines.iter().flat_map(|line| line.iter()).collect();
            assert!(points.len() > 2 && points.iter().all(|p| p.iter().all(|x| (0.0..=1.0).contains(x))));
        }
        assert!(GROUPS.iter().all(|tool| Tool::BRUSHES.iter().any(|(each, ..)| each == tool)));
    }
}
