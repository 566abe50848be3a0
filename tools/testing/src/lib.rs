//! Helpers that the tests of all crates share.

mod modules;
mod pool;
mod public_types;
mod skip;

pub use modules::{Arrow, Modules};
pub use pool::Pool;
pub use public_types::PublicTypes;
pub use skip::{gpu_or_skip, lacks_gpu, skip};
