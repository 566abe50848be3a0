//! What surrounds the picture, a file each.

pub mod ask;
pub mod body;
pub mod files;
pub mod frames;
pub mod groom;
pub mod icons;
pub mod inside;
pub mod keys;
pub mod knobs;
pub mod legend;
pub mod overlay;
pub mod record;
pub mod side;
pub mod status;
pub mod time;
pub mod top;
pub mod transport;
pub mod wind;

use eframe::egui;

/// What panels remember.
#[derive(Debug, Default)]
pub struct Panels {
    /// What the last frames took.
    pub frames: frames::Frames,
    /// What the panel at the side shows.
    pub page: side::Page,
    /// The words that parameters are searched by.
    pub search: String,
    /// Whether a loop is being ordered.
    pub record: bool,
    /// Pictures that were dropped, and may be any map.
    pub asked: Vec<ask::Asked>,
    /// Whether the panel at the side is hidden; `None`: where it would leave too little of the picture.
    folded: Option<bool>,
}

/// Width of a window that has room for a panel beside the picture, points.
const ROOM: f32 = 760.0;

impl Panels {
    /// Whether the panel at the side is hidden.
    pub fn is_folded(&self, context: &egui::Context) -> bool {
        self.folded.unwrap_or(context.content_rect().width() < ROOM)
    }

    /// Hides the panel at the side, or shows it.
    pub fn fold(&mut self, context: &egui::Context) {
        self.folded = Some(!self.is_folded(context));
    }
}
