//! A device that is lost, or refuses its work: one sentence, and another window.

use crate::options::Options;
use eframe::egui;
use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicBool, Ordering},
};

/// Options of the open window, for the next one if its device is lost.
static SHOWN: Mutex<Option<Box<Options>>> = Mutex::new(None);

/// Why the device of the window is gone.
static GONE: Mutex<Option<String>> = Mutex::new(None);

/// Whether a device that is destroyed counts as lost: only a test destroys one that is in use.
static DESTROYS: AtomicBool = AtomicBool::new(false);

/// Why nothing can be drawn any more.
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// One sentence.
    sentence: String,
    /// Whether the device itself is gone, and not only its work refused.
    is_gone: bool,
}

/// What the driver has reported so far.
#[derive(Clone, Debug, Default)]
pub struct Lost(Arc<Mutex<Option<Loss>>>);

impl Lost {
    /// Why nothing can be drawn any more.
    pub fn sentence(&self) -> Option<String> {
        self.loss().map(|loss| loss.sentence)
    }

    /// Whether there is no device any more with which a window could say so.
    pub fn is_gone(&self) -> bool {
        self.loss().is_some_and(|loss| loss.is_gone)
    }

    fn loss(&self) -> Option<Loss> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// From here on `lost` says what went wrong on `device`, instead of a panic.
pub fn listen(device: &wgpu::Device, context: &egui::Context, lost: &Lost) {
    let tell = |sentence: &str, is_gone: bool| {
        let (lost, context, sentence) = (lost.clone(), context.clone(), sentence.to_owned());
        move |message: String| {
            let first = message.lines().next().unwrap_or_default().to_owned();
            let mut lost = lost.0.lock().unwrap_or_else(PoisonError::into_inner);
            // What comes first is the cause; what is gone is worse than what is refused.
            if lost.as_ref().is_none_or(|before| is_gone && !before.is_gone) {
                let cause = if first.is_empty() { sentence.clone() } else { format!("{sentence}: {first}") };
                // egui has no device to draw it with.
                #[cfg(target_arch = "wasm32")]
                crate::page::say(&cause);
                if is_gone {
                    *GONE.lock().unwrap_or_else(PoisonError::into_inner) = Some(cause.clone());
                }
                *lost = Some(Loss { sentence: cause, is_gone });
            }
            context.request_repaint();
        }
    };
    let gone = tell("The GPU was lost", true);
    device.set_device_lost_callback(move |reason, message| {
        // That of a window that closes is none.
        if DESTROYS.load(Ordering::Relaxed) || reason != wgpu::DeviceLostReason::Destroyed {
            gone(message);
        }
    });
    let wrong = tell("The GPU refused its work", false);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        eprintln!("{error}");
        wrong(error.to_string());
    }));
}

/// Keeps the options that open the window again.
pub fn remember(shown: Options) {
    *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(shown));
}

/// The reason if the window's device is gone, and the options that open the window again. Takes both.
pub fn take() -> (Option<String>, Option<Box<Options>>) {
    let gone = GONE.lock().unwrap_or_else(PoisonError::into_inner).take();
    (gone, SHOWN.lock().unwrap_or_else(PoisonError::into_inner).take())
}

/// Loses the device after the frame that `TRESSES_STUDIO_LOSE_AT` names, once: a test of what follows.
pub fn lose_for_tests(device: &wgpu::Device, frames: u64) {
    static DONE: AtomicBool = AtomicBool::new(false);
    let at = std::env::var("TRESSES_STUDIO_LOSE_AT").ok().and_then(|text| text.parse::<u64>().ok());
    if at.is_some_and(|at| frames >= at) && !DONE.swap(true, Ordering::Relaxed) {
        DESTROYS.store(true, Ordering::Relaxed);
        device.destroy();
        // Calls back, here or on the thread that watches over frames; whatever it says, the device is gone.
        for _ in 0..1000 {
            let _ = device.poll(wgpu::PollType::Poll);
            if GONE.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        DESTROYS.store(false, Ordering::Relaxed);
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;
    use tresses::gpu::Gpu;

    #[test]
    fn a_lost_device_is_told() {
        let Ok(gpu) = pollster::block_on(Gpu::open()) else {
            assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none(), "there is no adapter");
            return;
        };
        let (context, lost) = (egui::Context::default(), Lost::default());
        let now = Lost::loss;
        listen(gpu.context.device(), &context, &lost);
        assert_eq!(now(&lost), None);
        // Refused work is told, and leaves a device.
        let usage = wgpu::BufferUsages::empty();
        let _ = gpu.context.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage,
            mapped_at_creation: false,
        });
        assert!(now(&lost).is_some_and(|loss| !loss.is_gone && loss.sentence.contains("refused")));
        DESTROYS.store(true, Ordering::Relaxed);
        gpu.context.device().destroy();
        let _ = gpu.context.device().poll(wgpu::PollType::Poll);
        assert!(now(&lost).is_some_and(|loss| loss.is_gone && loss.sentence.starts_with("The GPU was lost")));
    }
}
