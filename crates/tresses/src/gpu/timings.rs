//! GPU time per stage: from timestamps at the beginning and end of each pass, or by wall clock. What knows where stages
//! end also takes frames apart.

use super::{Context, Counts, readback::Pending};
use crate::{Error, Result};
use std::{sync::OnceLock, time::Duration};
use web_time::Instant;

/// The time since some moment that stays the same.
pub type Clock = fn() -> Duration;

/// The clock on the wall.
pub fn wall() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// The most passes of one frame.
const MAX_PASSES: u32 = 64;

/// Collects the times of the passes of one frame.
#[derive(Debug)]
pub struct Timings {
    source: Source,
    counts: Vec<(&'static str, Counts)>,
}

#[derive(Debug)]
enum Source {
    /// A begin and an end timestamp for every pass.
    Timestamps {
        queries: wgpu::QuerySet,
        resolved: wgpu::Buffer,
        names: Vec<&'static str>,
        /// Nanoseconds per tick.
        period: f32,
    },
    /// Every stage is submitted and waited for alone.
    Clock { clock: Clock, since: Duration, rows: Vec<(&'static str, f64)>, lost: Option<Error> },
    /// Every stage is a part of its own.
    Parts(Vec<wgpu::CommandBuffer>),
}

impl Timings {
    /// From timestamps; needs [`wgpu::Features::TIMESTAMP_QUERY`] on the device.
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
            period: queue.get_timestamp_period(),
        };
        Self { source, counts: Vec::new() }
    }

    /// By a clock, [`wall`] or one of the processor's time: a [`crate::frame::Recorder`] submits the parts of its stages one by
    /// one and waits for each. For tools on a software driver, whose timestamps of compute passes
    /// are those of the call, and those of drawing when pixels are filled; a part's time holds the call and
    /// the waiting. In a browser, where nothing can be waited for, the times are those of the calls alone.
    pub fn by(clock: Clock) -> Self {
        let source = Source::Clock { clock, since: clock(), rows: Vec::new(), lost: None };
        Self { source, counts: Vec::new() }
    }

    /// Of nothing: the [`parts`](Self::parts) of a frame that is recorded with it are to be submitted one by one, what
    /// its encoder still holds last. For frames so long that others want the queue meanwhile; a frame of which parts are
    /// left out is no picture, and the next one is lit anew.
    pub fn of_parts() -> Self {
        Self { source: Source::Parts(Vec::new()), counts: Vec::new() }
    }

    /// The parts of a frame, and starts over; without [`of_parts`](Self::of_parts) there are none.
    pub fn parts(&mut self) -> Vec<wgpu::CommandBuffer> {
        match &mut self.source {
            Source::Parts(parts) => std::mem::take(parts),
            _ => Vec::new(),
        }
    }

    /// Whether frames are taken apart, and are to be in parts that are not too long.
    pub(crate) fn takes_apart(&self) -> bool {
        matches!(self.source, Source::Parts(_))
    }

    fn next(&mut self, name: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let Source::Timestamps { queries, names, .. } = &mut self.source else { return None };
        let index = 2 * names.len() as u32;
        (index < 2 * MAX_PASSES).then(|| {
            names.push(name);
            (&*queries, index)
        })
    }

    /// The timestamps of a compute pass called `name`; passes of one name are added up.
    pub fn compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (query_set, index) = self.next(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(index),
            end_of_pass_write_index: Some(index + 1),
        })
    }

    /// The timestamps of a render pass called `name`; passes of one name are added up.
    pub fn render(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (query_set, index) = self.next(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(index),
            end_of_pass_write_index: Some(index + 1),
        })
    }

    /// By the clock, a part of a stage begins here. What was recorded before belongs to no row.
    pub(crate) fn start(&mut self) {
        if let Source::Clock { clock, since, .. } = &mut self.source {
            *since = clock();
        }
    }

    /// A part called `name` ends here and the next begins. By the clock, what `encoder` holds is submitted and
    /// waited for; [of parts](Self::of_parts), it is kept.
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
        queue.submit([recorded]);
        if let Err(error) = device.poll(wgpu::PollType::wait_indefinitely()) {
            *lost = Some(Error::Gpu { stage: name, problem: error.to_string() });
        }
        let now = clock();
        add(rows, name, now.saturating_sub(*since).as_secs_f64() * 1e3);
        *since = now;
    }

    /// What was recorded for each row of the frame, in order of first use; before its times are read.
    pub fn counts(&self) -> &[(&'static str, Counts)] {
        &self.counts
    }

    /// Records the resolve; once per frame, after the last pass.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Source::Timestamps { queries, resolved, names, .. } = &self.source {
            encoder.resolve_query_set(queries, 0..2 * names.len() as u32, resolved, 0);
        }
    }

    /// Milliseconds per name, in order of first use, and starts over. Waits for the frame: a program that
    /// must not takes [`later`](Self::later).
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn read(&mut self, context: &Context) -> Result<Vec<(&'static str, f64)>> {
        let Rows { source } = self.later(context);
        match source {
            RowSource::Ticks { ticks, names, period } => Ok(rows(&ticks.wait().await?, &names, period)),
            RowSource::Known(known) => known.unwrap_or_else(|| Ok(Vec::new())),
        }
    }

    /// Begins to read what [`read`](Self::read) gives, after the submission of the frame, and starts over:
    /// the next frame may be recorded at once.
    pub fn later(&mut self, context: &Context) -> Rows {
        self.counts.clear();
        let source = match &mut self.source {
            Source::Timestamps { resolved, names, period, .. } => RowSource::Ticks {
                ticks: Pending::buffer(context, resolved),
                names: std::mem::take(names),
                period: *period,
            },
            Source::Clock { rows, lost, .. } => RowSource::Known(Some(match lost.take() {
                Some(error) => Err(error),
                None => Ok(std::mem::take(rows)),
            })),
            Source::Parts(_) => RowSource::Known(None),
        };
        Rows { source }
    }
}

/// The times of one frame, on their way to the CPU.
#[derive(Debug)]
pub struct Rows {
    source: RowSource,
}

#[derive(Debug)]
enum RowSource {
    Ticks { ticks: Pending, names: Vec<&'static str>, period: f32 },
    Known(Option<Result<Vec<(&'static str, f64)>>>),
}

impl Rows {
    /// The milliseconds per name, once, if they have arrived by now: after the GPU is done with the
    /// frame and the device has been polled, as a submission does.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub fn take(&mut self) -> Option<Result<Vec<(&'static str, f64)>>> {
        match &mut self.source {
            RowSource::Ticks { ticks, names, period } => {
                let ticks = ticks.take()?;
                Some(ticks.map(|ticks| rows(&ticks, names, *period)))
            }
            RowSource::Known(known) => known.take(),
        }
    }
}

/// The rows of passes with `names` from their ticks of `period` nanoseconds.
fn rows(ticks: &[u8], names: &[&'static str], period: f32) -> Vec<(&'static str, f64)> {
    let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(ticks);
    let mut rows = Vec::new();
    for (name, [begin, end]) in names.iter().zip(ticks.as_chunks().0) {
        add(&mut rows, name, end.saturating_sub(*begin) as f64 * f64::from(period) * 1e-6);
    }
    rows
}

/// Adds to the row of that name.
fn add(rows: &mut Vec<(&'static str, f64)>, name: &'static str, ms: f64) {
    match rows.iter_mut().find(|(known, _)| *known == name) {
        Some((_, sum)) => *sum += ms,
        None => rows.push((name, ms)),
    }
}
