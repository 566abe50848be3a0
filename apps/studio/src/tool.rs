//! The tools: what a drag in the picture does.

use eframe::egui::Key;

/// A tool of the palette.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// The head follows the pointer; beside it the camera turns.
    #[default]
    Hand,
    /// A lock of hair follows the pointer.
    Lock,
    /// The camera turns wherever the drag begins.
    Camera,
}

impl Tool {
    /// All, with name, key and a line of help.
    pub const ALL: [(Self, &'static str, Key, &'static str); 3] = [
        (
            Self::Hand,
            "Head",
            Key::H,
            "Drag the head to move and shake it, with Shift to turn it. Beside the head the camera turns.",
        ),
        (Self::Lock, "Lock", Key::L, "Drag hair to pull a lock. Beside the hair nothing happens."),
        (Self::Camera, "Camera", Key::C, "Drag to orbit. The right button does so with any tool."),
    ];

    /// What the pointer can do, a line.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Hand => "Drag the head to shake it · drag beside it to orbit · wheel to zoom",
            Self::Lock => "Drag hair to pull a lock · right button to orbit · wheel to zoom",
            Self::Camera => "Drag to orbit · middle button or Shift to pan · wheel to zoom",
        }
    }
}
