//! A place for tools that measure what shaders do: they may replace each shader by one that also counts.
//!
//! Such a shader writes to `@group(4) @binding(0)`, beyond the groups of baseline WebGPU, a storage buffer whose offset
//! is given anew for each dispatch and draw. A context has at most one probe
//! ([`Context::with_probe`](super::Context::with_probe)).

use std::{fmt::Debug, sync::Arc};

/// The bind group that shaders of a probe write to.
pub const GROUP: u32 = 4;

/// What measures shaders.
pub trait Probe: Debug + Send + Sync {
    /// The shader `name`, which is `wgsl`.
    fn shader(&self, device: &wgpu::Device, name: &str, wgsl: &str) -> wgpu::ShaderModule;
    /// The layout of its group.
    fn layout(&self, device: &wgpu::Device) -> wgpu::BindGroupLayout;
    /// The nth resource of a bind group has so many bytes; 0 for what is no buffer.
    fn bound(&self, group: &wgpu::BindGroup, bytes: Vec<u64>);
    /// A dispatch or a draw with these bind groups: what it writes to, and from which byte on.
    fn work(&self, groups: &[Option<wgpu::BindGroup>]) -> (wgpu::BindGroup, u32);
    /// What was recorded since the last call belongs to the row `name` of a frame's times.
    fn lap(&self, name: &'static str);
}

/// Which groups a pass has bound, for a probe.
#[derive(Debug)]
pub(crate) struct Groups(Option<(Arc<dyn Probe>, Bound)>);

/// By their indices.
type Bound = [Option<wgpu::BindGroup>; GROUP as usize];

impl Groups {
    /// None yet.
    pub fn new(probe: Option<&Arc<dyn Probe>>) -> Self {
        Self(probe.cloned().map(|probe| (probe, Default::default())))
    }

    /// One more.
    pub fn set(&mut self, index: u32, group: &wgpu::BindGroup) {
        if let Some(place) = self.0.as_mut().and_then(|(_, groups)| groups.get_mut(index as usize)) {
            *place = Some(group.clone());
        }
    }

    /// What the next dispatch or draw binds besides.
    pub fn work(&self) -> Option<(wgpu::BindGroup, u32)> {
        self.0.as_ref().map(|(probe, groups)| probe.work(groups))
    }
}
