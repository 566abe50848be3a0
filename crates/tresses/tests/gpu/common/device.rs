//! One context per test thread. Pipelines are compiled once per context; a software driver needs seconds for all of them.

use tresses::{
    Context, Gpu, Pose, Result,
    low_level::{Hair, HairFrame, Recorder},
};
use tresses_testing::Pool;

/// Returns the context of this test's thread, or `None` if there is no adapter and `TRESSES_SKIP` lists `gpu`.
pub fn context() -> Option<&'static Context> {
    static CONTEXTS: Pool<Context> = Pool::new();
    CONTEXTS.get(|| Some(tresses_testing::gpu_or_skip(pollster::block_on(Gpu::open()))?.context))
}

/// Creates a context on wgpu's no-op device.
pub fn noop() -> Context {
    let (device, queue) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    Context::new(&device, &queue)
}

/// Records with `what` on the shared context and submits.
pub fn submit(what: impl FnOnce(&mut Recorder<'_>) -> Result<()>) {
    let context = context().expect("there is a GPU");
    let mut encoder = context.device().create_command_encoder(&Default::default());
    what(&mut context.recorder(&mut encoder)).expect("it fits");
    context.queue().submit([encoder.finish()]);
}

/// Records `record` in a compute pass and submits it.
pub fn compute(context: &Context, record: impl FnOnce(&mut tresses::low_level::ComputePass<'_>)) {
    let mut encoder = context.device().create_command_encoder(&Default::default());
    let mut commands = context.commands(&mut encoder);
    let mut pass = commands.compute("test");
    record(&mut pass);
    pass.end().expect("kernels compile");
    context.queue().submit([encoder.finish()]);
}

/// Returns a frame with default physics and no obstacles besides the head.
pub fn frame(head: Pose, dt: f32) -> HairFrame<'static> {
    HairFrame { dt, head, ..Default::default() }
}

/// Advances a groom by one frame.
pub fn advance(hair: &mut Hair, frame: &HairFrame<'_>) {
    submit(|recorder| recorder.advance(hair, frame));
}
