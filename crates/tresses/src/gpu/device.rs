//! Opening a device without a window.

use super::{Context, Tier};
use crate::{Error, Result};

/// Advice if there is no adapter.
const REMEDY: &str = if cfg!(target_arch = "wasm32") {
    "this browser does not support WebGPU, or blocks it on this page"
} else {
    "on Linux without a GPU, scripts/setup installs Mesa's software Vulkan driver"
};

/// An adapter and a context for its device, for programs that have no device yet. A clone refers to the same ones.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The adapter of the device.
    pub adapter: wgpu::Adapter,
    /// Name, driver and type of the adapter.
    pub info: wgpu::AdapterInfo,
    /// The device, its queue and the adapter's tier.
    pub context: Context,
}

impl Gpu {
    /// Opens the best adapter, hardware before software. Respects the environment variables of wgpu (`WGPU_BACKEND`,
    /// `WGPU_ADAPTER_NAME`).
    ///
    /// # Errors
    /// [`Error::Adapter`] if there is no adapter; the message says what to do.
    pub async fn open() -> Result<Self> {
        Self::showing(&Self::instance(), None).await
    }

    /// Creates a wgpu instance with the options of [`open`](Self::open), for creating a surface.
    pub fn instance() -> wgpu::Instance {
        wgpu::Instance::new(Self::instance_descriptor())
    }

    /// Returns the options of [`instance`](Self::instance), for programs that create one with other options.
    pub fn instance_descriptor() -> wgpu::InstanceDescriptor {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        // OpenGL lacks what the compute stages need, and probing it is slow and noisy.
        descriptor.backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY);
        // wgpu checks the counts of each indirect dispatch with a dispatch of its own. Here they all come from kernels
        // of this crate, which keep them within the limit. On Direct3D 12, the check also provides `num_workgroups`.
        if !cfg!(windows) && std::env::var_os("WGPU_VALIDATION_INDIRECT_CALL").is_none() {
            descriptor.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
        }
        descriptor
    }

    /// As [`open`](Self::open), for an adapter of `instance` that can present to `surface`.
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
        Self::on(adapter).await
    }

    /// Opens the device of `adapter`.
    ///
    /// # Errors
    /// [`Error::Adapter`] if the device does not open.
    pub async fn on(adapter: wgpu::Adapter) -> Result<Self> {
        let tier = Tier::of(&adapter);
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("tresses"),
                required_features: Tier::features(&adapter),
                // The adapter's own limits: large grooms need buffers beyond the baseline 128 MiB.
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await
            .map_err(|error| Error::Adapter(format!("{}: {error}", adapter.get_info().name)))?;
        Ok(Self { info: adapter.get_info(), context: Context::new(&device, &queue).with_tier(tier), adapter })
    }
}
