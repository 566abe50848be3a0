//! Hair by a rasteriser of our own: sorted and blended tile by tile, in compute shaders.
//!
//! ```text
//! depth of bodies ─► surface ─► depths per pixel, farthest per tile
//! strand vertices ─► project ─► points ─► count ─► totals ─► scan ─► scatter ─► sort, merge ─► lists of tiles
//! lists ─► touch ─► lists of rows ─► see ─► which segments are seen ─► light::shade ─► tint ─► colours ─► blend ─► hair
//!   ▲                                 │
//!   └─ sort, merge ◄─ deepen ◄────────┘ tiles whose front is not enough
//! ```
//!
//! A segment is the piece of a strand between two of its vertices. It is written into the list of each tile of 8×8
//! pixels that it reaches, unless bodies hide it there. Lists are made by counting, a prefix sum and a second pass
//! that writes: no length is guessed. In its tile a segment goes into one of 64 bins by its depth, between the
//! nearest and the farthest hair of 2×2 tiles, or the farthest body of the tile; in a bin an entry's place is the number
//! of those before it, which a thread counts for four neighbours at once, or a workgroup sorts the bin
//! where it holds very many. An entry is one word: the place of its depth in the bin, then its number, so that no two
//! are equal and two runs give the same bits.
//!
//! One thread follows the list of its tile for a row of eight pixels, front to back, until less than 2 % of the
//! light gets through any of them. The share of a pixel that a segment covers is exact for a strand that is
//! straight there (`coverage::half_plane`); where two segments meet, a pixel belongs to the one on whose side of
//! their common line its centre lies, so that strands of any width have no seams and nothing is counted twice.
//!
//! Most entries of a tile are in a few of its rows: `touch` tells which, in a bit for each row and entry. `see` follows
//! those without colours, marks what it meets, of which only the vertices are shaded, and leaves only those bits.
//! `blend` follows these with colours, and where somebody asks `geometry` with depths and motion
//! ([`embed`](super::embed)) and `label` with numbers ([`Label`]). Of bodies with several samples per pixel, a pixel keeps
//! two depths and their shares, and what gets through to either (`present::tiled`).
//!
//! **Depth.** Half of a portrait's entries, and most of a dense groom's, lie where nothing shows through. What a tile needed
//! in the picture before, and a quarter more, is its *front*: only that is put in order, touched and seen. Tiles in which
//! light still gets through at its end are listed, and their rest follows (`deepen`), so that a picture is the same to the
//! bit whatever was before it; a first picture is all front.
//!
//! **Room.** The list holds a *window*, one and a half entries per point or what the picture before needed, and the
//! longest tile. Where a picture needs
//! more, as in a close-up, tiles are drawn in [rounds](crate::constants::TILE_ROUNDS), each recorded as passes whose
//! workgroups the GPU counts: without need they have none.
//!
//! **Why so.** On a software driver loads and atomics are made lane by lane, so that a thread had better have many
//! pixels per load: a row of eight costs an eighth of the loads of eight threads with a pixel each. Ordering by bins of
//! a tile's own range of depth keeps most bins at a handful of entries, where comparing each with each is as fast as
//! anything: no thread waits for another's longer bin, as it would where each sorts one.
//!
//! Mesa's software driver ends the loops of a thread after 65,535 turns in all: counts of entries bound those of loops.
//!
//! Rejected: a bitonic sort in workgroup memory (45 barriers per tile, and a barrier costs a software driver as
//! much as the work between two; sorting just the bins of over 32 entries so doubles the time of all lists), lists of
//! linked fragments (their order and so the picture changes from run to run), Shell's sort of a bin by one thread (half as
//! long again), leaving out what lies behind a mean
//! optical depth (wrong where a tile is not covered evenly).
//! Untried: two segments as one entry, half floats.

pub mod geometry;
pub mod labels;
mod pipelines;
pub mod state;
mod texels;

