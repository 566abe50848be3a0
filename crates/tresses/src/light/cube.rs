//! Light probes: the light of a cube map, measured on the GPU.
//!
//! Engines store light probes and skies as cube maps, often on the GPU only. Hair needs their smooth part: nine
//! spherical harmonics for each color channel. The kernel sums samples in 6,144 directions, and the caller reads the
//! sums back some frames later. A map with bright features of a few texels needs mip levels, because the sample grid
//! would miss them.

use super::environment::{BANDS, Environment};
use crate::{
    Context, Result,
    gpu::{BindBuffer, Kernel, readback::Pending},
    shaders::kernels::light as kernels,
    strands::buffers::storage,
};
use glam::{Mat3, Vec3, Vec4};

/// Quantity that the texels of a cube map store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CubeMap {
    /// Radiance from the direction of the texel, as in a sky or a reflection probe.
    Radiance,
    /// Cosine-weighted mean radiance over the hemisphere around the direction of the texel (irradiance over π), as
    /// engines filter it for diffuse light.
    Irradiance,
}

/// Measures cube maps.
#[derive(Debug)]
pub struct CubeProbe {
    context: Context,
    kernel: Kernel,
    sampler: wgpu::Sampler,
}

/// A measurement in progress.
#[derive(Debug)]
pub struct CubeLight {
    sums: Pending,
    of: CubeMap,
}

impl CubeProbe {
    /// Creates a probe, which compiles its kernel on first use.
    pub fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("cube probe"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { kernel: Kernel::new::<kernels::Cube>(&context.device), sampler, context: context.clone() }
    }

    /// Starts to measure `map`, a view of six faces in a filterable format, after all work submitted so far. `to_map`
    /// transforms world directions to lookup directions of the map: a rotation, and for engines with left-handed cube
    /// maps also a reflection.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the kernel does not compile.
    pub fn measure(&self, map: &wgpu::TextureView, of: CubeMap, to_map: Mat3) -> Result<CubeLight> {
        let matrix = storage::<Vec4>(&self.context.device, "cube probe", 3)?;
        let columns = [to_map.x_axis, to_map.y_axis, to_map.z_axis].map(|column| column.extend(0.0));
        self.context.queue.write_buffer(&matrix, 0, bytemuck::cast_slice(&columns));
        let sums = storage::<Vec4>(&self.context.device, "cube probe", 9)?;
        let group = self.kernel.bind(&kernels::Cube {
            to_map: matrix.entire(),
            map,
            smooth_sampler: &self.sampler,
            results: sums.entire(),
        });
        let mut encoder = self
            .context
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("cube probe") });
        let mut commands = self.context.commands(&mut encoder);
        let mut pass = commands.compute("cube probe");
        self.kernel.record(&mut pass, &group, &[], 9);
        pass.end()?;
        self.context.queue.submit([encoder.finish()]);
        Ok(CubeLight { sums: Pending::buffer(&self.context, &sums), of })
    }
}

impl CubeLight {
    /// Returns the result once it has arrived, and only once. The readback progresses as work is submitted.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub fn take(&mut self) -> Option<Result<Environment>> {
        Some(self.sums.take()?.map(|bytes| read(&bytes, self.of)))
    }

    /// Waits for the result.
    ///
    /// # Errors
    /// As [`take`](Self::take).
    pub async fn wait(self) -> Result<Environment> {
        Ok(read(&self.sums.wait().await?, self.of))
    }
}

fn read(bytes: &[u8], of: CubeMap) -> Environment {
    let sums: Vec<Vec4> = bytemuck::pod_collect_to_vec(&bytes[..9 * size_of::<Vec4>()]);
    let mut coefficients: [Vec3; 9] = std::array::from_fn(|i| sums[i].truncate());
    if of == CubeMap::Irradiance {
        // Undo the cosine weight of each band.
        coefficients.iter_mut().zip(BANDS).for_each(|(sum, band)| *sum /= band);
    }
    // Treat maps with values that are not finite as black.
    if !coefficients.iter().all(|sum| sum.is_finite()) {
        coefficients = [Vec3::ZERO; 9];
    }
    Environment { coefficients }
}
