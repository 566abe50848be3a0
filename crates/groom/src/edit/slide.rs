//! Strokes that move roots.

use super::{
    GroomEditor,
    editor::MovedGuide,
    line::SKIN,
    solve::{Solver, turned},
    tools::Dab,
};
use glam::Vec3;

impl GroomEditor {
    /// Moves roots over the skin, with their hair.
    pub(super) fn slide(&mut self, dabs: &[Dab]) {
        let Some(stroke) = &self.stroke else { return };
        let (brush, field) = (&stroke.brush, self.ground.field.as_deref());
        let solver = Solver { field, keep_shape: 0.0, keep_volume: 0.0, bend: None };
        let near = vec![1.0; self.document.vertex_count()];
        let moved = self.changed(&self.under(stroke, dabs), |i| {
            let guide = self.guide(i);
            let weight = |dab: &Dab| dab.near(guide[0], brush) * dab.strength;
            let dab = dabs.iter().reduce(|a, b| if weight(b) > weight(a) { b } else { a })?;
            let way = dab.motion * weight(dab);
            if way == Vec3::ZERO {
                return None;
            }
            let reach = SKIN + way.length();
            let (_, before) = self.ground.nearest(guide[0], SKIN)?;
            let (root, normal) = self.ground.nearest(guide[0] + way, reach)?;
            let line: Vec<Vec3> =
                guide.iter().map(|p| root + turned(*p - guide[0], before, normal)).collect();
            let press = self.pressed(stroke, i);
            let vertices = solver.solve(&line, &line, &near, 1, &press);
            Some(MovedGuide { vertices, press, growth: 1.0 })
        });
        self.take(moved);
    }
}
