//! Thin helpers over wgpu: opening a device, bind group layouts by position, compute kernels,
//! read-back for tests and headless use, timings. No framework: everything here is optional for
//! a caller that owns its device.

pub mod bindings;
pub mod device;
pub(crate) mod grid;
pub mod kernel;
pub mod pass;
pub(crate) mod pipeline;
pub mod probe;
pub mod readback;
pub mod timings;

pub use bindings::Binding;
pub use device::{Gpu, Tier};
pub use kernel::Kernel;
pub use pass::{ComputePass, Counts, RenderPass, compute_pass, render_pass};
pub use timings::{Clock, Timings, wall};

/// A `u32` that shaders change atomically.
pub type Atomic = u32;

/// The adapter of all unit tests, opened once, or `None` where the machine has none and need not have one.
#[cfg(test)]
pub(crate) fn for_tests() -> Option<&'static Gpu> {
    static GPU: std::sync::OnceLock<Option<Gpu>> = std::sync::OnceLock::new();
    GPU.get_or_init(|| match pollster::block_on(Gpu::open()) {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none_or(|v| v != "1"), "{error}");
            println!("skipped: {error}");
            None
        }
    })
    .as_ref()
}
