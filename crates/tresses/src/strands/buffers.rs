//! Buffers of guides and strands. Sizes are checked against the adapter's limits before allocation.

use super::{
    Guide, GuideForce, GuideSample, PackedGuide, PackedRest, RootMotion, Strand, StrandBinding, StrandVertex,
};
use crate::{Context, Error, Result};
use wgpu::BufferUsages;

/// Buffers of the guides, indexed `vertex * count + guide` unless stated otherwise.
#[derive(Debug)]
pub struct GuideBuffers {
    /// Number of guides.
    pub count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Samples per tessellated guide; 0 if every strand [follows](crate::interpolate) its own guide.
    pub sample_count: u32,
    /// [`Guide`], one per guide.
    pub info: wgpu::Buffer,
    /// [`PackedGuide`], one per vertex.
    pub rest: wgpu::Buffer,
    /// Three floats: the position after the last step, relative to the origin of the simulation
    /// ([`crate::Hair::place`]). Then a word by [`pack_lag`](super::guide::pack_lag): the difference between the
    /// previous position and the one that position and velocity predict.
    pub current: wgpu::Buffer,
    /// Velocity after the last step, m/s, by [`pack_velocity`](super::guide::pack_velocity). If hair [can
    /// twist](Self::can_twist), the twist of each bend (radians) after and before the last step follows the velocities
    /// of all vertices.
    pub velocity: wgpu::Buffer,
    /// [`GuideForce`]: external forces in the next step. Contents are valid only within a step; the memory may be a
    /// groom's [scratch](crate::Hair) buffer, which may be larger.
    pub forces: wgpu::Buffer,
    /// [`GuideSample`], indexed `guide * sample_count + sample`.
    pub samples: wgpu::Buffer,
    /// [`RootMotion`]: one per guide and one more if roots are on a [deforming surface](crate::roots), else a single
    /// unused one.
    pub roots: wgpu::Buffer,
}

/// Buffers of the drawn strands. A clone shares the buffers.
#[derive(Clone, Debug)]
pub struct StrandBuffers {
    /// Number of strands.
    pub count: u32,
    /// Vertices per strand.
    pub vertex_count: u32,
    /// [`Strand`], one per strand.
    pub strands: wgpu::Buffer,
    /// [`StrandBinding`], one per strand.
    pub bindings: wgpu::Buffer,
    /// [`PackedRest`], indexed `strand * vertex_count + vertex`.
    pub rest: wgpu::Buffer,
    /// [`StrandVertex`], indexed `strand * drawn.vertex_count + vertex`.
    pub vertices: wgpu::Buffer,
    /// Widening of each strand relative to full detail, as a fraction: 0 for unchanged, -1 for a strand that is not
    /// drawn.
    pub widening: wgpu::Buffer,
    /// Root position of each strand (three floats, world space, meters, and one unused) if it is on a [deforming
    /// surface](crate::roots) between guides; else a single unused one.
    pub roots: wgpu::Buffer,
    /// Strands and vertices to draw; fewer than all at a lower level of detail.
    pub drawn: DrawCount,
    /// Capacity of `strands`, `vertices` and `widening`: the whole groom, except for a head that [shares its
    /// groom](crate::Hair::another).
    pub room: Room,
}

/// Capacity of one head's buffers: strands, and vertices in total.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Number of strands.
    pub strands: u32,
    /// Total number of vertices.
    pub vertices: u32,
}

impl Room {
    /// Returns a capacity for at least these strands and vertices, and at most for `all`. It grows in steps of half an
    /// octave, so that an approaching head seldom reallocates.
    pub fn of([strands, vertices]: [u32; 2], all: Self) -> Self {
        let step = |least: u32, need: u32, most: u32| {
            let mut room = f64::from(least);
            while room < f64::from(need) {
                room *= std::f64::consts::SQRT_2;
            }
            (room.ceil() as u32).min(most)
        };
        Self { strands: step(512, strands, all.strands), vertices: step(4096, vertices, all.vertices) }
    }

    /// Returns the new capacity if this one is smaller than `need` or more than three times too large.
    pub fn another(&self, need: [u32; 2], all: Self) -> Option<Self> {
        let fits = self.strands >= need[0] && self.vertices >= need[1];
        let room = Self::of(need, all);
        let wastes = self.strands / 3 > room.strands || self.vertices / 3 > room.vertices;
        (!fits || wastes).then_some(room)
    }
}

/// Strands and vertices that the stages after the guides process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawCount {
    /// Number of strands, the first of the order.
    pub count: u32,
    /// Vertices per strand.
    pub vertex_count: u32,
    /// Segments of the rest curve per drawn segment; the last drawn segment may be shorter.
    pub stride: f32,
    /// Factor of a strand's width for the area that light meets ([`crate::lod::Detail::area`]).
    pub area: f32,
    /// Factors of the number of fibers in front of visible hair ([`crate::lod::Detail::deeper`]).
    pub deeper: [f32; 2],
    /// See [`crate::lod::Detail::sunk`], meters.
    pub sunk: f32,
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
        let last = vertex_count.saturating_sub(1).max(1);
        if segments >= last as f32 {
            return Self {
                count,
                vertex_count,
                stride: 1.0,
                area: 1.0,
                deeper: [1.0; 2],
                sunk: 0.0,
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
            stride: last as f32 / segments,
            area: 1.0,
            deeper: [1.0; 2],
            sunk: 0.0,
            single: 1.0,
            dense: 0.0,
            packed: 0.0,
        }
    }
}

