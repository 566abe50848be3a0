//! The picture as a file.

use crate::{app::Studio, dialog::Answer, task};
use anyhow::Result;
use eframe::egui;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use tresses::gpu::readback::Pending;

impl Studio {
    /// Saves the picture, if somebody wants it.
    pub(crate) fn save_picture(&mut self, context: &egui::Context) {
        if !std::mem::take(&mut self.wants_picture) {
            return;
        }
        let Some(show) = &self.show else { return };
        let (device, targets) = (self.gpu.device.clone(), &show.stage.targets);
        let size = targets.size;
        let copy = Pending::texture(&device, &self.gpu.queue, targets.picture().texture());
        let (dialogs, context) = (self.dialogs.clone(), context.clone());
        task::spawn(move || async move {
            let done = async { encode(size, &copy?.wait(&device).await?) };
            match done.await {
                Ok(bytes) => dialogs.save(&context, "Save the picture", "tresses.png", bytes),
                Err(error) => dialogs.tell(&context, Answer::Failed(format!("{error:#}"))),
            }
        });
    }
}

/// PNG of opaque pixels.
fn encode([width, height]: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(rgba, width, height, ExtendedColorType::Rgba8)?;
    Ok(bytes)
}
