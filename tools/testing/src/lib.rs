//! Helpers that the tests of all crates share.

mod modules;
mod pool;
mod skip;

pub use modules::{Arrow, Modules};
pub use pool::Pool;
pub use skip::{lacks_gpu, skip};
