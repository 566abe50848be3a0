//! Scattering tables of fibers on the GPU.

use super::{
    FiberShape,
    far::{AZIMUTHS, AzimuthalLobes, COSINES, FarField, HUES, hue},
    mean,
};
use crate::Context;
use crate::gpu::{
    Binding,
    bindings::{self, layout},
};
use glam::Vec3;
use half::f16;
use std::sync::Mutex;

/// Parameters of the tables: fiber shape, and Zinke's d_b.
type Key = (FiberShape, f32);

/// Two textures and their bind group. The tables are computed on the CPU in tens of milliseconds, on first use and
/// again when the shape of the fiber changes.
#[derive(Debug)]
pub(crate) struct FiberTables {
    context: Context,
    /// [`AzimuthalLobes`] by azimuth and cos θ: two layers for light from one direction, two for the half circle around
    /// it.
    azimuthal: wgpu::Texture,
    /// [`mean::MeanScattering`] by cos θ and [`hue`]: two layers.
    mean: wgpu::Texture,
    pub(crate) group: wgpu::BindGroup,
    /// `None` before the tables are filled.
    build: Mutex<Option<TableBuild>>,
}

#[derive(Debug)]
struct TableBuild {
    key: Key,
    /// Fraction of the light that a fiber scatters forward, per step of [`hue`]: the mean over light directions.
    forward: Vec<f32>,
}

impl FiberTables {
    /// Returns the layout of the bind group, `@group(2)` of all shaders that shade hair.
    pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let stages = wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let entries = [Binding::Texture2dArray, Binding::Texture2dArray, Binding::Sampler];
        layout(device, "fiber", stages, &entries)
    }

    /// Creates empty tables.
    pub(crate) fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let texture = |label, width, height, layers| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba16Float,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            })
        };
        let azimuthal = texture("lobes around a fiber", AZIMUTHS, COSINES, 4);
        let mean = texture("means of fibers", COSINES, HUES, 2);
        let view = |texture: &wgpu::Texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            })
        };
        let group = device.group(
            "fiber",
            &Self::layout(device),
            &[
                wgpu::BindingResource::TextureView(&view(&azimuthal)),
                wgpu::BindingResource::TextureView(&view(&mean)),
                wgpu::BindingResource::Sampler(&bindings::linear_sampler(device)),
            ],
        );
        Self { context: context.clone(), azimuthal, mean, group, build: Mutex::new(None) }
    }

    /// Creates a second, empty set of tables.
    pub(crate) fn new_empty(&self) -> Self {
        Self::new(&self.context)
    }

    /// Whether the tables are filled, but for another shape or density.
    pub(crate) fn is_stale_for(&self, shape: &FiberShape, density: f32) -> bool {
        let build = self.build.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        build.as_ref().is_some_and(|build| build.key != (shape.clamped(), density))
    }

    /// Fills the tables for fibers of `shape`. `density` is Zinke's d_b, the fraction of the backscattered light that
    /// hits other fibers. Does nothing if the tables are already filled for both.
    pub(crate) fn fill(&self, shape: &FiberShape, density: f32) {
        let shape = shape.clamped();
        // The key is valid even if another thread has panicked.
        let mut build = self.build.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if build.as_ref().is_some_and(|build| build.key == (shape, density)) {
            return;
        }
        let far = FarField::new(&shape);
        let texels = |table: &[AzimuthalLobes]| {
            let first = table.iter().flat_map(|a| [a.weight[0], a.weight[1], a.weight[2], a.path[0]]);
            let second = table.iter().flat_map(|a| [a.path[1], a.spread[0], a.spread[1], 0.0]);
            first.chain(second).collect::<Vec<_>>()
        };
        write(&self.context, &self.azimuthal, [texels(&far.direct), texels(&far.wide)].concat());
        let means = mean::table(&far, density);
        let first = means.iter().flat_map(|m| [m.forward, m.forward_variance, m.local, m.local_variance]);
        let second = means.iter().flat_map(|m| [m.local_shift, m.rest, m.backward, m.backward_variance]);
        write(&self.context, &self.mean, first.chain(second).collect());
        *build = Some(TableBuild { key: (shape, density), forward: mean::forward(&means) });
    }

    /// Returns the fraction of ambient light that a fiber scatters forward, per color channel; zero before the tables
    /// are filled. `absorption` is per fiber radius.
    pub(crate) fn forward_fraction(&self, absorption: Vec3) -> Vec3 {
        let build = self.build.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let Some(TableBuild { forward, .. }) = &*build else { return Vec3::ZERO };
        let fraction = |sigma: f32| {
            let step = hue(f64::from(sigma.max(0.0))) as f32 * (HUES - 1) as f32;
            let low = (step as usize).min(HUES as usize - 2);
            forward[low] + (forward[low + 1] - forward[low]) * (step - low as f32)
        };
        Vec3::from_array(absorption.to_array().map(fraction))
    }

    /// GPU memory of the tables, bytes.
    pub fn bytes(&self) -> u64 {
        8 * u64::from(AZIMUTHS * COSINES * 4 + COSINES * HUES * 2)
    }
}

/// Uploads a texture of four half floats per texel.
fn write(context: &Context, texture: &wgpu::Texture, values: Vec<f32>) {
    let Context { queue, .. } = context;
    let halves: Vec<u16> = values.into_iter().map(|v| f16::from_f32(v).to_bits()).collect();
    let size = texture.size();
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&halves),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * size.width),
            rows_per_image: Some(size.height),
        },
        size,
    );
}
