//! Frame timing, per stage. The functions block, so browsers cannot use them.

use crate::{camera::Viewpoint, crowd::Crowd, motion::Motion, scene::Scene};
use anyhow::Result;
use tresses::Gesture;
use tresses::{
    Timings,
    low_level::{Clock, Counts},
};

/// Timing of a completed frame.
#[derive(Debug)]
pub struct MeasuredFrame {
    /// Wall time from recording to completion, ms.
    pub wall: f64,
    /// Time per stage, ms, if the adapter can measure it.
    pub stages: Vec<(&'static str, f64)>,
    /// Recorded GPU commands per stage.
    pub counts: Vec<(&'static str, Counts)>,
}

impl Scene {
    /// Sets the clock of measurements on adapters without comparable timestamps.
    pub fn measure_by(&mut self, clock: Clock) {
        self.clock = clock;
        let tier = &self.gpu.context.tier();
        if tier.software || !tier.timestamps {
            self.timings = Timings::by(clock);
        }
    }

    /// Measures a frame and waits for it.
    pub fn measured_frame(
        &mut self,
        gesture: &Gesture,
        seconds: f32,
        camera: &Viewpoint,
    ) -> Result<MeasuredFrame> {
        self.watch(camera);
        let start = (self.clock)();
        let mut timings = std::mem::replace(&mut self.timings, Timings::by(self.clock));
        // A software driver uses a clock that waits for each part.
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
        Ok(MeasuredFrame { wall, stages: self.read_timings()?, counts })
    }

    /// Measures the stages that advance the hair by a frame, ms. Without comparable timestamps, each stage is submitted
    /// and awaited separately.
    pub fn measured_advance(&mut self, gesture: &Gesture, seconds: f32) -> Result<Vec<(&'static str, f64)>> {
        let mut timings = std::mem::replace(&mut self.timings, Timings::by(self.clock));
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, Some(&mut timings), gesture, seconds)?;
        timings.resolve(&mut encoder);
        self.submit(encoder)?;
        self.timings = timings;
        self.read_timings()
    }

    /// Measures a frame of `crowd` and waits for it. `times` holds the time of the motion and the length of the frame,
    /// seconds. `staged` also measures each stage, which takes longer on a software driver because it waits for each
    /// part of each head.
    pub fn measured_crowd(
        &mut self,
        crowd: &mut Crowd,
        motion: &Motion,
        times: (f64, f32),
        staged: bool,
    ) -> Result<MeasuredFrame> {
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
        Ok(MeasuredFrame { wall, stages, counts })
    }

    /// Measures a frame without separating its stages, ms.
    pub fn measured_frame_time(
        &mut self,
        gesture: &Gesture,
        seconds: f32,
        camera: &Viewpoint,
    ) -> Result<f64> {
        self.watch(camera);
        let start = (self.clock)();
        let mut encoder = self.gpu.context.device().create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, None, gesture, seconds)?;
        self.record_draw(&mut encoder, None, camera)?;
        self.submit(encoder)?;
        Ok((self.clock)().saturating_sub(start).as_secs_f64() * 1e3)
    }

    /// Reads the stage timings of the last frame.
    fn read_timings(&mut self) -> Result<Vec<(&'static str, f64)>> {
        Ok(pollster::block_on(self.timings.read(&self.gpu.context))?)
    }
}
