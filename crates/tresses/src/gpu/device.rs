//! Opening a device without a window.

use super::{Context, Tier};
use crate::{Error, Result};

/// What to do where there is no adapter.
const REMEDY: &str = if cfg!(target_arch = "wasm32") {
    "this browser has no WebGPU, or keeps it from this page"
} else {
    "on Linux without a GPU, scripts/setup installs Mesa's software Vulkan driver"
};

/// An adapter and a context for its device, for programs that have none yet. A clone names the same ones.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The adapter that it is of.
    pub adapter: wgpu::Adapter,
    /// Name, driver and kind of the adapter.
    pub info: wgpu::AdapterInfo,
    /// The device, its queue and the adapter's tier.
    pub context: Context,
}

impl Gpu {
    /// Opens the best adapter, hardware before software. The environment variables of wgpu
    /// (`WGPU_BACKEND`, `WGPU_ADAPTER_NAME`) are honoured.
    ///
    /// # Errors
    /// [`Error::Adapter`] when there is none, with what to do about it.
    pub async fn open() -> Result<Self> {
        Self::showing(&Self::instance(), None).await
    }

    /// An instance of wgpu as [`open`](Self::open) uses it, to make a surface with.
    pub fn instance() -> wgpu::Instance {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        // OpenGL lacks what the compute stages need, and probing it is slow and noisy.
        descriptor.backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY);
        wgpu::Instance::new(descriptor)
    }

    /// [`open`](Self::open) for an adapter of `instance` that can show pictures on `surface`.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub async fn showing(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self> {
        let adapter = match std::env::var("WGPU_ADAPTER_NAME") {
            Ok(name) => instance
                .enumerate_adapters(wgpu::Backends::all())
                .await
                .into_iter()
                .find(|adapter| adapter.get_info().name.to_lowercase().contains(&name.to_lowercase()))
                .ok_or_else(|| Error::Adapter(format!("no GPU adapter has {name:?} in its name")))?,
            Err(_) => instance
                .request_adapter(&wgpu::RequestAdapterOptions {
                    power_preference: wgpu::PowerPreference::HighPerformance,
                    compatible_surface: surface,
                    ..Default::default()
                })
                .await
                .map_err(|error| Error::Adapter(format!("no GPU adapter was found ({error}); {REMEDY}")))?,
        };
        let tier = Tier::of(&adapter);
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("tresses"),
                required_features: Tier::features(&adapter),
                // What the adapter has: large grooms need buffers beyond the baseline 128 MiB.
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await
            .map_err(|error| Error::Adapter(format!("{}: {error}", adapter.get_info().name)))?;
        Ok(Self { info: adapter.get_info(), context: Context::new(&device, &queue).with_tier(tier), adapter })
    }
}
