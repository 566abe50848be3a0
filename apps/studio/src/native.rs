//! The desktop window.

use crate::{app::Studio, device, loss, options::Options};
use anyhow::{Result, anyhow};
use eframe::egui;
use std::panic::{self, AssertUnwindSafe};

/// Initial window size, points.
const SIZE: [f32; 2] = [1280.0, 800.0];

/// Maximum number of times that the window is reopened after a device loss.
const MAX_REOPENS: u32 = 3;

/// Opens the window and returns when it is closed. A window that loses its device is reopened.
///
/// # Errors
/// Fails with one sentence if there is no display or no suitable adapter, or the device was lost too often.
pub fn run(options: Options) -> Result<()> {
    let mut next = options;
    for _ in 0..=MAX_REOPENS {
        // wgpu's helpers and egui's painter panic when they allocate on a lost device.
        let result = panic::catch_unwind(AssertUnwindSafe(|| open(next)));
        let (cause, window_options) = loss::take();
        next = match (result, cause, window_options) {
            (Ok(_), Some(cause), Some(window_options)) => {
                let trouble = format!("{cause}. The window was opened again");
                Options { trouble: Some(trouble), ..*window_options }
            }
            // A panic within a frame: winit cannot open another window after that.
            (Err(_), Some(cause), _) => return Err(anyhow!("{cause}; start the studio again")),
            (Ok(result), ..) => return result,
            (Err(payload), ..) => panic::resume_unwind(payload),
        };
    }
    Err(anyhow!("the GPU was lost {} times; the studio gives up", MAX_REOPENS + 1))
}

/// Opens the window and returns when it is closed or its device is lost.
fn open(options: Options) -> Result<()> {
    let native_options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Tresses")
            .with_app_id("tresses")
            .with_inner_size(SIZE)
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: device::configuration(),
        // Panels are single colors, and frames are dithered already.
        dithering: false,
        ..Default::default()
    };
    let create_app: eframe::AppCreator<'_> =
        Box::new(move |context| Ok(Box::new(Studio::new(context, options)?) as Box<dyn eframe::App>));
    eframe::run_native("tresses", native_options, create_app)
        .map_err(|error| anyhow!("{}", with_hint(&error.to_string())))
}

/// Returns the window toolkit's error with a hint for the user.
fn with_hint(error: &str) -> String {
    let lower = error.to_lowercase();
    let hint = if lower.contains("display") || lower.contains("event loop") {
        "; the studio needs a display, `tresses render` and `tresses demo` do not"
    } else if lower.contains("adapter") || lower.contains("wgpu") {
        "; on Linux without a GPU, scripts/setup installs Mesa's software Vulkan driver"
    } else {
        ""
    };
    format!("the window cannot be opened: {error}{hint}")
}
