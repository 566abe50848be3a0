//! What the shaders of a frame count, dispatch by dispatch and draw by draw.

use super::instrument::{self, BINDINGS, BYTES, Counted};
use anyhow::{Result, ensure};
use std::{
    collections::HashMap,
    sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError},
};
use tresses::{
    Context,
    gpu::{probe::Probe, readback::blocking as readback},
};

/// Dispatches and draws of a frame that there is room for.
const MOST: usize = 4096;
/// What lies between two of them: dynamic offsets are multiples of 256.
const STEP: u64 = BYTES.next_multiple_of(256);

/// A row of a frame's times, and what its dispatches and draws did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Done {
    /// The sums; bytes of buffers not by binding.
    pub counted: Counted,
    /// Bytes loaded from and stored to buffers, as often as shaders ask.
    pub asked: u64,
    /// The same, but no binding of a dispatch more than its buffer has: what has to come from memory at least once.
    pub bytes: u64,
}

/// Counts for the frames between [`start`](Self::start) and [`take`](Self::take).
#[derive(Clone, Debug, Default)]
pub struct Meter(Arc<State>);

#[derive(Debug, Default)]
struct State {
    own: OnceLock<Own>,
    log: Mutex<Log>,
}

#[derive(Debug)]
struct Own {
    buffer: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
}

#[derive(Debug, Default)]
struct Log {
    counts: bool,
    sizes: HashMap<wgpu::BindGroup, Vec<u64>>,
    /// Bytes of what each dispatch or draw binds as its first group.
    work: Vec<Vec<u64>>,
    /// Names of rows, and how much work there was when they ended.
    rows: Vec<(&'static str, usize)>,
}

impl State {
    fn log(&self) -> MutexGuard<'_, Log> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn own(&self, device: &wgpu::Device) -> &Own {
        self.own.get_or_init(|| {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("tally"),
                size: STEP * MOST as u64,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let ty = wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: false },
                has_dynamic_offset: true,
                min_binding_size: None,
            };
            let visibility = wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE;
            let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("tally"),
                entries: &[wgpu::BindGroupLayoutEntry { binding: 0, visibility, ty, count: None }],
            });
            let resource = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &buffer,
                offset: 0,
                size: wgpu::BufferSize::new(BYTES),
            });
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("tally"),
                layout: &layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource }],
            });
            Own { buffer, layout, group }
        })
    }
}

impl Meter {
    /// What is recorded from here on counts.
    pub fn start(&self, context: &Context) {
        let mut log = self.0.log();
        log.counts = true;
        log.work.clear();
        log.rows.clear();
        let mut encoder = context.device().create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.0.own(context.device()).buffer, 0, None);
        context.queue().submit([encoder.finish()]);
    }

    /// What was counted since, row by row. Blocks.
    pub fn take(&self, context: &Context) -> Result<Vec<(&'static str, Done)>> {
        let words: Vec<u32> = readback::buffer(context, &self.0.own(context.device()).buffer)?;
        let mut log = self.0.log();
        log.counts = false;
        ensure!(
            log.work.len() <= MOST,
            "a frame of {} dispatches and draws: {MOST} can be counted",
            log.work.len()
        );
        let mut rows: Vec<(&'static str, Done)> = Vec::new();
        let mut from = 0;
        for (name, to) in &log.rows {
            let place = rows.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                rows.push((name, Done::default()));
                rows.len() - 1
            });
            for i in from..*to {
                let at = i * (STEP / 4) as usize;
                rows[place].1.add(&Counted::read(&words[at..]), &log.work[i]);
            }
            from = *to;
        }
        Ok(rows)
    }
}

impl Done {
    /// Adds a dispatch or draw whose first group binds so many bytes.
    fn add(&mut self, one: &Counted, bound: &[u64]) {
        let sum = &mut self.counted;
        sum.invocations += one.invocations;
        sum.operations += one.operations;
        sum.loads += one.loads;
        sum.texels += one.texels;
        sum.texel_bytes += one.texel_bytes;
        sum.atomics += one.atomics;
        let others: u64 = one.others.iter().sum();
        self.asked += others;
        self.bytes += others;
        for i in 0..BINDINGS {
            let room = bound.get(i).copied().filter(|bytes| *bytes > 0).unwrap_or(u64::MAX);
            for bytes in one.bound[i] {
                self.asked += bytes;
                self.bytes += bytes.min(room);
            }
        }
    }
}

impl Probe for Meter {
    fn shader(&self, device: &wgpu::Device, name: &str, wgsl: &str) -> wgpu::ShaderModule {
        // A test instruments them all.
        let module = instrument::instrument(wgsl).unwrap_or_else(|error| panic!("{name}: {error}"));
        let source = wgpu::ShaderSource::Naga(std::borrow::Cow::Owned(module));
        device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
    }

    fn layout(&self, device: &wgpu::Device) -> wgpu::BindGroupLayout {
        self.0.own(device).layout.clone()
    }

    fn bound(&self, group: &wgpu::BindGroup, bytes: Vec<u64>) {
        self.0.log().sizes.insert(group.clone(), bytes);
    }

    fn work(&self, groups: &[Option<wgpu::BindGroup>]) -> (wgpu::BindGroup, u32) {
        let own = self.0.own.get().expect("a pipeline was made");
        let mut log = self.0.log();
        let mut place = 0;
        if log.counts {
            place = log.work.len().min(MOST - 1);
            let first = groups[0].as_ref().and_then(|group| log.sizes.get(group));
            let bytes = first.cloned().unwrap_or_default();
            log.work.push(bytes);
        }
        (own.group.clone(), (STEP * place as u64) as u32)
    }

    fn lap(&self, name: &'static str) {
        let mut log = self.0.log();
        if log.counts {
            let so_far = log.work.len();
            log.rows.push((name, so_far));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_buffer_has_comes_from_memory_once() {
        let mut one = Counted { loads: 7, others: [8, 0], ..Counted::default() };
        one.bound[0] = [1000, 0];
        one.bound[1] = [16, 64];
        one.bound[2] = [500, 0];
        let mut done = Done::default();
        // The third is no buffer of a known size.
        done.add(&one, &[100, 32, 0]);
        assert_eq!((done.asked, done.bytes), (1000 + 16 + 64 + 500 + 8, 100 + 16 + 32 + 500 + 8));
        done.add(&one, &[]);
        assert_eq!((done.bytes, done.counted.loads), (656 + 1588, 14));
    }
}