/// Creates a storage buffer for `count` values of `T`.
///
/// # Errors
/// [`Error::Limit`] if the adapter cannot hold it.
pub fn storage<T>(device: &wgpu::Device, what: &'static str, count: u64) -> Result<wgpu::Buffer> {
    let need = count.saturating_mul(size_of::<T>() as u64).max(16);
    let limits = device.limits();
    let have = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    if need > have {
        return Err(Error::Limit { what, need, have, unit: "bytes in one buffer" });
    }
    Ok(device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: need,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    }))
}

/// Creates a storage buffer with the contents `bytes`.
///
/// # Errors
/// [`Error::Limit`] if the adapter cannot hold it.
pub(crate) fn filled(context: &Context, what: &'static str, bytes: &[u8]) -> Result<wgpu::Buffer> {
    let Context { device, queue, .. } = context;
    let buffer = storage::<u8>(device, what, bytes.len() as u64)?;
    queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

impl GuideBuffers {
    /// Creates empty buffers.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn new(context: &Context, count: u32, vertex_count: u32, sample_count: u32) -> Result<Self> {
        let Context { device, .. } = context;
        let vertices = u64::from(count) * u64::from(vertex_count);
        let samples = u64::from(count) * u64::from(sample_count);
        Ok(Self {
            count,
            vertex_count,
            sample_count,
            info: storage::<Guide>(device, "guide info", count.into())?,
            rest: storage::<PackedGuide>(device, "guide rest", vertices)?,
            current: storage::<[u32; 4]>(device, "guide current", vertices)?,
            velocity: storage::<[u32; 2]>(device, "guide velocity", vertices)?,
            forces: storage::<GuideForce>(device, "guide forces", vertices)?,
            samples: storage::<GuideSample>(device, "guide samples", samples.max(1))?,
            roots: storage::<RootMotion>(device, "guide roots", 1)?,
        })
    }

    /// Adds room for twist ([`SimulationParams::twist`](crate::simulate::SimulationParams::twist)).
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn with_twist(self, context: &Context) -> Result<Self> {
        let Context { device, .. } = context;
        let entries = 2 * u64::from(self.count) * u64::from(self.vertex_count);
        Ok(Self { velocity: storage::<[u32; 2]>(device, "guide velocity", entries)?, ..self })
    }

    /// Returns whether the buffers have room for twist.
    pub fn can_twist(&self) -> bool {
        self.velocity.size()
            > u64::from(self.count) * u64::from(self.vertex_count) * size_of::<[u32; 2]>() as u64
    }

    /// Creates the buffers of another head with the same groom. Rest states and the force buffer are shared; the
    /// current state is not.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn another(&self, context: &Context) -> Result<Self> {
        let Context { device, queue, .. } = context;
        let like = |what, buffer: &wgpu::Buffer| storage::<u8>(device, what, buffer.size());
        let samples = like("guide samples", &self.samples)?;
        // Samples also hold their rest positions: copy them.
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.samples, 0, &samples, 0, samples.size());
        queue.submit([encoder.finish()]);
        Ok(Self {
            info: self.info.clone(),
            rest: self.rest.clone(),
            current: like("guide current", &self.current)?,
            velocity: like("guide velocity", &self.velocity)?,
            forces: self.forces.clone(),
            samples,
            roots: storage::<RootMotion>(device, "guide roots", 1)?,
            ..*self
        })
    }

    /// Bytes of GPU memory that heads share.
    pub(crate) fn shared_bytes(&self) -> u64 {
        self.info.size() + self.rest.size() + self.forces.size()
    }

    /// Returns the number of points of a line along a guide: its samples, or else its vertices.
    pub(crate) fn line_count(&self) -> u32 {
        if self.sample_count == 0 { self.vertex_count } else { self.sample_count }
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        [&self.info, &self.rest, &self.current, &self.velocity, &self.forces, &self.samples, &self.roots]
            .iter()
            .map(|buffer| buffer.size())
            .sum()
    }
}

impl StrandBuffers {
    /// Creates empty buffers.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn new(context: &Context, count: u32, vertex_count: u32) -> Result<Self> {
        let Context { device, .. } = context;
        let vertices = u64::from(count) * u64::from(vertex_count);
        Ok(Self {
            count,
            vertex_count,
            strands: storage::<Strand>(device, "strands", count.into())?,
            bindings: storage::<StrandBinding>(device, "strand bindings", count.into())?,
            rest: storage::<PackedRest>(device, "strand rest", vertices)?,
            vertices: storage::<StrandVertex>(device, "strand vertices", vertices)?,
            widening: storage::<f32>(device, "strand widening", count.into())?,
            roots: storage::<[f32; 4]>(device, "strand roots", 1)?,
            drawn: DrawCount::new(count, vertex_count, f32::INFINITY),
            room: Room { strands: count, vertices: count.saturating_mul(vertex_count) },
        })
    }

    /// Returns the capacity for the whole groom.
    pub fn whole(&self) -> Room {
        Room { strands: self.count, vertices: self.count.saturating_mul(self.vertex_count) }
    }

    /// Creates the buffers of another head with the same groom. Constant data is shared; the rest has the capacity
    /// `room`.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn another(&self, context: &Context, room: Room) -> Result<Self> {
        let Context { device, .. } = context;
        Ok(Self {
            strands: storage::<Strand>(device, "strands", room.strands.into())?,
            vertices: storage::<StrandVertex>(device, "strand vertices", room.vertices.into())?,
            widening: storage::<f32>(device, "strand widening", room.strands.into())?,
            roots: storage::<[f32; 4]>(device, "strand roots", 1)?,
            room,
            ..self.clone()
        })
    }

    /// Bytes of GPU memory that heads share.
    pub(crate) fn shared_bytes(&self) -> u64 {
        self.bindings.size() + self.rest.size()
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        [&self.strands, &self.bindings, &self.rest, &self.vertices, &self.widening, &self.roots]
            .iter()
            .map(|buffer| buffer.size())
            .sum()
    }
}
