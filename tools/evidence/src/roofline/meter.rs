//! Collects the counts of instrumented shaders, per dispatch and draw of a frame.

use super::instrument::{self, BINDINGS, BYTES, ShaderCounts};
use anyhow::{Result, ensure};
use std::{
    collections::HashMap,
    sync::{
        Arc, Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicU32, Ordering},
    },
};
use tresses::{
    Context,
    low_level::{probe::Probe, readback::blocking as readback},
};

/// Most dispatches and draws of a frame that can be counted.
const MAX_COMMANDS: usize = 4096;
/// Distance between the counters of two dispatches: dynamic offsets are multiples of 256.
const STEP: u64 = BYTES.next_multiple_of(256);

/// Work of one stage of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StageWork {
    /// Sums of the counters, except bytes by binding.
    pub counted: ShaderCounts,
    /// Bytes that shaders load from and store to buffers.
    pub requested_bytes: u64,
    /// The same, but per dispatch at most the size of each buffer: the minimum memory traffic.
    pub bytes: u64,
}

/// Work of one dispatch or draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CommandWork {
    /// Stage of the frame.
    pub stage: &'static str,
    /// Module path of a dispatch's kernel.
    pub kernel: Option<&'static str>,
    /// Its work.
    pub work: StageWork,
}

/// Copies between CPU and GPU that a frame makes besides its commands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HostTransfers {
    /// Writes to buffers through the queue.
    pub uploads: u32,
    /// Copies to the CPU, each submitted on its own.
    pub read_backs: u32,
}

/// Counts the frames between [`start`](Self::start) and [`take`](Self::take).
#[derive(Clone, Debug, Default)]
pub struct Meter(Arc<State>);

#[derive(Debug, Default)]
struct State {
    own: OnceLock<CountBuffer>,
    log: Mutex<Log>,
    /// Number of bind groups created so far.
    groups: AtomicU32,
    /// Number of compute kernels created.
    kernels: AtomicU32,
}

#[derive(Debug)]
struct CountBuffer {
    buffer: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
}

#[derive(Debug, Default)]
struct Log {
    counts: bool,
    transfers: HostTransfers,
    sizes: HashMap<wgpu::BindGroup, Vec<u64>>,
    /// Kernel, and sizes of the buffers in the first bind group, of each dispatch or draw.
    work: Vec<(Option<&'static str>, Vec<u64>)>,
    /// Stage names, and the number of dispatches and draws when each stage ended.
    rows: Vec<(&'static str, usize)>,
}

impl State {
    fn log(&self) -> MutexGuard<'_, Log> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn own(&self, device: &wgpu::Device) -> &CountBuffer {
        self.own.get_or_init(|| {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("tally"),
                size: STEP * MAX_COMMANDS as u64,
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
            CountBuffer { buffer, layout, group }
        })
    }
}

impl Meter {
    /// Returns the number of bind groups created so far.
    pub fn groups(&self) -> u32 {
        self.0.groups.load(Ordering::Relaxed)
    }

    /// Returns the number of compute kernels created so far.
    pub fn kernels(&self) -> u32 {
        self.0.kernels.load(Ordering::Relaxed)
    }

    /// Starts counting the commands recorded from now on.
    pub fn start(&self, context: &Context) {
        let mut log = self.0.log();
        log.counts = true;
        log.transfers = HostTransfers::default();
        log.work.clear();
        log.rows.clear();
        let mut encoder = context.device().create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.0.own(context.device()).buffer, 0, None);
        context.queue().submit([encoder.finish()]);
    }

    /// Stops counting and returns the copies between CPU and GPU.
    pub fn host_transfers(&self) -> HostTransfers {
        let mut log = self.0.log();
        log.counts = false;
        log.transfers
    }

