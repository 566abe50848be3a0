//! Keyboard shortcuts.

use crate::{
    dialog::Dialogs, document::Document, messages::Messages, panels::Panels, renderer::StudioRenderer,
    tool::Tool, viewport::Viewport,
};
use eframe::egui::{self, Key, KeyboardShortcut, Modifiers};
use tresses_scene::camera::Angle;

/// Named views: label, key and hint.
pub const VIEWS: [(Angle, &str, Key, &str); 4] = [
    (Angle::Front, "Front", Key::Num1, "From the front"),
    (
        Angle::ThreeQuarter,
        "3/4",
        Key::Num2,
        "Three-quarter view; a double click in the viewport does the same",
    ),
    (Angle::Side, "Side", Key::Num3, "From the head's left"),
    (Angle::Back, "Back", Key::Num4, "From behind"),
];

/// Handles keys, unless a text field has the focus.
pub fn answer(
    panels: &mut Panels,
    document: &mut Document,
    renderer: &mut StudioRenderer,
    viewport: &mut Viewport,
    (dialogs, messages): (&Dialogs, &mut Messages),
    context: &egui::Context,
) {
    if context.egui_wants_keyboard_input() {
        return;
    }
    let undo = KeyboardShortcut::new(Modifiers::COMMAND, Key::Z);
    let redo = KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    // Redo first: its shortcut also matches undo.
    if context.input_mut(|input| input.consume_shortcut(&redo)) {
        document.undo(true, messages);
    }
    if context.input_mut(|input| input.consume_shortcut(&undo)) {
        document.undo(false, messages);
    }
    let keep = KeyboardShortcut::new(Modifiers::SHIFT, Key::Space);
    if context.input_mut(|input| input.consume_shortcut(&keep)) && document.groomer.is_some() {
        super::keep(renderer, dialogs);
    }
    // Several presses may arrive within one frame.
    let presses = |key| context.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
    let pressed = |key| presses(key) > 0;
    if presses(Key::Space) % 2 == 1 {
        match viewport.tool.brush() {
            Some(_) => viewport.set_live(!renderer.playback.live, renderer),
            None => renderer.playback.play.playing = !renderer.playback.play.playing,
        }
    }
    let Viewport { tool, kit, .. } = viewport;
    let groom = KeyboardShortcut::new(Modifiers::COMMAND, Key::G);
    if context.input_mut(|input| input.consume_shortcut(&groom)) {
        *tool = if tool.brush().is_some() { Tool::Hand } else { Tool::Brush(Default::default()) };
    }
    if tool.brush().is_some() {
        for (brush, key, _) in Tool::BRUSHES {
            if pressed(key) {
                *tool = Tool::Brush(brush);
            }
        }
        for (key, factor) in [(Key::OpenBracket, 1.0 / 1.15), (Key::CloseBracket, 1.15)] {
            kit.scale(f32::powi(factor, presses(key) as i32));
        }
    }
    for _ in 0..presses(Key::Period) {
        renderer.playback.play.step();
    }
    for _ in 0..presses(Key::B) {
        renderer.drop_ball();
    }
    if pressed(Key::R) {
        renderer.playback.play.reset();
    }
    if pressed(Key::F) {
        renderer.finish();
    }
    if presses(Key::P) % 2 == 1 {
        panels.fold(context);
    }
    for (each, _, key, _) in Tool::ALL {
        if pressed(key) {
            *tool = each;
        }
    }
    for (view, _, key, _) in VIEWS {
        if pressed(key) {
            renderer.orbit.frame(view);
            renderer.dirty = true;
        }
    }
}
