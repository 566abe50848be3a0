//! Chapter to come.

mod kernels;
mod options;

pub use kernels::{Avoid, AvoidGroups};
pub use options::{AvoidMode, AvoidOptions};

use crate::{
    Result,
    collide::ColliderSet,
    gpu::bindings,
    groom::{BoundStrands, SdfGrid},
    strands::{GuideBuffers, PackedRest, StrandBuffers, buffers::storage},
};
use bytemuck::{Pod, Zeroable};

/// The uniform of the kernels.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct AvoidParams {
    /// How far strands keep from obstacles, metres.
    pub clearance: f32,
    /// [`AvoidOptions::tolerance`].
    pub tolerance: f32,
    /// [`AvoidOptions::zone`].
    pub zone: f32,
    /// [`AvoidOptions::tightness`].
    pub tightness: f32,
    /// Number of strands.
    pub strand_count: u32,
    /// Vertices per strand, at least 2.
    pub vertex_count: u32,
    /// Samples per guide, at least 2.
    pub sample_count: u32,
    /// Unused.
    pub _pad: u32,
    /// 0 to forget what was, else 1.
    pub keep: f32,
    /// By how much a change-over that is needed grows, 0..=2, where 2 is at once.
    pub rise: f32,
    /// By how much one that is not needed shrinks, likewise.
    pub fall: f32,
    /// How far it moves along the strand at most, metres.
    pub shift: f32,
}

/// What is remembered of one strand.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct StrandState {
    /// The first vertex that penetrates; [`NO_HIT`] between frames and where none does.
    pub hit: u32,
    /// How far the strand has changed over, 0..=1.
    pub amount: f32,
    /// From where on it is the clump's, metres from its root.
    pub at: f32,
    /// Whether it hit in the last frame.
    pub hit_before: u32,
}

/// [`StrandState::hit`] of a strand that penetrates nothing.
pub const NO_HIT: u32 = u32::MAX;

/// One groom's share of the stage.
#[derive(Debug)]
pub struct Avoidance {
    /// How strands avoid obstacles. [`AvoidOptions::check`] says what is allowed.
    pub options: AvoidOptions,
    clearance: f32,
    params: wgpu::Buffer,
    states: wgpu::Buffer,
    groups: AvoidGroups,
}

impl Avoidance {
    /// For strands that keep `clearance` metres from obstacles.
    ///
    /// # Errors
    /// What [`AvoidOptions::check`] says, and [`crate::Error::Limit`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        stage: &Avoid,
        options: AvoidOptions,
        clearance: f32,
        guides: &GuideBuffers,
        strands: &StrandBuffers,
    ) -> Result<Self> {
        options.check()?;
        let params = bindings::uniform(device, "avoid", size_of::<AvoidParams>());
        let states = storage::<StrandState>(device, "avoidance", strands.count.into())?;
        let none = StrandState { hit: NO_HIT, amount: 0.0, at: 0.0, hit_before: 0 };
        queue.write_buffer(&states, 0, bytemuck::cast_slice(&vec![none; strands.count as usize]));
        let groups = stage.bind(device, &params, &states, guides, strands);
        Ok(Self { options, clearance, params, states, groups })
    }

    /// Writes the uniform of a frame of `dt` seconds; `forget` starts anew.
    pub(crate) fn prepare(
        &self,
        queue: &wgpu::Queue,
        (guides, strands): (&GuideBuffers, &StrandBuffers),
        dt: f32,
        forget: bool,
    ) {
        let [rise, fall, shift] = if forget { [2.0, 2.0, f32::MAX] } else { self.options.per_frame(dt) };
        let params = AvoidParams {
            clearance: self.clearance,
            tolerance: self.options.tolerance,
            zone: self.options.zone,
            tightness: self.options.tightness,
            strand_count: strands.count,
            vertex_count: strands.vertex_count,
            sample_count: guides.sample_count,
            _pad: 0,
            keep: if forget { 0.0 } else { 1.0 },
            rise,
            fall,
            shift,
        };
        queue.write_buffer(&self.params, 0, bytemuck::bytes_of(&params));
    }

    /// Records the stage.
    pub(crate) fn record(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        stage: &Avoid,
        colliders: &ColliderSet,
        strands: &StrandBuffers,
    ) {
        if !colliders.is_empty() {
            stage.record(pass, &self.groups, colliders, strands, self.options.mode);
        }
    }

    /// Records only the search: [`StrandState::hit`] is then the first hit of each strand.
    pub fn record_search(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        stage: &Avoid,
        colliders: &ColliderSet,
        strands: &StrandBuffers,
    ) {
        stage.record_first_hit(pass, &self.groups, colliders, strands);
    }

    /// [`StrandState`], one per strand.
    pub fn states(&self) -> &wgpu::Buffer {
        &self.states
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.params.size() + self.states.size()
    }
}

/// The rest vertices of `strands`, each with what it rests nearer to the `head` than `clearance`.
pub fn sunk(strands: &BoundStrands, head: &SdfGrid, clearance: f32) -> Vec<PackedRest> {
    let n = strands.vertex_count.max(1) as usize;
    let vertex = |(i, rest): (usize, &PackedRest)| {
        let (p, _) = rest.unpack(&strands.bindings[i / n]);
        rest.sink(clearance - head.sample(p))
    };
    strands.rest.iter().enumerate().map(vertex).collect()
}
