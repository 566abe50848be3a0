//! GPU time per stage, from timestamps at the beginning and end of each pass or from a CPU clock. Also splits a frame
//! into parts at the ends of its stages.

use super::{Context, Counts, readback::Pending};
use crate::{Error, Result};
use std::{sync::OnceLock, time::Duration};
use web_time::Instant;

/// Returns the time since a fixed moment.
pub type Clock = fn() -> Duration;

/// Wall-clock time since the first call.
pub fn wall() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// Largest number of timed passes in a frame: WebGPU allows 4,096 queries in a set.
const MAX_PASSES: u32 = 2048;

/// Timings of the passes of one frame.
#[derive(Debug)]
pub struct Timings {
    source: Source,
    counts: Vec<(&'static str, Counts)>,
    /// See [`untimed`](Self::untimed).
    untimed: u32,
}

#[derive(Debug)]
enum Source {
    /// Two timestamps per pass, at its beginning and its end.
    Timestamps {
        queries: wgpu::QuerySet,
        resolved: wgpu::Buffer,
        names: Vec<&'static str>,
        /// Passes of the frame beyond [`MAX_PASSES`].
        untimed: u32,
        /// Nanoseconds per tick.
        period: f32,
    },
    /// Each stage is submitted on its own, and the CPU waits for it.
    Clock { clock: Clock, since: Duration, rows: Vec<(&'static str, f64)>, lost: Option<Error> },
    /// Each stage becomes a command buffer of its own.
    Parts(Vec<wgpu::CommandBuffer>),
}

impl Timings {
    /// Measures by timestamps. The device needs [`wgpu::Features::TIMESTAMP_QUERY`].
    pub fn new(context: &Context) -> Self {
        let Context { device, queue, .. } = context;
        let count = 2 * MAX_PASSES;
        let source = Source::Timestamps {
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
            untimed: 0,
            period: queue.get_timestamp_period(),
        };
        Self { source, counts: Vec::new(), untimed: 0 }
    }

    /// Measures by a clock: [`wall`] or one that returns processor time. A [`crate::frame::Recorder`] then submits each
    /// part of a stage on its own and waits for it; the time of a part includes the submission and the wait.
    ///
    /// This is for tools on software drivers, where the timestamps of a compute pass are taken at the call, and the
    /// timestamps of a render pass when pixels are filled. A browser cannot wait, so there the times cover only the
    /// calls.
    pub fn by(clock: Clock) -> Self {
        let source = Source::Clock { clock, since: clock(), rows: Vec::new(), lost: None };
        Self { source, counts: Vec::new(), untimed: 0 }
    }

    /// Measures nothing, but splits a frame into [`parts`](Self::parts). The caller submits them in order, then what
    /// the encoder still holds. This lets other work use the queue during a very long frame. If parts are left out, the
    /// frame has no valid image, and the next frame renders its light again.
    pub fn of_parts() -> Self {
        Self { source: Source::Parts(Vec::new()), counts: Vec::new(), untimed: 0 }
    }

    /// Takes the recorded parts of the frame. There are none without [`of_parts`](Self::of_parts).
    pub fn parts(&mut self) -> Vec<wgpu::CommandBuffer> {
        match &mut self.source {
            Source::Parts(parts) => std::mem::take(parts),
            _ => Vec::new(),
        }
    }

    /// Whether the frame is split into parts, which should be short.
    pub(crate) fn is_split(&self) -> bool {
        matches!(self.source, Source::Parts(_))
    }

    fn next(&mut self, name: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let Source::Timestamps { queries, names, untimed, .. } = &mut self.source else { return None };
        let index = 2 * names.len() as u32;
        if index >= 2 * MAX_PASSES {
            *untimed += 1;
            return None;
        }
        names.push(name);
        Some((&*queries, index))
    }

    /// Timestamps for a compute pass. Passes with the same `name` are summed.
    pub fn compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (query_set, index) = self.next(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(index),
            end_of_pass_write_index: Some(index + 1),
        })
    }

    /// Timestamps for a render pass. Passes with the same `name` are summed.
    pub fn render(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (query_set, index) = self.next(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(index),
            end_of_pass_write_index: Some(index + 1),
        })
    }

    /// Begins a part of a stage. With a clock, commands recorded before count for no row.
    pub(crate) fn start(&mut self) {
        if let Source::Clock { clock, since, .. } = &mut self.source {
            *since = clock();
        }
    }

