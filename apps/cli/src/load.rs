//! From a preset to a character: a groom with its head, from files or built in.

use crate::{
    lod_args,
    scalp_map::{ColorSource, MapSource},
};
use anyhow::{Error, Result, ensure};
use std::{path::Path, str::FromStr};
use tresses::{
    gpu::Gpu,
    groom::{
        grow::{CurlCurve, Paint},
        styles::Style,
    },
    simulate::Simulate,
};
use tresses_scene::{
    Base, Character, Files, Preset,
    preset::Source,
    settings::{HairColor, Maps},
};

/// Reads or grows the character of `preset`; what is grown is draped on `gpu`.
pub fn load(preset: &Preset, gpu: &Gpu, simulate: &Simulate) -> Result<Character> {
    // What can be refused is refused before anything is made.
    let source = &preset.source;
    ensure!(
        source.color_map.is_none() || preset.settings.look.color == HairColor::File,
        "a map of colours shows with shading.color on file only"
    );
    let maps = maps(source)?;
    let style = match source.grooms.is_empty() {
        true => Some(Style::from_str(source.style.as_deref().unwrap_or("long"))?),
        false => None,
    };
    let styling = preset.settings.styling(style.as_ref(), &maps)?;
    let base = match &style {
        Some(style) => pollster::block_on(Base::built_in(style, gpu, simulate, &()))?,
        None => {
            let files = Files::Disk { grooms: &source.grooms, heads: &source.heads };
            pollster::block_on(Base::imported(&files, &source.orientation, &()))?
        }
    };
    pollster::block_on(base.dress(&styling, &()))
}

fn maps(source: &Source) -> Result<Maps> {
    let read = |name: &Option<String>| {
        let read = |name: &String| name.parse::<MapSource>().map_err(Error::msg)?.read();
        name.as_ref().map(read).transpose()
    };
    let color = |name: &String| name.parse::<ColorSource>().map_err(Error::msg)?.read();
    // Black hair is a quarter as stiff, white four times.
    let stiffness = read(&source.stiffness_map)?.map(|map| map.map(|grey| 4f32.powf(2.0 * grey - 1.0)));
    Ok(Maps {
        paint: Paint {
            density: read(&source.density_map)?,
            thickness: read(&source.thickness_map)?,
            length: read(&source.length_map)?,
            curl: read(&source.curl_map)?,
            color: source.color_map.as_ref().map(color).transpose()?,
        },
        stiffness,
        curl: source.curl_curve.as_ref().map(|path| CurlCurve::read(Path::new(path))).transpose()?,
        levels: match &source.lod_maps {
            Some(path) => lod_args::levels(Path::new(path))?,
            None => Vec::new(),
        },
    })
}
