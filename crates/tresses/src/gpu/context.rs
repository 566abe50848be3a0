//! A device, its queue and the pipelines that are compiled for it.

use super::{handle::Device, probe::Probe, tier::Tier};
use std::{
    any::{Any, TypeId},
    collections::HashMap,
    sync::{Arc, Mutex, OnceLock},
};

/// A device, its queue and the pipelines compiled for it. Everything that needs the GPU is made with one; make one per
/// device. A clone is cheap and shares the pipelines.
///
/// Creating a context compiles nothing. A pipeline is compiled when a frame first records it, or in advance by
/// [`prepare`](Self::prepare).
#[derive(Clone, Debug)]
pub struct Context {
    pub(crate) device: Device,
    pub(crate) queue: wgpu::Queue,
    tier: Tier,
    pub(super) sets: Arc<Mutex<HashMap<TypeId, Slot>>>,
}

/// A pipeline set, once it is made: an [`Arc`] of it.
pub(super) type Slot = Arc<OnceLock<Box<Erased>>>;
#[cfg(not(target_arch = "wasm32"))]
type Erased = dyn Any + Send + Sync;
/// Browser objects belong to one thread.
#[cfg(target_arch = "wasm32")]
type Erased = dyn Any;

impl Context {
    /// A context for the caller's device and its queue. The tier is what the device itself tells; [`Tier::of`] and
    /// [`with_tier`](Self::with_tier) find out more from the adapter.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            tier: Tier::of_device(device),
            device: Device { device: device.clone(), probe: None, broken: None },
            queue: queue.clone(),
            sets: Arc::default(),
        }
    }

    /// The same context with the capabilities `tier`.
    pub fn with_tier(self, tier: Tier) -> Self {
        Self { tier, ..self }
    }

    /// A context of the same device whose shaders are those of `probe`.
    pub fn with_probe(self, probe: Arc<dyn Probe>) -> Self {
        Self { device: Device { probe: Some(probe), ..self.device }, sets: Arc::default(), ..self }
    }

    /// A context of the same device in which the shader `module` is invalid; for tests of errors.
    #[doc(hidden)]
    pub fn with_broken(self, module: &'static str) -> Self {
        Self { device: Device { broken: Some(module), ..self.device }, sets: Arc::default(), ..self }
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
    fn contexts_and_what_they_make_move_between_threads() {
        fn check<T: Send + Sync>() {}
        check::<Context>();
        check::<crate::Hair>();
        check::<crate::View>();
        check::<crate::body::Body>();
        check::<crate::skinning::Skinning>();
    }
}
