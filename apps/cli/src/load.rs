//! From a preset to a character: a groom with its head, from files or built in.

use anyhow::{Result, ensure};
use std::str::FromStr;
use tresses::{Progress, gpu::Gpu, groom::styles::Style, simulate};
use tresses_scene::{Base, Character, Companions, Files, Preset, Shelf, settings::HairColor};

/// Reads or grows the character of `preset`; what is grown is draped on `gpu`.
pub fn load(
    preset: &Preset,
    gpu: &Gpu,
    simulate: &simulate::Pipelines,
    progress: &impl Progress,
) -> Result<Character> {
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
        Some(style) => pollster::block_on(Base::built_in(style, gpu, simulate, progress))?,
        None => {
            let files = Files::Disk { grooms: &source.grooms, heads: &source.heads };
            pollster::block_on(Base::imported(&files, &source.orientation, progress))?
        }
    };
    pollster::block_on(base.dress(&styling, progress))
}
