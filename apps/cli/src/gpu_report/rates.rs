//! Microbenchmarks: dispatches, switches between passes, atomics and dependent loads. Each with and without wgpu's
//! validation of indirect calls.

use super::{
    device,
    section::{Draft, cells},
};
use anyhow::{Context, Result};
use pollster::block_on;
use std::time::Instant;
use tresses::{Gpu, low_level::bindings::uniform_buffer};

/// Repetitions of each measurement; the best counts.
const TIMES: u32 = 5;
/// Loop iterations of the kernels.
const ITERATIONS: u32 = 64;
/// Words of the buffer that atomics change.
const WORDS: u64 = 1 << 16;
/// Side of the texture, texels. The buffer has as many words.
const SIDE: u32 = 512;

/// Measures all rates.
pub fn measure(draft: &mut Draft) -> Result<()> {
    const COLUMNS: &[&str] = &["measurement", "validation of indirect calls", "value", "unit"];
    draft.note("Best of 5 submissions by wall clock; times of one dispatch exclude the submission.");
    for (validation, flags) in
        [("off", wgpu::InstanceFlags::empty()), ("on", wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL)]
    {
        let rig = Rig::new(flags)?;
        for (name, value, unit) in [rig.dispatches()?, rig.loops()?].concat() {
            draft.row("Rates", COLUMNS, cells![name, validation, value, unit]);
        }
        draft.keep();
    }
    Ok(())
}

/// Name, value and unit of a measurement.
type Rate = (&'static str, f64, &'static str);

/// A device with the kernels' resources.
struct Rig {
    gpu: Gpu,
    module: wgpu::ShaderModule,
    words: wgpu::Buffer,
    source: wgpu::Buffer,
    texels: wgpu::TextureView,
    parameters: wgpu::Buffer,
    indirect: wgpu::Buffer,
}

