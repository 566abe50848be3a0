//! The picture as a file.

use crate::{app::Studio, dialog::Answer, stage::Moment, task};
use anyhow::Result;
use eframe::egui;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

impl Studio {
    /// Saves the picture on request, at the window's full size and quality; no frame is under way. Whether one is
    /// begun for it.
    pub(crate) fn save_picture(&mut self, context: &egui::Context) -> bool {
        let Some(show) = self.show.as_ref().filter(|_| self.wants_picture && self.recording.is_none()) else {
            return false;
        };
        let picture = show.picture().filter(|picture| picture.level == *self.pace.finest());
        let Some(size) = picture.map(|picture| picture.size).filter(|_| !self.dirty || self.kept) else {
            match self.draw_in_full(context) {
                Ok(()) => self.kept = true,
                Err(error) => (self.wants_picture, self.error) = (false, Some(format!("{error:#}"))),
            }
            return true;
        };
        (self.wants_picture, self.kept) = (false, false);
        let (device, copy) = (self.gpu.device.clone(), show.copy());
        let (dialogs, context) = (self.dialogs.clone(), context.clone());
        task::spawn(move || async move {
            let done = async { encode(size, &copy?.wait(&device).await?) };
            match done.await {
                Ok(bytes) => dialogs.save(&context, "Save the picture", "tresses.png", bytes),
                Err(error) => dialogs.tell(&context, Answer::Failed(format!("{error:#}"))),
            }
        });
        false
    }

    /// Draws the hair in its current state, however long it takes.
    fn draw_in_full(&mut self, context: &egui::Context) -> Result<()> {
        let level = self.pace.finest();
        self.dress(level);
        let (gesture, camera, size) = (self.gesture(), self.orbit.camera(), self.size_at(level));
        let (ssaa, ball) = (self.ssaa_at(level, size), self.ball.map(|ball| ball.at));
        let (again, level, parts) = (false, *level, self.pace.is_long(level));
        let Some(show) = &mut self.show else { return Ok(()) };
        let moment = Moment { gesture, seconds: 0.0, camera, size, ssaa, ball, again, level, parts };
        show.draw(&self.state, context, &moment)
    }
}

/// PNG of opaque pixels.
fn encode([width, height]: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(rgba, width, height, ExtendedColorType::Rgba8)?;
    Ok(bytes)
}
