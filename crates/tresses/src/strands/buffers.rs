//! The buffers themselves: sizes checked against the adapter's limits before anything is made.

use super::{
    Guide, GuideForce, GuideSample, PackedGuide, PackedRest, RootMotion, Strand, StrandBinding, StrandVertex,
};
use crate::{Context, Error, Result};
use wgpu::BufferUsages;

/// The buffers of the guides, indexed `vertex * count + guide` unless said otherwise.
#[derive(Debug)]
pub struct GuideBuffers {
    /// Number of guides.
    pub count: u32,
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Samples per tessellated guide; 0 where strands [follow](crate::interpolate) guides of their own.
    pub sample_count: u32,
    /// [`Guide`], one per guide.
    pub info: wgpu::Buffer,
    /// [`PackedGuide`].
    pub rest: wgpu::Buffer,
    /// Three floats, the position after the last step from where hair is simulated ([`crate::Hair::place`]), and a word:
    /// how far the position before it was from where this one and the velocity say, by
    /// [`pack_lag`](super::guide::pack_lag).
    pub current: wgpu::Buffer,
    /// Velocity after the last step, metres per second, by [`pack_velocity`](super::guide::pack_velocity); behind those of
    /// all vertices, where hair [can twist](Self::can_twist), by how much each bend is twisted (radians) after the last
    /// step and before it.
    pub velocity: wgpu::Buffer,
    /// [`GuideForce`]: what acts from outside in the next step. Nobody needs it between steps: a groom's
    /// [scratch](crate::Hair) may lie in the same memory, and be larger.
    pub forces: wgpu::Buffer,
    /// [`GuideSample`], indexed `guide * sample_count + sample`.
    pub samples: wgpu::Buffer,
    /// [`RootMotion`], one per guide and one more where roots are on a [living surface](crate::roots), else one that
    /// nobody reads.
    pub roots: wgpu::Buffer,
}

/// The buffers of the drawn strands. A clone names the same buffers.
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
    /// By how much each strand is wider than at full detail, as a fraction: 0 for unchanged, -1 for one that is
    /// not drawn.
    pub widening: wgpu::Buffer,
    /// Where each strand begins (three floats, world space, metres, and one unused), where that is on a
    /// [living surface](crate::roots) between guides; else one that nobody reads.
    pub roots: wgpu::Buffer,
    /// What of it is drawn: less than all where level of detail says so.
    pub drawn: Drawn,
    /// How much `strands`, `vertices` and `widening` have room for: all of it, but for a head that
    /// [shares its groom](crate::Hair::another).
    pub room: Room,
}

/// How many strands, and vertices of them in all, the buffers of one head hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Strands.
    pub strands: u32,
    /// Their vertices, all together.
    pub vertices: u32,
}

impl Room {
    /// Room for at least so many strands and vertices of theirs, at most for `all`: in steps of half an octave, so that
    /// a head that comes nearer seldom moves into other buffers.
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

    /// The room to move into for so much, where this one is too small or more than three times too large.
    pub fn another(&self, need: [u32; 2], all: Self) -> Option<Self> {
        let fits = self.strands >= need[0] && self.vertices >= need[1];
        let room = Self::of(need, all);
        let wastes = self.strands / 3 > room.strands || self.vertices / 3 > room.vertices;
        (!fits || wastes).then_some(room)
    }
}

/// The strands and vertices that the stages after the guides work on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// The first so many strands.
    pub count: u32,
    /// Vertices of each of them.
    pub vertex_count: u32,
    /// Segments of the rest curve that a drawn segment spans; the last one may be shorter.
    pub stride: f32,
    /// What light meets of a strand, as a factor on its width ([`crate::lod::Detail::area`]).
    pub area: f32,
    /// Factors on the fibres before what is seen ([`crate::lod::Detail::deeper`]).
    pub deeper: [f32; 2],
    /// See [`crate::lod::Detail::sunk`], metres.
    pub sunk: f32,
    /// How much of the chance by which single strands are in light or shade is left where each drawn one stands for
    /// several: the root of the share that is drawn.
    pub single: f32,
    /// The mean length of a strand over the area in which strands lie beside each other, 1/m; 0 where nobody knows. Times the
    /// strands and the edge of a texel it is how many lie in a texel of a shadow map.
    pub dense: f32,
    /// How far hair lies so thick that cells of ambient light which are larger than usual make it darker: 0 where they do
    /// not, 1 where light from half a cell of their own ahead makes up for it, at most 2.
    pub packed: f32,
}

impl Drawn {
    /// The first `count` strands, of `vertex_count` rest vertices each, drawn with `segments` segments,
    /// which need not be a whole number.
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

/// Makes a storage buffer for `count` values of `T`, or says that the adapter cannot hold it.
///
/// # Errors
/// [`Error::Limit`].
pub fn storage<T>(device: &wgpu::Device, what: &'static str, count: u64) -> Result<wgpu::Buffer> {
    let need = count.saturating_mul(size_of::<T>() as u64).max(16);
    let limits = device.limits();
    let have = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    if need > have {
        return Err(Error::Limit { what, need, have });
    }
    Ok(device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: need,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    }))
}

/// A storage buffer that holds `bytes`, or says that the adapter cannot hold it.
///
/// # Errors
/// [`Error::Limit`].
pub(crate) fn filled(context: &Context, what: &'static str, bytes: &[u8]) -> Result<wgpu::Buffer> {
    let Context { device, queue, .. } = context;
    let buffer = storage::<u8>(device, what, bytes.len() as u64)?;
    queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

impl GuideBuffers {
    /// Empty buffers.
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

    /// With room for how hair is twisted ([`SimulationParams::twist`](crate::simulate::SimulationParams::twist)).
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn with_twist(self, context: &Context) -> Result<Self> {
        let Context { device, .. } = context;
        let entries = 2 * u64::from(self.count) * u64::from(self.vertex_count);
        Ok(Self { velocity: storage::<[u32; 2]>(device, "guide velocity", entries)?, ..self })
    }

    /// Whether it has that room.
    pub fn can_twist(&self) -> bool {
        self.velocity.size()
            > u64::from(self.count) * u64::from(self.vertex_count) * size_of::<[u32; 2]>() as u64
    }

    /// Of another head with the same groom: where guides rest is shared, and what nobody needs between steps; where they are
    /// is its own.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(crate) fn another(&self, context: &Context) -> Result<Self> {
        let Context { device, queue, .. } = context;
        let like = |what, buffer: &wgpu::Buffer| storage::<u8>(device, what, buffer.size());
        let samples = like("guide samples", &self.samples)?;
        // Where samples rest stands among what changes.
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

    /// Points of a line that shows a guide: its samples, or else its vertices.
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
    /// Empty buffers.
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
            drawn: Drawn::new(count, vertex_count, f32::INFINITY),
            room: Room { strands: count, vertices: count.saturating_mul(vertex_count) },
        })
    }

    /// The room for all of it.
    pub fn whole(&self) -> Room {
        Room { strands: self.count, vertices: self.count.saturating_mul(self.vertex_count) }
    }

    /// Of another head with the same groom: what never changes is shared, the rest has `room`.
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
