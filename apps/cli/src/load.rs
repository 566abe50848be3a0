//! From options to a character: a groom with its head, from files or built in.

use crate::{
    args::{Guides, Source},
    lod_args,
    style_args::StyleArgs,
};
use anyhow::{Context, Result};
use std::str::FromStr;
use tresses::{
    constants::MAX_STRAND_VERTICES,
    glam::Vec3,
    gpu::Gpu,
    groom::{
        BindOptions, Groom, GuideCount, SdfGrid, Strands, TriMesh, bind,
        grow::{Growth, Paint},
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
    let map = source.shape.stiffness()?;
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
    let skull = neck + SKULL_ABOVE_NECK;
    let paint = source.shape.paint()?;
    let strands = if paint == Paint::default() { strands } else { paint.apply(&strands, skull, 1)? };
    let restyle = source.shape.restyle()?;
    // Curls need as many vertices as there may be.
    let strand_vertices = restyle.as_ref().and_then(|r| r.curls.any().then_some(MAX_STRAND_VERTICES));
    let mut groom = bind(&strands, &BindOptions { guides, strand_vertices, ..Default::default() })?;
    let mut notes = report.placement.doubts;
    if let Some(restyle) = restyle {
        restyle.apply(&mut groom, skull)?;
        notes.extend(StyleArgs::note(&restyle.curls, &groom));
    }
    notes.extend(report.head_placement.into_iter().flat_map(|placement| placement.doubts));
    Ok(Character { groom, head, field, neck, levels: Vec::new(), notes })
}

fn built_in(source: &Source, gpu: &Gpu, simulate: &Simulate) -> Result<Character> {
    let style = Style::from_str(source.style.as_deref().unwrap_or("long"))?;
    let growth = source.shape.growth(&style, source.strands)?;
    let built =
        pollster::block_on(styles::character_with(&gpu.device, &gpu.queue, simulate, &style, &growth, &()))?;
    let notes = StyleArgs::note(&growth.curls, &built.groom).into_iter().collect();
    Ok(Character {
        groom: match source.guides {
            None => built.groom,
            Some(guides) => rebound(&built.groom, guides)?,
        },
        head: Some(built.mesh),
        field: Some(built.field),
        neck: built.neck,
        levels: Vec::new(),
        notes,
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
