//! Thin helpers over wgpu: opening a device, bind group layouts by position, compute kernels,
//! read-back for tests and headless use, timings. No framework: everything here is optional for
//! a caller that owns its device.

pub mod bindings;
pub mod commands;
pub mod context;
mod counts;
pub mod device;
pub(crate) mod grid;
mod handle;
pub mod kernel;
pub(crate) mod pipeline;
pub mod probe;
pub mod readback;
mod sets;
mod tier;
pub mod timings;

pub use bindings::Binding;
pub use commands::{Commands, ComputePass, RenderPass};
pub use context::Context;
pub use counts::Counts;
pub use device::Gpu;
pub(crate) use handle::Device;
pub use kernel::Kernel;
pub(crate) use sets::PipelineSet;
pub use tier::Tier;
pub use timings::{Clock, Timings, wall};

/// A `u32` that shaders change atomically.
pub type Atomic = u32;

/// Records `record` in a compute pass and submits it.
#[cfg(test)]
pub(crate) fn compute(context: &Context, record: impl FnOnce(&mut commands::ComputePass<'_>)) {
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let mut commands = context.commands(&mut encoder);
    let mut pass = commands.compute("test");
    record(&mut pass);
    pass.end().expect("kernels compile");
    context.queue().submit([encoder.finish()]);
}

/// A context of a device that does nothing.
#[cfg(test)]
pub(crate) fn noop() -> Context {
    let (device, queue) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    Context::new(&device, &queue)
}

/// The context of all unit tests, opened once, or `None` where the machine has no adapter and need not have one.
#[cfg(test)]
pub(crate) fn for_tests() -> Option<&'static Context> {
    static CONTEXT: std::sync::OnceLock<Option<Context>> = std::sync::OnceLock::new();
    CONTEXT
        .get_or_init(|| match pollster::block_on(Gpu::open()) {
            Ok(gpu) => Some(gpu.context),
            Err(error) => {
                assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none_or(|v| v != "1"), "{error}");
                println!("skipped: {error}");
                None
            }
        })
        .as_ref()
}
