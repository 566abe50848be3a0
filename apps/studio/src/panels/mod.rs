//! Panels and controls around the viewport, one per file.

pub mod ask;
pub mod body;
pub mod brush;
pub mod cards;
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

use crate::cards::CardForm;
use eframe::egui;

/// State of the panels.
#[derive(Debug, Default)]
pub struct Panels {
    /// Durations of the last frames.
    pub frames: frames::Frames,
    /// Page of the side panel.
    pub page: side::Page,
    /// Choices for baking cards.
    pub cards: CardForm,
    /// Search words for parameters.
    pub search: String,
    /// Whether the dialog that records a loop is open.
    pub record: bool,
    /// Dropped images whose kind the user must choose.
    pub asked: Vec<ask::MapChoice>,
    /// Whether the side panel is hidden; `None` hides it in narrow windows.
    folded: Option<bool>,
}

/// Window width from which the side panel is shown by default, points.
const ROOM: f32 = 760.0;

impl Panels {
    /// Whether the side panel is hidden.
    pub fn is_folded(&self, context: &egui::Context) -> bool {
        self.folded.unwrap_or(context.content_rect().width() < ROOM)
    }

    /// Hides or shows the side panel.
    pub fn fold(&mut self, context: &egui::Context) {
        self.folded = Some(!self.is_folded(context));
    }
}
