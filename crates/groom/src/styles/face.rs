//! Region in front of the face that hair does not enter.

use crate::scalp::{Landmarks, Scalp};
use glam::Vec3;

/// An ellipsoidal region in front of the face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Center, meters.
    pub center: Vec3,
    /// Half the width, height and depth, meters.
    pub radii: Vec3,
}

impl Face {
    /// Creates the region for a head's landmarks, from above the brows to the chin.
    pub fn new(scalp: &dyn Scalp) -> Self {
        let Landmarks { brow, chin, .. } = scalp.landmarks();
        let height = 0.5 * (brow.y - chin.y) + 0.03;
        let center = Vec3::new(0.0, 0.5 * (brow.y + chin.y) - 0.01, brow.z + 0.01);
        Self { center, radii: Vec3::new(0.055, height, 0.06) }
    }

    /// Returns the depth of `p` inside, 0 at the edge or outside and 1 in the middle.
    pub fn depth(&self, p: Vec3) -> f32 {
        (1.0 - ((p - self.center) / self.radii).length()).max(0.0)
    }

    /// Returns a lower bound of the distance from `p` to the region, meters.
    pub fn distance_bound(&self, p: Vec3) -> f32 {
        ((((p - self.center) / self.radii).length() - 1.0) * self.radii.min_element()).max(0.0)
    }

    /// Returns the direction of the nearest way out that does not lead up or down: to the side, and a little back.
    pub fn sideways_direction(&self, p: Vec3, side: f32) -> Vec3 {
        let sign = if p.x.abs() > 0.004 { p.x.signum() } else { side };
        Vec3::new(sign, 0.0, -0.35).normalize()
    }

    /// Returns `p`, moved sideways to the edge of the region if it is inside.
    pub fn clear(&self, p: Vec3, side: f32) -> Vec3 {
        let q = (p - self.center) / self.radii;
        let across = 1.0 - q.y * q.y - q.z * q.z;
        if self.depth(p) <= 0.0 || across <= 0.0 {
            return p;
        }
        let sign = if p.x.abs() > 0.004 { p.x.signum() } else { side };
        Vec3::new(sign * across.sqrt() * self.radii.x * 1.001, p.y, p.z)
    }
}
