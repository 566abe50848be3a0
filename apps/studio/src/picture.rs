//! The picture as a file.

use crate::{answer::Answer, dialog::Dialogs, messages::Messages, renderer::Renderer, task};
use anyhow::Result;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use tresses_scene::Settings;

/// The request for a picture as a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Snapshot {
    /// Whether the picture is to be saved.
    pub wanted: bool,
    /// Whether the last frame was drawn to be saved.
    pub kept: bool,
}

impl Snapshot {
    /// Saves the picture on request, at the window's full size and quality; no frame is under way. Whether one is
    /// begun for it.
    pub fn save(
        &mut self,
        renderer: &mut Renderer,
        settings: &Settings,
        dialogs: &Dialogs,
        messages: &mut Messages,
    ) -> bool {
        let Some(show) = renderer.show.as_ref().filter(|_| self.wanted) else { return false };
        let level = renderer.pace.finest();
        let picture = show.picture().filter(|picture| picture.level == *level);
        let Some(size) = picture.map(|picture| picture.size).filter(|_| !renderer.dirty || self.kept) else {
            // The hair in its current state, however long it takes.
            let moment = renderer.prepare(level, settings, messages);
            match renderer.draw(&moment) {
                Ok(()) => self.kept = true,
                Err(error) => {
                    self.wanted = false;
                    messages.fail(error);
                }
            }
            return true;
        };
        *self = Self::default();
        let (copy, dialogs) = (show.copy(), dialogs.clone());
        task::spawn(move || async move {
            let done = async { encode(size, &copy?.wait().await?) };
            match done.await {
                Ok(bytes) => dialogs.save("Save the picture", "tresses.png", bytes),
                Err(error) => dialogs.tell(Answer::Failed(format!("{error:#}"))),
            }
        });
        false
    }
}

/// PNG of opaque pixels.
fn encode([width, height]: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(rgba, width, height, ExtendedColorType::Rgba8)?;
    Ok(bytes)
}
