//! Strokes that move roots.

use super::{
    Brush,
    hair::EditedHair,
    line::SKIN,
    solve::{Solver, rotate_between},
    tools::Dab,
};
use glam::Vec3;

/// Moves the roots under `dabs` over the skin, with their hair.
pub(super) fn slide(hair: &mut EditedHair, brush: &Brush, seed: u32, dabs: &[Dab]) {
    let near = vec![1.0; hair.document.vertex_count()];
    hair.dab(&hair.affected(brush, seed, dabs), |hair, i| {
        let guide = hair.guides.guide(i);
        let weight = |dab: &Dab| dab.near(guide[0], brush) * dab.strength;
        let dab = dabs.iter().reduce(|a, b| if weight(b) > weight(a) { b } else { a })?;
        let offset = dab.motion * weight(dab);
        if offset == Vec3::ZERO {
            return None;
        }
        let (_, before) = hair.ground.nearest(guide[0], SKIN)?;
        let (root, normal) = hair.ground.nearest(guide[0] + offset, SKIN + offset.length())?;
        let line: Vec<Vec3> =
            guide.iter().map(|p| root + rotate_between(*p - guide[0], before, normal)).collect();
        let press = hair.pressed(i);
        let solver = Solver { field: hair.field(), keep_shape: 0.0, keep_volume: 0.0, bend: None };
        Some((solver.solve(&line, &line, &near, 1, &press), press))
    });
}
