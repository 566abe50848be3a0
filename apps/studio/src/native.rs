//! The window.

use crate::{app::Studio, device, options::Options};
use anyhow::{Result, anyhow};
use eframe::egui;
use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicBool, Ordering},
};

/// The window's size at first, points.
const SIZE: [f32; 2] = [1280.0, 800.0];

/// How often a device may be lost before it is given up.
const MOST: u32 = 3;

/// What the next window begins with, after one that lost its device.
static AGAIN: Mutex<Option<Box<Options>>> = Mutex::new(None);

/// Opens the window and returns when it is closed. A window that loses its device is opened again.
///
/// # Errors
/// One sentence, when there is no display or no adapter that can draw, or the device was lost too often.
pub fn run(options: Options) -> Result<()> {
    let mut next = options;
    for _ in 0..=MOST {
        let done = open(next);
        match AGAIN.lock().unwrap_or_else(PoisonError::into_inner).take() {
            // What a window says that closes without a device means nothing.
            Some(again) => next = *again,
            None => return done,
        }
    }
    Err(anyhow!("the GPU was lost {} times; the studio gives it up", MOST + 1))
}

/// The window that is open has no device any more: another is to show what it shows.
pub(crate) fn leave(again: Options) {
    *AGAIN.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(again));
}

/// Loses the device after the frame that `TRESSES_STUDIO_LOSE_AT` names, once: a test of what follows.
pub(crate) fn lose_for_tests(device: &wgpu::Device, frames: u64) {
    static DONE: AtomicBool = AtomicBool::new(false);
    let at = std::env::var("TRESSES_STUDIO_LOSE_AT").ok().and_then(|text| text.parse::<u64>().ok());
    if at.is_some_and(|at| frames >= at) && !DONE.swap(true, Ordering::Relaxed) {
        device.destroy();
    }
}

fn open(options: Options) -> Result<()> {
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Tresses")
            .with_app_id("tresses")
            .with_inner_size(SIZE)
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: device::configuration(),
        ..Default::default()
    };
    let start: eframe::AppCreator<'_> =
        Box::new(move |context| Ok(Box::new(Studio::new(context, options)?) as Box<dyn eframe::App>));
    eframe::run_native("tresses", native, start).map_err(|error| anyhow!("{}", sentence(&error.to_string())))
}

/// What the toolkit says, with what to do about it.
fn sentence(error: &str) -> String {
    let lower = error.to_lowercase();
    let help = if lower.contains("display") || lower.contains("event loop") {
        "; the studio needs a display: `tresses render` and `tresses demo` do without"
    } else if lower.contains("adapter") || lower.contains("wgpu") {
        "; on Linux without a GPU, scripts/setup installs Mesa's software Vulkan driver"
    } else {
        ""
    };
    format!("the window cannot be opened: {error}{help}")
}
