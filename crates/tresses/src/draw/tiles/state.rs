//! The buffers of the stage: some of a picture's size, some of the hair's.

use super::{
    Pipelines,
    geometry::Geometry,
    labels::{Labels, Owner},
    texels::Texels,
};
use crate::{
    Context, Result,
    constants::{TILE, TILE_BINS, TILE_BLOCK, TILE_ROUNDS},
    draw::record::Canvas,
    draw::targets::{HDR_FORMAT, TextureKind},
    gpu::{bindings::uniform, readback::Pending},
    light::{Chosen, Seen},
    strands::buffers::storage,
};
use bytemuck::{Pod, Zeroable};
use std::sync::{Mutex, MutexGuard, PoisonError};
use wgpu::util::DeviceExt;

/// What all kernels know.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Grid {
    /// Width and height of the target, pixels.
    pub size: [u32; 2],
    /// Tiles along both axes.
    pub tiles: [u32; 2],
    /// Points of all grooms, gaps between them included.
    pub points: u32,
    /// Bits that number them; what an entry of a list has more of is the place of its depth in its bin.
    pub id_bits: u32,
    /// Entries of a round.
    pub window: u32,
    /// Unused.
    pub _pad: u32,
}

/// A groom's share of the points.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Part {
    /// Its first.
    pub first: u32,
    /// Its strands.
    pub count: u32,
    /// Their vertices.
    pub vertex_count: u32,
    /// Points that it has, or had in the picture before, if more.
    pub room: u32,
}

/// What the passes of a frame tell each other: workgroups of passes that the CPU does not know.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Control {
    /// Of what has one thread per segment, in each round.
    pub segments: [[u32; 4]; TILE_ROUNDS as usize],
    /// Of what has one workgroup per busy tile.
    pub bins: [[u32; 4]; TILE_ROUNDS as usize],
    /// Of what has one thread per row of a busy tile.
    pub rows: [[u32; 4]; TILE_ROUNDS as usize],
    /// As `segments`, when lists are made again: only if there are several rounds.
    pub segments_again: [[u32; 4]; TILE_ROUNDS as usize],
    /// As `bins`, likewise.
    pub bins_again: [[u32; 4]; TILE_ROUNDS as usize],
    /// As `bins`, of the tiles that need more than their front.
    pub deep_tiles: [[u32; 4]; TILE_ROUNDS as usize],
    /// Of what has one thread per row of those.
    pub deep_rows: [[u32; 4]; TILE_ROUNDS as usize],
    /// First busy tile of each round and the one after its last.
    pub busy: [[u32; 4]; TILE_ROUNDS as usize],
    /// Entries that all tiles need.
    pub entries: u32,
    /// Unused.
    pub _pad: [u32; 3],
}

/// What a pass asks of a tile's entries: twins of `grid::FRONT` and those below it.
#[derive(Clone, Copy)]
pub(super) enum Asked {
    /// Those that the picture before needed, and some.
    Front,
    /// Those behind them, where they were not enough.
    Behind,
    /// All.
    Whole,
}

/// Dynamic offsets of uniforms are multiples of this on any device.
pub(super) const STEP: u64 = 256;
/// Grooms begin at multiples of so many points, so that their share of a buffer of bits can be bound.
const ALIGN: u32 = STEP as u32 * 8;

/// What tiles add to the targets of a view.
#[derive(Debug)]
pub(crate) struct Tiles {
    size: [u32; 2],
    tiles: [u32; 2],
    /// Hair, premultiplied; alpha is its opacity.
    pub hair: wgpu::TextureView,
    /// Of each pixel, tile by tile, the depths of its bodies, later what gets through to them.
    pub surfaces: wgpu::Buffer,
    pub(super) farthest: wgpu::Buffer,
    pub(super) bins: wgpu::Buffer,
    /// See `grid::Bounds`; as words, and where they are read.
    pub(super) bounds: (wgpu::Buffer, Texels),
    busy: wgpu::Buffer,
    pub(super) ranges: wgpu::Buffer,
    pub(super) control: wgpu::Buffer,
    /// How deep into their lists tiles had to be followed, and which of them deeper than expected: see
    /// `grid::DEEP_COUNT`.
    depths: wgpu::Buffer,
    rounds: wgpu::Buffer,
    grid: wgpu::Buffer,
    bound: Mutex<Option<Bound>>,
    room: Mutex<Room>,
}

