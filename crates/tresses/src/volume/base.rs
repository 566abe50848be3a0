//! A groom's constants in the uniforms: how much hair a sample, an integer unit and a cell represent.

use super::{
    grid::{Grid, mean_density},
    params::VolumeUniforms,
};
use crate::{
    Pose,
    constants::VOLUME_WORKGROUP,
    strands::{Guide, GuideBuffers, RestGuides},
};
use glam::{Quat, Vec3};

/// What all hair together weighs in the integers of the splat.
pub(super) const TOTAL_UNITS: f64 = (1u64 << 30) as f64;

/// The most vertices of a guide that become one sample.
const MOST_TOGETHER: u32 = 4;

impl VolumeUniforms {
    /// What depends on the groom and its grid alone.
    pub(super) fn of(grid: &Grid, guides: &GuideBuffers, rest: &RestGuides, most_splatted: u32) -> Self {
        // The blur sees no gaps between samples that are up to one and a half cells apart.
        let edges = guides.vertex_count.saturating_sub(1).max(1) as f32;
        let lengths = rest.info.iter().map(|guide| (guide.strands * guide.length, guide.strands));
        let (metres_of, strands_of) = lengths.fold((0f32, 0f32), |sum, x| (sum.0 + x.0, sum.1 + x.1));
        let edge = metres_of / strands_of / edges;
        // Also where there is no hair or no number.
        let vertices_per_sample = ((1.5 * grid.cell / edge) as u32).clamp(1, MOST_TOGETHER);
        let samples = guides.vertex_count.div_ceil(vertices_per_sample);
        let stride = guides.count.saturating_mul(samples).div_ceil(most_splatted).max(1);
        let metres = |guide: &Guide| {
            let metres = f64::from(guide.strands) * f64::from(guide.length);
            if metres.is_finite() { metres.max(0.0) } else { 0.0 }
        };
        let all: f64 = rest.info.iter().map(metres).sum();
        let splatted: f64 = rest.info.iter().step_by(stride as usize).map(metres).sum();
        let some = splatted > 1e-9;
        let units = if some { TOTAL_UNITS / splatted } else { 0.0 };
        let density = if some { all / TOTAL_UNITS / 1e3 / f64::from(grid.cell).powi(3) } else { 0.0 };
        Self {
            resolution: grid.resolution,
            bias: grid.bias,
            scale: grid.scale,
            cell: grid.cell,
            guide_count: guides.count,
            vertex_count: guides.vertex_count,
            stride,
            splat_count: guides.count.div_ceil(stride),
            vertices_per_sample,
            samples,
            one: 1,
            turn: Quat::IDENTITY.into(),
            units: units as f32,
            density: density as f32,
            reference: mean_density(rest).max(1e-6),
            ..Default::default()
        }
    }

    /// How many workgroups splat the hair.
    pub(super) fn splat_workgroups(&self) -> u32 {
        (self.splat_count * self.samples).div_ceil(VOLUME_WORKGROUP)
    }

    /// These with the head at `pose`, moving at `drift` (m/s).
    pub(super) fn placed(&self, pose: &Pose, drift: Vec3) -> Self {
        Self { head: pose.rotation.into(), head_at: pose.translation, drift, ..*self }
    }
}
