//! From a preset to a character: a groom with its head, from files or built in.

use super::{Base, Character, Files};
use crate::{Companions, Preset, Shelf, settings::HairColor};
use anyhow::{Result, ensure};
use std::str::FromStr;
use tresses::{Progress, gpu::Gpu, groom::styles::Style, simulate};

impl Character {
    /// Reads or grows the character of `preset`; what is grown is draped on `gpu`.
    ///
    /// # Errors
    /// One sentence, when that makes no sense or a file cannot be read.
    pub async fn open(
        preset: &Preset,
        gpu: &Gpu,
        simulate: &simulate::Pipelines,
        progress: &impl Progress,
    ) -> Result<Self> {
        // What can be refused is refused before anything is made.
        let source = &preset.source;
        ensure!(
            source.color_map.is_none() || preset.settings.shading.color == HairColor::File,
            "a map of colours shows with shading.color on file only"
        );
        let maps = Companions::of(source, Shelf::default()).maps()?;
        let style = match source.grooms.is_empty() {
            true => Some(Style::from_str(source.style.as_deref().unwrap_or("long"))?),
            false => None,
        };
        let styling = preset.settings.styling(style.as_ref(), &maps)?;
        let base = match &style {
            Some(style) => Base::built_in(style, gpu, simulate, progress).await?,
            None => {
                let files = Files::Disk { grooms: &source.grooms, heads: &source.heads };
                Base::imported(&files, &source.orientation, progress).await?
            }
        };
        base.dress(&styling, progress).await
    }
}
