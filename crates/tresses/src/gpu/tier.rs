//! An adapter's capabilities beyond baseline WebGPU.

/// Capabilities of an adapter beyond baseline WebGPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tier {
    /// Whether GPU timestamps between passes are available.
    pub timestamps: bool,
    /// Largest number of samples per pixel of the HDR target: 1, 4, 8 or 16.
    pub max_samples: u32,
    /// Whether the adapter is a software driver that runs on the CPU. It has kernels of its own: guides are solved in
    /// private memory instead of workgroup memory, the wind's pressure by block sweeps instead of multigrid.
    pub software: bool,
}

impl Tier {
    /// Features to request from `adapter`.
    pub fn features(adapter: &wgpu::Adapter) -> wgpu::Features {
        adapter.features()
            & (wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
    }

    /// The tier as far as a device alone reports it: at most 4 samples per pixel.
    pub(crate) fn of_device(device: &wgpu::Device) -> Self {
        Self {
            timestamps: device.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            max_samples: 4,
            software: device.adapter_info().device_type == wgpu::DeviceType::Cpu,
        }
    }

    /// The tier of `adapter`, whose device was requested with [`features`](Self::features).
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
