//! Peak rates of an adapter, measured: memory traffic, arithmetic, loads, texels and atomics.

use anyhow::{Context, Result};
use serde::Serialize;
use tresses::{
    Gpu,
    low_level::{Clock, bindings::uniform_buffer},
};
use tresses_cli::bench::table::{ms, table};

/// Peak rates, per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rates {
    /// Bytes read and written by buffer copies.
    pub copied: f64,
    /// Bytes read and written by a kernel with one `vec4f` per thread.
    pub streamed: f64,
    /// Additions and multiplications, in several chains of dependent multiply-adds per thread.
    pub operations: f64,
    /// Words loaded from a storage buffer of 4 kB.
    pub loads: f64,
    /// Texels loaded from a texture of 64 kB.
    pub texels: f64,
    /// Atomic additions in a storage buffer, spread over 65,536 words.
    pub atomics: f64,
}

impl Rates {
    /// Returns the best memory rate, bytes per second.
    pub fn bytes(&self) -> f64 {
        self.copied.max(self.streamed)
    }

    /// Formats the rates as a table.
    pub fn text(&self) -> String {
        let row =
            |name: &str, rate: f64, unit: &str| vec![name.into(), format!("{} {unit}", ms(rate * 1e-9))];
        table(&[
            row("copied", self.copied, "GB/s"),
            row("streamed", self.streamed, "GB/s"),
            row("operations", self.operations, "G/s"),
            row("loads", self.loads, "G/s"),
            row("texels", self.texels, "G/s"),
            row("atomics", self.atomics, "G/s"),
        ])
    }
}

/// Repetitions of each measurement; the best counts.
const TIMES: u32 = 5;
/// Loop iterations of the kernels.
const ITERATIONS: u64 = 64;

/// Benchmark kernels. They store the results of loads and sums, so that no compiler removes them.
const KERNELS: &str = "
@group(0) @binding(0) var<storage, read> source: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> target_: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> sums: array<atomic<u32>>;
@group(0) @binding(3) var texels: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> words: array<u32>;
@group(0) @binding(5) var<storage, read> iterations: u32;

fn index(id: vec3u, count: vec3u) -> u32 { return id.x + id.y * count.x * 64u; }

@compute @workgroup_size(64)
fn stream(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) count: vec3u) {
    let i = index(id, count);
    target_[i] = source[i] + 1.0;
}

@compute @workgroup_size(64)
fn compute(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) count: vec3u) {
    let i = index(id, count);
    let b = vec4f(0.999, 0.998, 0.997, 0.996);
    let c = vec4f(f32(i));
    var x = c; var y = c + 1.0; var z = c + 2.0; var w = c + 3.0;
    var iteration = 0u;
    loop {
        x = fma(x, b, c); y = fma(y, b, c); z = fma(z, b, c); w = fma(w, b, c);
        x = fma(x, b, c); y = fma(y, b, c); z = fma(z, b, c); w = fma(w, b, c);
        x = fma(x, b, c); y = fma(y, b, c); z = fma(z, b, c); w = fma(w, b, c);
        x = fma(x, b, c); y = fma(y, b, c); z = fma(z, b, c); w = fma(w, b, c);
        continuing { iteration += 1u; break if iteration >= iterations; }
    }
    target_[i] = x + y + z + w;
}

@compute @workgroup_size(64)
fn load(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) count: vec3u) {
    let i = index(id, count);
    var sum = 0u;
    var iteration = 0u;
    loop {
        let at = i + 4u * iteration;
        sum += words[at & 1023u] ^ words[(at + 1u) & 1023u];
        sum += words[(at + 2u) & 1023u] ^ words[(at + 3u) & 1023u];
        continuing { iteration += 1u; break if iteration >= iterations; }
    }
    target_[i] = vec4f(f32(sum));
}

