//! The tools: the action of a drag in the viewport.

use eframe::egui::Key;

/// A tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Drags the head; beside it, turns the camera.
    #[default]
    Hand,
    /// Pulls a lock of hair.
    Lock,
    /// Turns the camera, wherever the drag starts.
    Camera,
}

impl Tool {
    /// All tools, with name, key and help.
    pub const ALL: [(Self, &'static str, Key, &'static str); 3] = [
        (
            Self::Hand,
            "Head",
            Key::H,
            "Drag the head to move it, or with Shift to turn it. Drag beside the head to orbit the camera.",
        ),
        (Self::Lock, "Lock", Key::L, "Drag hair to pull a lock. Dragging beside the hair does nothing."),
        (Self::Camera, "Camera", Key::C, "Drag to orbit the camera. The right button orbits with any tool."),
    ];

    /// Returns a line of help for the pointer.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Hand => "Drag the head to shake it · drag beside it to orbit · wheel to zoom",
            Self::Lock => "Drag hair to pull a lock · right button to orbit · wheel to zoom",
            Self::Camera => "Drag to orbit · middle button or Shift to pan · wheel to zoom",
        }
    }
}
