//! A hook for tools that measure shaders: it can replace each shader by an instrumented one.
//!
//! An instrumented shader writes to `@group(4) @binding(0)`, beyond the groups of baseline WebGPU: a storage buffer
//! with a new dynamic offset for each dispatch and draw. A context has at most one probe
//! ([`Context::with_probe`](super::Context::with_probe)).

use std::{fmt::Debug, sync::Arc};

/// Bind group that instrumented shaders write to.
pub const GROUP: u32 = 4;

/// Instruments and measures shaders.
pub trait Probe: Debug + Send + Sync {
    /// Creates the shader `name` from its source `wgsl`.
    fn shader(&self, device: &wgpu::Device, name: &str, wgsl: &str) -> wgpu::ShaderModule;
    /// Returns the layout of the probe's bind group.
    fn layout(&self, device: &wgpu::Device) -> wgpu::BindGroupLayout;
    /// Called when a bind group is created. `bytes` has the size of each resource, 0 if it is not a buffer.
    fn bound(&self, group: &wgpu::BindGroup, bytes: Vec<u64>);
    /// Called for each dispatch and draw with its bind groups, and with the module path of a dispatch's kernel. Returns
    /// the probe's group and dynamic offset.
    fn work(
        &self,
        kernel: Option<&'static str>,
        groups: &[Option<wgpu::BindGroup>],
    ) -> (wgpu::BindGroup, u32);
    /// Called when a frame writes to a buffer through the queue.
    fn uploaded(&self);
    /// Called when a copy to the CPU is submitted.
    fn read_back(&self);
    /// Assigns the work recorded since the last call to the row `name` of the frame's timings.
    fn lap(&self, name: &'static str);
}

/// Bind groups and kernel that a pass has set, for a probe.
#[derive(Debug)]
pub(crate) struct Groups(Option<(Arc<dyn Probe>, GroupSlots, Option<&'static str>)>);

/// Groups by index.
type GroupSlots = [Option<wgpu::BindGroup>; GROUP as usize];

impl Groups {
    /// No groups set.
    pub fn new(probe: Option<&Arc<dyn Probe>>) -> Self {
        Self(probe.cloned().map(|probe| (probe, Default::default(), None)))
    }

    /// Notes a group that the pass sets.
    pub fn set(&mut self, index: u32, group: &wgpu::BindGroup) {
        if let Some(slot) = self.0.as_mut().and_then(|(_, groups, _)| groups.get_mut(index as usize)) {
            *slot = Some(group.clone());
        }
    }

    /// Notes the kernel that the pass sets.
    pub fn name(&mut self, module: &'static str) {
        if let Some((_, _, kernel)) = &mut self.0 {
            *kernel = Some(module);
        }
    }

    /// Returns the probe's group and offset for the next dispatch or draw.
    pub fn work(&self) -> Option<(wgpu::BindGroup, u32)> {
        self.0.as_ref().map(|(probe, groups, kernel)| probe.work(*kernel, groups))
    }
}
