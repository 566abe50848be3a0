//! A frame on its way through the GPU. What takes long is handed in part by part, the next when the one before is
//! done: the window's own frames go between them, and what is left can be given up.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use web_time::Instant;

struct Parts {
    left: VecDeque<wgpu::CommandBuffer>,
    done: usize,
    /// When all of them were done.
    landed: Option<Instant>,
}

/// What is under way.
pub struct Flight {
    begun: Instant,
    all: usize,
    parts: Arc<Mutex<Parts>>,
}

fn lock(parts: &Mutex<Parts>) -> MutexGuard<'_, Parts> {
    parts.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Hands in the next part, and after the last calls `wake`.
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
    /// Hands `parts` in, one after another; `wake` is called when the last is done.
    pub fn start(
        queue: &wgpu::Queue,
        begun: Instant,
        parts: Vec<wgpu::CommandBuffer>,
        wake: impl FnOnce() + Send + 'static,
    ) -> Self {
        let all = parts.len();
        let parts = Arc::new(Mutex::new(Parts { left: parts.into(), done: 0, landed: None }));
        go_on(queue, &parts, wake);
        Self { begun, all, parts }
    }

    /// Milliseconds that it took, once it is done.
    pub fn landed(&self) -> Option<f32> {
        Some(lock(&self.parts).landed?.duration_since(self.begun).as_secs_f32() * 1e3)
    }

    /// How many of its parts are done, of how many.
    pub fn progress(&self) -> (usize, usize) {
        (lock(&self.parts).done, self.all)
    }

    /// No more parts are handed in.
    pub fn give_up(&self) {
        lock(&self.parts).left.clear();
    }
}

/// A device calls back when somebody asks it: a thread does while a frame is under way.
#[cfg(not(target_arch = "wasm32"))]
pub struct Watcher(std::sync::mpsc::Sender<Arc<Mutex<Parts>>>);

#[cfg(not(target_arch = "wasm32"))]
impl Watcher {
    /// For what is handed in to `device`.
    pub fn new(device: &wgpu::Device) -> Self {
        let (sender, receiver) = std::sync::mpsc::channel::<Arc<Mutex<Parts>>>();
        let device = device.clone();
        std::thread::spawn(move || {
            while let Ok(parts) = receiver.recv() {
                while lock(&parts).landed.is_none() {
                    // Waiting inside the device would keep the window from handing in work.
                    if device.poll(wgpu::PollType::Poll).is_err() {
                        return;
                    }
                    std::thread::sleep(std::time::Duration::from_millis(1));
                }
            }
        });
        Self(sender)
    }

    /// Sees to `flight`.
    pub fn watch(&self, flight: &Flight) {
        // Without the thread the device is lost, and somebody has said so.
        let _ = self.0.send(flight.parts.clone());
    }
}

/// A browser calls back by itself.
#[cfg(target_arch = "wasm32")]
pub struct Watcher;

#[cfg(target_arch = "wasm32")]
impl Watcher {
    /// For what is handed in to a device.
    pub fn new(_: &wgpu::Device) -> Self {
        Self
    }

    /// Sees to a flight.
    pub fn watch(&self, _: &Flight) {}
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};
    use tresses::gpu::Gpu;

    #[test]
    fn parts_go_one_by_one_until_they_are_given_up() {
        let Ok(gpu) = pollster::block_on(Gpu::open()) else {
            assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none(), "there is no adapter");
            return;
        };
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
