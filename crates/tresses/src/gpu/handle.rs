//! A device as kernels and pipelines see it.

use super::probe::Probe;
use std::{ops::Deref, sync::Arc};

/// A device, and what else decides how things are made for it.
#[derive(Clone, Debug)]
pub(crate) struct Device {
    pub device: wgpu::Device,
    /// Measures shaders.
    pub probe: Option<Arc<dyn Probe>>,
    /// A module whose shader is invalid.
    pub broken: Option<&'static str>,
}

impl Deref for Device {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        &self.device
    }
}
