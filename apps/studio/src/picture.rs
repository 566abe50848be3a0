//! The picture as a file.

use crate::app::Studio;
use anyhow::{Context, Result};
use eframe::egui;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use tresses::gpu::readback;

impl Studio {
    /// Saves the picture, if somebody wants it.
    pub(crate) fn save_picture(&mut self, context: &egui::Context) {
        if !std::mem::take(&mut self.wants_picture) {
            return;
        }
        match self.png() {
            Ok(bytes) => self.dialogs.save(context, "Save the picture", "tresses.png", bytes),
            Err(error) => self.error = Some(format!("{error:#}")),
        }
    }

    fn png(&self) -> Result<Vec<u8>> {
        let show = self.show.as_ref().context("there is no picture yet")?;
        let (gpu, targets) = (&self.gpu, &show.stage.targets);
        let rgba = readback::texture(&gpu.device, &gpu.queue, targets.picture().texture())?;
        encode(targets.size, &rgba)
    }
}

/// PNG of opaque pixels.
fn encode([width, height]: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(rgba, width, height, ExtendedColorType::Rgba8)?;
    Ok(bytes)
}
