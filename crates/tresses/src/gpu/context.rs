//! A device, its queue and the pipelines that are compiled for it.

use super::{
    handle::{Device, Queue},
    tier::Tier,
};
use std::{
    any::{Any, TypeId},
    collections::HashMap,
    sync::{Arc, Mutex, OnceLock},
};

/// A device, its queue and the pipelines compiled for it. Every object on the GPU is created with one. Make one context
/// per device; a clone is cheap and shares the pipelines.
///
/// Creating a context compiles nothing. A pipeline is compiled when a frame first records it, or in advance by
/// [`prepare`](Self::prepare).
#[derive(Clone, Debug)]
pub struct Context {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    tier: Tier,
    pub(super) sets: Arc<Mutex<HashMap<TypeId, Slot>>>,
}

/// A pipeline set: an [`Arc`] of it once it is created.
pub(super) type Slot = Arc<OnceLock<Box<AnyPipelines>>>;
#[cfg(not(target_arch = "wasm32"))]
type AnyPipelines = dyn Any + Send + Sync;
/// Browser objects belong to one thread.
#[cfg(target_arch = "wasm32")]
type AnyPipelines = dyn Any;

impl Context {
    /// Creates a context for the caller's device and queue. Its tier is what the device itself reports; [`Tier::of`]
    /// and [`with_tier`](Self::with_tier) add what only the adapter knows.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let (tier, device) = (Tier::of_device(device), device.clone());
        let is_gpu = !tier.software;
        Self {
            tier,
            device: Device {
                device,
                is_gpu,
                probe: None,
                broken: None,
                rewrite: None,
                fill: None,
                uniforms: Arc::default(),
            },
            queue: Queue { queue: queue.clone(), probe: None },
            sets: Arc::default(),
        }
    }

    /// The same device with the capabilities `tier`, which choose the kernels.
    pub fn with_tier(self, tier: Tier) -> Self {
        let device = Device { is_gpu: !tier.software, ..self.device };
        Self { tier, device, sets: Arc::default(), ..self }
    }

    /// The same device with shaders that `probe` replaces.
    #[cfg(feature = "probe")]
    pub fn with_probe(self, probe: Arc<dyn super::probe::Probe>) -> Self {
        let queue = Queue { probe: Some(probe.clone()), ..self.queue };
        Self { device: Device { probe: Some(probe), ..self.device }, queue, sets: Arc::default(), ..self }
    }

    /// The same device with an invalid shader `module`, for tests of errors.
    #[doc(hidden)]
    pub fn with_broken(self, module: &'static str) -> Self {
        Self { device: Device { broken: Some(module), ..self.device }, sets: Arc::default(), ..self }
    }

    /// The same device with shaders that `rewrite` changes, for tests of the order of workgroups.
    #[doc(hidden)]
    pub fn with_rewritten_shaders(self, rewrite: fn(&str) -> String) -> Self {
        Self { device: Device { rewrite: Some(rewrite), ..self.device }, sets: Arc::default(), ..self }
    }

    /// The same device whose new memory does not start at zero (`gpu/fill.rs`), for tests.
    #[doc(hidden)]
    pub fn with_filled_memory(self) -> Self {
        let fill = Some(self.queue.queue.clone());
        Self { device: Device { fill, ..self.device }, sets: Arc::default(), ..self }
    }

    /// Uploads the uniforms that were written since the last call. Call it before commands that read them are submitted.
    pub(crate) fn flush_uniforms(&self) {
        self.device.uniforms.flush(|buffer, offset, bytes| self.queue.write_buffer(buffer, offset, bytes));
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue of the device.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Capabilities beyond baseline WebGPU.
    pub fn tier(&self) -> Tier {
        self.tier
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contexts_and_their_objects_are_send_and_sync() {
        fn check<T: Send + Sync>() {}
        check::<Context>();
        check::<crate::hair::Hair>();
        check::<crate::View>();
        check::<crate::body::Body>();
        check::<crate::skinning::Skinning>();
    }
}
