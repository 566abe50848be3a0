//! Scalp of the mannequin.

use super::{LANDMARKS, SKULL_CENTER, distance, face, meshing, model, skull};
use crate::{SdfGrid, scalp::GridScalp};
use glam::{Vec3, vec3};

impl GridScalp {
    /// Returns the scalp of the built-in mannequin, with its field sampled at `resolution` nodes along the longest
    /// axis.
    pub fn mannequin(resolution: u32) -> Self {
        Self::of_mannequin(model::sdf(resolution))
    }

    /// Returns the scalp of the built-in mannequin from its sampled field.
    pub fn of_mannequin(field: SdfGrid) -> Self {
        Self { field, landmarks: LANDMARKS }
    }
}

/// Returns the distance to the bare head without features, ears and neck, meters: star-shaped about [`SKULL_CENTER`].
fn skin(p: Vec3) -> f32 {
    let p = vec3(p.x.abs(), p.y, p.z) * 1000.0;
    face::planes(p, skull::head(p)) * 0.001
}

/// Returns the point (meters) and outward unit normal where the ray from [`SKULL_CENTER`] along `direction` (of any
/// length) leaves the head. Returns `None` where the bare head is not the surface of the bust (under the ears, the
/// features and the neck), and for a direction without a length.
pub fn scalp_point(direction: Vec3) -> Option<(Vec3, Vec3)> {
    let direction = direction.try_normalize()?;
    let (mut inside, mut outside) = (0.02, 0.2);
    for _ in 0..12 {
        let midpoint = 0.5 * (inside + outside);
        if skin(SKULL_CENTER + direction * midpoint) < 0.0 { inside = midpoint } else { outside = midpoint }
    }
    let mut point = SKULL_CENTER + direction * (0.5 * (inside + outside));
    if distance(point).abs() > 1e-3 {
        return None;
    }
    // Where ear and neck blend into the head, the surface is slightly above the bare head: follow it.
    let mut normal = direction;
    for _ in 0..2 {
        let (d, gradient) = meshing::distance_and_gradient(point);
        point -= direction * (d / gradient.dot(direction).max(0.3));
        normal = gradient;
    }
    Some((point, normal.try_normalize()?))
}
