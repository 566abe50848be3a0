//! Hair of other grooms in one groom's grid: where two characters touch, each has the other's hair in its own grid,
//! where it pushes and rubs like its own.
//!
//! The splat kernel runs again for each other groom. Its uniforms transform the other's guides from their simulation
//! frame into this grid. Sums of integers are independent of order, so the order of the other grooms does not matter.
//! Their guides are in the state after their last step: two grooms that meet are simulated in turn.

use super::{
    HairHair, Volume,
    met::Neighbor,
    params::{STRIDE, VolumeUniforms},
    state::{Slots, splat},
};
use crate::{
    Context, Pose,
    clock::{MAX_STEPS, Steps},
    gpu::{BindBuffer, bindings},
    strands::GuideBuffers,
};
use glam::Vec3;

/// Another groom and its relation to this one.
#[derive(Debug)]
pub(crate) struct OtherGroom<'a> {
    pub guides: &'a GuideBuffers,
    pub volume: &'a Volume,
    /// Transform from the other's simulation frame to this hair's.
    pub way: Pose,
    /// Velocity of this hair's frame relative to the other's, m/s, in this frame's axes.
    pub closing: Vec3,
}

impl Volume {
    /// Adds `others` to the grid in the next frame.
    pub(crate) fn meet<'a>(&mut self, context: &Context, others: impl Iterator<Item = OtherGroom<'a>>) {
        let Context { device, .. } = context;
        let mut before = std::mem::take(&mut self.others);
        let mut met = |OtherGroom { guides, volume, way, closing }: OtherGroom<'_>| {
            let known = before.iter().position(|met| met.guides == *guides.current);
            if let Some(known) = known {
                return Neighbor { way, closing, ..before.swap_remove(known) };
            }
            let uniforms = bindings::uniform(device, "volume steps", (STRIDE * MAX_STEPS) as usize);
            let (rested, cells) = (volume.rested.entire(), self.cells.entire());
            let splat = splat(&self.pipelines, &uniforms, guides, rested, cells);
            let guides = (*guides.current).clone();
            Neighbor { guides, uniforms, splat, base: volume.base, way, closing }
        };
        self.others = others.filter(|other| other.volume.base.meters() > 0.0).map(&mut met).collect();
        self.meets_next = true;
    }

    /// Returns whether the grid holds other grooms in this frame.
    pub(crate) fn meets(&self) -> bool {
        !self.others.is_empty()
    }

    /// Begins a frame: removes the other grooms if [`meet`](Self::meet) was not called since the last frame.
    pub(crate) fn begin(&mut self) {
        if !std::mem::take(&mut self.meets_next) {
            self.others.clear();
        }
    }

    /// Returns the factor that reduces the integer units of all hair, so that their sum is no larger than without other
    /// grooms.
    pub(super) fn shared_units(&self) -> f64 {
        let own = self.base.meters();
        let others: f64 = self.others.iter().map(|met| met.base.meters()).sum();
        if own > 0.0 { own / (own + others) } else { 1.0 }
    }

    /// Writes the uniforms of the other grooms for the steps of `frame`. `shift`, meters, was added to all positions of
    /// this hair before these steps.
    pub(crate) fn prepare_others(
        &self,
        context: &Context,
        params: &HairHair,
        frame: &Steps<'_>,
        shift: Vec3,
    ) {
        let Context { queue, .. } = context;
        let own = self.with(params, frame.length);
        let share = self.shared_units() as f32;
        for met in &self.others {
            let way = Pose { translation: met.way.translation + shift, ..met.way };
            let base = VolumeUniforms {
                guide_count: met.base.guide_count,
                vertex_count: met.base.vertex_count,
                stride: met.base.stride,
                splat_count: met.base.splat_count,
                vertices_per_sample: met.base.vertices_per_sample,
                samples: met.base.samples,
                units: own.units * share * met.base.strands_each() / own.strands_each(),
                velocity_rotation: way.rotation.into(),
                ..own
            };
            let mut slots = Slots::new(MAX_STEPS);
            for (i, step) in frame.last().iter().enumerate() {
                // The head's pose in the other's carrier frame.
                let head = way.inverse().after(&step.begin);
                let drift = way.rotation.conjugate() * (step.drift(frame.length) + met.closing);
                slots.put(i as u32, &base.placed(&head, drift));
            }
            queue.write_buffer(&met.uniforms, 0, &slots.0);
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
