//! The picture as a file.

use crate::{app::Studio, dialog::Answer, stage::Moment, task};
use anyhow::Result;
use eframe::egui;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

impl Studio {
    /// Saves the picture on request, at the window's full size and quality.
    pub(crate) fn save_picture(&mut self, context: &egui::Context) {
        if !self.wants_picture || self.recording.is_some() {
            return;
        }
        let Some(show) = &self.show else { return };
        if self.drawn != *self.pace.finest() {
            if show.is_under_way() {
                // Its end wakes the window.
                return;
            }
            if let Err(error) = self.draw_in_full(context) {
                self.error = Some(format!("{error:#}"));
            }
        }
        self.wants_picture = false;
        let Some(show) = &self.show else { return };
        let (device, size) = (self.gpu.device.clone(), show.stage.targets().size);
        let copy = show.copy();
        let (dialogs, context) = (self.dialogs.clone(), context.clone());
        task::spawn(move || async move {
            let done = async { encode(size, &copy?.wait(&device).await?) };
            match done.await {
                Ok(bytes) => dialogs.save(&context, "Save the picture", "tresses.png", bytes),
                Err(error) => dialogs.tell(&context, Answer::Failed(format!("{error:#}"))),
            }
        });
    }

    /// Draws the hair in its current state, however long it takes.
    fn draw_in_full(&mut self, context: &egui::Context) -> Result<()> {
        let level = self.pace.finest();
        self.dress(level);
        let (pose, camera, size) = (self.pose(), self.orbit.camera(), self.size_at(level));
        let (ssaa, ball) = (self.ssaa_at(level, size), self.ball.map(|ball| ball.at));
        let Some(show) = &mut self.show else { return Ok(()) };
        show.draw(
            &self.state,
            context,
            &Moment { pose, seconds: 0.0, camera, size, ssaa, ball, again: false },
        )
    }
}

/// PNG of opaque pixels.
fn encode([width, height]: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(rgba, width, height, ExtendedColorType::Rgba8)?;
    Ok(bytes)
}
