//! From options to a character: a groom with its head, from files or built in.

use crate::{
    args::{Guides, Source},
    lod_args,
};
use anyhow::{Context, Result};
use std::{fs::File, io::BufReader, path::Path, str::FromStr};
use tresses::{
    glam::Vec3,
    gpu::Gpu,
    groom::{
        BindOptions, Groom, GuideCount, SdfGrid, Strands, TriMesh, bind,
        grow::{Growth, ScalpMap},
        import,
        mesh::sdf::{self, SdfOptions},
        styles::{self, Style},
    },
    lod::LodLevel,
    simulate::Simulate,
};

/// How far the joint that a head nods and turns about lies below and behind the crown, metres.
const NECK_BELOW_CROWN: Vec3 = Vec3::new(0.0, -0.165, -0.012);

/// Where the middle of the braincase lies from that joint, metres.
const SKULL_ABOVE_NECK: Vec3 = Vec3::new(0.0, 0.075, 0.012);

/// A groom on a head, in metres, not yet on the GPU.
pub struct Character {
    /// Guides and strands.
    pub groom: Groom,
    /// What is drawn with the hair.
    pub head: Option<TriMesh>,
    /// What the hair collides with.
    pub field: Option<SdfGrid>,
    /// The neck joint, metres.
    pub neck: Vec3,
    /// Painted levels of detail.
    pub levels: Vec<LodLevel>,
    /// What the user should know, a sentence each.
    pub notes: Vec<String>,
}

impl Character {
    /// The middle of the braincase, metres.
    pub fn skull(&self) -> Vec3 {
        self.neck + SKULL_ABOVE_NECK
    }
}

/// Reads or grows the character that `source` names; what is grown is draped on `gpu`.
pub fn load(source: &Source, gpu: &Gpu, simulate: &Simulate) -> Result<Character> {
    let map = source.stiffness_map.as_deref().map(stiffness_map).transpose()?;
    let mut character =
        if source.grooms.is_empty() { built_in(source, gpu, simulate)? } else { imported(source)? };
    if let Some(map) = map {
        character.groom.guides.stiffen(&map, character.skull());
    }
    if let Some(path) = &source.lod_maps {
        character.levels = lod_args::levels(path)?;
    }
    Ok(character)
}

/// The factors that the grey picture at `path` stands for.
fn stiffness_map(path: &Path) -> Result<ScalpMap> {
    grey_map(path, &|grey| 4f32.powf(2.0 * grey - 1.0))
}

/// What `value` makes of the greys, 0 to 1, of the picture at `path`.
pub fn grey_map(path: &Path, value: &dyn Fn(f32) -> f32) -> Result<ScalpMap> {
    let read = || -> Result<ScalpMap> {
        let mut decoder = png::Decoder::new(BufReader::new(File::open(path)?));
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info()?;
        let size = reader.output_buffer_size().context("the picture is too large")?;
        let mut bytes = vec![0; size];
        let info = reader.next_frame(&mut bytes)?;
        let (width, height) = (info.width as usize, info.height as usize);
        // The mean of the colours, without alpha.
        let colors = if info.color_type.samples() < 3 { 1 } else { 3 };
        let grey = |pixel: &[u8]| pixel[..colors].iter().map(|v| f32::from(*v)).sum::<f32>() / colors as f32;
        // Pictures start at the top, scalp maps at the back of the head.
        let rows = bytes[..info.buffer_size()].chunks_exact(info.line_size).rev();
        let values = rows.flat_map(|row| {
            row[..width * info.color_type.samples()]
                .chunks_exact(info.color_type.samples())
                .map(|pixel| value(grey(pixel) / 255.0))
        });
        Ok(ScalpMap::new(width, height, values.collect())?)
    };
    read().with_context(|| path.display().to_string())
}

fn imported(source: &Source) -> Result<Character> {
    let options = source.orientation.options();
    let (strands, head, report) = if source.head.is_empty() {
        let (strands, report) = import::read(&source.grooms, &options)?;
        (strands, None, report)
    } else {
        let (strands, head, report) = import::read_with_head(&source.grooms, &source.head, &options)?;
        (strands, Some(head), report)
    };
    let field = match &head {
        Some(head) => Some(sdf::build(head, &SdfOptions::default()).with_context(|| {
            source.head.first().map(|path| path.display().to_string()).unwrap_or_default()
        })?),
        None => None,
    };
    let strands = match source.strands {
        Some(count) => thinned(&strands, count as usize),
        None => strands,
    };
    let guides = source.guides.map_or(BindOptions::default().guides, count);
    let neck = neck(&strands, head.as_ref());
    let groom = bind(&strands, &BindOptions { guides, ..Default::default() })?;
    let mut notes = report.placement.doubts;
    notes.extend(report.head_placement.into_iter().flat_map(|placement| placement.doubts));
    Ok(Character { groom, head, field, neck, levels: Vec::new(), notes })
}