@compute @workgroup_size(64)
fn texel(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) count: vec3u) {
    let i = index(id, count);
    var sum = 0.0;
    var iteration = 0u;
    loop {
        let at = vec2u(i + 4u * iteration, iteration) & vec2u(124u, 127u);
        sum += textureLoad(texels, at, 0).x * textureLoad(texels, at + vec2u(1u, 0u), 0).x;
        sum += textureLoad(texels, at + vec2u(2u, 0u), 0).x * textureLoad(texels, at + vec2u(3u, 0u), 0).x;
        continuing { iteration += 1u; break if iteration >= iterations; }
    }
    target_[i] = vec4f(sum);
}

@compute @workgroup_size(64)
fn count(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) count: vec3u) {
    let i = index(id, count);
    var iteration = 0u;
    loop {
        atomicAdd(&sums[(i * 17u + iteration * 1021u) & 65535u], 1u);
        continuing { iteration += 1u; break if iteration >= iterations; }
    }
}
";

/// Measures all rates.
pub fn measure(gpu: &Gpu, clock: Clock) -> Result<Rates> {
    let Gpu { context, .. } = gpu;
    let (device, queue, tier) = (context.device(), context.queue(), context.tier());
    // Buffers larger than all caches; enough threads to occupy the GPU for some milliseconds.
    let (bytes, threads): (u64, u64) = if tier.software { (64 << 20, 1 << 16) } else { (256 << 20, 1 << 22) };
    let buffer = |size| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("rates"),
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let [source, target, sums, words] = [bytes, bytes, 4 << 16, 4096].map(buffer);
    let iterations = uniform_buffer(device, "iterations", 4);
    queue.write_buffer(&iterations, 0, &(ITERATIONS as u32).to_le_bytes());
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("rates"),
        size: wgpu::Extent3d { width: 128, height: 128, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("rates"),
        source: wgpu::ShaderSource::Wgsl(KERNELS.into()),
    });
    // Returns the rate of a submission that does `amount` units of work.
    let rate = |amount: u64, record: &dyn Fn(&mut wgpu::CommandEncoder)| -> Result<f64> {
        let mut best = f64::INFINITY;
        for _ in 0..=TIMES {
            let mut encoder = device.create_command_encoder(&Default::default());
            record(&mut encoder);
            let commands = encoder.finish();
            let start = clock();
            queue.submit([commands]);
            device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
            best = best.min(clock().saturating_sub(start).as_secs_f64());
        }
        Ok(amount as f64 / best.max(1e-9))
    };
    let kernel = |name: &str, threads: u64, bindings: &[u32], amount: u64| -> Result<f64> {
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module: &module,
            entry_point: Some(name),
            compilation_options: Default::default(),
            cache: None,
        });
        let resource = |binding: u32| match binding {
            0 => source.as_entire_binding(),
            1 => target.as_entire_binding(),
            2 => sums.as_entire_binding(),
            3 => wgpu::BindingResource::TextureView(&view),
            4 => words.as_entire_binding(),
            _ => iterations.as_entire_binding(),
        };
        let entry = |&binding: &u32| wgpu::BindGroupEntry { binding, resource: resource(binding) };
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(name),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &bindings.iter().map(entry).collect::<Vec<_>>(),
        });
        let workgroups = threads / 64;
        let across = workgroups.min(1 << 15);
        rate(amount, &|encoder| {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(across as u32, (workgroups / across) as u32, 1);
        })
    };
    Ok(Rates {
        copied: rate(2 * bytes, &|encoder| encoder.copy_buffer_to_buffer(&source, 0, &target, 0, bytes))?,
        streamed: kernel("stream", bytes / 16, &[0, 1], 2 * bytes)?,
        // 16 lines of 4 components, a multiplication and an addition each.
        operations: kernel("compute", threads, &[1, 5], threads * ITERATIONS * 16 * 4 * 2)?,
        loads: kernel("load", threads, &[1, 4, 5], threads * ITERATIONS * 4)?,
        texels: kernel("texel", threads, &[1, 3, 5], threads * ITERATIONS * 4)?,
        atomics: kernel("count", threads, &[2, 5], threads * ITERATIONS)?,
    })
}
