//! Long work that says what it does and lets others run in between.

use std::pin::Pin;

/// Who waits for long work.
///
/// Work is `async` and stops at each step: a browser draws and answers in between, a thread of its own
/// just goes on.
pub trait Progress {
    /// From now on `what` is done, a few words.
    fn tell(&self, what: &str);

    /// Ready when the work may go on.
    fn give_way(&self) -> Pin<Box<dyn Future<Output = ()> + '_>> {
        Box::pin(std::future::ready(()))
    }
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn tell(&self, _: &str) {}
}

/// The next step of some work.
pub(crate) async fn step(progress: &dyn Progress, what: &str) {
    progress.tell(what);
    progress.give_way().await;
}
