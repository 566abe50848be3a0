//! Measures frames, stage by stage. Blocks, so it is not for a browser.

use crate::{camera::Viewpoint, crowd::Crowd, motion::Motion, scene::Scene};
use anyhow::Result;
use tresses::character::Gesture;
use tresses::gpu::{Clock, Counts, Timings};

/// A frame that was waited for.
#[derive(Debug)]
pub struct Measured {
    /// Milliseconds from recording to completion.
    pub wall: f64,
    /// Milliseconds of its stages, where the adapter can tell.
    pub stages: Vec<(&'static str, f64)>,
    /// What was recorded for them.
    pub counts: Vec<(&'static str, Counts)>,
}

impl Scene {
    /// What is measured from here on is measured by `clock`, on adapters whose own timestamps do not compare.
    pub fn measure_by(&mut self, clock: Clock) {
        self.clock = clock;
        let tier = &self.gpu.context.tier();
        if tier.software || !tier.timestamps {
            self.timings = Timings::by(clock);
        }
    }

    /// A whole frame, waited for.
    pub fn measured_frame(
        &mut self,
        gesture: &Gesture,
        seconds: f32,
        camera: &Viewpoint,
    ) -> Result<Measured> {
        self.watch(camera);
        let start = (self.clock)();
        let mut timings = std::mem::replace(&mut self.timings, Timings::by(self.clock));
        // On a software driver they are those of a clock that waits for each part.
        let tier = &self.gpu.context.tier();
        let mut timed = (tier.timestamps || tier.software).then_some(&mut timings);
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, timed.as_deref_mut(), gesture, seconds)?;
        self.record_draw(&mut encoder, timed, camera)?;
        timings.resolve(&mut encoder);
        self.submit(encoder)?;
        let wall = (self.clock)().saturating_sub(start).as_secs_f64() * 1e3;
        self.timings = timings;
        let counts = self.timings.counts().to_vec();
        Ok(Measured { wall, stages: self.read_timings()?, counts })
    }

    /// The milliseconds of the stages that move the hair by a frame: by timestamps, or each stage
    /// submitted and waited for alone where there are none that compare.
    pub fn measured_advance(&mut self, gesture: &Gesture, seconds: f32) -> Result<Vec<(&'static str, f64)>> {
        let mut timings = std::mem::replace(&mut self.timings, Timings::by(self.clock));
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, Some(&mut timings), gesture, seconds)?;
        timings.resolve(&mut encoder);
        self.submit(encoder)?;
        self.timings = timings;
        self.read_timings()
    }

    /// A whole frame of `crowd`, waited for, at `time` of a motion; stage by stage if `staged`, which on a software driver
    /// takes longer: each part of each head is waited for then.
    pub fn measured_crowd(
        &mut self,
        crowd: &mut Crowd,
        motion: &Motion,
        times: (f64, f32),
        staged: bool,
    ) -> Result<Measured> {
        let start = (self.clock)();
        let mut timings = std::mem::replace(&mut self.timings, Timings::by(self.clock));
        let mut timed = staged.then_some(&mut timings);
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        crowd.record_advance(self, &mut encoder, timed.as_deref_mut(), motion, times)?;
        crowd.record_draw(self, &mut encoder, timed)?;
        if staged {
            timings.resolve(&mut encoder);
        }
        self.submit(encoder)?;
        let wall = (self.clock)().saturating_sub(start).as_secs_f64() * 1e3;
        self.timings = timings;
        let counts = self.timings.counts().to_vec();
        let stages = if staged { self.read_timings()? } else { Vec::new() };
        Ok(Measured { wall, stages, counts })
    }

    /// A whole frame of the one head, waited for as one.
    pub fn measured_whole(&mut self, gesture: &Gesture, seconds: f32, camera: &Viewpoint) -> Result<f64> {
        self.watch(camera);
        let start = (self.clock)();
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, None, gesture, seconds)?;
        self.record_draw(&mut encoder, None, camera)?;
        self.submit(encoder)?;
        Ok((self.clock)().saturating_sub(start).as_secs_f64() * 1e3)
    }

    /// Bytes of GPU memory that a picture takes per pixel.
    pub fn bytes_per_pixel(&self) -> f64 {
        let [width, height] = self.targets().size;
        self.targets().bytes() as f64 / (f64::from(width) * f64::from(height))
    }

    /// The rows of the frame that was waited for.
    fn read_timings(&mut self) -> Result<Vec<(&'static str, f64)>> {
        Ok(pollster::block_on(self.timings.read(&self.gpu.context))?)
    }
}
