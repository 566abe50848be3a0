//! How long a stage's frames take, stage by stage. Waits for them: not for a browser.

use crate::{camera::Camera, stage::Stage};
use anyhow::{Context, Result};
use std::time::Instant;
use tresses::{
    Pose,
    gpu::{Gpu, Timings},
};

impl Stage {
    /// A whole frame, waited for: its milliseconds from recording to completion, and those of its
    /// stages where the adapter can tell.
    pub fn measured_frame(
        &mut self,
        pose: &Pose,
        seconds: f32,
        camera: &Camera,
    ) -> Result<(f64, Vec<(&'static str, f64)>)> {
        self.watch(camera);
        if self.gpu.tier.software {
            let start = Instant::now();
            let mut stages = self.stage_by_stage(pose, seconds, camera)?;
            let wall = start.elapsed().as_secs_f64() * 1e3;
            self.split_thickness(&mut stages)?;
            return Ok((wall, stages));
        }
        let start = Instant::now();
        let mut timings = std::mem::replace(&mut self.timings, Timings::by_the_clock());
        let mut timed = self.gpu.tier.timestamps.then_some(&mut timings);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, timed.as_deref_mut(), pose, seconds)?;
        self.record_draw(&mut encoder, timed, camera)?;
        timings.resolve(&mut encoder);
        self.submit(encoder)?;
        let wall = start.elapsed().as_secs_f64() * 1e3;
        self.timings = timings;
        Ok((wall, self.read_timings()?))
    }

    /// The milliseconds of the stages that move the hair by a frame: by timestamps, or each stage
    /// submitted and waited for alone where there are none that compare.
    pub fn measured_advance(&mut self, pose: &Pose, seconds: f32) -> Result<Vec<(&'static str, f64)>> {
        let mut timings = std::mem::replace(&mut self.timings, Timings::by_the_clock());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, Some(&mut timings), pose, seconds)?;
        timings.resolve(&mut encoder);
        self.submit(encoder)?;
        self.timings = timings;
        self.read_timings()
    }

    /// The stages of a frame, each submitted and waited for alone, and its milliseconds by the clock.
    ///
    /// Mesa's software driver writes the timestamps of drawing when pixels are filled, those of
    /// compute when it is called, so that differences between them mean nothing.
    fn stage_by_stage(
        &mut self,
        pose: &Pose,
        seconds: f32,
        camera: &Camera,
    ) -> Result<Vec<(&'static str, f64)>> {
        self.look_from(camera);
        let mut rows = self.measured_advance(pose, seconds)?;
        let Self { gpu: Gpu { device, queue, .. }, renderer, hair, body, targets, look: scene, .. } = self;
        let body = body.as_ref();
        let mut stage = |name, record: &mut dyn FnMut(&mut wgpu::CommandEncoder) -> Result<()>| {
            let start = Instant::now();
            let mut encoder = device.create_command_encoder(&Default::default());
            record(&mut encoder)?;
            queue.submit([encoder.finish()]);
            device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
            rows.push((name, start.elapsed().as_secs_f64() * 1e3));
            anyhow::Ok(())
        };
        let drawing = &renderer.draw;
        let set = Some(&hair.set);
        stage("shadow", &mut |encoder| {
            drawing.prepare(queue, scene, targets, set, body);
            drawing.shadow(encoder, None, scene, set, body);
            Ok(())
        })?;
        stage("shade", &mut |encoder| {
            drawing.shade(encoder, None, &hair.set);
            Ok(())
        })?;
        for is_body in [drawing.body_first(), !drawing.body_first()] {
            stage(if is_body { "draw body" } else { "draw hair" }, &mut |encoder| {
                if is_body {
                    drawing.draw_body(encoder, None, targets, body);
                } else {
                    drawing.draw_hair(encoder, None, scene, targets, set);
                }
                Ok(())
            })?;
        }
        stage("present", &mut |encoder| {
            drawing.present(device, encoder, None, targets, targets.picture());
            Ok(())
        })?;
        Ok(rows)
    }

    /// Of peeled hair, takes the pass that measures its thickness out of the row of the hair into one of its
    /// own, by drawing it once more.
    fn split_thickness(&self, rows: &mut Vec<(&'static str, f64)>) -> Result<()> {
        let Self { gpu: Gpu { device, queue, .. }, renderer, hair, targets, look: scene, .. } = self;
        let start = Instant::now();
        let mut encoder = device.create_command_encoder(&Default::default());
        if !renderer.draw.draw_thickness(&mut encoder, scene, targets, &hair.set) {
            return Ok(());
        }
        queue.submit([encoder.finish()]);
        device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
        let time = start.elapsed().as_secs_f64() * 1e3;
        if let Some(at) = rows.iter().position(|(name, _)| *name == "draw hair") {
            rows[at].1 -= time;
            rows.insert(at + 1, ("thickness", time));
        }
        Ok(())
    }

    /// Bytes of GPU memory that a picture takes per pixel.
    pub fn bytes_per_pixel(&self) -> f64 {
        let [width, height] = self.targets.size;
        self.targets.bytes() as f64 / (f64::from(width) * f64::from(height))
    }

    /// The rows of the frame that was waited for.
    fn read_timings(&mut self) -> Result<Vec<(&'static str, f64)>> {
        Ok(pollster::block_on(self.timings.read(&self.gpu.device, &self.gpu.queue))?)
    }
}
