//! Light probes: the light of a cube map, measured on the GPU.
//!
//! Engines keep light probes and skies as cube maps, and often on the GPU alone. Hair wants their smooth part, nine numbers
//! for each colour: the kernel asks 6,144 directions of a map and sums them up, and the sums come back some frames later.
//! A map that is brighter in a few texels than such a grid can see has to have mip levels.

use super::environment::{BANDS, Environment};
use crate::{
    Context, Result,
    gpu::{Binding, Kernel, readback::Pending},
    strands::buffers::storage,
};
use glam::{Mat3, Vec3, Vec4};

/// What the texels of a cube map are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubeMap {
    /// The radiance that comes from their direction: a sky, a reflection probe.
    Radiance,
    /// The mean radiance over the hemisphere around their direction, weighted by the cosine (irradiance over π): what
    /// engines filter for diffuse light.
    Irradiance,
}

/// Measures cube maps.
#[derive(Debug)]
pub struct CubeProbe {
    context: Context,
    kernel: Kernel,
    sampler: wgpu::Sampler,
}

/// A measurement under way.
#[derive(Debug)]
pub struct CubeLight {
    sums: Pending,
    of: CubeMap,
}

impl CubeProbe {
    /// Compiled when it is first used.
    pub fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let entries = [Binding::Storage, Binding::Cube, Binding::Sampler, Binding::StorageMut];
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("cube probe"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            kernel: Kernel::new(&context.device, "light::cube", &entries),
            sampler,
            context: context.clone(),
        }
    }

    /// Begins to measure `map`, a view of six faces of a filterable format, as it is after all that was submitted so far.
    /// `to_map` brings directions of the world to those by which the map is asked: a rotation, and for engines whose cube
    /// maps are left-handed a mirror.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the kernel does not compile.
    pub fn measure(&self, map: &wgpu::TextureView, of: CubeMap, to_map: Mat3) -> Result<CubeLight> {
        let turn = storage::<Vec4>(&self.context.device, "cube probe", 3)?;
        let columns = [to_map.x_axis, to_map.y_axis, to_map.z_axis].map(|column| column.extend(0.0));
        self.context.queue.write_buffer(&turn, 0, bytemuck::cast_slice(&columns));
        let sums = storage::<Vec4>(&self.context.device, "cube probe", 9)?;
        let resources = [
            turn.as_entire_binding(),
            wgpu::BindingResource::TextureView(map),
            wgpu::BindingResource::Sampler(&self.sampler),
            sums.as_entire_binding(),
        ];
        let group = self.kernel.bind(&resources);
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
    /// What was measured, once, if it has come by now; submissions bring it along.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub fn take(&mut self) -> Option<Result<Environment>> {
        Some(self.sums.take()?.map(|bytes| read(&bytes, self.of)))
    }

    /// The same when it has come.
    ///
    /// # Errors
    /// As there.
    pub async fn wait(self) -> Result<Environment> {
        Ok(read(&self.sums.wait().await?, self.of))
    }
}

fn read(bytes: &[u8], of: CubeMap) -> Environment {
    let sums: Vec<Vec4> = bytemuck::pod_collect_to_vec(&bytes[..9 * size_of::<Vec4>()]);
    let mut coefficients: [Vec3; 9] = std::array::from_fn(|i| sums[i].truncate());
    if of == CubeMap::Irradiance {
        // What the cosine has taken from each band.
        coefficients.iter_mut().zip(BANDS).for_each(|(sum, band)| *sum /= band);
    }
    // A map that holds what is no number is as good as none.
    if !coefficients.iter().all(|sum| sum.is_finite()) {
        coefficients = [Vec3::ZERO; 9];
    }
    Environment { coefficients }
}
