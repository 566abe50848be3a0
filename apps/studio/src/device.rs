//! The GPU device shared by the window and the hair.

use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::sync::Arc;
use tresses::{Context, Gpu, low_level::Tier};

/// Returns egui's device configuration.
pub fn configuration() -> WgpuConfiguration {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor = Gpu::instance_descriptor();
    setup.power_preference = wgpu::PowerPreference::HighPerformance;
    setup.device_descriptor = Arc::new(|adapter| wgpu::DeviceDescriptor {
        label: Some("tresses studio"),
        required_features: Tier::features(adapter),
        required_limits: limits(adapter),
        ..Default::default()
    });
    if let Ok(name) = std::env::var("WGPU_ADAPTER_NAME") {
        setup.native_adapter_selector = Some(Arc::new(move |adapters, _| {
            let named = |a: &&wgpu::Adapter| a.get_info().name.to_lowercase().contains(&name.to_lowercase());
            adapters
                .iter()
                .find(named)
                .cloned()
                .ok_or_else(|| format!("no GPU adapter has {name:?} in its name"))
        }));
    }
    WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..Default::default() }
}

/// Returns WebGPU's default limits, with buffers as large as the adapter supports, for large grooms.
fn limits(adapter: &wgpu::Adapter) -> wgpu::Limits {
    let has = adapter.limits();
    wgpu::Limits {
        max_buffer_size: has.max_buffer_size,
        max_storage_buffer_binding_size: has.max_storage_buffer_binding_size,
        max_texture_dimension_2d: has.max_texture_dimension_2d.min(16384),
        ..wgpu::Limits::default()
    }
}

/// Wraps egui's device for the library.
pub fn gpu(state: &eframe::egui_wgpu::RenderState) -> Gpu {
    Gpu {
        adapter: state.adapter.clone(),
        info: state.adapter.get_info(),
        context: Context::new(&state.device, &state.queue).with_tier(Tier::of(&state.adapter)),
    }
}
