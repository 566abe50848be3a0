//! An adapter's capabilities beyond baseline WebGPU.

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

    /// What can be known from a device alone: at most 4 samples per pixel.
    pub(crate) fn of_device(device: &wgpu::Device) -> Self {
        Self {
            timestamps: device.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            max_samples: 4,
            software: device.adapter_info().device_type == wgpu::DeviceType::Cpu,
        }
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
