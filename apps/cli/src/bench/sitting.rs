//! How everything of one call is measured.

use indicatif::ProgressBar;
use tresses::gpu::Clock;

/// How everything of one call is measured.
#[derive(Clone, Copy)]
pub struct Sitting<'a> {
    /// Measured frames per scene.
    pub frames: u32,
    /// What times are measured by.
    pub clock: Clock,
    /// Advances by one with each measured frame.
    pub bar: &'a ProgressBar,
}
