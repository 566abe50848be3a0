//! The window.

use crate::{app::Studio, device, options::Options};
use anyhow::{Result, anyhow};
use eframe::egui;

/// The window's size at first, points.
const SIZE: [f32; 2] = [1280.0, 800.0];

/// Opens the window and returns when it is closed.
///
/// # Errors
/// One sentence, when there is no display or no adapter that can draw.
pub fn run(options: Options) -> Result<()> {
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