pub use labels::Label;
pub(crate) use pipelines::Pipelines;
pub(crate) use state::Tiles;

use super::record::Canvas;
use crate::{
    Error, Result,
    constants::{STRAND_WORKGROUP, TILE, TILE_ROUNDS},
    gpu::Kernel,
    light::Seen,
    stage::Stage,
};
use state::{Asked, Bound, Control};
use std::mem::offset_of;

/// A round of tiles that fit into the list.
struct Round<'a> {
    control: &'a wgpu::Buffer,
    number: u32,
}

impl<'a> Round<'a> {
    fn all(control: &'a wgpu::Buffer) -> impl Iterator<Item = Self> {
        (0..TILE_ROUNDS).map(move |number| Self { control, number })
    }

    /// Records a kernel for what is asked of tiles, with the workgroups that a field of [`Control`] tells.
    fn run(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        kernel: &Kernel,
        group: &wgpu::BindGroup,
        (asked, field): (Asked, usize),
    ) {
        let workgroups = (self.control, field as u64 + 16 * u64::from(self.number));
        kernel.record_indirect(pass, group, &[self.offset(asked)], workgroups);
    }

    /// Of the uniform of a pass.
    fn offset(&self, asked: Asked) -> u32 {
        state::STEP as u32 * (asked as u32 * TILE_ROUNDS + self.number)
    }
}

fn tiles<'a>(canvas: &Canvas<'a, '_>) -> Result<&'a Tiles> {
    canvas.targets.tiles.as_ref().ok_or_else(|| Error::Parameter {
        name: "targets",
        value: "without tiles".into(),
        range: "made for tiles",
    })
}

fn threads(count: u32) -> u32 {
    count.div_ceil(STRAND_WORKGROUP)
}

