//! Lost devices and device errors: reports the cause and reopens the window.

use crate::options::Options;
use eframe::egui;
use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicBool, Ordering},
};

/// Options that reopen the current window if its device is lost.
static SHOWN: Mutex<Option<Box<Options>>> = Mutex::new(None);

/// Why the window's device was lost.
static LOSS_CAUSE: Mutex<Option<String>> = Mutex::new(None);

/// Whether destroying the device counts as losing it. Only tests set this.
static DESTROYS: AtomicBool = AtomicBool::new(false);

/// Why drawing has stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// Cause, one sentence.
    sentence: String,
    /// Whether the device is lost, as opposed to a device error.
    is_lost: bool,
}

/// First loss or error that the driver reported.
#[derive(Clone, Debug, Default)]
pub struct DeviceLoss(Arc<Mutex<Option<Loss>>>);

impl DeviceLoss {
    /// Returns why drawing has stopped, if it has.
    pub fn sentence(&self) -> Option<String> {
        self.loss().map(|loss| loss.sentence)
    }

    /// Whether the device is lost, so that the window cannot show the cause.
    pub fn is_lost(&self) -> bool {
        self.loss().is_some_and(|loss| loss.is_lost)
    }

    fn loss(&self) -> Option<Loss> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Records errors and the loss of `device` in `lost` instead of panicking.
pub fn listen(device: &wgpu::Device, context: &egui::Context, lost: &DeviceLoss) {
    let tell = |sentence: &str, is_lost: bool| {
        let (lost, context, sentence) = (lost.clone(), context.clone(), sentence.to_owned());
        move |message: String| {
            let first = message.lines().next().unwrap_or_default().to_owned();
            let mut lost = lost.0.lock().unwrap_or_else(PoisonError::into_inner);
            // The first report is the cause, except that a lost device replaces a device error.
            if lost.as_ref().is_none_or(|before| is_lost && !before.is_lost) {
                let cause = if first.is_empty() { sentence.clone() } else { format!("{sentence}: {first}") };
                // egui has no device left to draw the message.
                #[cfg(target_arch = "wasm32")]
                crate::page::say(&cause);
                if is_lost {
                    *LOSS_CAUSE.lock().unwrap_or_else(PoisonError::into_inner) = Some(cause.clone());
                }
                *lost = Some(Loss { sentence: cause, is_lost });
            }
            context.request_repaint();
        }
    };
    let on_loss = tell("The GPU was lost", true);
    device.set_device_lost_callback(move |reason, message| {
        // A closing window destroys its device, which is no loss.
        if DESTROYS.load(Ordering::Relaxed) || reason != wgpu::DeviceLostReason::Destroyed {
            on_loss(message);
        }
    });
    let wrong = tell("The GPU reported an error", false);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        eprintln!("{error}");
        wrong(error.to_string());
    }));
}

/// Stores the options that reopen the window.
pub fn remember(shown: Options) {
    *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(shown));
}

/// Takes the cause if the window's device was lost, and the options that reopen the window.
pub fn take() -> (Option<String>, Option<Box<Options>>) {
    let cause = LOSS_CAUSE.lock().unwrap_or_else(PoisonError::into_inner).take();
    (cause, SHOWN.lock().unwrap_or_else(PoisonError::into_inner).take())
}

/// Destroys the device after the frame that `TRESSES_STUDIO_LOSE_AT` names, once, to test recovery.
pub fn lose_for_tests(device: &wgpu::Device, frames: u64) {
    static DONE: AtomicBool = AtomicBool::new(false);
    let at = std::env::var("TRESSES_STUDIO_LOSE_AT").ok().and_then(|text| text.parse::<u64>().ok());
    if at.is_some_and(|at| frames >= at) && !DONE.swap(true, Ordering::Relaxed) {
        DESTROYS.store(true, Ordering::Relaxed);
        device.destroy();
        // The callback runs here or on the polling thread; either way the device is lost.
        for _ in 0..1000 {
            let _ = device.poll(wgpu::PollType::Poll);
            if LOSS_CAUSE.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
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
    use tresses::Gpu;

    #[test]
    fn device_errors_and_loss_are_reported() {
        let Some(gpu) = tresses_testing::gpu_or_skip(pollster::block_on(Gpu::open())) else { return };
        let (context, lost) = (egui::Context::default(), DeviceLoss::default());
        let now = DeviceLoss::loss;
        listen(gpu.context.device(), &context, &lost);
        assert_eq!(now(&lost), None);
        // A device error is reported and does not count as a loss.
        let usage = wgpu::BufferUsages::empty();
        let _ = gpu.context.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage,
            mapped_at_creation: false,
        });
        assert!(
            now(&lost)
                .is_some_and(|loss| !loss.is_lost && loss.sentence.starts_with("The GPU reported an error"))
        );
        DESTROYS.store(true, Ordering::Relaxed);
        gpu.context.device().destroy();
        let _ = gpu.context.device().poll(wgpu::PollType::Poll);
        assert!(now(&lost).is_some_and(|loss| loss.is_lost && loss.sentence.starts_with("The GPU was lost")));
    }
}
