//! Host side of `spline.wesl`, and of `walk.wesl`, which `interpolate::follow` also uses.

use crate::{
    Context, Pose,
    constants::GUIDE_WORKGROUP,
    gpu::{BindBuffer, Kernel, PipelineSet, Uniform},
    groom::curve,
    shaders::kernels::tessellate as kernels,
    strands::GuideBuffers,
};
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// Uniform of the kernel, created by [`TessellateParams::new`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct TessellateParams {
    /// Rotation from the state before the last step to the head's current pose.
    pub previous_rotation: Quat,
    /// Rotation from the state after the last step to the head's current pose.
    pub current_rotation: Quat,
    /// Current rotation of the head.
    pub head_rotation: Quat,
    /// Translation from the state before the last step to the head's current pose, meters.
    pub previous_translation: Vec3,
    /// Interpolation factor: 0 draws the previous state, 1 the current one.
    pub blend: f32,
    /// Translation from the state after the last step to the head's current pose, meters.
    pub current_translation: Vec3,
    /// Number of guides.
    pub guide_count: u32,
    /// Vertices per guide, at least 2.
    pub vertex_count: u32,
    /// Samples per guide, at least 2 if there are any.
    pub sample_count: u32,
    /// Duration of the last step, s.
    pub span: f32,
    /// 1 if guides twist, else 0.
    pub twists: f32,
    /// Current position of the head, meters.
    pub head_translation: Vec3,
    /// Unused.
    pub _pad: u32,
}

impl TessellateParams {
    /// Returns the uniform for a head that was at `previous` and `current` after the last two steps, `span` seconds
    /// apart, and is now at `now`. `blend` is the interpolation factor; `twists` tells whether guides twist.
    pub fn new(
        guides: &GuideBuffers,
        (previous, current, span): (&Pose, &Pose, f32),
        now: &Pose,
        (blend, twists): (f32, bool),
    ) -> Self {
        let (from_previous, from_current) = (now.after(&previous.inverse()), now.after(&current.inverse()));
        Self {
            previous_rotation: from_previous.rotation,
            current_rotation: from_current.rotation,
            head_rotation: now.rotation,
            previous_translation: from_previous.translation,
            blend,
            current_translation: from_current.translation,
            guide_count: guides.count,
            vertex_count: guides.vertex_count,
            sample_count: guides.sample_count,
            span,
            twists: f32::from(u8::from(twists)),
            head_translation: now.translation,
            _pad: 0,
        }
    }
}

/// The stage's pipeline.
#[derive(Debug)]
pub(crate) struct Pipelines {
    kernel: Kernel,
}

impl PipelineSet for Pipelines {
    fn new(context: &Context) -> Self {
        Self { kernel: Kernel::new::<kernels::Spline>(&context.device) }
    }

    fn kernels(&self) -> Vec<&Kernel> {
        vec![&self.kernel]
    }
}

/// Tessellation of one groom.
#[derive(Debug)]
pub(crate) struct Tessellation {
    pipelines: Arc<Pipelines>,
    params: Uniform,
    group: wgpu::BindGroup,
}

impl Tessellation {
    /// Creates the tessellation of `guides`.
    pub fn new(context: &Context, guides: &GuideBuffers) -> Self {
        let Context { device, .. } = context;
        let pipelines: Arc<Pipelines> = context.pipelines();
        let params = device.uniform(size_of::<TessellateParams>());
        let bindings = kernels::Spline { walk: walk(&params, guides), samples: guides.samples.entire() };
        Self { group: pipelines.kernel.bind(&bindings), pipelines, params }
    }

    /// Returns the bindings of a kernel that walks along this frame's guides.
    pub(crate) fn walk<'a>(&'a self, guides: &'a GuideBuffers) -> kernels::Walk<'a> {
        walk(&self.params, guides)
    }

    /// Writes the uniform of a frame.
    pub fn prepare(&self, params: &TessellateParams) {
        self.params.write(0, bytemuck::bytes_of(params));
    }

    /// Records the stage, with one thread per guide. Does nothing if guides have no samples.
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>, guides: &GuideBuffers) {
        if guides.sample_count > 0 {
            self.pipelines.kernel.record(pass, &self.group, &[], guides.count.div_ceil(GUIDE_WORKGROUP));
        }
    }
}

/// Returns the bindings of `walk.wesl`.
fn walk<'a>(params: &'a Uniform, guides: &'a GuideBuffers) -> kernels::Walk<'a> {
    kernels::Walk {
        params: params.entire(),
        current: guides.current.entire(),
        velocity: guides.velocity.entire(),
        rest: guides.rest.entire(),
        info: guides.info.entire(),
        roots: guides.roots.entire(),
    }
}

/// Returns the samples of a guide at rest: the same spline over `vertices`, without rotations. Positions equal the
/// kernel's. Needs at least two vertices and two samples.
pub fn rest_samples(vertices: &[Vec3], sample_count: u32) -> Vec<Vec3> {
    let edges_per_sample = (vertices.len() - 1) as f32 / (sample_count - 1) as f32;
    (0..sample_count).map(|sample| curve::spline_at(vertices, sample as f32 * edges_per_sample)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spline_starts_at_root_and_ends_at_tip() {
        let vertices: Vec<_> =
            (0..9).map(|i| Vec3::new((i as f32).sin(), -0.1 * i as f32, (i as f32).cos())).collect();
        let samples = rest_samples(&vertices, 33);
        assert!(samples[0].distance(vertices[0]) < 1e-6);
        assert!(samples[32].distance(vertices[8]) < 1e-6);
        // Every fourth sample is a knot: (P[i-1] + 4 P[i] + P[i+1]) / 6.
        let knot = (vertices[3] + 4.0 * vertices[4] + vertices[5]) / 6.0;
        assert!(samples[16].distance(knot) < 1e-6);
    }

    #[test]
    fn straight_guide_stays_straight_and_even() {
        let vertices: Vec<_> = (0..5).map(|i| Vec3::Y * i as f32).collect();
        for (i, sample) in rest_samples(&vertices, 17).into_iter().enumerate() {
            assert!(sample.distance(Vec3::Y * i as f32 * 0.25) < 1e-5);
        }
    }
}
