//! Counts of recorded commands.

use std::ops::AddAssign;

/// Numbers of recorded commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Compute and render passes.
    pub passes: u32,
    /// Dispatches, including indirect ones.
    pub dispatches: u32,
    /// Indirect ones of these.
    pub indirect: u32,
    /// Draw calls.
    pub draws: u32,
    /// Pipeline changes.
    pub pipelines: u32,
    /// Bind group changes.
    pub groups: u32,
    /// Copies and fills outside passes.
    pub transfers: u32,
    /// Runs of transfers without a pass between them. On Metal, each is an encoder, as is each pass.
    pub transfer_runs: u32,
    /// Bytes that attachments and transfers move by their sizes. Shader accesses are not counted.
    pub bytes: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passes += other.passes;
        self.dispatches += other.dispatches;
        self.indirect += other.indirect;
        self.draws += other.draws;
        self.pipelines += other.pipelines;
        self.groups += other.groups;
        self.transfers += other.transfers;
        self.transfer_runs += other.transfer_runs;
        self.bytes += other.bytes;
    }
}
