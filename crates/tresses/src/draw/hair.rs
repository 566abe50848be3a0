//! One groom, ready to be drawn: index buffers, the shaded values, bind groups.

use super::DrawStage;
use crate::{
    Result,
    light::{fiber::FiberTables, material::HairUniform},
    strands::{Drawn, StrandBuffers, buffers::storage},
};
use std::collections::BTreeMap;

/// The most vertices that a 16-bit index reaches.
const REACH: u32 = 1 << 16;

/// A list of indices for as many strands as 16 bits reach, drawn again and again with another
/// base vertex. One list costs nothing to keep in a cache; indices for a whole groom would be
/// twice the memory of its vertices, and instances of one strand leave GPUs idle.
#[derive(Debug)]
struct Chunks {
    indices: wgpu::Buffer,
    strands_per_chunk: u32,
    indices_per_strand: u32,
    vertices_per_strand: u32,
}

impl Chunks {
    fn new(device: &wgpu::Device, count: u32, strand: &[u16], vertices_per_strand: u32) -> Self {
        let strands_per_chunk = (REACH / vertices_per_strand).min(count).max(1);
        let list: Vec<u16> = (0..strands_per_chunk)
            .flat_map(|i| strand.iter().map(move |index| (i * vertices_per_strand) as u16 + index))
            .collect();
        use wgpu::util::DeviceExt;
        // Copies into buffers come in fours of bytes.
        let mut bytes = bytemuck::cast_slice::<_, u8>(&list).to_vec();
        bytes.resize(bytes.len().next_multiple_of(4).max(4), 0);
        let indices = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("strand indices"),
            contents: &bytes,
            usage: wgpu::BufferUsages::INDEX,
        });
        Self { indices, strands_per_chunk, indices_per_strand: strand.len() as u32, vertices_per_strand }
    }

    /// For strips of strands with `vertex_count` vertices, strip after strip.
    fn of(device: &wgpu::Device, count: u32, vertex_count: u32) -> Self {
        let strip: Vec<u16> = (0..vertex_count.saturating_sub(1) as u16)
            .flat_map(|i| [0, 1, 2, 2, 1, 3].map(|corner| 2 * i + corner))
            .collect();
        Self::new(device, count, &strip, 2 * vertex_count.max(1))
    }

    fn record(&self, pass: &mut wgpu::RenderPass<'_>, count: u32) {
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        for first in (0..count).step_by(self.strands_per_chunk as usize) {
            let strands = self.strands_per_chunk.min(count - first);
            let base = (first * self.vertices_per_strand) as i32;
            pass.draw_indexed(0..strands * self.indices_per_strand, base, 0..1);
        }
    }
}

/// A groom as the drawing stages need it. It reads the [`StrandBuffers`] it was made for.
#[derive(Debug)]
pub struct HairSet {
    /// What of the strands is drawn.
    pub drawn: Drawn,
    /// Strands and their vertices at full detail.
    full_count: u32,
    pub(crate) rest_count: u32,
    /// By their number of vertices, made when a level of detail first asks for it.
    strips: BTreeMap<u32, Chunks>,
    /// Stride and number of the segments in the shadow maps.
    pub(crate) splat: [u32; 2],
    pub(crate) uniform: wgpu::Buffer,
    shaded: wgpu::Buffer,
    pub(crate) group: wgpu::BindGroup,
    pub(crate) fiber: FiberTables,
    pub(crate) shade_group: wgpu::BindGroup,
    pub(crate) splat_group: wgpu::BindGroup,
    pub(crate) ambient_group: wgpu::BindGroup,
}

impl HairSet {
    /// Prepares `strands` to be drawn by `stage`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(device: &wgpu::Device, stage: &DrawStage, strands: &StrandBuffers) -> Result<Self> {
        let (count, vertex_count) = (strands.count, strands.vertex_count);
        let vertices = u64::from(count) * u64::from(vertex_count);
        if vertices * 2 > i32::MAX as u64 {
            return Err(crate::Error::Limit {
                what: "strand vertices",
                need: vertices * 32,
                have: i32::MAX as u64 * 16,
            });
        }
        let shaded = storage::<[u32; 2]>(device, "shaded strands", vertices)?;
        let uniform = crate::gpu::bindings::uniform(device, "hair", size_of::<HairUniform>());
        let mut set = Self {
            drawn: strands.drawn,
            full_count: count,
            rest_count: vertex_count,
            strips: BTreeMap::new(),
            splat: [1; 2],
            fiber: FiberTables::new(device, stage.fiber_layout()),
            splat_group: stage.bind_splat(device, &uniform, strands),
            ambient_group: stage.bind_ambient(device, &uniform, strands),
            group: stage.bind_hair(device, &uniform, strands, &shaded),
            shade_group: stage.bind_shade(device, &uniform, strands, &shaded),
            uniform,
            shaded,
        };
        set.show(device, &strands.drawn);
        Ok(set)
    }

    /// From here on only what `drawn` says of the strands it was made for is shaded, splatted and drawn.
    pub(crate) fn show(&mut self, device: &wgpu::Device, drawn: &Drawn) {
        self.drawn = *drawn;
        // The maps' texels are coarse: about eight segments per strand are enough.
        let last = drawn.vertex_count.saturating_sub(1).max(1);
        let stride = (last / 8).max(1);
        self.splat = [stride, last.div_ceil(stride)];
        let count = self.full_count;
        self.strips
            .entry(drawn.vertex_count)
            .or_insert_with(|| Chunks::of(device, count, drawn.vertex_count));
    }

    /// What `light::shade` wrote: four half floats per strand vertex, radiance and the radius in
    /// millimetres, or, when pixels are shaded, eight bytes of what arrives of the light.
    pub fn shaded(&self) -> &wgpu::Buffer {
        &self.shaded
    }

    /// Bytes of GPU memory, without the strands' own buffers.
    pub fn bytes(&self) -> u64 {
        self.shaded.size()
            + self.fiber.bytes()
            + self.uniform.size()
            + self.strips.values().map(|chunks| chunks.indices.size()).sum::<u64>()
    }

    /// Triangles of the strips.
    pub fn triangles(&self) -> u64 {
        u64::from(self.drawn.count) * 2 * u64::from(self.drawn.vertex_count.saturating_sub(1))
    }

    pub(crate) fn record_strips(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_bind_group(2, &self.fiber.group, &[]);
        if let Some(strips) = self.strips.get(&self.drawn.vertex_count) {
            strips.record(pass, self.drawn.count);
        }
    }
}
