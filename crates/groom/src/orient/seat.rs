//! Fits a groom onto a head it was not made for.

use glam::Vec3;

use super::{LengthUnit, Placement, evidence::HairFacts, size};
use crate::{Strands, TriMesh, mesh::bvh::Bvh};

/// Moves and scales `own`, the placement of a groom, so that the roots lie on `mesh`, whose placement is `head`. The
/// axes do not change. The result's reasons state how well the groom fits.
pub fn seat(strands: &Strands, own: Placement, mesh: &TriMesh, head: &Placement) -> Placement {
    let mut mesh = mesh.clone();
    head.apply_to_mesh(&mut mesh);
    let Some(facts) = HairFacts::of(strands).filter(|_| !mesh.triangles.is_empty()) else { return own };
    let bvh = Bvh::new(&mesh);
    let step = (facts.roots.len() / 600).max(1);
    let roots: Vec<Vec3> = facts.roots.iter().step_by(step).map(|p| own.axes() * *p).collect();
    let mut scale = own.unit.0;
    let mut shift = start(&roots, scale, &mesh);
    let mut median = 0.0;
    for _ in 0..24 {
        let mut pairs: Vec<(f32, Vec3, Vec3)> = roots
            .iter()
            .filter_map(|r| {
                let position = *r * scale + shift;
                bvh.closest_point(position).map(|c| (c.distance, *r, c.point))
            })
            .collect();
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        median = pairs.get(pairs.len() / 2).map_or(0.0, |p| p.0);
        // Roots in a band lie off every scalp: ignore the farthest fifth.
        pairs.truncate((pairs.len() * 4 / 5).max(1));
        let n = pairs.len() as f32;
        let from = pairs.iter().map(|p| p.1).sum::<Vec3>() / n;
        let to = pairs.iter().map(|p| p.2).sum::<Vec3>() / n;
        let square: f32 = pairs.iter().map(|p| (p.1 - from).length_squared()).sum();
        let product: f32 = pairs.iter().map(|p| (p.1 - from).dot(p.2 - to)).sum();
        if square > 0.0 && product > 0.0 {
            // Limit the scale: closest points hardly pull towards growth, and heads differ by a quarter at most.
            scale = (product / square).clamp(0.75 * own.unit.0, 1.33 * own.unit.0);
        }
        shift = to - from * scale;
    }
    if !shift.is_finite() {
        return Placement { doubts: vec!["the groom cannot be fitted onto this mesh".into()], ..own };
    }
    let mut placed = Placement { unit: LengthUnit(scale), translation: shift, ..own };
    placed.reasons.push(format!(
        "no unit and orientation puts the roots on this mesh, so the groom is fitted onto it: {:.5} m per unit, moved by {:.3} m, median distance of the roots {:.1} mm",
        scale,
        shift,
        median * 1e3
    ));
    placed
        .doubts
        .push("this groom was made for another head; if it was not, set unit, axes or mirroring".into());
    placed
}

/// Returns the initial translation: the topmost root at the height of the crown, the tops centered on each other.
fn start(roots: &[Vec3], scale: f32, mesh: &TriMesh) -> Vec3 {
    let crown = mesh.positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
    let bounds = |points: &mut dyn Iterator<Item = Vec3>| {
        points.fold((Vec3::MAX, Vec3::MIN), |(lo, hi), p| (lo.min(p), hi.max(p)))
    };
    let cap = crown - 1.2 * size::HALF_BREADTH;
    let (lo, hi) = bounds(&mut mesh.positions.iter().copied().filter(|p| p.y > cap));
    let top = roots.iter().map(|p| p.y * scale).fold(f32::MIN, f32::max);
    let (own_lo, own_hi) =
        bounds(&mut roots.iter().map(|p| *p * scale).filter(|p| p.y > top - 1.2 * size::HALF_BREADTH));
    let between = 0.5 * (lo + hi) - 0.5 * (own_lo + own_hi);
    Vec3::new(between.x, crown - top, between.z)
}