    /// Ends a part called `name` and begins the next. With a clock, submits the contents of `encoder` and waits; with
    /// [`of_parts`](Self::of_parts), stores them.
    pub(crate) fn lap(
        &mut self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        (name, counts): (&'static str, Counts),
    ) {
        let Context { device, queue, .. } = context;
        match self.counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, sum)) => *sum += counts,
            None => self.counts.push((name, counts)),
        }
        if matches!(self.source, Source::Timestamps { .. }) {
            return;
        }
        let recorded =
            std::mem::replace(encoder, device.create_command_encoder(&Default::default())).finish();
        let (clock, since, rows, lost) = match &mut self.source {
            Source::Clock { clock, since, rows, lost } => (clock, since, rows, lost),
            Source::Parts(parts) => return parts.push(recorded),
            Source::Timestamps { .. } => return,
        };
        context.flush_uniforms();
        queue.submit([recorded]);
        if let Err(error) = device.poll(wgpu::PollType::wait_indefinitely()) {
            *lost = Some(Error::Gpu { stage: name, problem: error.to_string() });
        }
        let now = clock();
        add(rows, name, now.saturating_sub(*since).as_secs_f64() * 1e3);
        *since = now;
    }

    /// Commands recorded for each row of the frame, in order of first use. Reading the times clears them.
    pub fn counts(&self) -> &[(&'static str, Counts)] {
        &self.counts
    }

    /// Passes that the rows of the last frame leave out, because it had more than can be timed.
    pub fn untimed(&self) -> u32 {
        self.untimed
    }

    /// Resolves the timestamps; call it once per frame, after the last pass.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Source::Timestamps { queries, resolved, names, .. } = &self.source {
            encoder.resolve_query_set(queries, 0..2 * names.len() as u32, resolved, 0);
        }
    }

    /// Waits for the frame and returns milliseconds per name, in order of first use. Then starts over. Programs that
    /// must not wait use [`start_read`](Self::start_read).
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(&mut self, context: &Context) -> Result<Vec<(&'static str, f64)>> {
        let PendingTimings { source, .. } = self.start_read(context);
        match source {
            RowSource::Ticks { ticks, names, period } => Ok(rows(&ticks.wait().await?, &names, period)),
            RowSource::Known(known) => known.unwrap_or_else(|| Ok(Vec::new())),
        }
    }

    /// Begins to read the times, after the frame is submitted, and starts over. The next frame can be recorded
    /// immediately.
    pub fn start_read(&mut self, context: &Context) -> PendingTimings {
        self.counts.clear();
        self.untimed = 0;
        let source = match &mut self.source {
            Source::Timestamps { resolved, names, untimed, period, .. } => {
                self.untimed = std::mem::take(untimed);
                RowSource::Ticks {
                    ticks: Pending::part(context, resolved, 16 * names.len().max(1) as u64),
                    names: std::mem::take(names),
                    period: *period,
                }
            }
            Source::Clock { rows, lost, .. } => RowSource::Known(Some(match lost.take() {
                Some(error) => Err(error),
                None => Ok(std::mem::take(rows)),
            })),
            Source::Parts(_) => RowSource::Known(None),
        };
        PendingTimings { source, span: None }
    }
}

/// Times of one frame that are still being read back.
#[derive(Debug)]
pub struct PendingTimings {
    source: RowSource,
    /// See [`span`](Self::span).
    span: Option<f64>,
}

#[derive(Debug)]
enum RowSource {
    Ticks { ticks: Pending, names: Vec<&'static str>, period: f32 },
    Known(Option<Result<Vec<(&'static str, f64)>>>),
}

impl PendingTimings {
    /// Returns milliseconds per name, once, if they have arrived. This requires that the GPU has finished the frame and
    /// that the device was polled, as a submission does.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub fn take(&mut self) -> Option<Result<Vec<(&'static str, f64)>>> {
        match &mut self.source {
            RowSource::Ticks { ticks, names, period } => {
                let ticks = ticks.take()?;
                self.span = ticks.as_ref().ok().and_then(|ticks| span(ticks, *period));
                Some(ticks.map(|ticks| rows(&ticks, names, *period)))
            }
            RowSource::Known(known) => known.take(),
        }
    }

    /// Milliseconds from the beginning of the frame's first timed pass to the end of its last, with the copies, fills
    /// and gaps between passes. `None` before the times were [taken](Self::take), and without timestamps.
    pub fn span(&self) -> Option<f64> {
        self.span
    }
}

/// Returns the milliseconds from the first tick to the last, which are in pairs.
fn span(ticks: &[u8], period: f32) -> Option<f64> {
    let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(ticks);
    let first = ticks.iter().step_by(2).min()?;
    let last = ticks.iter().skip(1).step_by(2).max()?;
    Some(last.saturating_sub(*first) as f64 * f64::from(period) * 1e-6)
}

/// Sums ticks of `period` nanoseconds per name.
fn rows(ticks: &[u8], names: &[&'static str], period: f32) -> Vec<(&'static str, f64)> {
    let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(ticks);
    let mut rows = Vec::new();
    for (name, [begin, end]) in names.iter().zip(ticks.as_chunks().0) {
        add(&mut rows, name, end.saturating_sub(*begin) as f64 * f64::from(period) * 1e-6);
    }
    rows
}

/// Adds a time to the row `name`.
fn add(rows: &mut Vec<(&'static str, f64)>, name: &'static str, ms: f64) {
    match rows.iter_mut().find(|(known, _)| *known == name) {
        Some((_, sum)) => *sum += ms,
        None => rows.push((name, ms)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_sum_passes_and_the_span_includes_gaps() {
        // Two passes of `a` with one of `b` between them, in ticks of half a microsecond.
        let ticks: [u64; 6] = [1_000, 3_000, 4_000, 8_000, 9_000, 10_000];
        let ticks = bytemuck::cast_slice(&ticks);
        assert_eq!(rows(ticks, &["a", "b", "a"], 500.0), [("a", 1.5), ("b", 2.0)]);
        assert_eq!(span(ticks, 500.0), Some(4.5));
        assert_eq!(span(&[], 500.0), None);
    }
}
