//! Thin helpers over wgpu: opening a device, bind group layouts by position, compute kernels,
//! read-back for tests and headless use, timings. No framework: everything here is optional for
//! a caller that owns its device.

pub mod bindings;
pub mod device;
pub mod kernel;
pub mod readback;
pub mod timings;

pub use bindings::Binding;
pub use device::{Gpu, Tier};
pub use kernel::Kernel;
pub use timings::Timings;