/// What is known of how long the lists are.
#[derive(Debug, Default)]
struct Room {
    /// Entries of the last picture that is known.
    entries: u32,
    /// How long they were in a picture before, on its way here.
    asked: Option<Pending>,
}

impl Room {
    /// Learns from what the GPU counted; whether all of it was drawn.
    fn learn(&mut self, control: &[u8], window: u32) -> bool {
        let at = std::mem::offset_of!(Control, entries);
        let entries: u32 = bytemuck::pod_read_unaligned(&control[at..at + 4]);
        self.entries = entries;
        u64::from(entries) <= u64::from(window) * u64::from(TILE_ROUNDS)
    }
}

/// What depends on the hair that is seen: buffers, and groups that bind them.
#[derive(Debug)]
pub(super) struct Bound {
    /// By what it was made: vertices and colours of each groom.
    of: Vec<[wgpu::Buffer; 2]>,
    pub grid: Grid,
    /// Where the points of each groom begin.
    firsts: Vec<u32>,
    pub parts: Vec<Groom>,
    /// A bit for each segment.
    pub seen: wgpu::Buffer,
    pub points: Texels,
    bytes: u64,
    pub surface: wgpu::BindGroup,
    pub bound: wgpu::BindGroup,
    pub count: wgpu::BindGroup,
    pub totals: wgpu::BindGroup,
    pub scan: wgpu::BindGroup,
    pub scatter: wgpu::BindGroup,
    pub sort: wgpu::BindGroup,
    pub merge: wgpu::BindGroup,
    pub deepen: wgpu::BindGroup,
    pub rewind: wgpu::BindGroup,
    pub touch: wgpu::BindGroup,
    pub see: wgpu::BindGroup,
    pub blend: wgpu::BindGroup,
    /// Where a scene asks.
    pub geometry: Option<Geometry>,
    /// Likewise.
    pub labels: Option<Labels>,
}

/// A groom among others.
#[derive(Debug)]
pub(super) struct Groom {
    part: wgpu::Buffer,
    pub project: wgpu::BindGroup,
    /// What of it is seen.
    pub chosen: Chosen,
    pub tint: wgpu::BindGroup,
    /// Points that it has now.
    pub points: u32,
    /// See [`Part::room`].
    pub room: u32,
}

