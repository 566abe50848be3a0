//! The device handle that kernels and pipelines use.

use super::probe::Probe;
use std::{ops::Deref, sync::Arc};

/// A device, and the test hooks that change its shaders.
#[derive(Clone, Debug)]
pub(crate) struct Device {
    pub device: wgpu::Device,
    /// Instruments shaders.
    pub probe: Option<Arc<dyn Probe>>,
    /// Module whose shader is made invalid.
    pub broken: Option<&'static str>,
}

impl Deref for Device {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        &self.device
    }
}
