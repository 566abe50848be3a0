//! A place for tools that measure what shaders do: they may replace each shader by one that also counts.
//!
//! Such a shader writes to `@group(4) @binding(0)`, beyond the groups of baseline WebGPU, a storage buffer whose offset
//! is given anew for each dispatch and draw. Nothing is asked of anybody until a probe is there.

use std::sync::OnceLock;

/// The bind group that shaders of a probe write to.
pub const GROUP: u32 = 4;

/// What measures shaders.
pub trait Probe: Send + Sync {
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

static PROBE: OnceLock<Box<dyn Probe>> = OnceLock::new();

/// Shaders that this process compiles from here on are those of `probe`. It measures one device, until the process ends;
/// of a second call nothing comes.
pub fn install(probe: Box<dyn Probe>) {
    _ = PROBE.set(probe);
}

/// The probe that was installed.
pub(crate) fn get() -> Option<&'static dyn Probe> {
    PROBE.get().map(|probe| &**probe)
}

/// Which groups a pass has bound, for a probe.
#[derive(Debug, Default)]
pub(crate) struct Groups([Option<wgpu::BindGroup>; GROUP as usize]);

impl Groups {
    /// One more.
    pub fn set(&mut self, index: u32, group: &wgpu::BindGroup) {
        if get().is_some()
            && let Some(place) = self.0.get_mut(index as usize)
        {
            *place = Some(group.clone());
        }
    }

    /// What the next dispatch or draw binds besides.
    pub fn work(&self) -> Option<(wgpu::BindGroup, u32)> {
        get().map(|probe| probe.work(&self.0))
    }
}
