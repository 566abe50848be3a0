//! One device for all tests, and its pipelines, which are compiled once: a software driver takes seconds for all.

use std::sync::OnceLock;
use tresses::{Pipelines, gpu::Gpu, simulate};

/// The adapter of all tests; without one, skips (`None`) or, when `TRESSES_REQUIRE_GPU=1`, panics.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| match pollster::block_on(Gpu::open()) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("TRESSES_REQUIRE_GPU").is_some_and(|v| v == "1") => panic!("{error}"),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    })
    .as_ref()
}

/// The pipelines of that adapter.
pub fn pipelines() -> Option<&'static Pipelines> {
    static PIPELINES: OnceLock<Option<Pipelines>> = OnceLock::new();
    PIPELINES.get_or_init(|| Some(Pipelines::new(&gpu()?.device))).as_ref()
}

/// The step of the guides alone.
pub fn simulate() -> Option<&'static simulate::Pipelines> {
    pipelines().map(|pipelines| &pipelines.simulate)
}
