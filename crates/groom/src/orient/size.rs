//! How large a unit is, from the size of a human head.

use glam::{Mat3, Vec3};

use super::Unit;
use crate::TriMesh;

/// Half the breadth of the rooted area of a human head, metres.
pub(super) const HALF_BREADTH: f32 = 0.08;
/// Crown to chin of a human head, metres.
pub(super) const HEAD_HEIGHT: f32 = 0.22;

/// The known unit that makes a length of `measured` units about `real` metres, or the scale that makes
/// it exactly that; and whether it is a known one.
pub(super) fn unit(measured: f32, real: f32) -> (Unit, bool) {
    let scale = real / measured;
    // Broken files hold numbers that no head has; any unit will do, but it must be one.
    let scale = if scale.is_finite() { scale.clamp(1e-9, 1e9) } else { 1.0 };
    let near = |metres: f32| (metres / scale).max(scale / metres);
    let metric = &Unit::KNOWN[..4];
    // Heads differ by less than these factors; inches and feet lie too close to others to be guessed.
    match metric.iter().find(|(_, metres)| near(*metres) < 1.4) {
        Some((_, metres)) => (Unit(*metres), true),
        None => (Unit(scale), false),
    }
}

/// Crown and chin of a head, in the mesh's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeadSize {
    /// The highest point.
    pub crown: f32,
    /// Crown to chin.
    pub height: f32,
}

/// Finds crown and chin on the profile: the line of the foremost points at the middle, from the crown
/// down, stays at the face's depth and steps back under the chin. `axes` turns the mesh upright.
///
/// Without hair the skull's breadth comes from the top: a ball's half breadth at a depth of its
/// radius is its radius.
pub(super) fn head(mesh: &TriMesh, axes: Mat3, half_breadth: Option<f32>) -> Option<HeadSize> {
    let points: Vec<Vec3> = mesh.positions.iter().map(|p| axes * *p).collect();
    let crown = points.iter().map(|p| p.y).fold(f32::MIN, f32::max);
    let breadth = half_breadth.or_else(|| skull_radius(&points, crown))?;
    if !(breadth > 0.0 && breadth.is_finite()) {
        return None;
    }
    let top: Vec<&Vec3> = points.iter().filter(|p| p.y > crown - 2.0 * breadth).collect();
    let (mut lo, mut hi) = (Vec3::MAX, Vec3::MIN);
    for p in top.iter().filter(|p| p.y > crown - 1.2 * breadth) {
        lo = lo.min(**p);
        hi = hi.max(**p);
    }
    let middle = 0.5 * (lo + hi);
    const BINS: usize = 48;
    let depth = 4.0 * breadth;
    let mut profile = [f32::MIN; BINS];
    for p in points.iter().filter(|p| (p.x - middle.x).abs() < 0.3 * breadth) {
        let bin = ((crown - p.y) / depth * BINS as f32) as usize;
        if let Some(front) = profile.get_mut(bin) {
            *front = front.max(p.z - middle.z);
        }
    }
    let face = profile[..BINS * 3 / 4].iter().copied().fold(f32::MIN, f32::max);
    // Below the eyes at the earliest, and where the profile lies behind the face's middle depth.
    let chin = (BINS * 9 / 20..BINS).find(|i| profile[*i] > f32::MIN && profile[*i] < 0.62 * face)?;
    let height = depth * chin as f32 / BINS as f32;
    Some(HeadSize { crown, height })
}

fn skull_radius(points: &[Vec3], crown: f32) -> Option<f32> {
    let mut depths: Vec<(f32, Vec3)> = points.iter().map(|p| (crown - p.y, *p)).collect();
    depths.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let (mut lo, mut hi) = (Vec3::MAX, Vec3::MIN);
    for (depth, p) in depths {
        lo = lo.min(p);
        hi = hi.max(p);
        let half = 0.25 * ((hi.x - lo.x) + (hi.z - lo.z));
        if depth > 0.0 && half > 0.0 && depth >= half {
            return Some(depth);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_units_snap_and_others_scale() {
        assert_eq!(unit(0.085, HALF_BREADTH), (Unit(1.0), true));
        assert_eq!(unit(8.3, HALF_BREADTH), (Unit(0.01), true));
        let (free, known) = unit(24.0, HALF_BREADTH);
        assert!(!known && (free.0 - 0.08 / 24.0).abs() < 1e-6);
    }
}
