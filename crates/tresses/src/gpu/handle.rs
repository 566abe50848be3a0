//! The handles of device and queue that kernels and pipelines use.

use super::{
    probe::Probe,
    uniforms::{Space, Uniform, UniformHeap},
};
use std::{ops::Deref, sync::Arc};

/// A device, and the hooks of tests and tools that change its shaders and the contents of new memory.
#[derive(Clone, Debug)]
pub(crate) struct Device {
    pub device: wgpu::Device,
    /// Whether shaders have the constants of GPUs ([`crate::constants::TIERED`]).
    pub is_gpu: bool,
    /// Instruments shaders.
    pub probe: Option<Arc<dyn Probe>>,
    /// Module whose shader is made invalid.
    pub broken: Option<&'static str>,
    /// Changes the text of each shader.
    pub rewrite: Option<fn(&str) -> String>,
    /// Queue that fills new memory with a pattern ([`super::fill`]).
    pub fill: Option<wgpu::Queue>,
    /// Pages of small values, which all clones of a context share.
    pub uniforms: Arc<UniformHeap>,
}

impl Device {
    /// Takes a slot of `size` bytes, initially zero, that shaders bind as `var<uniform>`.
    pub fn uniform(&self, size: usize) -> Uniform {
        self.uniforms.slot(&self.device, Space::Uniform, size)
    }

    /// As [`uniform`](Self::uniform), for shaders that bind it as `var<storage, read>`: if the values alone decide
    /// loops or branches, and for arrays. Shaders see an array of at least 16 bytes.
    pub fn storage_uniform(&self, size: usize) -> Uniform {
        self.uniforms.slot(&self.device, Space::Storage, size)
    }
}

impl Deref for Device {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        &self.device
    }
}

/// A queue whose uploads a probe counts.
#[derive(Clone, Debug)]
pub(crate) struct Queue {
    pub queue: wgpu::Queue,
    pub probe: Option<Arc<dyn Probe>>,
}

impl Queue {
    /// As [`wgpu::Queue::write_buffer`].
    pub fn write_buffer(&self, buffer: &wgpu::Buffer, offset: u64, data: &[u8]) {
        if let Some(probe) = &self.probe {
            probe.uploaded();
        }
        self.queue.write_buffer(buffer, offset, data);
    }
}

impl Deref for Queue {
    type Target = wgpu::Queue;

    fn deref(&self) -> &wgpu::Queue {
        &self.queue
    }
}
