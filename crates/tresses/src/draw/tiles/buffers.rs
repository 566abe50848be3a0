//! Buffers whose size depends on the target, and the structs in them.

use super::texels::Texels;
use crate::{
    Result,
    constants::{STRAND_WORKGROUP, TILE, TILE_BINS, TILE_BLOCK, TILE_ROUNDS},
    draw::canvas::{HDR_FORMAT, TextureKind},
    gpu::{BindBuffer, BufferBinding, Device, Uniform},
    strands::buffers::storage,
};
use bytemuck::{Pod, Zeroable};
use wgpu::util::DeviceExt;

/// Sizes that all kernels read.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct TileGrid {
    /// Width and height of the target, pixels.
    pub size: [u32; 2],
    /// Tiles along both axes.
    pub tiles: [u32; 2],
    /// Points of all grooms, including gaps between them.
    pub points: u32,
    /// Number of low bits of a list entry that hold the segment number. The bits above hold the depth within the bin.
    pub id_bits: u32,
    /// Entries of a round. The list holds as many, and the longest tile.
    pub window: u32,
    /// Unused.
    pub _pad: u32,
}

/// Indirect dispatch sizes and results of a frame, written by the GPU. Sizes are per round: workgroups in x, y and z.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct TileControl {
    /// For kernels with one thread per segment.
    pub segments: [[u32; 4]; TILE_ROUNDS as usize],
    /// For kernels with one workgroup per occupied tile.
    pub bins: [[u32; 4]; TILE_ROUNDS as usize],
    /// For kernels with one thread per row of an occupied tile.
    pub rows: [[u32; 4]; TILE_ROUNDS as usize],
    /// As `segments`, to rebuild the lists before blending. Zero unless there are several rounds.
    pub segments_again: [[u32; 4]; TILE_ROUNDS as usize],
    /// As `bins`, to rebuild the lists before blending. Zero unless there are several rounds.
    pub bins_again: [[u32; 4]; TILE_ROUNDS as usize],
    /// As `bins`, for tiles that need more than their front.
    pub deep_tiles: [[u32; 4]; TILE_ROUNDS as usize],
    /// As `rows`, for tiles that need more than their front.
    pub deep_rows: [[u32; 4]; TILE_ROUNDS as usize],
    /// First occupied tile of each round, and the one after its last.
    pub occupied: [[u32; 4]; TILE_ROUNDS as usize],
    /// Total entries of all tiles.
    pub entries: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// Part of a tile's list that a pass processes. The values equal `grid::FRONT`, `grid::BEHIND`, `grid::ALL`
/// and `grid::COUNT`.
#[derive(Clone, Copy)]
pub(super) enum ListSpan {
    /// The entries that the previous frame needed, plus a margin.
    Front,
    /// The entries behind the front, for tiles whose front did not suffice.
    Behind,
    /// All entries.
    All,
    /// No entries: `scatter` counts them.
    Count,
}

/// Alignment of dynamic uniform offsets that every device supports, bytes.
pub(super) const STEP: u64 = 256;

/// Buffers and textures of a target's size.
#[derive(Debug)]
pub(crate) struct TileBuffers {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Width and height, tiles.
    pub tiles: [u32; 2],
    /// Hair color, premultiplied by its opacity, which is alpha.
    pub hair: wgpu::TextureView,
    /// Two words per pixel in tile order: depths of the opaque surfaces, later the transmittance to each of them.
    pub surfaces: wgpu::Buffer,
    /// Farthest opaque depth per tile.
    pub far_depths: wgpu::Buffer,
    /// Entry counts per bin of a tile, later the bins' offsets.
    pub bins: wgpu::Buffer,
    /// `grid::Bounds` per tile, and the same as texels.
    pub bounds: (wgpu::Buffer, Texels),
    /// Entries and occupied tiles of each workgroup of `totals`.
    pub sums: wgpu::Buffer,
    /// Tiles with hair.
    pub occupied: wgpu::Buffer,
    /// Depth range of the hair per block of tiles.
    pub ranges: wgpu::Buffer,
    /// See [`TileControl`].
    pub control: wgpu::Buffer,
    /// Number of entries that each list needed, and the tiles that needed more than their front: see
    /// `grid::DEEP_COUNT`.
    pub depths: wgpu::Buffer,
    rounds: wgpu::Buffer,
    /// See [`TileGrid`].
    pub grid: Uniform,
}

impl TileBuffers {
    /// Allocates buffers for targets of `size` pixels, and textures with `texture`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if a buffer exceeds the device's limits.
    pub fn new(
        device: &Device,
        size: [u32; 2],
        texture: impl Fn(TextureKind) -> wgpu::Texture,
    ) -> Result<Self> {
        let tiles = size.map(|side| side.div_ceil(TILE));
        let count = u64::from(tiles[0]) * u64::from(tiles[1]);
        let blocks = tiles.map(|side| u64::from(side.div_ceil(TILE_BLOCK)));
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
        let spans = [ListSpan::Front, ListSpan::Behind, ListSpan::All, ListSpan::Count];
        let mut numbers = vec![0u32; spans.len() * (STEP * u64::from(TILE_ROUNDS)) as usize / 4];
        for (at, words) in numbers.chunks_mut(STEP as usize / 4).enumerate() {
            words[..2].copy_from_slice(&[at as u32 % TILE_ROUNDS, at as u32 / TILE_ROUNDS]);
        }
        let rounds = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("rounds"),
            contents: bytemuck::cast_slice(&numbers),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        Ok(Self {
            size,
            tiles,
            hair: texture(("hair", HDR_FORMAT, usage)).create_view(&Default::default()),
            surfaces: storage::<[u32; 2]>(device, "surfaces", count * u64::from(TILE * TILE))?,
            far_depths: storage::<u32>(device, "farthest bodies", count)?,
            bins: storage::<u32>(device, "bins", count * u64::from(TILE_BINS))?,
            bounds: (
                storage::<[u32; 4]>(device, "bounds of tiles", count)?,
                Texels::new(device, "bounds of tiles", count, wgpu::TextureFormat::Rgba32Uint)?,
            ),
            sums: storage::<[u32; 2]>(device, "sums of tiles", count.div_ceil(STRAND_WORKGROUP.into()))?,
            occupied: storage::<[u32; 4]>(device, "occupied tiles", count)?,
            ranges: storage::<[u32; 2]>(device, "ranges of depth", blocks[0] * blocks[1])?,
            control: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("control of tiles"),
                size: size_of::<TileControl>() as u64,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::INDIRECT
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            depths: storage::<u32>(device, "depths of lists", u64::from(TILE_ROUNDS) + 2 * count)?,
            rounds,
            grid: device.storage_uniform(size_of::<TileGrid>()),
        })
    }

    /// Number of tiles.
    pub fn count(&self) -> u32 {
        self.tiles[0] * self.tiles[1]
    }

    /// The uniform of a pass, bound with a dynamic offset.
    pub fn round(&self) -> BufferBinding<'_, [u32; 4]> {
        self.rounds.part(0, Some(16))
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let own = [&self.surfaces, &self.far_depths, &self.bins, &self.occupied, &self.ranges, &self.depths];
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        own.iter().map(|buffer| buffer.size()).sum::<u64>()
            + self.bounds.0.size()
            + self.bounds.1.bytes()
            + pixels * 8
    }
}
