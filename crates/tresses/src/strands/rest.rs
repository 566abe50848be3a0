//! Guides at rest on the CPU.

use super::{Guide, GuideBuffers, GuideRest, GuideShape, PackedGuide};

use crate::{Context, Error, Result};
use glam::Vec3;

/// Guides at rest, for upload to [`GuideBuffers`]; per-vertex data is vertex-major.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RestGuides {
    /// Vertices per guide.
    pub vertex_count: u32,
    /// Properties, one per guide.
    pub info: Vec<Guide>,
    /// Rest positions and clearances, indexed `vertex * info.len() + guide`.
    pub rest: Vec<GuideRest>,
    /// Rest shapes, with the same index.
    pub shape: Vec<GuideShape>,
}

impl RestGuides {
    /// Writes the buffers: rest, shape, info, and the rest pose as the current state.
    ///
    /// # Errors
    /// [`Error::Groom`] if `buffers` have other counts.
    pub fn upload(&self, context: &Context, buffers: &GuideBuffers) -> Result<()> {
        let Context { queue, .. } = context;
        let counts = (buffers.count as usize, buffers.vertex_count);
        if counts != (self.info.len(), self.vertex_count) {
            return Err(Error::unusable(format!(
                "buffers for {} guides of {} vertices cannot hold {} guides of {}",
                counts.0,
                counts.1,
                self.info.len(),
                self.vertex_count
            )));
        }
        let positions: Vec<[f32; 4]> = self.rest.iter().map(|r| r.position.extend(0.0).into()).collect();
        self.write(context, &buffers.info, &buffers.rest);
        queue.write_buffer(&buffers.current, 0, bytemuck::cast_slice(&positions));
        queue.write_buffer(&buffers.velocity, 0, &vec![0; buffers.velocity.size() as usize]);
        Ok(())
    }

    /// Writes properties and rest state.
    pub(crate) fn write(&self, Context { queue, .. }: &Context, info: &wgpu::Buffer, rest: &wgpu::Buffer) {
        queue.write_buffer(info, 0, bytemuck::cast_slice(&self.info));
        let packed: Vec<_> = (0..self.rest.len()).map(|at| self.packed(at)).collect();
        queue.write_buffer(rest, 0, bytemuck::cast_slice(&packed));
    }

    /// Returns vertex `at` in GPU layout.
    fn packed(&self, at: usize) -> PackedGuide {
        let count = self.info.len();
        let position = |at: usize| self.rest[at].position;
        let (rest, shape, guide) = (&self.rest[at], &self.shape[at], &self.info[at % count]);
        if at + count >= self.rest.len() {
            return PackedGuide::pack(rest, Vec3::ZERO, 0.0, 1.0, guide);
        }
        let edge = position(at + count) - rest.position;
        let give = if at < count {
            Vec3::ZERO
        } else {
            edge - (rest.position - position(at - count)) - shape.curvature
        };
        PackedGuide::pack(rest, give, edge.length() - shape.length, edge.length(), guide)
    }
}
