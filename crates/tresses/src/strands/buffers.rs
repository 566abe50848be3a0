//! Buffers of guides and strands. Sizes are checked against the adapter's limits before allocation.

use super::{
    Guide, GuideForce, GuideSample, PackedGuide, PackedRest, RootMotion, Strand, StrandBinding, StrandVertex,
};
use crate::{
    Context, Error, Result,
    gpu::{Buffer, Device},
};
use wgpu::BufferUsages;

/// Buffers of the guides, indexed `vertex * count + guide` unless stated otherwise.
#[derive(Debug)]
pub struct GuideBuffers {
    /// Number of guides.
    pub count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Samples per tessellated guide; 0 if every strand follows its own guide.
    pub sample_count: u32,
    /// One per guide.
    pub info: Buffer<Guide>,
    /// One per vertex.
    pub rest: Buffer<PackedGuide>,
    /// Three floats: the position after the last step, relative to the origin of the simulation
    /// ([`Hair::simulation_transform`](crate::hair::Hair::simulation_transform)). Then a word by `pack_lag`: the
    /// difference between the previous position and the one that position and velocity predict.
    pub current: Buffer<[u32; 4]>,
    /// Velocity after the last step, m/s, by `pack_velocity`. If hair can twist, the twist of each bend (radians) after
    /// and before the last step follows the velocities of all vertices.
    pub velocity: Buffer<[u32; 2]>,
    /// External forces in the next step. Contents are valid only within a step; the memory may be a
    /// groom's [scratch](crate::hair::Hair) buffer, which may be larger.
    pub forces: Buffer<GuideForce>,
    /// Indexed `guide * sample_count + sample`.
    pub samples: Buffer<GuideSample>,
    /// One per guide and one more if roots are on a deforming surface, else a single unused one.
    pub(crate) roots: Buffer<RootMotion>,
}

/// Buffers of the drawn strands. A clone shares the buffers.
#[derive(Clone, Debug)]
pub struct StrandBuffers {
    /// Number of strands.
    pub count: u32,
    /// Vertices per strand.
    pub vertex_count: u32,
    /// One per strand.
    pub strands: Buffer<Strand>,
    /// One per strand.
    pub bindings: Buffer<StrandBinding>,
    /// Indexed `strand * vertex_count + vertex`.
    pub rest: Buffer<PackedRest>,
    /// Indexed `strand * drawn.vertex_count + vertex`.
    pub vertices: Buffer<StrandVertex>,
    /// Widening of each strand relative to full detail, as a fraction: 0 for unchanged, -1 for a strand that is not
    /// drawn.
    pub widening: Buffer<f32>,
    /// Root position of each strand (three floats, world space, meters, and one unused) if it is on a deforming
    /// surface between guides; else a single unused one.
    pub roots: Buffer<[f32; 4]>,
    /// Strands and vertices to draw; fewer than all at a lower level of detail.
    pub drawn: DrawCount,
    /// Capacity of `strands`, `vertices` and `widening`. [`Hair`](crate::hair::Hair) allocates enough for its level of
    /// detail.
    pub capacity: StrandCapacity,
}

/// Capacity of one head's buffers: strands, and vertices in total.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StrandCapacity {
    /// Number of strands.
    pub strands: u32,
    /// Total number of vertices.
    pub vertices: u32,
}

impl StrandCapacity {
    /// Returns a capacity for at least these strands and vertices, and at most for `all`. It grows in steps of half an
    /// octave, so that an approaching head seldom reallocates.
    pub fn of([strands, vertices]: [u32; 2], all: Self) -> Self {
        let step = |min: u32, need: u32, max: u32| {
            let mut capacity = f64::from(min);
            while capacity < f64::from(need) {
                capacity *= std::f64::consts::SQRT_2;
            }
            (capacity.ceil() as u32).min(max)
        };
        Self { strands: step(512, strands, all.strands), vertices: step(4096, vertices, all.vertices) }
    }

    /// Returns the new capacity if this one is smaller than `need` or more than three times too large.
    pub fn resized(&self, need: [u32; 2], all: Self) -> Option<Self> {
        let fits = self.strands >= need[0] && self.vertices >= need[1];
        let capacity = Self::of(need, all);
        let is_wasteful = self.strands / 3 > capacity.strands || self.vertices / 3 > capacity.vertices;
        (!fits || is_wasteful).then_some(capacity)
    }
}

