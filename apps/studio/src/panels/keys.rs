//! Keys.

use crate::{document::Document, messages::Messages, panels::Panels, renderer::Renderer, tool::Tool};
use eframe::egui::{self, Key, KeyboardShortcut, Modifiers};
use tresses_scene::camera::Angle;

/// The views and their keys.
pub const VIEWS: [(Angle, &str, Key, &str); 4] = [
    (Angle::Front, "Front", Key::Num1, "From before the face"),
    (
        Angle::ThreeQuarter,
        "3/4",
        Key::Num2,
        "Three-quarter view; a double click in the picture does the same",
    ),
    (Angle::Side, "Side", Key::Num3, "From the head's left"),
    (Angle::Back, "Back", Key::Num4, "From behind"),
];

/// Handles keys, unless a text field has the focus.
pub fn answer(
    panels: &mut Panels,
    document: &mut Document,
    renderer: &mut Renderer,
    tool: &mut Tool,
    messages: &mut Messages,
    context: &egui::Context,
) {
    if context.egui_wants_keyboard_input() {
        return;
    }
    let undo = KeyboardShortcut::new(Modifiers::COMMAND, Key::Z);
    let redo = KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    // The one with more modifiers first.
    if context.input_mut(|input| input.consume_shortcut(&redo)) {
        document.undo(true, messages);
    }
    if context.input_mut(|input| input.consume_shortcut(&undo)) {
        document.undo(false, messages);
    }
    // Several presses may come between two frames of the window.
    let presses = |key| context.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
    let pressed = |key| presses(key) > 0;
    renderer.playback.play.playing ^= presses(Key::Space) % 2 == 1;
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
