//! The character of a preset: a groom with its head, from files or built in.

use crate::{companions::Companions, preset::Preset, settings::HairColor, shelf::Shelf};
use anyhow::{Result, ensure};
use std::str::FromStr;
use tresses::{
    Context, Progress,
    character::{CharacterFiles, CharacterParts, CharacterSource},
    groom::styles::Style,
};

impl Preset {
    /// Reads or grows the character of this preset; built-in styles are draped on the GPU.
    ///
    /// # Errors
    /// One sentence, when that makes no sense or a file cannot be read.
    pub async fn character(&self, context: &Context, progress: &impl Progress) -> Result<CharacterParts> {
        // What can be refused is refused before anything is made.
        let source = &self.source;
        ensure!(
            source.color_map.is_none() || self.settings.shading.color == HairColor::File,
            "a map of colours shows with shading.color on file only"
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