impl Tiles {
    /// For targets of `size` pixels, with textures that `texture` makes.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(
        device: &wgpu::Device,
        size: [u32; 2],
        texture: impl Fn(TextureKind) -> wgpu::Texture,
    ) -> Result<Self> {
        let tiles = size.map(|side| side.div_ceil(TILE));
        let count = u64::from(tiles[0]) * u64::from(tiles[1]);
        let blocks = tiles.map(|side| u64::from(side.div_ceil(TILE_BLOCK)));
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
        let asked = [Asked::Front, Asked::Behind, Asked::Whole];
        let mut numbers = vec![0u32; asked.len() * (STEP * u64::from(TILE_ROUNDS)) as usize / 4];
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
            farthest: storage::<u32>(device, "farthest bodies", count)?,
            bins: storage::<u32>(device, "bins", count * u64::from(TILE_BINS))?,
            bounds: (
                storage::<[u32; 4]>(device, "bounds of tiles", Texels::rows(count))?,
                Texels::new(device, "bounds of tiles", count, wgpu::TextureFormat::Rgba32Uint)?,
            ),
            busy: storage::<[u32; 4]>(device, "busy tiles", count)?,
            ranges: storage::<[u32; 2]>(device, "ranges of depth", blocks[0] * blocks[1])?,
            control: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("control of tiles"),
                size: size_of::<Control>() as u64,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::INDIRECT
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            depths: storage::<u32>(device, "depths of lists", u64::from(TILE_ROUNDS) + 2 * count)?,
            rounds,
            grid: uniform(device, "grid of tiles", size_of::<Grid>()),
            bound: Mutex::default(),
            room: Mutex::default(),
        })
    }

    /// Tiles in all.
    pub(super) fn count(&self) -> u32 {
        self.tiles[0] * self.tiles[1]
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        let own = [&self.surfaces, &self.farthest, &self.bins, &self.busy, &self.ranges, &self.depths];
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        own.iter().map(|buffer| buffer.size()).sum::<u64>()
            + self.bounds.0.size()
            + self.bounds.1.bytes()
            + pixels * 8
            + self.hair_bytes()
    }

    /// Those of them that are there for hair: points, lists and what is seen of it.
    pub fn hair_bytes(&self) -> u64 {
        self.bound().as_ref().map_or(0, |bound| bound.bytes)
    }

    /// What [`Canvas::geometry`] asked for in the last picture; none where that had no hair.
    pub fn geometry(&self) -> Option<wgpu::TextureView> {
        let bound = self.bound();
        let geometry = bound.as_ref()?.geometry.as_ref()?;
        geometry.is_asked().then(|| geometry.texture.clone())
    }

    /// Whether that tells how hair moved.
    pub fn knows_motion(&self) -> bool {
        self.bound()
            .as_ref()
            .and_then(|bound| bound.geometry.as_ref())
            .is_some_and(|known| known.knows_motion)
    }

    /// What [`Canvas::labels`] asked for in the last picture, and whose points its numbers are of.
    pub fn labels(&self) -> Option<Labels> {
        self.bound().as_ref()?.labels.clone().filter(|labels| !labels.owners.is_empty())
    }

    /// The picture has no hair: where that of the one before was is not to be told of this one.
    pub(super) fn forget(&self) {
        if let Some(bound) = self.bound().as_mut() {
            bound.geometry = None;
            bound.labels = None;
        }
    }

    pub(super) fn bound(&self) -> MutexGuard<'_, Option<Bound>> {
        // What a panic leaves behind is whole.
        self.bound.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What this frame works on, its uniforms written; `hair` is not empty.
    pub(super) fn bind(
        &self,
        kernels: &Pipelines,
        canvas: &Canvas<'_, '_>,
        hair: &[Seen<'_>],
    ) -> Result<MutexGuard<'_, Option<Bound>>> {
        let mut bound = self.bound();
        let entries = self.learn(canvas, bound.as_ref().map(|bound| bound.grid.window));
        let of: Vec<_> = hair
            .iter()
            .map(|seen| [seen.hair.strands.vertices.clone(), seen.shaded.colors.clone()])
            .collect();
        let asked = canvas.geometry.is_some();
        let fits = |bound: &Bound| {
            let has = (!asked || bound.geometry.is_some()) && (!canvas.labels || bound.labels.is_some());
            bound.of == of && bound.grid.window >= entries && has
        };
        if !bound.as_ref().is_some_and(fits) {
            // The old one goes first: the two need not be there at once.
            *bound = None;
            *bound = Some(self.make(kernels, canvas, hair, of, next(entries))?);
        }
        if let Some(bound) = bound.as_mut() {
            bound.prepare(canvas.commands.context(), &self.grid, hair);
        }
        Ok(bound)
    }

    /// Entries of a picture before, as far as they are known: nothing is waited for.
    fn learn(&self, canvas: &Canvas<'_, '_>, window: Option<u32>) -> u32 {
        let mut room = self.room.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(window) = window {
            let asked =
                room.asked.get_or_insert_with(|| Pending::buffer(canvas.commands.context(), &self.control));
            if let Some(control) = asked.take() {
                room.asked = None;
                // A lost device is found by whoever waits for it.
                if let Ok(control) = control {
                    room.learn(&control, window);
                }
            }
        }
        room.entries
    }

    /// Whether the lists held all of the last picture; if not, those of the next will.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn is_complete(&self, context: &Context) -> Result<bool> {
        let Some(window) = self.bound().as_ref().map(|bound| bound.grid.window) else { return Ok(true) };
        let control = Pending::buffer(context, &self.control).wait().await?;
        let mut room = self.room.lock().unwrap_or_else(PoisonError::into_inner);
        // What was asked before is older than this.
        room.asked = None;
        Ok(room.learn(&control, window))
    }

    fn make(
        &self,
        kernels: &Pipelines,
        canvas: &Canvas<'_, '_>,
        hair: &[Seen<'_>],
        of: Vec<[wgpu::Buffer; 2]>,
        least: u32,
    ) -> Result<Bound> {
        let device = &canvas.commands.context().device;
        let mut firsts = Vec::new();
        let mut all = 0u64;
        for seen in hair {
            firsts.push(all as u32);
            let vertices = u64::from(seen.hair.strands.room.vertices);
            all += vertices.next_multiple_of(u64::from(ALIGN));
        }
        use wgpu::TextureFormat::{R32Uint, Rgba32Float};
        let points = Texels::new(device, "points", all, Rgba32Float)?;
        let seen = storage::<u32>(device, "what is seen", all / 32)?;
        let colors = Texels::new(device, "colours of points", all, R32Uint)?;
        // A window, and the longest tile: no segment is in a tile twice.
        let window = window_of(all).max(least.into());
        let unsorted = storage::<u32>(device, "unsorted lists", window + all)?;
        let list = Texels::new(device, "lists of tiles", window + all, R32Uint)?;
        // A byte for each entry; of each tile's a word for each row in front, and its last 32 need not be full.
        let touches = (window + all) / 32 + 2 * u64::from(self.count());
        let touches = storage::<u32>(device, "rows of tiles", touches * u64::from(TILE))?;
        let id_bits = 32 - (all as u32).leading_zeros();
        let grid = Grid {
            size: self.size,
            tiles: self.tiles,
            points: all as u32,
            id_bits,
            window: window as u32,
            _pad: 0,
        };
        let many = usize::from(canvas.targets.samples > 1);
        let round = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.rounds,
            offset: 0,
            size: wgpu::BufferSize::new(16),
        });
        let depth = wgpu::BindingResource::TextureView(&canvas.targets.depth);
        let [camera, g, control, busy] =
            [canvas.eye, &self.grid, &self.control, &self.busy].map(wgpu::Buffer::as_entire_binding);
        let [surfaces, farthest, bins, ranges, d, s, t] =
            [&self.surfaces, &self.farthest, &self.bins, &self.ranges, &self.depths, &seen, &touches]
                .map(wgpu::Buffer::as_entire_binding);
        let [unsorted_words, b] = [&unsorted, &self.bounds.0].map(wgpu::Buffer::as_entire_binding);
        let [points_texels, colors_texels, list_texels, bounds_texels] =
            [&points, &colors, &list, &self.bounds.1].map(Texels::resource);
        let parts = hair
            .iter()
            .zip(&firsts)
            .map(|(own, first)| {
                let part = uniform(device, "part of the points", size_of::<Part>());
                let of = part.as_entire_binding();
                let [vertices, strands, shaded] =
                    [&own.hair.strands.vertices, &own.hair.strands.strands, &own.shaded.colors]
                        .map(wgpu::Buffer::as_entire_binding);
                let project =
                    [&camera, &g, &of, &vertices, &strands, &points_texels, &ranges].map(Clone::clone);
                let tint = [&of, &shaded, &s, &colors_texels].map(Clone::clone);
                let offset = u64::from(*first) / 8;
                let seen =
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: &seen, offset, size: None });
                let light = (own.light, canvas.eye);
                Ok(Groom {
                    chosen: Chosen::new(canvas.commands.context(), light, own.hair, own.shaded, seen)?,
                    project: kernels.project.bind(&project),
                    tint: kernels.tint.bind(&tint),
                    points: 0,
                    room: 0,
                    part,
                })
            })
            .collect::<Result<_>>()?;
        let mut surface = vec![&g, &ranges, &depth, &surfaces, &farthest];
        if many == 1 {
            surface.push(&camera);
        }
        let bind = |kernel: &crate::gpu::Kernel, of: &[&wgpu::BindingResource<'_>]| {
            kernel.bind(&of.iter().map(|&of| of.clone()).collect::<Vec<_>>())
        };
        let hair_texture = wgpu::BindingResource::TextureView(&self.hair);
        let asked = [&g, &control, &busy, &d, &round];
        let lists = [&g, &control, &busy, &list_texels, &points_texels];
        let of_rows = [&lists[..], &[&surfaces, &t]].concat().into_iter().cloned().collect::<Vec<_>>();
        let geometry = canvas
            .geometry
            .map(|_| Geometry::new(&kernels.geometry[many], canvas, &points, &of_rows, round.clone()));
        let label = &kernels.label[many];
        let labels = canvas.labels.then(|| Labels::new(label, canvas, &of_rows, round.clone()));
        let bytes = [&points, &colors, &list].map(Texels::bytes).iter().sum::<u64>()
            + unsorted.size()
            + seen.size()
            + touches.size()
            + geometry.as_ref().map_or(0, Geometry::bytes)
            + labels.as_ref().map_or(0, Labels::bytes);
        Ok(Bound {
            surface: bind(&kernels.surface[many], &surface),
            bound: bind(&kernels.bound, &[&g, &farthest, &ranges, &b]),
            count: bind(&kernels.count, &[&g, &points_texels, &bounds_texels, &bins]),
            totals: bind(&kernels.totals, &[&g, &bins, &b]),
            scan: bind(&kernels.scan, &[&g, &b, &busy, &control, &d]),
            scatter: bind(
                &kernels.scatter,
                &[&g, &points_texels, &bounds_texels, &bins, &unsorted_words, &round],
            ),
            sort: bind(&kernels.sort, &[&asked[..], &[&bins, &unsorted_words, &list_texels]].concat()),
            merge: bind(&kernels.merge, &[&asked[..], &[&bins, &unsorted_words, &list_texels]].concat()),
            deepen: bind(&kernels.deepen, &[&control, &d, &round]),
            rewind: bind(&kernels.rewind, &[&control, &busy, &bins, &round]),
            see: bind(&kernels.see[many], &[&lists[..], &[&surfaces, &t, &s, &round, &d]].concat()),
            touch: bind(&kernels.touch, &[&asked[..], &[&list_texels, &points_texels, &t]].concat()),
            blend: bind(
                &kernels.blend[many],
                &[&lists[..], &[&surfaces, &t, &colors_texels, &round, &hair_texture]].concat(),
            ),
            geometry,
            labels,
            of,
            grid,
            firsts,
            parts,
            seen,
            points,
            bytes,
        })
    }
}

