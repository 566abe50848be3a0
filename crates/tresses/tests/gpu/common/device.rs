//! One context per test thread. Pipelines are compiled once per context; a software driver needs seconds for all of
//! them.

use tresses::{
    Character, Context, Gpu, Picture, Pose, Result, View,
    low_level::{Hair, HairFrame, Recorder},
};
use tresses_testing::Pool;

/// Returns the context of this test's thread, or `None` if there is no adapter and `TRESSES_SKIP` lists `gpu`.
pub fn context() -> Option<&'static Context> {
    static CONTEXTS: Pool<Context> = Pool::new();
    CONTEXTS.get(|| {
        let gpu = tresses_testing::gpu_or_skip(pollster::block_on(Gpu::open()))?;
        Some(super::order::selected(gpu.context))
    })
}

/// Creates a context on wgpu's no-op device.
pub fn noop() -> Context {
    let (device, queue) = wgpu::Device::noop(&wgpu::DeviceDescriptor::default());
    Context::new(&device, &queue)
}

/// Records with `what` on the shared context and submits.
pub fn submit(what: impl FnOnce(&mut Recorder<'_>) -> Result<()>) {
    try_submit(what).expect("it fits");
}

/// Records with `what` on the shared context and submits unless it fails.
pub fn try_submit(what: impl FnOnce(&mut Recorder<'_>) -> Result<()>) -> Result<()> {
    let context = context().expect("there is a GPU");
    let mut encoder = context.device().create_command_encoder(&Default::default());
    what(&mut context.recorder(&mut encoder))?;
    context.queue().submit([encoder.finish()]);
    Ok(())
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

/// Advances characters by one frame.
pub fn advance_characters(characters: &mut [&mut Character], dt: f32) {
    let context = context().expect("there is a GPU");
    let mut encoder = context.device().create_command_encoder(&Default::default());
    context.frame(&mut encoder).advance(characters, dt).unwrap();
    context.queue().submit([encoder.finish()]);
}

/// Draws characters with `view`: RGBA, rows from the top.
pub fn draw_characters(view: &mut View, characters: &[&Character], picture: &Picture) -> Vec<u8> {
    let context = context().expect("there is a GPU");
    let output = view.targets().picture().clone();
    let mut encoder = context.device().create_command_encoder(&Default::default());
    context.frame(&mut encoder).draw(view, characters, picture, &output).unwrap();
    context.queue().submit([encoder.finish()]);
    pollster::block_on(view.targets().read()).unwrap()
}

/// Advances the guides of a groom by one frame.
pub fn simulate(hair: &mut Hair, frame: &HairFrame<'_>) {
    submit(|recorder| recorder.simulate(hair, frame));
}
