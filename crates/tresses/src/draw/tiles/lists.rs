//! The part of the stage that depends on the hair: projected points, the lists of tiles, and the bind groups of all
//! passes. They are recreated when other grooms are drawn or when the lists must grow.

use super::{
    Pipelines,
    buffers::{STEP, TileBuffers, TileGrid},
    geometry::Geometry,
    labels::{Labels, Owner},
    texels::Texels,
};
use crate::{
    Result,
    constants::TILE,
    draw::canvas::Canvas,
    gpu::{BindBuffer, Device, Uniform},
    light::{HairView, ShadingSubset},
    shaders::kernels::draw::tiles as bound,
    strands::buffers::storage,
};
use bytemuck::{Pod, Zeroable};

/// The points of one groom.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct PointRange {
    /// Index of the first point.
    pub first: u32,
    /// Number of strands.
    pub count: u32,
    /// Vertices per strand.
    pub vertex_count: u32,
    /// Number of points in this frame or the last one, whichever is greater.
    pub capacity: u32,
}

/// The first point of each groom is a multiple of this, so that its bits in [`ListBuffers::seen`] can be bound.
const ALIGN: u32 = STEP as u32 * 8;

/// Buffers and bind groups for a set of grooms.
#[derive(Debug)]
pub(super) struct HairLists {
    /// The vertices and colors of each groom, which the bind groups hold.
    source: Vec<[wgpu::Buffer; 2]>,
    pub grid: TileGrid,
    /// Index of the first point of each groom.
    firsts: Vec<u32>,
    pub grooms: Vec<GroomPoints>,
    buffers: ListBuffers,
    pub groups: Groups,
    /// Motion, depth and opacity, once a frame has asked for them.
    pub geometry: Option<Geometry>,
    /// Strand labels, once a frame has asked for them.
    pub labels: Option<Labels>,
}

/// The points of one groom and the bind groups that read them.
#[derive(Debug)]
pub(super) struct GroomPoints {
    part: Uniform,
    pub project: wgpu::BindGroup,
    /// The visible segments, for shading.
    pub visible_segments: ShadingSubset,
    pub tint: wgpu::BindGroup,
    /// Number of points in this frame.
    pub points: u32,
    /// See [`PointRange::capacity`].
    pub capacity: u32,
}

/// Buffers and textures that grow with the number of points or entries.
#[derive(Debug)]
struct ListBuffers {
    points: Texels,
    colors: Texels,
    /// A bit per segment: whether it is visible.
    visible: wgpu::Buffer,
    unsorted: wgpu::Buffer,
    list: Texels,
    /// A byte per entry: the rows of its tile that it covers.
    touches: wgpu::Buffer,
}

/// The bind group of each kernel of [`Pipelines`], by its name.
#[derive(Debug)]
pub(super) struct Groups {
    pub surface: wgpu::BindGroup,
    pub bound: wgpu::BindGroup,
    pub totals: wgpu::BindGroup,
    pub scan: wgpu::BindGroup,
    pub scatter: wgpu::BindGroup,
    pub sort: wgpu::BindGroup,
    pub merge: wgpu::BindGroup,
    pub dispatch_deep: wgpu::BindGroup,
    pub reset_bins: wgpu::BindGroup,
    pub touch: wgpu::BindGroup,
    pub visibility: wgpu::BindGroup,
    pub blend: wgpu::BindGroup,
}

