//! Compute rasterizer for hair: sorts and blends strand segments tile by tile.
//!
//! ```text
//! depth of bodies ─► surface ─► depths per pixel, farthest per tile
//! strand vertices ─► project ─► points ─► scatter (counts) ─► totals ─► scan ─► scatter ─► sort, merge ─► lists of tiles
//! lists ─► touch ─► bits per row ─► visibility ─► visible segments ─► light::shade ─► tint ─► colors ─► blend ─► hair
//!   ▲                                 │
//!   └─ sort, merge ◄─ dispatch_deep ◄─┘ tiles whose front is not enough
//! ```
//!
//! **Lists.** A segment is the part of a strand between two adjacent vertices. It is written into the list of each tile
//! of 8×8 pixels that it touches, unless bodies hide it there. Lists are built by counting, a prefix sum, and a second
//! pass that writes, so no length is guessed.
//!
//! **Order.** Each tile divides depth into 64 bins, from the nearest to the farthest hair of its block of 2×2 tiles, or
//! to the tile's farthest body if that is nearer. Within a bin, the position of an entry is the number of entries
//! before it. One thread counts it for four adjacent entries at once; a workgroup sorts bins with very many entries. An
//! entry is one word: its depth within the bin, then the number of its segment. No two entries are equal, so the result
//! is deterministic.
//!
//! **Coverage.** One thread follows its tile's list for a row of eight pixels, front to back, until all eight pixels
//! have a transmittance below 2 %. The covered fraction of a pixel is exact for a strand that is straight there
//! (`coverage::half_plane`). Where two segments meet, a pixel belongs to the segment on whose side of the joint its
//! center lies. Strands of any width therefore have no seams, and no pixel is counted twice.
//!
//! **Rows.** Most entries of a tile touch only a few of its rows. `touch` writes one bit per row and entry.
//! `visibility` follows these bits without colors, marks the visible segments, and keeps only the bits of those. Only
//! the vertices of visible segments are shaded. `blend` follows the bits with colors. On request, `geometry` does so
//! with depth and motion ([`embed`](super::embed)), and `label` with segment numbers ([`Label`]). With multisampled
//! bodies, a pixel stores two depths, their shares, and the transmittance of the hair in front of each
//! (`present::tiled`).
//!
//! **Front.** Half of a portrait's entries, and most of a dense groom's, lie behind opaque hair. The part of a tile's
//! list that the previous frame needed, plus a quarter, is its *front*. Only the front is sorted, touched and followed
//! first. Tiles that still transmit light at the end of their front are listed, and the rest of their entries follows
//! (`dispatch_deep`). The image is therefore bit-identical whatever the previous frame was. In the first frame, the
//! front is the whole list.
//!
//! **Memory.** The list buffer holds a *window* and the longest tile. The window is one and a half entries per point,
//! or a quarter more than a recent frame needed. If a frame needs more, as in a close-up, its tiles are drawn in
//! [rounds](crate::constants::TILE_ROUNDS). Rounds are recorded with indirect dispatches, which have no workgroups if
//! the round is not needed. But even an empty dispatch costs a GPU microseconds. If the camera has hardly moved since
//! the last frame whose entries are known, a frame records only the rounds that 15 % more entries would need. If these
//! are several for half a second, the lists grow until one suffices.
//!
//! **Readback.** The CPU learns the number of entries from `TileControl`, 528 bytes per view. From the second frame
//! on, recording a frame submits a copy of it and maps the copy, unless an earlier one is in flight. A later frame
//! takes the result if it has arrived, without waiting, and enlarges the lists if they are too short.
//! [`View::is_complete`](crate::View::is_complete) waits for the count of the last frame, and says whether its rounds
//! sufficed.
//!
//! **Performance.** A software driver executes loads and atomics lane by lane, so that a thread should process many
//! pixels per load: a row of eight costs an eighth of the loads of eight threads with one pixel each. Bins over the
//! tile's own depth range mostly hold a handful of entries. Comparing all pairs of those is as fast as any sort, and no
//! thread waits for another's longer bin, as it would if each thread sorted one.
//!
//! Mesa's lavapipe ends the loops of a thread after 65,535 iterations in total. Here the number of list entries bounds
//! the iterations.
//!
//! Rejected: a bitonic sort in workgroup memory (45 barriers per tile, each of which costs a software driver as much as
//! the work between two of them; for bins of over 32 entries only, it still doubles the time of all lists); linked
//! lists of fragments (their order, and thus the image, changes from run to run); Shell's sort of a bin by one thread
//! (1.5 times slower); a cutoff at a mean optical depth (wrong where a tile is covered unevenly). Untried: two segments
//! per entry, half floats.