    /// Stops counting and returns the work of each stage. Blocks.
    pub fn take(&self, context: &Context) -> Result<Vec<(&'static str, StageWork)>> {
        let mut rows: Vec<(&'static str, StageWork)> = Vec::new();
        for command in self.commands(context)? {
            let index = rows.iter().position(|(known, _)| *known == command.stage).unwrap_or_else(|| {
                rows.push((command.stage, StageWork::default()));
                rows.len() - 1
            });
            rows[index].1.merge(&command.work);
        }
        Ok(rows)
    }

    /// Stops counting and returns the work of each dispatch and draw. Blocks.
    pub fn commands(&self, context: &Context) -> Result<Vec<CommandWork>> {
        self.0.log().counts = false;
        let words: Vec<u32> = readback::buffer(context, &self.0.own(context.device()).buffer)?;
        let log = self.0.log();
        ensure!(
            log.work.len() <= MAX_COMMANDS,
            "the frame has {} dispatches and draws, but at most {MAX_COMMANDS} can be counted",
            log.work.len()
        );
        let mut commands = Vec::new();
        let mut from = 0;
        for (stage, to) in &log.rows {
            for (i, (kernel, bound)) in log.work[from..*to].iter().enumerate() {
                let mut work = StageWork::default();
                work.add(&ShaderCounts::read(&words[(from + i) * (STEP / 4) as usize..]), bound);
                commands.push(CommandWork { stage, kernel: *kernel, work });
            }
            from = *to;
        }
        Ok(commands)
    }
}

impl StageWork {
    /// Adds the work of others, without bytes by binding.
    fn merge(&mut self, other: &Self) {
        let (sum, one) = (&mut self.counted, &other.counted);
        sum.invocations += one.invocations;
        sum.operations += one.operations;
        sum.loads += one.loads;
        sum.texels += one.texels;
        sum.texel_bytes += one.texel_bytes;
        sum.atomics += one.atomics;
        self.requested_bytes += other.requested_bytes;
        self.bytes += other.bytes;
    }

    /// Adds a dispatch or draw. `bound` are the sizes of the buffers in its first bind group.
    fn add(&mut self, one: &ShaderCounts, bound: &[u64]) {
        self.merge(&Self { counted: *one, ..Self::default() });
        let others: u64 = one.others.iter().sum();
        self.requested_bytes += others;
        self.bytes += others;
        for i in 0..BINDINGS {
            let buffer_size = bound.get(i).copied().filter(|bytes| *bytes > 0).unwrap_or(u64::MAX);
            for bytes in one.bound[i] {
                self.requested_bytes += bytes;
                self.bytes += bytes.min(buffer_size);
            }
        }
    }
}

impl Probe for Meter {
    fn shader(&self, device: &wgpu::Device, name: &str, wgsl: &str) -> wgpu::ShaderModule {
        if wgsl.contains("@compute") {
            self.0.kernels.fetch_add(1, Ordering::Relaxed);
        }
        // A test instruments every shader.
        let module = instrument::instrument(wgsl).unwrap_or_else(|error| panic!("{name}: {error}"));
        let source = wgpu::ShaderSource::Naga(std::borrow::Cow::Owned(module));
        device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
    }

    fn layout(&self, device: &wgpu::Device) -> wgpu::BindGroupLayout {
        self.0.own(device).layout.clone()
    }

    fn bound(&self, group: &wgpu::BindGroup, bytes: Vec<u64>) {
        self.0.groups.fetch_add(1, Ordering::Relaxed);
        self.0.log().sizes.insert(group.clone(), bytes);
    }

    fn work(
        &self,
        kernel: Option<&'static str>,
        groups: &[Option<wgpu::BindGroup>],
    ) -> (wgpu::BindGroup, u32) {
        let own = self.0.own.get().expect("a pipeline was made");
        let mut log = self.0.log();
        let mut index = 0;
        if log.counts {
            index = log.work.len().min(MAX_COMMANDS - 1);
            let first = groups[0].as_ref().and_then(|group| log.sizes.get(group));
            let bytes = first.cloned().unwrap_or_default();
            log.work.push((kernel, bytes));
        }
        (own.group.clone(), (STEP * index as u64) as u32)
    }

    fn uploaded(&self) {
        let mut log = self.0.log();
        log.transfers.uploads += u32::from(log.counts);
    }

    fn read_back(&self) {
        let mut log = self.0.log();
        log.transfers.read_backs += u32::from(log.counts);
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
    fn memory_traffic_is_capped_at_the_buffer_size() {
        let mut one = ShaderCounts { loads: 7, others: [8, 0], ..ShaderCounts::default() };
        one.bound[0] = [1000, 0];
        one.bound[1] = [16, 64];
        one.bound[2] = [500, 0];
        let mut done = StageWork::default();
        // Size 0: the third binding is not a buffer.
        done.add(&one, &[100, 32, 0]);
        assert_eq!((done.requested_bytes, done.bytes), (1000 + 16 + 64 + 500 + 8, 100 + 16 + 32 + 500 + 8));
        done.add(&one, &[]);
        assert_eq!((done.bytes, done.counted.loads), (656 + 1588, 14));
    }
}