/// Strands and vertices that the stages after the guides process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawCount {
    /// Number of strands: the first ones in the buffers.
    pub count: u32,
    /// Vertices per strand.
    pub vertex_count: u32,
    /// Segments of the rest curve per drawn segment; the last drawn segment may be shorter.
    pub stride: f32,
    /// Factor on strand widths in shadow maps and ambient light ([`crate::lod::Detail::area`]).
    pub area: f32,
    /// Factors on fiber counts in front of visible hair ([`crate::lod::Detail::deeper`]).
    pub deeper: [f32; 2],
    /// See [`crate::lod::Detail::depth_offset`], meters.
    pub depth_offset: f32,
    /// Strength of the stochastic light and shadow on single strands, where each drawn strand represents several: the
    /// square root of the fraction that is drawn.
    pub single: f32,
    /// Mean length of a strand over the area across which strands are spread, 1/m; 0 if unknown. Times the number of
    /// strands and the edge of a texel, it is the number of strands in a texel of a shadow map.
    pub dense: f32,
    /// Compensation for large ambient cells, which darken dense hair: 0 where they do not, 1 where sampling half a cell
    /// ahead compensates, at most 2.
    pub packed: f32,
}

impl DrawCount {
    /// Returns the settings for the first `count` strands, of `vertex_count` rest vertices each, drawn with `segments`
    /// segments. `segments` need not be an integer.
    pub fn new(count: u32, vertex_count: u32, segments: f32) -> Self {
        let rest_segments = vertex_count.saturating_sub(1).max(1);
        if segments >= rest_segments as f32 {
            return Self {
                count,
                vertex_count,
                stride: 1.0,
                area: 1.0,
                deeper: [1.0; 2],
                depth_offset: 0.0,
                single: 1.0,
                dense: 0.0,
                packed: 0.0,
            };
        }
        let segments = segments.max(1.0);
        let vertex_count = segments.ceil() as u32 + 1;
        Self {
            count,
            vertex_count,
            stride: rest_segments as f32 / segments,
            area: 1.0,
            deeper: [1.0; 2],
            depth_offset: 0.0,
            single: 1.0,
            dense: 0.0,
            packed: 0.0,
        }
    }
}

/// Creates a storage buffer for `count` values of `T`, at least 16 bytes.
///
/// # Errors
/// [`Error::Limit`] if the adapter cannot hold it.
pub fn storage<T>(device: &Device, label: &'static str, count: u64) -> Result<wgpu::Buffer> {
    storage_with::<T>(device, label, count, BufferUsages::empty())
}

/// Like [`storage`], with more usages.
pub(crate) fn storage_with<T>(
    device: &Device,
    label: &'static str,
    count: u64,
    usage: BufferUsages,
) -> Result<wgpu::Buffer> {
    let need = count.saturating_mul(size_of::<T>() as u64).max(16);
    let limits = device.limits();
    let have = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    if need > have {
        return Err(Error::Limit { what: label, need, have, unit: "bytes in one buffer" });
    }
    Ok(device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: need,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC | usage,
        mapped_at_creation: false,
    }))
}

/// Like [`storage`], but returns a typed buffer.
pub(crate) fn buffer<T>(device: &Device, label: &'static str, count: u64) -> Result<Buffer<T>> {
    Ok(storage::<T>(device, label, count)?.into())
}

/// Creates a storage buffer with the contents `bytes`.
///
/// # Errors
/// [`Error::Limit`] if the adapter cannot hold it.
pub(crate) fn filled(context: &Context, label: &'static str, bytes: &[u8]) -> Result<wgpu::Buffer> {
    let Context { device, queue, .. } = context;
    let buffer = storage::<u8>(device, label, bytes.len() as u64)?;
    queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

/// Buffers of the guides that never change, shared by all hair of a groom.
#[derive(Clone, Debug)]
pub(crate) struct GuideAsset {
    pub count: u32,
    pub vertex_count: u32,
    pub sample_count: u32,
    pub info: Buffer<Guide>,
    pub rest: Buffer<PackedGuide>,
    pub forces: Buffer<GuideForce>,
}

impl GuideAsset {
    /// Creates empty buffers. `forces` holds [`GuideForce`]s during a step.
    pub fn new(
        context: &Context,
        [count, vertex_count, sample_count]: [u32; 3],
        forces: Buffer<GuideForce>,
    ) -> Result<Self> {
        let Context { device, .. } = context;
        let info = buffer(device, "guide info", count.into())?;
        let rest = buffer(device, "guide rest", u64::from(count) * u64::from(vertex_count))?;
        Ok(Self { count, vertex_count, sample_count, info, rest, forces })
    }

    /// Returns the GPU memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.info.size() + self.rest.size() + self.forces.size()
    }
}

