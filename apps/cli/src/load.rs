//! From options to a character: a groom with its head, from files or built in.

use crate::{
    args::{Guides, Source},
    lod_args,
};
use anyhow::Result;
use std::str::FromStr;
use tresses::{
    gpu::Gpu,
    groom::{GuideCount, styles::Style},
    simulate::Simulate,
};
use tresses_scene::{Base, Character, Files, Styling};

/// Reads or grows the character that `source` names; what is grown is draped on `gpu`.
pub fn load(source: &Source, gpu: &Gpu, simulate: &Simulate) -> Result<Character> {
    // What can be refused is refused before anything is made.
    let mut styling = Styling {
        strands: source.strands,
        guides: source.guides.map(count),
        stiffness: source.shape.stiffness()?,
        levels: source.lod_maps.as_ref().map(|path| lod_args::levels(path)).transpose()?.unwrap_or_default(),
        ..Styling::default()
    };
    let base = if source.grooms.is_empty() {
        let style = Style::from_str(source.style.as_deref().unwrap_or("long"))?;
        styling.growth = Some(source.shape.growth(&style, source.strands)?);
        pollster::block_on(Base::built_in(&style, gpu, simulate, &()))?
    } else {
        styling.paint = source.shape.paint()?;
        styling.restyle = source.shape.restyle()?;
        let files = Files::Disk { grooms: &source.grooms, heads: &source.head };
        pollster::block_on(Base::imported(&files, &source.orientation.options(), &()))?
    };
    pollster::block_on(base.dress(&styling, &()))
}

fn count(guides: Guides) -> GuideCount {
    match guides {
        Guides::All => GuideCount::All,
        Guides::Count(count) => GuideCount::Count(count),
    }
}