impl Pipelines {
    /// Records which segments are in which tiles and which of them are seen; bodies are drawn.
    pub fn record_bins(&self, canvas: &mut Canvas<'_, '_>, hair: &[Seen<'_>]) -> Result<()> {
        let tiles = tiles(canvas)?;
        // Where no tile is busy nothing is written.
        canvas.commands.clear_texture("no hair", &tiles.hair);
        if hair.is_empty() {
            tiles.forget();
            return Ok(());
        }
        let mut bound = tiles.bind(self, canvas, hair)?;
        let Some(bound) = bound.as_mut() else { return Ok(()) };
        bound.begin(canvas, hair);
        for buffer in [&tiles.farthest, &tiles.bins, &tiles.ranges, &bound.seen] {
            canvas.commands.clear(buffer, None);
        }
        let many = usize::from(canvas.targets.samples > 1);
        let mut pass = canvas.commands.compute("bins");
        for groom in &bound.parts {
            self.project.record(&mut pass, &groom.project, &[], threads(groom.room));
        }
        self.surface[many].record(&mut pass, &bound.surface, &[], threads(tiles.count() * TILE));
        self.bound.record(&mut pass, &bound.bound, &[], threads(tiles.count()));
        pass.end()?;
        tiles.bounds.1.copy(canvas.commands, &tiles.bounds.0, tiles.count());
        let mut pass = canvas.commands.compute("bins");
        self.count.record(&mut pass, &bound.count, &[], threads(bound.grid.points));
        self.totals.record(&mut pass, &bound.totals, &[], threads(tiles.count()));
        self.scan.record(&mut pass, &bound.scan, &[], 1);
        pass.end()?;
        tiles.bounds.1.copy(canvas.commands, &tiles.bounds.0, tiles.count());
        canvas.commands.lap(Stage::Bins);
        for round in Round::all(&tiles.control) {
            let fields = [offset_of!(Control, segments), offset_of!(Control, bins)];
            let mut pass = canvas.commands.compute("bins");
            self.order(&mut pass, bound, &round, Asked::Front, fields);
            pass.end()?;
            canvas.commands.lap(Stage::Bins);
            let mut pass = canvas.commands.compute("see");
            let of = |field| (Asked::Front, field);
            round.run(&mut pass, &self.touch, &bound.touch, of(offset_of!(Control, bins)));
            round.run(&mut pass, &self.see[many], &bound.see, of(offset_of!(Control, rows)));
            self.deepen.record(&mut pass, &bound.deepen, &[round.offset(Asked::Front)], 1);
            let of = |field| (Asked::Behind, field);
            round.run(&mut pass, &self.sort, &bound.sort, of(offset_of!(Control, deep_tiles)));
            round.run(&mut pass, &self.merge, &bound.merge, of(offset_of!(Control, deep_tiles)));
            round.run(&mut pass, &self.touch, &bound.touch, of(offset_of!(Control, deep_tiles)));
            round.run(&mut pass, &self.see[many], &bound.see, of(offset_of!(Control, deep_rows)));
            pass.end()?;
            canvas.commands.lap(Stage::See);
        }
        Ok(())
    }

    /// Records that the lists of a round are filled, and what is asked of them put in order; with the workgroups that two
    /// fields of [`Control`] tell.
    fn order(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        bound: &Bound,
        round: &Round<'_>,
        asked: Asked,
        [segments, bins]: [usize; 2],
    ) {
        round.run(pass, &self.scatter, &bound.scatter, (asked, segments));
        round.run(pass, &self.sort, &bound.sort, (asked, bins));
        round.run(pass, &self.merge, &bound.merge, (asked, bins));
    }

    /// Records the shading of what the last [`record_bins`](Self::record_bins) has seen.
    pub fn record_shade(&self, canvas: &mut Canvas<'_, '_>, hair: &[Seen<'_>]) -> Result<()> {
        let bound = tiles(canvas)?.bound();
        let Some(bound) = bound.as_ref().filter(|_| !hair.is_empty()) else { return Ok(()) };
        let chosen: Vec<_> =
            hair.iter().zip(&bound.parts).map(|(seen, groom)| (seen.hair, &groom.chosen)).collect();
        canvas.light.shade_chosen(canvas.commands, &chosen)
    }

    /// Records the hair of the last [`record_bins`](Self::record_bins); what is seen of it is shaded.
    pub fn record_blend(&self, canvas: &mut Canvas<'_, '_>, hair: &[Seen<'_>]) -> Result<()> {
        let tiles = tiles(canvas)?;
        let bound = tiles.bound();
        let Some(bound) = bound.as_ref().filter(|_| !hair.is_empty()) else { return Ok(()) };
        let many = usize::from(canvas.targets.samples > 1);
        let mut pass = canvas.commands.compute("hair");
        for groom in &bound.parts {
            self.tint.record(&mut pass, &groom.tint, &[], threads(groom.points));
        }
        pass.end()?;
        let (asked, labelled) = (canvas.geometry.is_some(), canvas.labels);
        for round in Round::all(&tiles.control) {
            let mut pass = canvas.commands.compute("hair");
            let of = |field| (Asked::Whole, field);
            round.run(&mut pass, &self.rewind, &bound.rewind, of(offset_of!(Control, bins_again)));
            let fields = [offset_of!(Control, segments_again), offset_of!(Control, bins_again)];
            self.order(&mut pass, bound, &round, Asked::Whole, fields);
            round.run(&mut pass, &self.touch, &bound.touch, of(offset_of!(Control, bins_again)));
            if let Some(geometry) = bound.geometry.as_ref().filter(|_| asked) {
                round.run(&mut pass, &self.geometry[many], &geometry.group, of(offset_of!(Control, rows)));
            }
            if let Some(labels) = bound.labels.as_ref().filter(|_| labelled) {
                round.run(&mut pass, &self.label[many], &labels.group, of(offset_of!(Control, rows)));
            }
            round.run(&mut pass, &self.blend[many], &bound.blend, of(offset_of!(Control, rows)));
            pass.end()?;
        }
        Ok(())
    }
}
