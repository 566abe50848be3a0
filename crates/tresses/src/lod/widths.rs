//! Host side of `widths.wesl`.

use super::{Detail, maps::PaintedFactors};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{BindBuffer, Kernel, PipelineSet, Uniform},
    shaders::kernels::lod as kernels,
    strands::{Strand, StrandBuffers, buffers::filled},
};
use bytemuck::{Pod, Zeroable};
use glam::Vec4;
use half::f16;
use std::sync::Arc;

/// Level-of-detail data of one strand.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct StrandLod {
    /// Radius at full detail, meters.
    pub radius: f32,
    /// Two half floats: the drawn shares at which the strand begins to appear and at which it has its full width.
    pub span: u32,
    /// One byte per painted level: factor on the drawn share, 255 is 1.
    pub density: u32,
    /// One byte per painted level: factor on the width, 63 is 1.
    pub thickness: u32,
}

/// The uniform of the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct WidthParams {
    /// Blend weights of the painted levels.
    pub weights: Vec4,
    /// Share of the strands that is drawn.
    pub fraction: f32,
    /// Factor on strand widths.
    pub width: f32,
    /// Number of drawn strands.
    pub count: u32,
    /// Unused.
    pub _pad: u32,
}

/// The pipeline that writes strand widths.
#[derive(Debug)]
pub(crate) struct Widths(Kernel);

impl PipelineSet for Widths {
    fn new(context: &Context) -> Self {
        Self(Kernel::new::<kernels::Widths>(&context.device))
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.0]
    }
}

/// Data of the strands of a groom that does not depend on the current level.
pub(super) fn upload(
    context: &Context,
    strands: &[Strand],
    ends: &[u32],
    painted: &PaintedFactors,
) -> Result<wgpu::Buffer> {
    let mut bucket = 0;
    let lods: Vec<_> = strands
        .iter()
        .enumerate()
        .map(|(i, strand)| {
            bucket += usize::from(i as u32 >= ends[bucket]);
            StrandLod {
                radius: strand.radius,
                span: span(ends, bucket),
                density: painted.density[i],
                thickness: painted.thickness[i],
            }
        })
        .collect();
    filled(context, "strand levels of detail", bytemuck::cast_slice(&lods))
}

/// The kernel's state for one head.
#[derive(Debug)]
pub(super) struct WidthStage {
    pipeline: Arc<Widths>,
    params: Uniform,
    group: wgpu::BindGroup,
}

impl WidthStage {
    /// Binds `lods` to the strands of one head.
    pub fn new(context: &Context, lods: &wgpu::Buffer, buffers: &StrandBuffers) -> Self {
        let pipeline: Arc<Widths> = context.pipelines();
        let params = context.device.uniform(size_of::<WidthParams>());
        let group = pipeline.0.bind(&kernels::Widths {
            params: params.entire(),
            lods: lods.entire(),
            strands: buffers.strands.entire(),
            widening: buffers.widening.entire(),
        });
        Self { pipeline, params, group }
    }

    pub fn prepare(&self, detail: &Detail) {
        let params = WidthParams {
            weights: Vec4::from_array(detail.levels),
            fraction: detail.fraction,
            width: detail.width,
            count: detail.strand_count,
            _pad: 0,
        };
        self.params.write(0, bytemuck::bytes_of(&params));
    }

    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, count: u32) {
        self.pipeline.0.record(pass, &self.group, &[], count.div_ceil(STRAND_WORKGROUP));
    }

    pub fn bytes(&self) -> u64 {
        self.params.size()
    }
}

/// Returns the share range of a bucket's strands, packed.
fn span(ends: &[u32], bucket: usize) -> u32 {
    let [from, to] = super::span(ends, bucket);
    u32::from(f16::from_f32(from).to_bits()) | u32::from(f16::from_f32(to).to_bits()) << 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_survive_packing() {
        for i in 1..=10_000u32 {
            let ends = [i, 10_000 + i];
            for bucket in 0..2 {
                let packed = span(&ends, bucket);
                let back = [packed, packed >> 16].map(|bits| f16::from_bits(bits as u16).to_f32());
                for (back, value) in back.into_iter().zip(super::super::span(&ends, bucket)) {
                    assert!((back - value).abs() <= value * 5e-4 + 3.1e-8, "{value} {back}");
                }
            }
        }
    }
}
