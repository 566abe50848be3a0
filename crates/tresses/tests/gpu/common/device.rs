//! One device for all tests, and pipelines that are built once: a software driver takes seconds for a set.

use std::{
    ops::Deref,
    sync::{Mutex, OnceLock, PoisonError},
};
use tresses::{
    HairRenderer,
    draw::{DrawOptions, DrawStage},
    gpu::Gpu,
    simulate::Simulate,
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

/// Every pipeline as it is by default, for tests that move hair and read strands: what a picture writes into
/// the renderer (lights, maps) is for one test at a time, which [`drawing`] sees to.
pub fn renderer() -> Option<&'static HairRenderer> {
    static RENDERER: OnceLock<Option<HairRenderer>> = OnceLock::new();
    RENDERER.get_or_init(|| Some(HairRenderer::new(&gpu()?.device, &DrawOptions::default()))).as_ref()
}

/// The step of the guides alone.
pub fn simulate() -> Option<&'static Simulate> {
    renderer().map(|renderer| &renderer.simulate)
}

/// A renderer that nobody else draws with until it is given back.
pub fn drawing(gpu: &Gpu, options: &DrawOptions) -> Lease<HairRenderer> {
    static SHELF: Shelf<HairRenderer> = Mutex::new(Vec::new());
    Lease::take(&SHELF, options, || HairRenderer::new(&gpu.device, options))
}

/// A drawing stage that nobody else draws with until it is given back.
pub fn stage(gpu: &Gpu, options: &DrawOptions) -> Lease<DrawStage> {
    static SHELF: Shelf<DrawStage> = Mutex::new(Vec::new());
    Lease::take(&SHELF, options, || DrawStage::new(&gpu.device, options))
}

/// What is not in use, by how it was made.
type Shelf<T> = Mutex<Vec<(DrawOptions, T)>>;

/// Pipelines that go back to their shelf when the test ends.
pub struct Lease<T: 'static> {
    shelf: &'static Shelf<T>,
    options: DrawOptions,
    /// There until it is dropped.
    held: Option<T>,
}

impl<T> Lease<T> {
    fn take(shelf: &'static Shelf<T>, options: &DrawOptions, make: impl FnOnce() -> T) -> Self {
        let found = {
            let mut free = shelf.lock().unwrap_or_else(PoisonError::into_inner);
            free.iter().position(|(of, _)| of == options).map(|i| free.swap_remove(i).1)
        };
        Self { shelf, options: *options, held: Some(found.unwrap_or_else(make)) }
    }
}

impl<T> Deref for Lease<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.held.as_ref().expect("held until it is dropped")
    }
}

impl<T> Drop for Lease<T> {
    fn drop(&mut self) {
        // After a failed test nobody knows what it has left behind.
        if let Some(held) = self.held.take().filter(|_| !std::thread::panicking()) {
            self.shelf.lock().unwrap_or_else(PoisonError::into_inner).push((self.options, held));
        }
    }
}
