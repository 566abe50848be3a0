//! One device for all tests, and its pipelines, which are compiled once: a software driver takes seconds for all.

use std::sync::OnceLock;
use tresses::{
    Hair, Pipelines, Pose, Result,
    frame::{Frame, Recorder},
    gpu::Gpu,
    simulate,
};

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

/// Records with `what` on that adapter, and submits.
pub fn submit(what: impl FnOnce(&mut Recorder<'_>) -> Result<()>) {
    let Gpu { device, queue, .. } = gpu().expect("there is a GPU");
    let mut encoder = device.create_command_encoder(&Default::default());
    let pipelines = pipelines().expect("there is a GPU");
    what(&mut Recorder { pipelines, device, queue, encoder: &mut encoder, timings: None }).expect("it fits");
    queue.submit([encoder.finish()]);
}

/// A frame of the usual physics, among no obstacles but the head.
pub fn frame(head: Pose, dt: f32) -> Frame<'static> {
    Frame { dt, head, ..Default::default() }
}

/// Moves a groom on by a frame.
pub fn advance(hair: &mut Hair, frame: &Frame<'_>) {
    submit(|recorder| recorder.advance(hair, frame));
}