impl HairLists {
    /// Allocates lists of at least `min_entries` entries for `hair`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if a buffer exceeds the device's limits.
    pub fn new(
        kernels: &Pipelines,
        tiles: &TileBuffers,
        canvas: &Canvas<'_, '_>,
        hair: &[HairView<'_>],
        min_entries: u32,
    ) -> Result<Self> {
        let (firsts, points) = firsts(hair);
        let window = window_of(points).max(min_entries.into());
        let buffers = ListBuffers::new(&canvas.commands.context().device, points, window, tiles.count())?;
        let grid = TileGrid {
            size: tiles.size,
            tiles: tiles.tiles,
            points: points as u32,
            id_bits: 32 - (points as u32).leading_zeros(),
            window: window as u32,
            _pad: 0,
        };
        let grooms = hair.iter().zip(&firsts);
        let grooms =
            grooms.map(|(own, first)| GroomPoints::new(kernels, tiles, canvas, &buffers, own, *first));
        let grooms = grooms.collect::<Result<_>>()?;
        let many = usize::from(canvas.target.samples > 1);
        let fine = buffers.fine(tiles);
        let geometry =
            canvas.geometry.map(|_| Geometry::new(&kernels.geometry[many], canvas, &buffers.points, fine));
        let labels = canvas.writes_labels.then(|| Labels::new(&kernels.label[many], canvas, fine));
        Ok(Self {
            groups: Groups::new(kernels, tiles, canvas, &buffers),
            source: source(hair),
            grid,
            firsts,
            grooms,
            buffers,
            geometry,
            labels,
        })
    }

    /// Whether the lists suffice for a frame of `hair` with this number of entries.
    pub fn fits(&self, canvas: &Canvas<'_, '_>, hair: &[HairView<'_>], entries: u32) -> bool {
        let outputs = (canvas.geometry.is_none() || self.geometry.is_some())
            && (!canvas.writes_labels || self.labels.is_some());
        outputs && self.grid.window >= entries && self.source == source(hair)
    }

    /// Prepares labels and motion, before this frame overwrites the last frame's points.
    pub fn begin(&mut self, canvas: &mut Canvas<'_, '_>, hair: &[HairView<'_>]) {
        if let Some(labels) = &mut self.labels {
            let owner = |(view, first): (&HairView<'_>, &u32)| Owner {
                first: *first,
                count: view.hair.drawn.count,
                vertex_count: view.hair.drawn.vertex_count,
            };
            let labeled = if canvas.writes_labels { hair } else { &[] };
            labels.begin(canvas, labeled.iter().zip(&self.firsts).map(owner).collect());
        }
        let Some(geometry) = &mut self.geometry else { return };
        match canvas.geometry {
            Some(depth) => {
                let drawn = hair.iter().map(|view| [view.hair.drawn.count, view.hair.drawn.vertex_count]);
                geometry.begin(canvas, &self.buffers.points, drawn.collect(), depth);
            }
            None => geometry.forget(),
        }
    }

    /// Writes the uniforms of a frame.
    pub fn prepare(&mut self, grid: &Uniform, hair: &[HairView<'_>]) {
        let mut points = 0;
        for ((view, groom), first) in hair.iter().zip(&mut self.grooms).zip(&self.firsts) {
            let drawn = &view.hair.drawn;
            let own = drawn.count * drawn.vertex_count;
            let capacity = groom.points.max(own);
            let part =
                PointRange { first: *first, count: drawn.count, vertex_count: drawn.vertex_count, capacity };
            (groom.points, groom.capacity) = (own, capacity);
            points = part.first + own;
            groom.part.write(0, bytemuck::bytes_of(&part));
        }
        self.grid.points = points;
        grid.write(0, bytemuck::bytes_of(&self.grid));
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.buffers.bytes()
            + self.geometry.as_ref().map_or(0, Geometry::bytes)
            + self.labels.as_ref().map_or(0, Labels::bytes)
    }
}

impl ListBuffers {
    fn new(device: &Device, points: u64, window: u64, tiles: u32) -> Result<Self> {
        use wgpu::TextureFormat::{R32Uint, Rgba32Float};
        // A window and the longest tile: a segment occurs at most once in a tile.
        let entries = window + points;
        // One byte per entry, plus a word per row of each tile for the count, and another because the last word can be
        // partial.
        let touches = (entries / 32 + 2 * u64::from(tiles)) * u64::from(TILE);
        Ok(Self {
            points: Texels::new(device, "points", points, Rgba32Float)?,
            colors: Texels::new(device, "colors of points", points, R32Uint)?,
            visible: storage::<u32>(device, "visible segments", points / 32)?,
            unsorted: storage::<u32>(device, "unsorted lists", entries)?,
            list: Texels::new(device, "lists of tiles", entries, R32Uint)?,
            touches: storage::<u32>(device, "rows of tiles", touches)?,
        })
    }

    /// Bindings of every kernel that walks the rows of a tile.
    fn fine<'a>(&'a self, tiles: &'a TileBuffers) -> bound::Fine<'a> {
        bound::Fine {
            grid: tiles.grid.entire(),
            control: tiles.control.entire(),
            occupied: tiles.occupied.entire(),
            list: self.list.view(),
            points: self.points.view(),
            surfaces: tiles.surfaces.entire(),
            touches: self.touches.entire(),
            round: tiles.round(),
        }
    }

    fn bytes(&self) -> u64 {
        [&self.points, &self.colors, &self.list].map(Texels::bytes).iter().sum::<u64>()
            + self.unsorted.size()
            + self.visible.size()
            + self.touches.size()
    }
}

impl GroomPoints {
    fn new(
        kernels: &Pipelines,
        tiles: &TileBuffers,
        canvas: &Canvas<'_, '_>,
        buffers: &ListBuffers,
        own: &HairView<'_>,
        first: u32,
    ) -> Result<Self> {
        let context = canvas.commands.context();
        let part = context.device.storage_uniform(size_of::<PointRange>());
        let project = kernels.project.bind(&bound::Project {
            view: canvas.eye.entire(),
            grid: tiles.grid.entire(),
            part: part.entire(),
            vertices: own.hair.strands.vertices.entire(),
            strands: own.hair.strands.strands.entire(),
            points: buffers.points.view(),
            ranges: tiles.ranges.entire(),
            visible: buffers.visible.entire(),
        });
        let tint = kernels.tint.bind(&bound::Tint {
            part: part.entire(),
            shaded: own.shaded.colors.entire(),
            visible: buffers.visible.entire(),
            colors: buffers.colors.view(),
        });
        let seen = buffers.visible.part(u64::from(first) / 8, None);
        let light = (own.light, canvas.eye);
        Ok(Self {
            visible_segments: ShadingSubset::new(context, light, own.hair, own.shaded, seen)?,
            project,
            tint,
            points: 0,
            capacity: 0,
            part,
        })
    }
}

impl Groups {
    fn new(kernels: &Pipelines, tiles: &TileBuffers, canvas: &Canvas<'_, '_>, buffers: &ListBuffers) -> Self {
        let many = usize::from(canvas.target.samples > 1);
        let (grid, control, occupied) =
            (tiles.grid.entire(), tiles.control.entire(), tiles.occupied.entire());
        let (bins, bounds, depths) = (tiles.bins.entire(), tiles.bounds.0.entire(), tiles.depths.entire());
        let (far_depths, surfaces, ranges) =
            (tiles.far_depths.entire(), tiles.surfaces.entire(), tiles.ranges.entire());
        let sums = tiles.sums.entire();
        let (unsorted, touches, visible) =
            (buffers.unsorted.entire(), buffers.touches.entire(), buffers.visible.entire());
        let (points, list, colors) = (buffers.points.view(), buffers.list.view(), buffers.colors.view());
        let (depth, hair, round, fine) =
            (&canvas.target.depth, &tiles.hair, tiles.round(), buffers.fine(tiles));
        let slots = bound::Slots { grid, control, occupied, depths, round };
        let texels = tiles.bounds.1.view();
        let scatter = bound::Scatter { grid, points, bounds: texels, bins, list: unsorted, round };
        let surface = if many == 0 {
            kernels.surface[0].bind(&bound::SurfaceOne { grid, ranges, depth, surfaces, far_depths })
        } else {
            let view = canvas.eye.entire();
            kernels.surface[1].bind(&bound::SurfaceMany { grid, ranges, depth, surfaces, far_depths, view })
        };
        Self {
            surface,
            bound: kernels.bound.bind(&bound::Bound { grid, far_depths, ranges, bins, bounds, texels }),
            totals: kernels.totals.bind(&bound::Totals { grid, bins, bounds, ranges, sums }),
            scan: kernels.scan.bind(&bound::Scan { grid, bounds, sums, occupied, control, depths, texels }),
            scatter: kernels.scatter.bind(&scatter),
            sort: kernels.sort.bind(&bound::Sort { slots, bins, unsorted, list }),
            merge: kernels.merge.bind(&bound::Merge { slots, bins, entries: unsorted, list }),
            dispatch_deep: kernels.dispatch_deep.bind(&bound::DispatchDeep { control, depths, round }),
            reset_bins: kernels.reset_bins.bind(&bound::ResetBins { control, occupied, bins, round }),
            touch: kernels.touch.bind(&bound::Touch { slots, list, points, touches }),
            visibility: kernels.visibility[many].bind(&bound::Visibility { fine, visible, depths }),
            blend: kernels.blend[many].bind(&bound::Blend { fine, colors, hair }),
        }
    }
}

/// The first point of each groom, and the number of points of all.
fn firsts(hair: &[HairView<'_>]) -> (Vec<u32>, u64) {
    let mut points = 0u64;
    let first = |seen: &HairView<'_>| {
        let first = points as u32;
        points += u64::from(seen.hair.strands.capacity.vertices).next_multiple_of(u64::from(ALIGN));
        first
    };
    let firsts = hair.iter().map(first).collect();
    (firsts, points)
}

fn source(hair: &[HairView<'_>]) -> Vec<[wgpu::Buffer; 2]> {
    hair.iter().map(|seen| [(*seen.hair.strands.vertices).clone(), seen.shaded.colors.clone()]).collect()
}

/// Entries per round for this number of points.
fn window_of(points: u64) -> u64 {
    (points * 3 / 2).max(1 << 16)
}
