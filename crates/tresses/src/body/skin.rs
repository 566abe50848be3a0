//! The vertices of a body that something deforms, as other stages read them.

use super::Body;
use crate::{Error, Result, groom::TriMesh};

/// Where a surface's vertices are in a buffer of floats: words from its beginning, and from one vertex to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Words {
    /// Of the first vertex.
    pub first: u32,
    /// From one vertex to the next, at least 3.
    pub stride: u32,
}

impl Words {
    /// # Errors
    /// [`crate::groom::Error::Unusable`] where `buffer` does not hold the vertices of `mesh` so.
    pub(crate) fn hold(&self, buffer: &wgpu::Buffer, mesh: &TriMesh) -> Result<()> {
        let last = (mesh.positions.len() as u64).saturating_sub(1);
        let need = 4 * (u64::from(self.first) + last * u64::from(self.stride) + 3);
        if self.stride < 3 || buffer.size() < need {
            return Err(Error::unusable(format!(
                "a buffer of {} bytes is too small for the skin's {} vertices",
                buffer.size(),
                mesh.positions.len()
            )));
        }
        Ok(())
    }
}

/// The vertices of a body that bends, in buffers that may be bound as storage. The same buffer may be both.
#[derive(Clone, Copy, Debug)]
pub struct Skin<'a> {
    /// Three floats for each vertex, metres.
    pub positions: (&'a wgpu::Buffer, Words),
    /// Three floats for each vertex, of any length.
    pub normals: (&'a wgpu::Buffer, Words),
}

impl<'a> From<&'a Body> for Skin<'a> {
    fn from(body: &'a Body) -> Self {
        let [position, normal] = [0, 3].map(|first| (body.vertices(), Words { first, stride: Body::WORDS }));
        Self { positions: position, normals: normal }
    }
}
