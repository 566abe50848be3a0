//! One context for all tests, whose pipelines are compiled once: a software driver takes seconds for all.

use std::sync::OnceLock;
use tresses::{Context, Hair, Pose, Result, frame::Recorder, gpu::Gpu, hair::HairFrame};

/// The context of all tests; without an adapter, skips (`None`) or, when `TRESSES_REQUIRE_GPU=1`, panics.
pub fn context() -> Option<&'static Context> {
    static CONTEXT: OnceLock<Option<Context>> = OnceLock::new();
    CONTEXT
        .get_or_init(|| match pollster::block_on(Gpu::open()) {
            Ok(gpu) => Some(gpu.context),
            Err(error) if std::env::var_os("TRESSES_REQUIRE_GPU").is_some_and(|v| v == "1") => {
                panic!("{error}")
            }
            Err(error) => {
                println!("skipped: {error}");
                None
            }
        })
        .as_ref()
}

/// A context of a device that does nothing.
pub fn noop() -> Context {
    let (device, queue) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    Context::new(&device, &queue)
}

/// Records with `what` on that adapter, and submits.
pub fn submit(what: impl FnOnce(&mut Recorder<'_>) -> Result<()>) {
    let context = context().expect("there is a GPU");
    let mut encoder = context.device().create_command_encoder(&Default::default());
    what(&mut context.recorder(&mut encoder)).expect("it fits");
    context.queue().submit([encoder.finish()]);
}

/// Records `record` in a compute pass and submits it.
pub fn compute(context: &Context, record: impl FnOnce(&mut tresses::gpu::ComputePass<'_>)) {
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let mut commands = context.commands(&mut encoder);
    let mut pass = commands.compute("test");
    record(&mut pass);
    pass.end().expect("kernels compile");
    context.queue().submit([encoder.finish()]);
}

/// A frame of the usual physics, among no obstacles but the head.
pub fn frame(head: Pose, dt: f32) -> HairFrame<'static> {
    HairFrame { dt, head, ..Default::default() }
}

/// Moves a groom on by a frame.
pub fn advance(hair: &mut Hair, frame: &HairFrame<'_>) {
    submit(|recorder| recorder.advance(hair, frame));
}
