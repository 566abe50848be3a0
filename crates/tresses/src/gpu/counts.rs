//! Counts of what is recorded.

use std::ops::AddAssign;

/// How much was recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Compute and render passes.
    pub passes: u32,
    /// Dispatches, those included whose workgroups the GPU counts.
    pub dispatches: u32,
    /// Draws.
    pub draws: u32,
    /// Pipelines that were set.
    pub pipelines: u32,
    /// Bind groups that were set.
    pub groups: u32,
    /// Copies and fills outside of passes.
    pub transfers: u32,
    /// Bytes that attachments and transfers read and write by what they are, whatever shaders do.
    pub bytes: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passes += other.passes;
        self.dispatches += other.dispatches;
        self.draws += other.draws;
        self.pipelines += other.pipelines;
        self.groups += other.groups;
        self.transfers += other.transfers;
        self.bytes += other.bytes;
    }
}