impl GuideBuffers {
    /// Creates empty buffers.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn new(context: &Context, count: u32, vertex_count: u32, sample_count: u32) -> Result<Self> {
        let vertices = u64::from(count) * u64::from(vertex_count);
        let forces = buffer(&context.device, "guide forces", vertices)?;
        Self::of(context, &GuideAsset::new(context, [count, vertex_count, sample_count], forces)?)
    }

    /// Creates empty buffers for the state of one head's guides.
    pub(crate) fn of(context: &Context, asset: &GuideAsset) -> Result<Self> {
        let Context { device, .. } = context;
        let GuideAsset { count, vertex_count, sample_count, info, rest, forces } = asset.clone();
        let vertices = u64::from(count) * u64::from(vertex_count);
        let samples = u64::from(count) * u64::from(sample_count);
        Ok(Self {
            count,
            vertex_count,
            sample_count,
            info,
            rest,
            current: buffer(device, "guide current", vertices)?,
            velocity: buffer(device, "guide velocity", vertices)?,
            forces,
            samples: buffer(device, "guide samples", samples.max(1))?,
            roots: buffer(device, "guide roots", 1)?,
        })
    }

    /// Extends `velocity` by the twist of each bend
    /// ([`SimulationParams::twist`](crate::simulate::SimulationParams::twist)), initially zero. The velocities stay.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn add_twist(&mut self, context: &Context) -> Result<()> {
        let Context { device, queue, .. } = context;
        let entries = 2 * u64::from(self.count) * u64::from(self.vertex_count);
        let velocity = buffer(device, "guide velocity", entries)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.velocity, 0, &velocity, 0, self.velocity.size());
        queue.submit([encoder.finish()]);
        self.velocity = velocity;
        Ok(())
    }

    /// Returns whether `velocity` includes twist.
    pub(crate) fn can_twist(&self) -> bool {
        self.velocity.size()
            > u64::from(self.count) * u64::from(self.vertex_count) * size_of::<[u32; 2]>() as u64
    }

    /// Returns the number of points of a line along a guide: its samples, or else its vertices.
    #[cfg(feature = "debug-views")]
    pub(crate) fn line_count(&self) -> u32 {
        if self.sample_count == 0 { self.vertex_count } else { self.sample_count }
    }

    /// Returns the GPU memory of this head alone, bytes.
    pub(crate) fn own_bytes(&self) -> u64 {
        [&*self.current, &self.velocity, &self.samples, &self.roots].iter().map(|buffer| buffer.size()).sum()
    }
}

/// Buffers of the strands that never change, shared by all hair of a groom.
#[derive(Clone, Debug)]
pub(crate) struct StrandAsset {
    pub count: u32,
    pub vertex_count: u32,
    pub bindings: Buffer<StrandBinding>,
    pub rest: Buffer<PackedRest>,
}

impl StrandAsset {
    /// Creates empty buffers.
    pub fn new(context: &Context, count: u32, vertex_count: u32) -> Result<Self> {
        let Context { device, .. } = context;
        let bindings = buffer(device, "strand bindings", count.into())?;
        let vertices = u64::from(count) * u64::from(vertex_count);
        Ok(Self { count, vertex_count, bindings, rest: buffer(device, "strand rest", vertices)? })
    }

    /// Returns the capacity for all strands.
    pub fn full_capacity(&self) -> StrandCapacity {
        StrandCapacity { strands: self.count, vertices: self.count.saturating_mul(self.vertex_count) }
    }

    /// Returns the GPU memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.bindings.size() + self.rest.size()
    }
}

impl StrandBuffers {
    /// Creates empty buffers for all strands.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn new(context: &Context, count: u32, vertex_count: u32) -> Result<Self> {
        let asset = StrandAsset::new(context, count, vertex_count)?;
        Self::of(context, &asset, asset.full_capacity())
    }

    /// Creates empty buffers of one head with the capacity `capacity`.
    pub(crate) fn of(context: &Context, asset: &StrandAsset, capacity: StrandCapacity) -> Result<Self> {
        let Context { device, .. } = context;
        let StrandAsset { count, vertex_count, bindings, rest } = asset.clone();
        Ok(Self {
            count,
            vertex_count,
            strands: buffer(device, "strands", capacity.strands.into())?,
            bindings,
            rest,
            vertices: buffer(device, "strand vertices", capacity.vertices.into())?,
            widening: buffer(device, "strand widening", capacity.strands.into())?,
            roots: buffer(device, "strand roots", 1)?,
            drawn: DrawCount::new(count, vertex_count, f32::INFINITY),
            capacity,
        })
    }

    /// Returns the GPU memory of this head alone, bytes.
    pub(crate) fn own_bytes(&self) -> u64 {
        [&*self.strands, &self.vertices, &self.widening, &self.roots].iter().map(|buffer| buffer.size()).sum()
    }
}