mod buffers;
pub mod geometry;
pub mod labels;
mod lists;
mod pipelines;
pub mod state;
mod texels;

pub use labels::Label;
pub(crate) use pipelines::Pipelines;
pub(crate) use state::Tiles;

use super::canvas::Canvas;
use crate::{
    Result,
    constants::{STRAND_WORKGROUP, TILE, TILE_ROUNDS},
    gpu::Kernel,
    light::HairView,
    stage::Stage,
};
use buffers::{ListSpan, STEP, TileControl};
use lists::HairLists;
use std::mem::offset_of;

/// One round: tiles whose lists fit into the window together.
struct Round<'a> {
    control: &'a wgpu::Buffer,
    number: u32,
}

impl<'a> Round<'a> {
    /// Returns the rounds of the frame that is being recorded.
    fn all(tiles: &'a Tiles) -> impl Iterator<Item = Self> {
        (0..tiles.rounds()).map(|number| Self { control: &tiles.buffers.control, number })
    }

    /// Records an indirect dispatch of `kernel` for part of the lists. `field` is the offset of the workgroup counts in
    /// [`TileControl`].
    fn run(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        kernel: &Kernel,
        group: &wgpu::BindGroup,
        (span, field): (ListSpan, usize),
    ) {
        let workgroups = (self.control, field as u64 + 16 * u64::from(self.number));
        kernel.record_indirect(pass, group, &[self.offset(span)], workgroups);
    }

    /// Dynamic offset of the pass's uniform.
    fn offset(&self, span: ListSpan) -> u32 {
        Self::offset_of(span, self.number)
    }

    fn offset_of(span: ListSpan, number: u32) -> u32 {
        STEP as u32 * (span as u32 * TILE_ROUNDS + number)
    }
}

fn threads(count: u32) -> u32 {
    count.div_ceil(STRAND_WORKGROUP)
}

impl Pipelines {
    /// Records the lists of all tiles and finds the visible segments. Bodies must be drawn already.
    pub(crate) fn record_bins(
        &self,
        tiles: &Tiles,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
    ) -> Result<()> {
        // Tiles without hair are never written.
        canvas.commands.clear_texture("no hair", &tiles.buffers.hair);
        if hair.is_empty() {
            tiles.forget();
            return Ok(());
        }
        let mut lists = tiles.bind(self, canvas, hair)?;
        let Some(lists) = lists.as_mut() else { return Ok(()) };
        lists.begin(canvas, hair);
        let many = usize::from(canvas.target.samples > 1);
        let mut pass = canvas.commands.compute("bins");
        for groom in &lists.grooms {
            self.project.record(&mut pass, &groom.project, &[], threads(groom.capacity));
        }
        self.surface[many].record(
            &mut pass,
            &lists.groups.surface,
            &[],
            threads(tiles.buffers.count() * TILE),
        );
        self.bound.record(&mut pass, &lists.groups.bound, &[], threads(tiles.buffers.count()));
        let counting = [Round::offset_of(ListSpan::Count, 0)];
        self.scatter.record(&mut pass, &lists.groups.scatter, &counting, threads(lists.grid.points));
        self.totals.record(&mut pass, &lists.groups.totals, &[], threads(tiles.buffers.count()));
        self.scan.record(&mut pass, &lists.groups.scan, &[], threads(tiles.buffers.count()) + 1);
        pass.end()?;
        canvas.commands.lap(Stage::Bins);
        for round in Round::all(tiles) {
            let fields = [offset_of!(TileControl, segments), offset_of!(TileControl, bins)];
            let mut pass = canvas.commands.compute("bins");
            self.order(&mut pass, lists, &round, ListSpan::Front, fields);
            pass.end()?;
            canvas.commands.lap(Stage::Bins);
            let mut pass = canvas.commands.compute("see");
            let of = |field| (ListSpan::Front, field);
            round.run(&mut pass, &self.touch, &lists.groups.touch, of(offset_of!(TileControl, bins)));
            round.run(
                &mut pass,
                &self.visibility[many],
                &lists.groups.visibility,
                of(offset_of!(TileControl, rows)),
            );
            self.dispatch_deep.record(
                &mut pass,
                &lists.groups.dispatch_deep,
                &[round.offset(ListSpan::Front)],
                1,
            );
            let of = |field| (ListSpan::Behind, field);
            round.run(&mut pass, &self.sort, &lists.groups.sort, of(offset_of!(TileControl, deep_tiles)));
            round.run(&mut pass, &self.merge, &lists.groups.merge, of(offset_of!(TileControl, deep_tiles)));
            round.run(&mut pass, &self.touch, &lists.groups.touch, of(offset_of!(TileControl, deep_tiles)));
            round.run(
                &mut pass,
                &self.visibility[many],
                &lists.groups.visibility,
                of(offset_of!(TileControl, deep_rows)),
            );
            pass.end()?;
            canvas.commands.lap(Stage::Visibility);
        }
        Ok(())
    }

