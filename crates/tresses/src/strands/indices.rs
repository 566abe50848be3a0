//! Index buffers of strips.

use std::ops::Range;

/// Number of vertices that a 16-bit index can address.
const ADDRESSABLE_VERTICES: u32 = 1 << 16;

/// Index buffer for as many strands as 16 bits can address, drawn repeatedly with different base vertices. One list
/// stays in the cache. Indices for a whole groom would take twice the memory of its vertices, and instances of one
/// strand leave GPUs idle.
#[derive(Debug)]
pub(crate) struct Chunks {
    indices: wgpu::Buffer,
    strands_per_chunk: u32,
    indices_per_strand: u32,
    vertices_per_strand: u32,
}

impl Chunks {
    fn new(device: &wgpu::Device, count: u32, strand: &[u16], vertices_per_strand: u32) -> Self {
        let strands_per_chunk = (ADDRESSABLE_VERTICES / vertices_per_strand).min(count).max(1);
        let list: Vec<u16> = (0..strands_per_chunk)
            .flat_map(|i| strand.iter().map(move |index| (i * vertices_per_strand) as u16 + index))
            .collect();
        use wgpu::util::DeviceExt;
        // Copies into buffers are multiples of four bytes.
        let mut bytes = bytemuck::cast_slice::<_, u8>(&list).to_vec();
        bytes.resize(bytes.len().next_multiple_of(4).max(4), 0);
        let indices = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("strand indices"),
            contents: &bytes,
            usage: wgpu::BufferUsages::INDEX,
        });
        Self { indices, strands_per_chunk, indices_per_strand: strand.len() as u32, vertices_per_strand }
    }

    /// Creates the indices for strips of strands with `vertex_count` vertices, one strip after the other.
    pub fn of(device: &wgpu::Device, count: u32, vertex_count: u32) -> Self {
        let strip: Vec<u16> = (0..vertex_count.saturating_sub(1) as u16)
            .flat_map(|i| [0, 1, 2, 2, 1, 3].map(|corner| 2 * i + corner))
            .collect();
        Self::new(device, count, &strip, 2 * vertex_count.max(1))
    }

    /// Records the strips of `strands`.
    pub fn record(&self, pass: &mut crate::gpu::RenderPass<'_>, strands: Range<u32>) {
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        for first in strands.clone().step_by(self.strands_per_chunk as usize) {
            let strands = self.strands_per_chunk.min(strands.end - first);
            let base = (first * self.vertices_per_strand) as i32;
            pass.draw_indexed(0..strands * self.indices_per_strand, base, 0..1);
        }
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.indices.size()
    }
}
