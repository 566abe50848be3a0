//! Fits heads to the size and place of the built-in one, for which hairstyles are designed.

use super::HeadShape;
use crate::{
    Groom, Progress, Result, TriMesh,
    mannequin::SKULL_CENTER,
    mesh::sdf,
    scalp::{GridScalp, Landmarks},
};
use glam::{Quat, Vec3};

/// Depth below the chin to which the body supports hair, meters at the built-in head's size.
const BELOW_CHIN: f32 = 0.25;
/// Distance from the skull to which the body supports hair sideways, meters at the built-in head's size.
const AROUND: f32 = 0.3;

/// Similarity from the built-in head's space to groom space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadFit {
    /// Size relative to the built-in head.
    pub scale: f32,
    /// Translation after scaling, meters.
    pub offset: Vec3,
}

impl HeadFit {
    /// Returns the similarity that maps the skull of the built-in head to the skull of `head`.
    pub fn of(head: &HeadShape) -> Self {
        let scale = head.size();
        Self { scale, offset: head.landmarks.skull - SKULL_CENTER * scale }
    }

    /// Returns the point of the built-in head's space as a point of groom space.
    pub fn point(&self, p: Vec3) -> Vec3 {
        p * self.scale + self.offset
    }

    /// Returns the point of groom space as a point of the built-in head's space.
    fn fitted(&self, p: Vec3) -> Vec3 {
        (p - self.offset) / self.scale
    }

    /// Returns the scalp of `head`, which is part of `mesh`, in the built-in head's space.
    ///
    /// # Errors
    /// As [`sdf::build`].
    pub async fn scalp(
        &self,
        head: &HeadShape,
        mesh: &TriMesh,
        progress: &impl Progress,
    ) -> Result<GridScalp> {
        let Landmarks { skull, brow, chin, ear, nape } = head.landmarks;
        let [skull, brow, chin, ear, nape] = [skull, brow, chin, ear, nape].map(|p| self.fitted(p));
        let landmarks = Landmarks { skull, brow, chin, ear, nape };
        let mut near = mesh.clone();
        near.transform(1.0, Quat::IDENTITY, -self.offset);
        near.transform(1.0 / self.scale, Quat::IDENTITY, Vec3::ZERO);
        let (positions, lowest) = (&near.positions, chin.y - BELOW_CHIN);
        near.triangles.retain(|t| {
            let corners = t.map(|v| positions[v as usize]);
            corners.iter().all(|p| p.y > lowest && (p.x - skull.x).abs() < AROUND)
        });
        let options = sdf::SdfOptions { resolution: 128, ..Default::default() };
        Ok(GridScalp { field: sdf::build_with(&near, &options, progress).await?, landmarks })
    }

    /// Moves `groom` from the built-in head's space to groom space. Widths stay.
    pub fn transform_groom(&self, groom: &mut Groom) {
        groom.guides.positions.iter_mut().for_each(|p| *p = self.point(*p));
        for binding in &mut groom.strands.bindings {
            binding.origin = self.point(binding.origin);
            binding.extent *= self.scale;
        }
    }
}