    /// Records the kernels that fill the lists of a round and sort the requested part. `segments` and `bins` are
    /// offsets of workgroup counts in [`TileControl`].
    fn order(
        &self,
        pass: &mut crate::gpu::ComputePass<'_>,
        lists: &HairLists,
        round: &Round<'_>,
        span: ListSpan,
        [segments, bins]: [usize; 2],
    ) {
        let first = matches!(span, ListSpan::Front) && round.number == 0;
        if first {
            // The first round always has work if there is any.
            let workgroups = threads(lists.grid.points);
            self.scatter.record(pass, &lists.groups.scatter, &[round.offset(span)], workgroups);
        } else {
            round.run(pass, &self.scatter, &lists.groups.scatter, (span, segments));
        }
        round.run(pass, &self.sort, &lists.groups.sort, (span, bins));
        round.run(pass, &self.merge, &lists.groups.merge, (span, bins));
    }

    /// Records the shading of the segments that the last [`record_bins`](Self::record_bins) found visible.
    pub(crate) fn record_shade(
        &self,
        tiles: &Tiles,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
    ) -> Result<()> {
        let lists = tiles.lists();
        let Some(lists) = lists.as_ref().filter(|_| !hair.is_empty()) else { return Ok(()) };
        let subsets: Vec<_> = hair
            .iter()
            .zip(&lists.grooms)
            .map(|(view, groom)| (view.hair, &groom.visible_segments))
            .collect();
        canvas.light.shade_subsets(canvas.commands, &subsets)
    }

    /// Blends the hair of the last [`record_bins`](Self::record_bins). Its visible segments must be shaded.
    pub(crate) fn record_blend(
        &self,
        tiles: &Tiles,
        canvas: &mut Canvas<'_, '_>,
        hair: &[HairView<'_>],
    ) -> Result<()> {
        let lists = tiles.lists();
        let Some(lists) = lists.as_ref().filter(|_| !hair.is_empty()) else { return Ok(()) };
        let many = usize::from(canvas.target.samples > 1);
        let mut pass = canvas.commands.compute("hair");
        for groom in &lists.grooms {
            self.tint.record(&mut pass, &groom.tint, &[], threads(groom.points));
        }
        pass.end()?;
        let (has_geometry, writes_labels) = (canvas.geometry.is_some(), canvas.writes_labels);
        for round in Round::all(tiles) {
            let mut pass = canvas.commands.compute("hair");
            let of = |field| (ListSpan::All, field);
            if tiles.rounds() > 1 {
                let again = offset_of!(TileControl, bins_again);
                round.run(&mut pass, &self.reset_bins, &lists.groups.reset_bins, of(again));
                let fields = [offset_of!(TileControl, segments_again), again];
                self.order(&mut pass, lists, &round, ListSpan::All, fields);
                round.run(&mut pass, &self.touch, &lists.groups.touch, of(again));
            }
            if let Some(geometry) = lists.geometry.as_ref().filter(|_| has_geometry) {
                round.run(
                    &mut pass,
                    &self.geometry[many],
                    &geometry.group,
                    of(offset_of!(TileControl, rows)),
                );
            }
            if let Some(labels) = lists.labels.as_ref().filter(|_| writes_labels) {
                round.run(&mut pass, &self.label[many], &labels.group, of(offset_of!(TileControl, rows)));
            }
            round.run(&mut pass, &self.blend[many], &lists.groups.blend, of(offset_of!(TileControl, rows)));
            pass.end()?;
        }
        Ok(())
    }
}
