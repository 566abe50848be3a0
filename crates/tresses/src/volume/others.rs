//! Hair of other grooms in the grid of one: where two characters touch, each has the other's hair in its own grid as well,
//! which pushes and rubs as its own does.
//!
//! The kernel is the one that splats the groom's own hair, with uniforms that take the other's guides from the frame in
//! which they are simulated into the grid. Sums of integers do not depend on their order, so that it does not matter in
//! which order others come. They are where their last step left them: two grooms that meet see each other by turns.

use super::{
    HairHair, Volume,
    met::Met,
    params::{STRIDE, VolumeUniforms},
    state::{Slots, slot},
};
use crate::{
    Context, Pose,
    clock::{MAX_STEPS, Steps},
    gpu::bindings,
    strands::GuideBuffers,
};
use glam::Vec3;

/// Another groom, and how it lies to this one.
#[derive(Debug)]
pub(crate) struct Other<'a> {
    pub guides: &'a GuideBuffers,
    pub volume: &'a Volume,
    /// From the frame in which it is simulated to that of this hair.
    pub way: Pose,
    /// By how much faster this hair's frame goes than the other's, m/s in the axes of this one's.
    pub closing: Vec3,
}

impl Volume {
    /// In the next frame `others` are in its grid as well.
    pub(crate) fn meet<'a>(&mut self, context: &Context, others: impl Iterator<Item = Other<'a>>) {
        let Context { device, .. } = context;
        let mut before = std::mem::take(&mut self.others);
        let mut met = |Other { guides, volume, way, closing }: Other<'_>| {
            let known = before.iter().position(|met| met.guides == guides.current);
            if let Some(known) = known {
                return Met { way, closing, ..before.swap_remove(known) };
            }
            let uniforms = bindings::uniform(device, "volume steps", (STRIDE * MAX_STEPS) as usize);
            let buffers =
                [&guides.info, &guides.rest, &guides.current, &guides.velocity, &volume.rested, &self.cells];
            let bound = buffers.map(wgpu::Buffer::as_entire_binding);
            let entries: Vec<_> = std::iter::once(slot(&uniforms)).chain(bound).collect();
            let splat = self.pipelines.splat.bind(&entries);
            Met { guides: guides.current.clone(), uniforms, splat, base: volume.base, way, closing }
        };
        self.others = others.filter(|other| other.volume.base.metres() > 0.0).map(&mut met).collect();
        self.meets_next = true;
    }

    /// Whether any others are in its grid in this frame.
    pub(crate) fn meets(&self) -> bool {
        !self.others.is_empty()
    }

    /// A frame begins: those of the last one, whom it does not meet again, are forgotten.
    pub(crate) fn begin(&mut self) {
        if !std::mem::take(&mut self.meets_next) {
            self.others.clear();
        }
    }

    /// By how much the integers of all hair are smaller, so that their sum is no larger.
    pub(super) fn shared_units(&self) -> f64 {
        let own = self.base.metres();
        let others: f64 = self.others.iter().map(|met| met.base.metres()).sum();
        if own > 0.0 { own / (own + others) } else { 1.0 }
    }

    /// Writes the uniforms of others for the steps of `frame`, before which this hair's frame was shifted, so that `shift`
    /// was added to positions, metres.
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
                turn: way.rotation.into(),
                ..own
            };
            let mut slots = Slots::new(MAX_STEPS);
            for (i, step) in frame.last().iter().enumerate() {
                // The head as the other's carrier has it.
                let head = way.inverse().after(&step.begin);
                let drift = way.rotation.conjugate() * (step.drift(frame.length) + met.closing);
                slots.put(i as u32, &base.placed(&head, drift));
            }
            queue.write_buffer(&met.uniforms, 0, &slots.0);
        }
    }
}

impl VolumeUniforms {
    /// The length of all hair, metres.
    fn metres(&self) -> f64 {
        f64::from(self.density) * super::base::TOTAL_UNITS * 1e3 * f64::from(self.cell).powi(3)
    }

    /// For how much hair each metre that is splatted stands.
    fn strands_each(&self) -> f32 {
        self.density * 1e3 * self.cell.powi(3) * self.units
    }
}
