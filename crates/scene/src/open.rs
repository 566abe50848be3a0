//! Loads the character of a preset: a groom and its head, imported or built in.

use crate::{companion_files::CompanionFiles, preset::Preset, settings::HairColor, shelf::Shelf};
use anyhow::{Result, ensure};
use std::str::FromStr;
use tresses::{
    CharacterFiles, CharacterParts, CharacterSource, Context, Progress, Styling, drape,
    groom::{
        edit::{GroomDocument, GroomEditor},
        styles::Style,
    },
};

impl Preset {
    /// Imports or grows this preset's character. Built-in styles are draped on the GPU.
    ///
    /// # Errors
    /// Fails if the preset is contradictory or a file cannot be read. The message is one sentence.
    pub async fn character(&self, context: &Context, progress: &impl Progress) -> Result<CharacterParts> {
        let (base, styling) = self.open_source(context, progress).await?;
        Ok(base.parts(&styling, progress).await?)
    }

    /// Opens this preset's character to edit its hair, as styled by the settings. Also returns the character with the
    /// first version of the hair.
    ///
    /// # Errors
    /// As [`character`](Self::character).
    pub async fn editor(
        &self,
        context: &Context,
        progress: &impl Progress,
    ) -> Result<(CharacterSource, GroomEditor)> {
        let (base, styling) = self.open_source(context, progress).await?;
        let document = edited(&base, &styling, &self.files(), progress).await?;
        let base = base.with_document(document.clone());
        let editor = base.editor(document, progress).await?;
        Ok((base, editor))
    }

    fn files(&self) -> CharacterFiles<'_> {
        CharacterFiles::Disk { grooms: &self.source.grooms, heads: &self.source.heads }
    }

    /// Opens the source, and returns how its strands are styled.
    async fn open_source(
        &self,
        context: &Context,
        progress: &impl Progress,
    ) -> Result<(CharacterSource, Styling)> {
        // Check the arguments before any expensive work.
        let source = &self.source;
        ensure!(
            source.color_map.is_none() || self.settings.shading.color == HairColor::File,
            "a color map needs shading.color = file"
        );
        let maps = CompanionFiles::of(source, Shelf::default()).maps()?;
        let style = match source.grooms.is_empty() {
            true => Some(Style::from_str(source.style.as_deref().unwrap_or("long"))?),
            false => None,
        };
        let styling = self.settings.styling(style.as_ref(), &maps)?;
        let base = match &style {
            Some(style) if source.is_mannequin() => drape::style(context, style, progress).await?,
            Some(style) => {
                drape::style_on(context, style, &self.files(), &source.orientation, progress).await?
            }
            None => CharacterSource::imported(&self.files(), &source.orientation, progress).await?,
        };
        Ok((base, styling))
    }
}

/// Returns the first version of the hair of `base` to edit, styled by `styling`: an edited groom as it is, if nothing
/// restyles it. `files` are those of `base`.
///
/// # Errors
/// Fails if the styling is invalid or a file of the head cannot be read again.
pub async fn edited(
    base: &CharacterSource,
    styling: &Styling,
    files: &CharacterFiles<'_>,
    progress: &impl Progress,
) -> Result<GroomDocument> {
    if let Some(document) = base.document().filter(|_| styling.restyle.is_none()) {
        return Ok(document.clone());
    }
    // Stiffness is multiplied again whenever the document is dressed.
    let styling = Styling { stiffness: None, ..styling.clone() };
    let groom = base.parts(&styling, progress).await?.groom;
    Ok(base.edit(groom, files)?)
}
