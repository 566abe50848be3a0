//! Saves the image in the viewport as a file.

use crate::{answer::Answer, dialog::Dialogs, messages::Messages, renderer::StudioRenderer, task};
use anyhow::Result;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use tresses_scene::{Settings, words::sentence};

/// A request to save the image.
#[derive(Clone, Copy, Debug, Default)]
pub struct Snapshot {
    /// Whether an image is to be saved.
    pub is_requested: bool,
    /// Whether the last frame was drawn to be saved.
    pub kept: bool,
}

impl Snapshot {
    /// Saves the image if requested, at the window's full size and quality. No frame may be in flight. Returns whether
    /// a frame was started for it.
    pub fn save(
        &mut self,
        renderer: &mut StudioRenderer,
        settings: &Settings,
        dialogs: &Dialogs,
        messages: &mut Messages,
    ) -> bool {
        let Some(show) = renderer.show.as_ref().filter(|_| self.is_requested) else { return false };
        let level = renderer.pace.finest();
        let picture = show.picture().filter(|picture| picture.level == *level);
        let Some(size) = picture.map(|picture| picture.size).filter(|_| !renderer.dirty || self.kept) else {
            // Draw the hair's current state at full quality, however long it takes.
            let moment = renderer.prepare(level, settings, messages);
            match renderer.draw(&moment) {
                Ok(()) => self.kept = true,
                Err(error) => {
                    self.is_requested = false;
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
                Ok(bytes) => dialogs.save("Save the image", "tresses.png", bytes),
                Err(error) => dialogs.tell(Answer::Failed(sentence(&error))),
            }
        });
        false
    }
}

/// Encodes opaque pixels as PNG.
fn encode([width, height]: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(rgba, width, height, ExtendedColorType::Rgba8)?;
    Ok(bytes)
}