fn built_in(source: &Source, gpu: &Gpu, simulate: &Simulate) -> Result<Character> {
    let style = Style::from_str(source.style.as_deref().unwrap_or("long"))?;
    let built = styles::character(&gpu.device, &gpu.queue, simulate, &style, source.strands)?;
    Ok(Character {
        groom: match source.guides {
            None => built.groom,
            Some(guides) => rebound(&built.groom, guides)?,
        },
        head: Some(built.mesh),
        field: Some(built.field),
        neck: built.neck,
        levels: Vec::new(),
        notes: Vec::new(),
    })
}

/// The same strands on other guides, chosen among the strands.
fn rebound(groom: &Groom, guides: Guides) -> Result<Groom> {
    let mut strands = Strands::default();
    for i in 0..groom.strands.len() {
        let line: Vec<_> = groom.strands.rest_positions(i).collect();
        strands.push(&line);
    }
    let options = BindOptions {
        guides: count(guides),
        guide_vertices: Some(groom.strands.vertex_count),
        strand_vertices: Some(groom.strands.vertex_count),
        ..Default::default()
    };
    let mut rebound = bind(&strands, &options)?;
    // They look as before: width, and the seeds of what differs from strand to strand.
    rebound.strands.strands.clone_from(&groom.strands.strands);
    Ok(rebound)
}

fn count(guides: Guides) -> GuideCount {
    match guides {
        Guides::All => GuideCount::All,
        Guides::Count(count) => GuideCount::Count(count),
    }
}

/// How many strands of the default style make about `triangles` triangles.
pub fn strands_for(triangles: u64) -> u32 {
    let segments = u64::from(Growth::default().vertices.max(2) - 1);
    u32::try_from(triangles / (2 * segments)).unwrap_or(u32::MAX)
}

/// About `count` strands, evenly picked.
fn thinned(strands: &Strands, count: usize) -> Strands {
    let all = strands.len();
    if count >= all {
        return strands.clone();
    }
    let mut few = Strands { offsets: vec![0], ..Strands::default() };
    for k in 0..count {
        let i = k * all / count;
        let range = strands.range(i);
        few.positions.extend_from_slice(&strands.positions[range.clone()]);
        few.offsets.push(few.positions.len() as u32);
        // Attributes are there for all or for none.
        few.radii.extend(strands.radii.get(range.clone()).into_iter().flatten());
        few.colors.extend(strands.colors.get(range).into_iter().flatten());
        few.root_uvs.extend(strands.root_uvs.get(i));
        few.tip_pinned.extend(strands.tip_pinned.get(i));
    }
    few
}

/// Where the head turns: below the highest root, between the sides of the head.
fn neck(strands: &Strands, head: Option<&TriMesh>) -> Vec3 {
    let roots = || strands.iter().filter_map(|strand| strand.first().copied());
    let Some((lo, hi)) = roots().map(|p| (p, p)).reduce(|(lo, hi), (p, _)| (lo.min(p), hi.max(p))) else {
        return Vec3::ZERO;
    };
    let middle = 0.5 * (lo + hi);
    let x = head.and_then(TriMesh::bounds).map_or(middle.x, |(lo, hi)| 0.5 * (lo.x + hi.x));
    Vec3::new(x, hi.y, middle.z) + NECK_BELOW_CROWN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_means_stiffness() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 2, 2);
        encoder.set_color(png::ColorType::Rgb);
        let pixels = [[0u8; 3], [255; 3], [255; 3], [255; 3]];
        encoder.write_header().unwrap().write_image_data(&pixels.concat()).unwrap();
        let map = stiffness_map(&path).unwrap();
        // The first pixel is at the front on the head's right.
        assert_eq!(map.sample(tresses::glam::Vec2::new(0.0, 1.0)), 0.25);
        assert_eq!(map.sample(tresses::glam::Vec2::new(0.0, 0.0)), 4.0);
        assert_eq!(map.sample(tresses::glam::Vec2::new(1.0, 1.0)), 4.0);
        std::fs::write(&path, "no picture").unwrap();
        let error = format!("{:#}", stiffness_map(&path).unwrap_err());
        assert!(error.contains("map.png") && !error.contains('\n'), "{error}");
    }

    #[test]
    fn thinning_keeps_strands_whole() {
        let mut strands = Strands::default();
        for i in 0..10 {
            let x = Vec3::X * i as f32;
            strands.push(&[x, x + Vec3::Y, x + Vec3::Y * 2.0]);
            strands.root_uvs.push(tresses::glam::Vec2::splat(i as f32));
        }
        strands.radii = vec![1.0; 30];
        let few = thinned(&strands, 5);
        assert_eq!((few.len(), few.positions.len(), few.radii.len(), few.root_uvs.len()), (5, 15, 15, 5));
        assert_eq!(few.strand(2), strands.strand(4));
        assert!(few.colors.is_empty());
        assert_eq!(thinned(&strands, 20), strands);
    }
}
