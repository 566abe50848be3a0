//! Opening a device without a window, and an adapter's capabilities beyond baseline WebGPU.

use crate::{Error, Result};

/// What the adapter offers beyond baseline WebGPU; chosen once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tier {
    /// GPU timestamps between passes.
    pub timestamps: bool,
    /// The most samples per pixel of the HDR target: 1, 4, 8 or 16.
    pub max_samples: u32,
    /// Whether the adapter is a software driver that runs on the CPU.
    pub software: bool,
}

impl Tier {
    /// The features to request from `adapter`.
    pub fn features(adapter: &wgpu::Adapter) -> wgpu::Features {
        adapter.features()
            & (wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
    }

    /// What `adapter` offers when [`features`](Self::features) were requested.
    pub fn of(adapter: &wgpu::Adapter) -> Self {
        let features = Self::features(adapter);
        let specific = features.contains(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);
        let supported = |samples| {
            [wgpu::TextureFormat::Rgba16Float, wgpu::TextureFormat::Depth32Float].iter().all(|format| {
                adapter.get_texture_format_features(*format).flags.sample_count_supported(samples)
            })
        };
        let max_samples = if specific { [16, 8].into_iter().find(|n| supported(*n)).unwrap_or(4) } else { 4 };
        Self {
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            max_samples,
            software: adapter.get_info().device_type == wgpu::DeviceType::Cpu,
        }
    }
}

/// What to do where there is no adapter.
const REMEDY: &str = if cfg!(target_arch = "wasm32") {
    "this browser has no WebGPU, or keeps it from this page"
} else {
    "on Linux without a GPU, scripts/setup installs Mesa's software Vulkan driver"
};

/// An adapter, its device and its queue, for programs that have none yet. A clone names the same ones.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The adapter that it is of.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name, driver and kind of the adapter.
    pub info: wgpu::AdapterInfo,
    /// What it offers.
    pub tier: Tier,
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
        Ok(Self { device, queue, info: adapter.get_info(), tier, adapter })
    }
}
