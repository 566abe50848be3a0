//! Guesses the unit of a file from the size of a human head.

use glam::{Mat3, Vec3};

use super::LengthUnit;
use crate::TriMesh;

/// Half the breadth of the rooted area of a human head, meters.
pub(super) const HALF_BREADTH: f32 = 0.08;
/// Length of an animal with fur, meters.
const BODY: std::ops::RangeInclusive<f32> = 0.1..=5.0;
/// Crown to chin of a human head, meters.
pub(super) const HEAD_HEIGHT: f32 = 0.22;

/// Returns the known unit in which `measured` units are about `real` meters, or else the unit in which they are exactly
/// that; and whether it is a known one.
pub(super) fn unit(measured: f32, real: f32) -> (LengthUnit, bool) {
    let scale = real / measured;
    // Broken files give lengths that no head has. Any valid unit will do.
    let scale = if scale.is_finite() { scale.clamp(1e-9, 1e9) } else { 1.0 };
    let near = |meters: f32| (meters / scale).max(scale / meters);
    let metric = &LengthUnit::KNOWN[..4];
    // Heads differ by less than this factor. Inches and feet are too close to other units to be guessed.
    match metric.iter().find(|(_, meters)| near(*meters) < 1.4) {
        Some((_, meters)) => (LengthUnit(*meters), true),
        None => (LengthUnit(scale), false),
    }
}

/// Returns the first known metric unit in which an animal may be `measured` units long.
pub(super) fn unit_of_body(measured: f32) -> Option<LengthUnit> {
    let fits = |meters: f32| BODY.contains(&(measured * meters));
    LengthUnit::KNOWN[..4].iter().find(|(_, meters)| fits(*meters)).map(|(_, meters)| LengthUnit(*meters))
}

/// Crown and chin of a head, in the mesh's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeadSize {
    /// Height of the highest point.
    pub crown: f32,
    /// Height from crown to chin.
    pub height: f32,
}

/// Finds crown and chin on the profile, the line of the foremost points in the middle from the crown down. It stays at
/// the face's depth and recedes under the chin. `axes` rotates the mesh upright.
///
/// `half_breadth` is measured on the rooted area. Without hair, the function measures the skull from the top: a ball's
/// half breadth at a depth of its radius equals the radius.
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
    let center = 0.5 * (lo + hi);
    const BINS: usize = 48;
    let depth = 4.0 * breadth;
    let mut profile = [f32::MIN; BINS];
    for p in points.iter().filter(|p| (p.x - center.x).abs() < 0.3 * breadth) {
        let bin = ((crown - p.y) / depth * BINS as f32) as usize;
        if let Some(front) = profile.get_mut(bin) {
            *front = front.max(p.z - center.z);
        }
    }
    let face = profile[..BINS * 3 / 4].iter().copied().fold(f32::MIN, f32::max);
    // The chin is below the eyes, where the profile first recedes behind 62 % of the face's depth.
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
        assert_eq!(unit(0.085, HALF_BREADTH), (LengthUnit(1.0), true));
        assert_eq!(unit(8.3, HALF_BREADTH), (LengthUnit(0.01), true));
        let (free, known) = unit(24.0, HALF_BREADTH);
        assert!(!known && (free.0 - 0.08 / 24.0).abs() < 1e-6);
        assert_eq!([1.2, 120.0, 1200.0].map(unit_of_body), [1.0, 0.01, 0.001].map(|m| Some(LengthUnit(m))));
        assert_eq!(unit_of_body(1e9), None);
    }
}
