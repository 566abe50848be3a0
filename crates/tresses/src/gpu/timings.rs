//! GPU time per stage, from timestamps at the begin and end of each pass.

use crate::{Result, gpu::readback};

/// The most passes of one frame.
const MAX_PASSES: u32 = 64;

/// Collects a begin and an end timestamp for every pass of one frame.
#[derive(Debug)]
pub struct Timings {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    names: Vec<&'static str>,
    /// Nanoseconds per tick.
    period: f32,
}

impl Timings {
    /// Needs [`wgpu::Features::TIMESTAMP_QUERY`] on the device.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let count = 2 * MAX_PASSES;
        Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timings"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timings"),
                size: u64::from(count) * 8,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            names: Vec::new(),
            period: queue.get_timestamp_period(),
        }
    }

    fn next(&mut self, name: &'static str) -> Option<(u32, u32)> {
        let index = 2 * self.names.len() as u32;
        (index < 2 * MAX_PASSES).then(|| {
            self.names.push(name);
            (index, index + 1)
        })
    }

    /// The timestamps of a compute pass called `name`; passes of one name are added up.
    pub fn compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (begin, end) = self.next(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        })
    }

    /// The timestamps of a render pass called `name`; passes of one name are added up.
    pub fn render(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (begin, end) = self.next(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        })
    }

    /// Records the resolve; once per frame, after the last pass.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2 * self.names.len() as u32, &self.resolved, 0);
    }

    /// Milliseconds per name, in order of first use, and starts over. Blocks.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub fn read(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<(&'static str, f64)>> {
        let ticks: Vec<u64> = readback::buffer(device, queue, &self.resolved)?;
        let mut rows: Vec<(&'static str, f64)> = Vec::new();
        for (name, [begin, end]) in self.names.drain(..).zip(ticks.as_chunks().0) {
            let ms = end.saturating_sub(*begin) as f64 * f64::from(self.period) * 1e-6;
            match rows.iter_mut().find(|(known, _)| *known == name) {
                Some((_, sum)) => *sum += ms,
                None => rows.push((name, ms)),
            }
        }
        Ok(rows)
    }
}
