//! Strand labels: which strand covers most of each pixel, as training data.

use super::geometry::FORMAT;
use crate::{
    draw::canvas::Canvas,
    gpu::{Kernel, commands::bytes},
    shaders::kernels::draw::tiles as kernels,
};

/// The strand segment that covers most of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Label {
    /// Index of the groom among those that were drawn.
    pub groom: u32,
    /// Index of the strand in the groom.
    pub strand: u32,
    /// First vertex of the segment.
    pub vertex: u32,
    /// Position of the pixel between that vertex (0) and the next (1).
    pub along: f32,
    /// Share of the pixel that the segment covers, 0 to 1.
    pub coverage: f32,
}

/// Points of a groom: the first one, and the strand and vertex counts of the last frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Owner {
    pub first: u32,
    pub count: u32,
    pub vertex_count: u32,
}

impl Label {
    /// Decodes a texel that the kernel wrote.
    pub(crate) fn read([low, rest, along, coverage]: [f32; 4], owners: &[Owner]) -> Option<Self> {
        if coverage <= 0.0 {
            return None;
        }
        let id = low as u32 | (rest as u32) << 12;
        let groom = owners.iter().rposition(|owner| owner.first <= id)?;
        let Owner { first, count, vertex_count } = owners[groom];
        let (own, each) = (id - first, vertex_count.max(1));
        let strand = own / each;
        (strand < count).then_some(Self { groom: groom as u32, strand, vertex: own % each, along, coverage })
    }
}

/// Output of the label kernel.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    pub texture: wgpu::TextureView,
    pub group: wgpu::BindGroup,
    /// Owners of the last frame's points; empty if it did not request labels.
    pub owners: Vec<Owner>,
}

impl Labels {
    /// Creates the output of the kernel, which reads the tiles of `fine`.
    pub fn new(kernel: &Kernel, canvas: &Canvas<'_, '_>, fine: kernels::Fine<'_>) -> Self {
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let texture = canvas.target.texture()(("labels of hair", FORMAT, usage));
        let texture = texture.create_view(&Default::default());
        let group = kernel.bind(&kernels::Label { fine, labels: &texture });
        Self { texture, group, owners: Vec::new() }
    }

    /// Begins a frame with the points of `owners`, which is empty if labels are not requested.
    pub fn begin(&mut self, canvas: &mut Canvas<'_, '_>, owners: Vec<Owner>) {
        if !owners.is_empty() {
            canvas.commands.clear_texture("no labels", &self.texture);
        }
        self.owners = owners;
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        bytes(self.texture.texture())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_map_point_numbers_to_strands() {
        let owners = [
            Owner { first: 0, count: 3, vertex_count: 16 },
            Owner { first: 2048, count: 5000, vertex_count: 20 },
        ];
        let read = |id: u32, share| Label::read([(id & 4095) as f32, (id >> 12) as f32, 0.5, share], &owners);
        let label = |groom, strand, vertex| Some(Label { groom, strand, vertex, along: 0.5, coverage: 0.25 });
        assert_eq!(read(0, 0.25), label(0, 0, 0));
        assert_eq!(read(47, 0.25), label(0, 2, 15));
        assert_eq!(read(2048, 0.25), label(1, 0, 0));
        assert_eq!(read(2048 + 4999 * 20 + 3, 0.25), label(1, 4999, 3));
        // Without coverage, or outside all grooms.
        for (id, share) in [(0, 0.0), (48, 0.25), (2048 + 5000 * 20, 0.25)] {
            assert_eq!(read(id, share), None);
        }
    }
}
