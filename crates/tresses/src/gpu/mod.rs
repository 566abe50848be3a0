//! Thin helpers over wgpu: opening a device, bind group layouts, compute kernels, read-back for tests and
//! headless use, timings. None is required of a caller that owns its device.

pub mod bindings;
pub mod commands;
pub mod context;
mod counts;
pub mod device;
mod fill;
pub(crate) mod grid;
mod handle;
pub mod kernel;
pub(crate) mod pipeline;
#[cfg(feature = "probe")]
pub mod probe;
#[cfg(not(feature = "probe"))]
mod probe;
pub mod readback;
mod sets;
mod tier;
pub mod timings;
pub(crate) mod uniforms;

pub(crate) use bindings::{BindBuffer, Bindings, BufferBinding, Opaque, Resource};
pub use bindings::{Binding, Buffer};
pub(crate) use commands::RenderPass;
pub use commands::{Commands, ComputePass};
pub use context::Context;
pub use counts::Counts;
pub use device::Gpu;
pub(crate) use handle::{Device, Queue};
pub use kernel::Kernel;
pub(crate) use sets::PipelineSet;
pub use tier::Tier;
pub use timings::{Clock, Timings, wall};
pub(crate) use uniforms::Uniform;

/// A `u32` that shaders change atomically.
pub type Atomic = u32;

/// Runs the commands of `record` in a compute pass and submits it.
#[cfg(test)]
pub(crate) fn compute(context: &Context, record: impl FnOnce(&mut commands::ComputePass<'_>)) {
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let mut commands = context.commands(&mut encoder);
    let mut pass = commands.compute("test");
    record(&mut pass);
    pass.end().expect("kernels compile");
    context.queue().submit([encoder.finish()]);
}

/// A context of a no-op device.
#[cfg(test)]
pub(crate) fn noop() -> Context {
    let (device, queue) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    Context::new(&device, &queue)
}

/// Returns the context of this test's thread, or `None` without an adapter if `TRESSES_SKIP` lists `gpu`.
#[cfg(test)]
pub(crate) fn for_tests() -> Option<&'static Context> {
    static CONTEXTS: tresses_testing::Pool<Context> = tresses_testing::Pool::new();
    CONTEXTS.get(|| {
        let gpu = tresses_testing::gpu_or_skip(pollster::block_on(Gpu::open()))?;
        Some(crate::common::order::selected(gpu.context))
    })
}
