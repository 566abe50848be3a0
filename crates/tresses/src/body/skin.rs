//! Vertices of a deformed body, as other stages read them.

use super::Body;
use crate::{Error, Result, groom::TriMesh};

/// Layout of vertices in a buffer of floats, in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Words {
    /// Offset of the first vertex.
    pub first: u32,
    /// Distance between vertices, at least 3.
    pub stride: u32,
}

impl Words {
    /// # Errors
    /// [`crate::groom::Error::Unusable`] if `buffer` is too small for the vertices of `mesh` in this layout.
    pub(crate) fn hold(&self, buffer: &wgpu::Buffer, mesh: &TriMesh) -> Result<()> {
        let last = (mesh.positions.len() as u64).saturating_sub(1);
        let need = 4 * (u64::from(self.first) + last * u64::from(self.stride) + 3);
        if self.stride < 3 || buffer.size() < need {
            return Err(Error::unusable(format!(
                "a buffer of {} bytes is too small for the {} vertices of the mesh",
                buffer.size(),
                mesh.positions.len()
            )));
        }
        Ok(())
    }
}

/// Vertices of a deformed body, in buffers with storage usage. Both can be the same buffer.
#[derive(Clone, Copy, Debug)]
pub struct Skin<'a> {
    /// Positions: three floats per vertex, meters.
    pub positions: (&'a wgpu::Buffer, Words),
    /// Normals: three floats per vertex, of any length.
    pub normals: (&'a wgpu::Buffer, Words),
}

impl<'a> From<&'a Body> for Skin<'a> {
    fn from(body: &'a Body) -> Self {
        let [position, normal] =
            [0, 3].map(|first| (body.vertex_buffer(), Words { first, stride: Body::WORDS }));
        Self { positions: position, normals: normal }
    }
}
