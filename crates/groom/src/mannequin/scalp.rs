//! The skin on which hair grows.

use super::{LANDMARKS, SKULL_CENTRE, distance, face, meshing, model, skull};
use crate::{SdfGrid, scalp::GridScalp};
use glam::{Vec3, vec3};

impl GridScalp {
    /// The built-in mannequin, its field sampled at `resolution` nodes along the longest axis.
    pub fn mannequin(resolution: u32) -> Self {
        Self::of_mannequin(model::sdf(resolution))
    }

    /// The built-in mannequin with its field already sampled.
    pub fn of_mannequin(field: SdfGrid) -> Self {
        Self { field, landmarks: LANDMARKS }
    }
}

/// Bare head without features, ears and neck, metres: star-shaped about [`SKULL_CENTRE`].
fn skin(p: Vec3) -> f32 {
    let p = vec3(p.x.abs(), p.y, p.z) * 1000.0;
    face::planes(p, skull::head(p)) * 0.001
}

/// The point (metres) and outward unit normal where the ray from [`SKULL_CENTRE`] along `direction` (of any
/// length) leaves the head; `None` where the head's own skin is not the bust's surface there, that is under
/// the ears, the features and the neck, and for a direction without a length.
pub fn scalp_point(direction: Vec3) -> Option<(Vec3, Vec3)> {
    let direction = direction.try_normalize()?;
    let (mut inside, mut outside) = (0.02, 0.2);
    for _ in 0..12 {
        let middle = 0.5 * (inside + outside);
        if skin(SKULL_CENTRE + direction * middle) < 0.0 { inside = middle } else { outside = middle }
    }
    let mut point = SKULL_CENTRE + direction * (0.5 * (inside + outside));
    if distance(point).abs() > 1e-3 {
        return None;
    }
    // Where ear and neck run out into the head, the surface is a little above the skin: follow it.
    let mut normal = direction;
    for _ in 0..2 {
        let (d, gradient) = meshing::distance_and_gradient(point);
        point -= direction * (d / gradient.dot(direction).max(0.3));
        normal = gradient;
    }
    Some((point, normal.try_normalize()?))
}
