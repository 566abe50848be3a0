//! Which strand a pixel shows most of: labels for pictures that something is to learn from.

use super::geometry::FORMAT;
use crate::{
    draw::record::Canvas,
    gpu::{Kernel, commands::bytes},
};

/// What a pixel shows most of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// Which of the picture's grooms, in the order in which they were given.
    pub groom: u32,
    /// Which of its strands.
    pub strand: u32,
    /// The vertex that begins the segment.
    pub vertex: u32,
    /// Where between that vertex (0) and the next (1) the pixel meets it.
    pub along: f32,
    /// The segment's share of the pixel, 0 to 1.
    pub share: f32,
}

/// Which points belong to a groom: its first, and its strands and their vertices in the last picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Owner {
    pub first: u32,
    pub count: u32,
    pub vertex_count: u32,
}

impl Label {
    /// What a texel of the kernel says.
    pub(crate) fn read([low, rest, along, share]: [f32; 4], owners: &[Owner]) -> Option<Self> {
        if share <= 0.0 {
            return None;
        }
        let id = low as u32 | (rest as u32) << 12;
        let groom = owners.iter().rposition(|owner| owner.first <= id)?;
        let Owner { first, count, vertex_count } = owners[groom];
        let (own, each) = (id - first, vertex_count.max(1));
        let strand = own / each;
        (strand < count).then_some(Self { groom: groom as u32, strand, vertex: own % each, along, share })
    }
}

/// The texture that the kernel writes.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    pub texture: wgpu::TextureView,
    pub group: wgpu::BindGroup,
    /// Whose points those of the last picture are; none where it did not ask.
    pub owners: Vec<Owner>,
}

impl Labels {
    /// The kernel's resources are `of_rows`, the texture, and `round`.
    pub fn new(
        kernel: &Kernel,
        canvas: &Canvas<'_, '_>,
        of_rows: &[wgpu::BindingResource<'_>],
        round: wgpu::BindingResource<'_>,
    ) -> Self {
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let texture = canvas.targets.texture()(("labels of hair", FORMAT, usage));
        let texture = texture.create_view(&Default::default());
        let own = [wgpu::BindingResource::TextureView(&texture), round];
        let group = kernel.bind(&of_rows.iter().cloned().chain(own).collect::<Vec<_>>());
        Self { texture, group, owners: Vec::new() }
    }

    /// A picture begins whose points are those of `owners`; of one that does not ask, nobody's.
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
    fn numbers_of_points_are_strands_of_grooms() {
        let owners = [
            Owner { first: 0, count: 3, vertex_count: 16 },
            Owner { first: 2048, count: 5000, vertex_count: 20 },
        ];
        let read = |id: u32, share| Label::read([(id & 4095) as f32, (id >> 12) as f32, 0.5, share], &owners);
        let label = |groom, strand, vertex| Some(Label { groom, strand, vertex, along: 0.5, share: 0.25 });
        assert_eq!(read(0, 0.25), label(0, 0, 0));
        assert_eq!(read(47, 0.25), label(0, 2, 15));
        assert_eq!(read(2048, 0.25), label(1, 0, 0));
        assert_eq!(read(2048 + 4999 * 20 + 3, 0.25), label(1, 4999, 3));
        // Of nothing, and of what is in no groom.
        for (id, share) in [(0, 0.0), (48, 0.25), (2048 + 5000 * 20, 0.25)] {
            assert_eq!(read(id, share), None);
        }
    }
}
