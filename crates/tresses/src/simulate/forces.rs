//! Forces of the hair and air grids on the guides: the kernel that samples both.

use super::SimulationParams;
use crate::{
    Context,
    clock::MAX_STEPS,
    constants::VOLUME_WORKGROUP,
    gpu::{BindBuffer, Kernel, Uniform, bindings},
    shaders::kernels::simulate as kernels,
    strands::GuideBuffers,
    volume::{self, Volume},
    wind::{Air, drag},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::sync::Arc;

/// The kernel and its sampler.
#[derive(Debug)]
pub(crate) struct ForcesKernel {
    pub(super) kernel: Kernel,
    sampler: wgpu::Sampler,
}

impl ForcesKernel {
    pub fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        Self {
            kernel: Kernel::new::<kernels::Forces>(&context.device),
            sampler: bindings::linear_sampler(device),
        }
    }
}

/// Writes [`GuideBuffers::forces`] of one groom from its hair and air grids.
#[derive(Debug)]
pub(crate) struct Forces {
    pipelines: Arc<super::Pipelines>,
    group: wgpu::BindGroup,
    air: Uniform,
    threads: u32,
}

/// Air parameters of one step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct AirUniforms {
    /// Corner of the air grid, meters.
    pub corner: Vec3,
    /// Texture coordinates per meter.
    pub scale: f32,
    /// Rate of the slow drag of calm air, 1/s ([`SimulationParams::drag`]).
    pub drag: f32,
    /// Reynolds number of a hair per m/s of relative speed.
    pub reynolds: f32,
    /// [`drag::drag_weight`], 1/m.
    pub weight: f32,
    /// 1 if there is wind.
    pub blows: u32,
}

/// Stride between the air uniforms of consecutive steps, bytes: a multiple of every adapter's alignment.
const AIR_STRIDE: u32 = 256;

impl Forces {
    /// Binds the grids of `volume` and, if present, of `air` to `guides`.
    pub fn new(context: &Context, guides: &GuideBuffers, volume: &Volume, air: Option<&Air>) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<super::Pipelines> = context.pipelines();
        let uniforms = device.storage_uniform((AIR_STRIDE * MAX_STEPS) as usize);
        // Calm air samples nothing, so any texture will do.
        let [texture, among] = air.map_or([&volume.hair; 2], |air| [&air.view, &air.among]);
        let group = pipelines.forces.kernel.bind(&kernels::Forces {
            volume: volume.uniforms(),
            current: guides.current.entire(),
            forces_out: guides.forces.entire(),
            hair: &volume.hair,
            push: &volume.push,
            grid_sampler: &pipelines.forces.sampler,
            air: uniforms.part(0, Some(size_of::<AirUniforms>() as u64)),
            wind: texture,
            velocity: guides.velocity.entire(),
            among,
        });
        Self { pipelines, group, air: uniforms, threads: guides.count * guides.vertex_count }
    }

    /// Writes the air uniforms of a frame of `count` steps.
    pub(crate) fn prepare(&self, physics: &SimulationParams, air: Option<&Air>, count: usize) {
        let mut bytes = vec![0u8; AIR_STRIDE as usize * count.min(MAX_STEPS as usize)];
        if let Some(air) = air {
            for (i, slot) in bytes.chunks_mut(AIR_STRIDE as usize).enumerate() {
                let grid = air.grid_after(i as u32);
                let uniforms = AirUniforms {
                    corner: grid.corner,
                    scale: grid.scale,
                    drag: physics.drag,
                    reynolds: physics.diameter / drag::AIR_VISCOSITY,
                    weight: drag::drag_weight(physics.diameter, physics.line_density),
                    blows: 1,
                };
                slot[..size_of::<AirUniforms>()].copy_from_slice(bytemuck::bytes_of(&uniforms));
            }
        }
        self.air.write(0, &bytes);
    }

    /// Bytes of GPU memory.
    pub(crate) fn bytes(&self) -> u64 {
        self.air.size()
    }

    /// Records the dispatch for step `i` of those written by [`Volume::prepare`].
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, i: u32) {
        let workgroups = self.threads.div_ceil(VOLUME_WORKGROUP);
        self.pipelines.forces.kernel.record(
            pass,
            &self.group,
            &[volume::offset(i), i * AIR_STRIDE],
            workgroups,
        );
    }
}
