//! A device that is lost, or refuses its work: one sentence, and another window.

use crate::app::Studio;
use eframe::egui;
use std::sync::{Arc, Mutex, PoisonError};

/// Why nothing can be drawn any more.
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// One sentence.
    sentence: String,
    /// Whether the device itself is gone, and not only its work refused.
    is_gone: bool,
}

/// What the driver has reported so far.
pub type Lost = Arc<Mutex<Option<Loss>>>;

impl Studio {
    /// Closes a window that has no device any more; [`crate::native::run`] opens another. Whether it does:
    /// then nothing must be shown, as there is nothing to draw it with.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn leaves_if_gone(&mut self, context: &egui::Context) -> bool {
        crate::native::lose_for_tests(&self.gpu.device, self.show.as_ref().map_or(0, |show| show.frames));
        crate::native::remember(self.again());
        let gone = self.is_gone();
        if gone {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        gone
    }

    /// Why nothing can be drawn any more.
    pub(crate) fn lost(&self) -> Option<String> {
        self.loss().map(|loss| loss.sentence)
    }

    /// Whether there is no device any more with which a window could say so.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn is_gone(&self) -> bool {
        self.loss().is_some_and(|loss| loss.is_gone)
    }

    fn loss(&self) -> Option<Loss> {
        self.lost.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// From here on `lost` says what went wrong on `device`, instead of a panic.
pub fn listen(device: &wgpu::Device, context: &egui::Context, lost: &Lost) {
    let tell = |sentence: &str, is_gone: bool| {
        let (lost, context, sentence) = (lost.clone(), context.clone(), sentence.to_owned());
        move |message: String| {
            let first = message.lines().next().unwrap_or_default().to_owned();
            let mut lost = lost.lock().unwrap_or_else(PoisonError::into_inner);
            // What comes first is the cause; what is gone is worse than what is refused.
            if lost.as_ref().is_none_or(|before| is_gone && !before.is_gone) {
                let cause = if first.is_empty() { sentence.clone() } else { format!("{sentence}: {first}") };
                // egui has no device to draw it with.
                #[cfg(target_arch = "wasm32")]
                crate::web::say(&cause);
                #[cfg(not(target_arch = "wasm32"))]
                if is_gone {
                    crate::native::gone(&cause);
                }
                *lost = Some(Loss { sentence: cause, is_gone });
            }
            context.request_repaint();
        }
    };
    let gone = tell("The GPU was lost", true);
    device.set_device_lost_callback(move |reason, message| {
        #[cfg(target_arch = "wasm32")]
        let destroys = false;
        #[cfg(not(target_arch = "wasm32"))]
        let destroys = crate::native::DESTROYS.load(std::sync::atomic::Ordering::Relaxed);
        // That of a window that closes is none.
        if destroys || reason != wgpu::DeviceLostReason::Destroyed {
            gone(message);
        }
    });
    let wrong = tell("The GPU refused its work", false);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        eprintln!("{error}");
        wrong(error.to_string());
    }));
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
        let now = |lost: &Mutex<Option<Loss>>| lost.lock().unwrap().clone();
        listen(&gpu.device, &context, &lost);
        assert_eq!(now(&lost), None);
        // Refused work is told, and leaves a device.
        let usage = wgpu::BufferUsages::empty();
        let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage,
            mapped_at_creation: false,
        });
        assert!(now(&lost).is_some_and(|loss| !loss.is_gone && loss.sentence.contains("refused")));
        crate::native::DESTROYS.store(true, std::sync::atomic::Ordering::Relaxed);
        gpu.device.destroy();
        let _ = gpu.device.poll(wgpu::PollType::Poll);
        assert!(now(&lost).is_some_and(|loss| loss.is_gone && loss.sentence.starts_with("The GPU was lost")));
    }
}
