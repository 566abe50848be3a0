//! Constants of a groom in the uniforms: hair per sample, per integer unit and per cell.

use super::{
    grid::{VolumeGrid, mean_density},
    params::VolumeUniforms,
};
use crate::{
    Pose,
    constants::VOLUME_WORKGROUP,
    strands::{Guide, RestGuides},
};
use glam::{Quat, Vec3};

/// Sum of all hair in the integer units of the splat.
pub(super) const TOTAL_UNITS: f64 = (1u64 << 30) as f64;

/// Maximum number of vertices of a guide in one sample.
const MAX_VERTICES_PER_SAMPLE: u32 = 4;

impl VolumeUniforms {
    /// Returns the uniforms that depend only on the groom and its grid.
    pub(super) fn of(grid: &VolumeGrid, rest: &RestGuides, max_samples: u32) -> Self {
        let (guide_count, vertex_count) = (rest.info.len() as u32, rest.vertex_count);
        // The blur hides gaps of up to one and a half cells between samples.
        let edges = vertex_count.saturating_sub(1).max(1) as f32;
        let lengths = rest.info.iter().map(|guide| (guide.strands * guide.length, guide.strands));
        let (meters_of, strands_of) = lengths.fold((0f32, 0f32), |sum, x| (sum.0 + x.0, sum.1 + x.1));
        let edge = meters_of / strands_of / edges;
        // Clamped also without hair, where the ratio is NaN.
        let vertices_per_sample = ((1.5 * grid.cell / edge) as u32).clamp(1, MAX_VERTICES_PER_SAMPLE);
        let samples = vertex_count.div_ceil(vertices_per_sample);
        let stride = guide_count.saturating_mul(samples).div_ceil(max_samples).max(1);
        let meters = |guide: &Guide| {
            let meters = f64::from(guide.strands) * f64::from(guide.length);
            if meters.is_finite() { meters.max(0.0) } else { 0.0 }
        };
        let all: f64 = rest.info.iter().map(meters).sum();
        let splatted: f64 = rest.info.iter().step_by(stride as usize).map(meters).sum();
        let some = splatted > 1e-9;
        let units = if some { TOTAL_UNITS / splatted } else { 0.0 };
        let density = if some { all / TOTAL_UNITS / 1e3 / f64::from(grid.cell).powi(3) } else { 0.0 };
        Self {
            resolution: grid.resolution,
            bias: grid.bias,
            scale: grid.scale,
            cell: grid.cell,
            guide_count,
            vertex_count,
            stride,
            splat_count: guide_count.div_ceil(stride),
            vertices_per_sample,
            samples,
            one: 1,
            velocity_rotation: Quat::IDENTITY.into(),
            units: units as f32,
            density: density as f32,
            reference: mean_density(rest).max(1e-6),
            ..Default::default()
        }
    }

    /// Returns the number of workgroups of the splat.
    pub(super) fn splat_workgroups(&self) -> u32 {
        (self.splat_count * self.samples).div_ceil(VOLUME_WORKGROUP)
    }

    /// Returns the uniforms with the head at `pose`, moving at `drift` (m/s).
    pub(super) fn placed(&self, pose: &Pose, drift: Vec3) -> Self {
        Self { head: pose.rotation.into(), head_at: pose.translation, drift, ..*self }
    }
}
