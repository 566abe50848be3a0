//! Hair of other grooms in one groom's grid: where two characters touch, each has the other's hair in its own grid,
//! where it pushes and rubs like its own.
//!
//! The splat kernel runs again for each other groom. Its uniforms transform the other's guides from their simulation
//! frame into this grid. Sums of integers are independent of order, so the order of the other grooms does not matter.
//! Their guides are in the state after their last step: two grooms that meet are simulated in turn.

use super::{
    HairHair, Volume,
    neighbor::Neighbor,
    params::{STRIDE, VolumeUniforms},
    state::{Slots, splat},
};
use crate::{
    Context, Pose,
    clock::{MAX_STEPS, Steps},
    gpu::BindBuffer,
    strands::GuideBuffers,
};
use glam::Vec3;

/// Another groom and its relation to this one.
#[derive(Debug)]
pub(crate) struct OtherGroom<'a> {
    pub guides: &'a GuideBuffers,
    pub volume: &'a Volume,
    /// Transform from the other's simulation frame to this hair's.
    pub transform: Pose,
    /// Velocity of this hair's frame relative to the other's, m/s, in this frame's axes.
    pub closing: Vec3,
}

impl Volume {
    /// Adds `others` to the grid in the next frame.
    pub(crate) fn set_neighbors<'a>(
        &mut self,
        context: &Context,
        others: impl Iterator<Item = OtherGroom<'a>>,
    ) {
        let Context { device, .. } = context;
        let mut before = std::mem::take(&mut self.neighbors);
        let mut to_neighbor = |OtherGroom { guides, volume, transform, closing }: OtherGroom<'_>| {
            let known = before.iter().position(|neighbor| neighbor.guides == *guides.current);
            if let Some(known) = known {
                return Neighbor { transform, closing, ..before.swap_remove(known) };
            }
            let uniforms = device.uniform((STRIDE * MAX_STEPS) as usize);
            let (rested, cells) = (volume.rested.entire(), self.cells.entire());
            let splat = splat(&self.pipelines, &uniforms, guides, rested, cells);
            let guides = (*guides.current).clone();
            Neighbor { guides, uniforms, splat, base: volume.base, transform, closing }
        };
        self.neighbors =
            others.filter(|other| other.volume.base.meters() > 0.0).map(&mut to_neighbor).collect();
        self.has_new_neighbors = true;
    }

    /// Returns whether the grid holds other grooms in this frame.
    pub(crate) fn has_neighbors(&self) -> bool {
        !self.neighbors.is_empty()
    }

    /// Begins a frame: removes the other grooms if [`set_neighbors`](Self::set_neighbors) was not called since the last
    /// frame.
    pub(crate) fn begin(&mut self) {
        if !std::mem::take(&mut self.has_new_neighbors) {
            self.neighbors.clear();
        }
    }

    /// Returns the factor that reduces the integer units of all hair, so that their sum is no larger than without other
    /// grooms.
    pub(super) fn shared_units(&self) -> f64 {
        let own = self.base.meters();
        let others: f64 = self.neighbors.iter().map(|neighbor| neighbor.base.meters()).sum();
        if own > 0.0 { own / (own + others) } else { 1.0 }
    }

    /// Writes the uniforms of the other grooms for the steps of `frame`. `shift`, meters, was added to all positions of
    /// this hair before these steps.
    pub(crate) fn prepare_others(&self, params: &HairHair, frame: &Steps<'_>, shift: Vec3) {
        let own = self.with(params, frame.length);
        let unit_scale = self.shared_units() as f32;
        for neighbor in &self.neighbors {
            let transform =
                Pose { translation: neighbor.transform.translation + shift, ..neighbor.transform };
            let base = VolumeUniforms {
                guide_count: neighbor.base.guide_count,
                vertex_count: neighbor.base.vertex_count,
                stride: neighbor.base.stride,
                splat_count: neighbor.base.splat_count,
                vertices_per_sample: neighbor.base.vertices_per_sample,
                samples: neighbor.base.samples,
                units: own.units * unit_scale * neighbor.base.strands_each() / own.strands_each(),
                velocity_rotation: transform.rotation.into(),
                ..own
            };
            let mut slots = Slots::new(MAX_STEPS);
            for (i, step) in frame.last().iter().enumerate() {
                // The head's pose in the other's carrier frame.
                let head = transform.inverse().after(&step.begin);
                let drift = transform.rotation.conjugate() * (step.drift(frame.length) + neighbor.closing);
                slots.put(i as u32, &base.placed(&head, drift));
            }
            neighbor.uniforms.write(0, &slots.0);
        }
    }
}

impl VolumeUniforms {
    /// Returns the total length of hair, meters.
    fn meters(&self) -> f64 {
        f64::from(self.density) * super::base::TOTAL_UNITS * 1e3 * f64::from(self.cell).powi(3)
    }

    /// Returns the length of hair that one splatted meter represents, meters.
    fn strands_each(&self) -> f32 {
        self.density * 1e3 * self.cell.powi(3) * self.units
    }
}
