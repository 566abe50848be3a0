//! Loads the character of a preset: a groom and its head, imported or built in.

use crate::{companions::Companions, preset::Preset, settings::HairColor, shelf::Shelf};
use anyhow::{Result, ensure};
use std::str::FromStr;
use tresses::{
    Context, Progress,
    character::{CharacterFiles, CharacterParts, CharacterSource},
    groom::styles::Style,
};

impl Preset {
    /// Imports or grows this preset's character. Built-in styles are draped on the GPU.
    ///
    /// # Errors
    /// Fails if the preset is contradictory or a file cannot be read. The message is one sentence.
    pub async fn character(&self, context: &Context, progress: &impl Progress) -> Result<CharacterParts> {
        // Check the arguments before any expensive work.
        let source = &self.source;
        ensure!(
            source.color_map.is_none() || self.settings.shading.color == HairColor::File,
            "a color map needs shading.color = file"
        );
        let maps = Companions::of(source, Shelf::default()).maps()?;
        let style = match source.grooms.is_empty() {
            true => Some(Style::from_str(source.style.as_deref().unwrap_or("long"))?),
            false => None,
        };
        let styling = self.settings.styling(style.as_ref(), &maps)?;
        let base = match &style {
            Some(style) => CharacterSource::built_in(context, style, progress).await?,
            None => {
                let files = CharacterFiles::Disk { grooms: &source.grooms, heads: &source.heads };
                CharacterSource::imported(&files, &source.orientation, progress).await?
            }
        };
        Ok(base.dress(&styling, progress).await?)
    }
}
