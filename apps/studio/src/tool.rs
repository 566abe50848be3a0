//! The tools: the action of a drag in the viewport.

use eframe::egui::Key;
use tresses::groom::edit::BrushTool;

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
    /// Strokes hair at rest with a brush; beside the hair, turns the camera.
    Brush(BrushTool),
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

    /// All brushes, with name, key and help. The keys work while a brush is active.
    pub const BRUSHES: [(BrushTool, Key, &'static str); 24] = [
        (BrushTool::Comb, Key::C, "Drags hair along; it slides through the brush"),
        (BrushTool::Grab, Key::G, "Holds the hair under the brush and moves it"),
        (
            BrushTool::Smooth,
            Key::S,
            "Evens out bends and differences between neighbors; any brush does so with Shift",
        ),
        (BrushTool::Puff, Key::U, "Raises hair at the root; with Ctrl it lays hair down"),
        (BrushTool::Lay, Key::D, "Lays hair down at the root, in the direction of the stroke"),
        (BrushTool::Pinch, Key::N, "Pulls hair towards the line of the stroke; with Ctrl away from it"),
        (BrushTool::Spread, Key::W, "Pushes hair away from the line of the stroke"),
        (BrushTool::Blow, Key::H, "Blows hair away like a dryer; with Ctrl it draws hair in"),
        (
            BrushTool::Cut,
            Key::K,
            "Cuts hair where it enters the brush; hair with its root under the brush stays",
        ),
        (BrushTool::Line, Key::J, "Cuts hair along a straight line, from the press to the release"),
        (BrushTool::Lasso, Key::X, "Cuts hair that enters the outline that you draw"),
        (BrushTool::Length, Key::L, "Makes hair longer; with Ctrl shorter"),
        (BrushTool::Plant, Key::A, "Plants hair on the skin"),
        (BrushTool::Remove, Key::E, "Removes hair with its root under the brush"),
        (BrushTool::Slide, Key::V, "Moves roots over the skin, with their hair"),
        (BrushTool::Part, Key::I, "Parts hair along the stroke"),
        (BrushTool::Clump, Key::Q, "Gathers strands into clumps; with Ctrl frees them"),
        (BrushTool::Curl, Key::R, "Curls hair; with Ctrl straightens it"),
        (BrushTool::Frizz, Key::Z, "Makes hair frizzy; with Ctrl calms it"),
        (BrushTool::Width, Key::T, "Makes strands wider; with Ctrl narrower"),
        (
            BrushTool::Stiffness,
            Key::O,
            "Makes hair stiffer; with Ctrl softer. Dots show the stiffness of guides",
        ),
        (BrushTool::Color, Key::B, "Colors strands; with Ctrl they get their color back"),
        (BrushTool::Hold, Key::M, "Holds hair, so that no other tool changes it; with Ctrl lets it go"),
        (BrushTool::Refine, Key::Y, "Makes guides of strands, for finer strokes; no hair moves"),
    ];

    /// Returns the brush, if the tool is one.
    pub fn brush(self) -> Option<BrushTool> {
        match self {
            Self::Brush(tool) => Some(tool),
            _ => None,
        }
    }

    /// Returns a line of help for the pointer; `live` with brushes on moving hair.
    pub fn hint(self, live: bool) -> &'static str {
        match self {
            Self::Hand => "Drag the head to shake it · drag beside it to orbit · wheel to zoom",
            Self::Lock => "Drag hair to pull a lock · right button to orbit · wheel to zoom",
            Self::Camera => "Drag to orbit · middle button or Shift to pan · wheel to zoom",
            Self::Brush(_) if live => {
                "Drag moving hair · Ctrl inverts · [ ] radius · Shift Space keeps the shape · Space stops · right button orbits"
            }
            Self::Brush(tool) if tool.draws() => {
                "Draw a line over hair: it cuts in the direction of sight · Esc takes the stroke back · right button orbits"
            }
            Self::Brush(_) => {
                "Drag hair · Shift smooths · Ctrl inverts · [ ] radius · Esc takes the stroke back · Space lets the hair move · right button orbits"
            }
        }
    }
}
