//! A frame in flight on the GPU. A long frame is split into parts, and each part is submitted when the previous one is
//! done. The window's own frames run in between, and the remaining parts can be canceled.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use web_time::Instant;

struct Parts {
    left: VecDeque<wgpu::CommandBuffer>,
    done: usize,
    /// Time at which all parts were done.
    landed: Option<Instant>,
}

/// A frame in flight.
pub struct Flight {
    started: Instant,
    all: usize,
    parts: Arc<Mutex<Parts>>,
}

fn lock(parts: &Mutex<Parts>) -> MutexGuard<'_, Parts> {
    parts.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Submits the next part. Calls `wake` when none is left.
fn go_on(queue: &wgpu::Queue, parts: &Arc<Mutex<Parts>>, wake: impl FnOnce() + Send + 'static) {
    let next = lock(parts).left.pop_front();
    let Some(next) = next else {
        lock(parts).landed = Some(Instant::now());
        return wake();
    };
    queue.submit([next]);
    let (again, parts) = (queue.clone(), parts.clone());
    queue.on_submitted_work_done(move || {
        lock(&parts).done += 1;
        go_on(&again, &parts, wake);
    });
}

impl Flight {
    /// Starts submitting `parts` in order. Calls `wake` when the last is done.
    pub fn start(
        queue: &wgpu::Queue,
        started: Instant,
        parts: Vec<wgpu::CommandBuffer>,
        wake: impl FnOnce() + Send + 'static,
    ) -> Self {
        let all = parts.len();
        let parts = Arc::new(Mutex::new(Parts { left: parts.into(), done: 0, landed: None }));
        go_on(queue, &parts, wake);
        Self { started, all, parts }
    }

    /// Returns the frame's duration in milliseconds once it is done.
    pub fn landed(&self) -> Option<f32> {
        Some(lock(&self.parts).landed?.duration_since(self.started).as_secs_f32() * 1e3)
    }

    /// Returns the number of finished parts and of all parts.
    pub fn progress(&self) -> (usize, usize) {
        (lock(&self.parts).done, self.all)
    }

    /// Cancels the parts not yet submitted.
    pub fn give_up(&self) {
        lock(&self.parts).left.clear();
    }
}

/// Thread that polls the device while a frame is in flight. Native wgpu runs callbacks only when the device is polled.
#[cfg(not(target_arch = "wasm32"))]
pub struct Watcher(std::sync::mpsc::Sender<Arc<Mutex<Parts>>>);

#[cfg(not(target_arch = "wasm32"))]
impl Watcher {
    /// Starts the thread for `device`.
    pub fn new(device: &wgpu::Device) -> Self {
        let (sender, receiver) = std::sync::mpsc::channel::<Arc<Mutex<Parts>>>();
        let device = device.clone();
        std::thread::spawn(move || {
            while let Ok(parts) = receiver.recv() {
                while lock(&parts).landed.is_none() {
                    // A blocking wait would hold a device lock and delay the window's submissions.
                    if device.poll(wgpu::PollType::Poll).is_err() {
                        return;
                    }
                    std::thread::sleep(std::time::Duration::from_millis(1));
                }
            }
        });
        Self(sender)
    }

    /// Polls until `flight` is done.
    pub fn watch(&self, flight: &Flight) {
        // The thread only ends when the device is lost, which the loss callback reports.
        let _ = self.0.send(flight.parts.clone());
    }
}

/// Does nothing: a browser runs callbacks without polling.
#[cfg(target_arch = "wasm32")]
pub struct Watcher;

#[cfg(target_arch = "wasm32")]
impl Watcher {
    /// Creates the placeholder.
    pub fn new(_: &wgpu::Device) -> Self {
        Self
    }

    /// Does nothing.
    pub fn watch(&self, _: &Flight) {}
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};
    use tresses::Gpu;

    #[test]
    fn parts_are_submitted_in_order_until_canceled() {
        let Some(gpu) = tresses_testing::gpu_or_skip(pollster::block_on(Gpu::open())) else { return };
        let woken = Arc::new(AtomicU32::new(0));
        let start = || {
            let parts =
                (0..8).map(|_| gpu.context.device().create_command_encoder(&Default::default()).finish());
            let woken = woken.clone();
            Flight::start(gpu.context.queue(), Instant::now(), parts.collect(), move || {
                woken.fetch_add(1, Ordering::Relaxed);
            })
        };
        let wait = |flight: &Flight| {
            while flight.landed().is_none() {
                gpu.context.device().poll(wgpu::PollType::Poll).unwrap();
            }
            flight.progress()
        };
        let flight = start();
        assert!(flight.progress().0 <= 1, "the second is not handed in before the first is done");
        assert_eq!(wait(&flight), (8, 8));
        let flight = start();
        flight.give_up();
        assert!(wait(&flight).0 <= 1, "what was under way, and no more");
        assert_eq!(woken.load(Ordering::Relaxed), 2, "each wakes once");
    }
}