impl Rig {
    fn new(flags: wgpu::InstanceFlags) -> Result<Self> {
        let descriptor = wgpu::InstanceDescriptor { flags, ..Gpu::instance_descriptor() };
        let gpu = device::watched(block_on(Gpu::showing(&wgpu::Instance::new(descriptor), None))?);
        let device = gpu.context.device();
        let buffer = |label, size, usage| {
            let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            let label = Some(label);
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("texels"),
            size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let indirect = buffer("indirect", 12, wgpu::BufferUsages::INDIRECT);
        gpu.context.queue().write_buffer(&indirect, 0, bytemuck::cast_slice(&[1u32, 1, 1]));
        Ok(Self {
            module: device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("rates"),
                source: wgpu::ShaderSource::Wgsl(include_str!("kernels.wgsl").into()),
            }),
            words: buffer("words", 4 * WORDS, wgpu::BufferUsages::STORAGE),
            source: buffer("source", 4 * u64::from(SIDE * SIDE), wgpu::BufferUsages::STORAGE),
            texels: texture.create_view(&Default::default()),
            parameters: uniform_buffer(device, "parameters", 16),
            indirect,
            gpu,
        })
    }

    /// Measures dispatches of one workgroup, and switches between passes; microseconds.
    fn dispatches(&self) -> Result<Vec<Rate>> {
        let empty = self.kernel("empty", &[]);
        let dependent = self.kernel("dependent", &[0]);
        let direct = |kernel: &Kernel, encoder: &mut wgpu::CommandEncoder, n: u32| {
            let mut pass = kernel.begin(encoder);
            (0..n).for_each(|_| pass.dispatch_workgroups(1, 1, 1));
        };
        let indirect = |encoder: &mut wgpu::CommandEncoder, n: u32| {
            let mut pass = dependent.begin(encoder);
            (0..n).for_each(|_| pass.dispatch_workgroups_indirect(&self.indirect, 0));
        };
        let passes = |encoder: &mut wgpu::CommandEncoder, n: u32| {
            (0..n).for_each(|_| dependent.begin(encoder).dispatch_workgroups(1, 1, 1));
        };
        let copies = |encoder: &mut wgpu::CommandEncoder, n: u32| {
            for _ in 0..n {
                dependent.begin(encoder).dispatch_workgroups(1, 1, 1);
                encoder.copy_buffer_to_buffer(&self.words, 0, &self.source, 0, 4);
            }
        };
        Ok(vec![
            ("empty submission", 1e6 * self.best(&|_| ())?, "µs"),
            ("empty dispatch", self.each(&|encoder, n| direct(&empty, encoder, n))?, "µs"),
            ("dependent dispatch", self.each(&|encoder, n| direct(&dependent, encoder, n))?, "µs"),
            ("dependent indirect dispatch", self.each(&indirect)?, "µs"),
            ("compute pass with a dispatch", self.each(&passes)?, "µs"),
            ("compute pass with a dispatch, and a copy", self.each(&copies)?, "µs"),
        ])
    }

    /// Measures atomics and dependent loads; 10⁹ per second.
    fn loops(&self) -> Result<Vec<Rate>> {
        let threads: u32 = if self.gpu.context.tier().software { 1 << 14 } else { 1 << 20 };
        let rate = |kernel: &Kernel, mask: u32| -> Result<f64> {
            let parameters = [ITERATIONS, mask, 0, 0];
            self.gpu.context.queue().write_buffer(&self.parameters, 0, bytemuck::cast_slice(&parameters));
            let seconds =
                self.best(&|encoder| kernel.begin(encoder).dispatch_workgroups(threads / 64, 1, 1))?;
            Ok(1e-9 * f64::from(threads) * f64::from(ITERATIONS) / seconds)
        };
        let count = self.kernel("count", &[0, 3]);
        Ok(vec![
            ("atomic additions to one word", rate(&count, 0)?, "10⁹/s"),
            ("atomic additions to a line of 16 words", rate(&count, 15)?, "10⁹/s"),
            ("atomic additions to 65,536 words", rate(&count, WORDS as u32 - 1)?, "10⁹/s"),
            (
                "dependent loads from a buffer of 1 MiB",
                rate(&self.kernel("walk_buffer", &[0, 1, 3]), 0)?,
                "10⁹/s",
            ),
            (
                "dependent loads from a texture of 1 MiB",
                rate(&self.kernel("walk_texture", &[0, 2, 3]), 0)?,
                "10⁹/s",
            ),
        ])
    }

    /// Returns the best time of a submission, seconds.
    fn best(&self, record: &dyn Fn(&mut wgpu::CommandEncoder)) -> Result<f64> {
        let (device, queue) = (self.gpu.context.device(), self.gpu.context.queue());
        let mut best = f64::INFINITY;
        for _ in 0..=TIMES {
            let mut encoder = device.create_command_encoder(&Default::default());
            record(&mut encoder);
            let commands = encoder.finish();
            let start = Instant::now();
            queue.submit([commands]);
            device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
            best = best.min(start.elapsed().as_secs_f64());
        }
        Ok(best.max(1e-9))
    }

    /// Returns the time of one of the `n` items that `record` records, microseconds.
    fn each(&self, record: &dyn Fn(&mut wgpu::CommandEncoder, u32)) -> Result<f64> {
        let n = if self.gpu.context.tier().software { 64 } else { 512 };
        let [few, many] = [n, 3 * n].map(|n| self.best(&|encoder| record(encoder, n)));
        Ok(1e6 * (many? - few?).max(0.0) / f64::from(2 * n))
    }

    fn kernel(&self, entry: &str, bindings: &[u32]) -> Kernel {
        let device = self.gpu.context.device();
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: None,
            module: &self.module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        });
        let resource = |binding: u32| match binding {
            0 => self.words.as_entire_binding(),
            1 => self.source.as_entire_binding(),
            2 => wgpu::BindingResource::TextureView(&self.texels),
            _ => self.parameters.as_entire_binding(),
        };
        let entry = |&binding: &u32| wgpu::BindGroupEntry { binding, resource: resource(binding) };
        let group = (!bindings.is_empty()).then(|| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("rates"),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &bindings.iter().map(entry).collect::<Vec<_>>(),
            })
        });
        Kernel { pipeline, group }
    }
}

/// A kernel and its bindings.
struct Kernel {
    pipeline: wgpu::ComputePipeline,
    group: Option<wgpu::BindGroup>,
}

impl Kernel {
    /// Begins a pass with this kernel.
    fn begin<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::ComputePass<'a> {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        if let Some(group) = &self.group {
            pass.set_bind_group(0, group, &[]);
        }
        pass
    }
}