/// What a picture may need after one with so many entries: a motion needs a little more from one to the next.
fn next(entries: u32) -> u32 {
    entries.saturating_add(entries / 4)
}

/// Entries of a round for so many points.
fn window_of(points: u64) -> u64 {
    (points * 3 / 2).max(1 << 16)
}

impl Bound {
    /// Before the points of a picture replace those of the one before: what tells how they moved.
    pub fn begin(&mut self, canvas: &mut Canvas<'_, '_>, hair: &[Seen<'_>]) {
        if let Some(labels) = &mut self.labels {
            let owner = |(seen, first): (&Seen<'_>, &u32)| Owner {
                first: *first,
                count: seen.hair.drawn.count,
                vertex_count: seen.hair.drawn.vertex_count,
            };
            let asked = if canvas.labels { hair } else { &[] };
            labels.begin(canvas, asked.iter().zip(&self.firsts).map(owner).collect());
        }
        let Some(geometry) = &mut self.geometry else { return };
        match canvas.geometry {
            Some(depth) => {
                let drawn = hair.iter().map(|seen| [seen.hair.drawn.count, seen.hair.drawn.vertex_count]);
                geometry.begin(canvas, &self.points, drawn.collect(), depth);
            }
            None => geometry.forget(),
        }
    }

    /// Writes the uniforms of a frame.
    fn prepare(&mut self, context: &Context, grid: &wgpu::Buffer, hair: &[Seen<'_>]) {
        let Context { queue, .. } = context;
        let mut points = 0;
        for ((seen, groom), first) in hair.iter().zip(&mut self.parts).zip(&self.firsts) {
            let drawn = &seen.hair.drawn;
            let own = drawn.count * drawn.vertex_count;
            let room = groom.points.max(own);
            let part = Part { first: *first, count: drawn.count, vertex_count: drawn.vertex_count, room };
            (groom.points, groom.room) = (own, room);
            points = part.first + own;
            queue.write_buffer(&groom.part, 0, bytemuck::bytes_of(&part));
        }
        self.grid.points = points;
        queue.write_buffer(grid, 0, bytemuck::bytes_of(&self.grid));
    }
}
