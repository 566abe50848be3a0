//! What surrounds the picture, a file each.

pub mod frames;
pub mod groom;
pub mod icons;
pub mod inside;
pub mod keys;
pub mod knobs;
pub mod legend;
pub mod overlay;
pub mod side;
pub mod status;
pub mod time;
pub mod top;
pub mod transport;
pub mod wind;

/// What panels remember.
#[derive(Debug, Default)]
pub struct Panels {
    /// What the last frames took.
    pub frames: frames::Frames,
    /// What the panel at the side shows.
    pub page: side::Page,
    /// The words that parameters are searched by.
    pub search: String,
    /// Whether the panel at the side is hidden.
    pub folded: bool,
}
