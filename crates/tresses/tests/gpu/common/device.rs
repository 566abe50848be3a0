//! One context per test thread. Pipelines are compiled once per context; a software driver needs seconds for all of them.

use std::sync::{Mutex, PoisonError};
use tresses::{Context, Hair, Pose, Result, frame::Recorder, gpu::Gpu, hair::HairFrame};
use tresses_testing::Pool;

/// One value per context.
pub type PerContext<T> = Mutex<Vec<(&'static Context, &'static T)>>;

/// Returns the value of this thread's context in `made`. `make` makes it if the context has none.
pub fn per_context<T>(made: &PerContext<T>, make: impl FnOnce(&'static Context) -> T) -> Option<&'static T> {
    let context = context()?;
    // A failed test leaves the list consistent.
    let mut made = made.lock().unwrap_or_else(PoisonError::into_inner);
    let known = made.iter().find(|(other, _)| std::ptr::eq(*other, context));
    Some(known.map(|(_, value)| *value).unwrap_or_else(|| {
        let value = Box::leak(Box::new(make(context)));
        made.push((context, value));
        value
    }))
}

/// Returns the context of this test's thread, or `None` if there is no adapter and `TRESSES_SKIP` lists `gpu`.
pub fn context() -> Option<&'static Context> {
    static CONTEXTS: Pool<Context> = Pool::new();
    CONTEXTS.get(|| match pollster::block_on(Gpu::open()) {
        Ok(gpu) => Some(gpu.context),
        Err(error) => {
            tresses_testing::skip("gpu", error);
            None
        }
    })
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
pub fn compute(context: &Context, record: impl FnOnce(&mut tresses::gpu::ComputePass<'_>)) {
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
