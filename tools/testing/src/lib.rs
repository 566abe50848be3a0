//! Helpers that the tests of all crates share.

mod modules;
mod pool;
mod skip;

pub use modules::{Arrow, Modules};
pub use pool::Pool;
pub use skip::{gpu_or_skip, lacks_gpu, skip};
