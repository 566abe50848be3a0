//! Strokes that paint: widths, colors, clumps, curls and frizz of strands, stiffness of guides.

use super::{
    Brush, BrushTool, GroomDocument, brush::chance, hair::EditedHair, painted_values::PaintedValues,
    posed_guides::sphere, tools::Dab,
};
use crate::{
    bound::strand::{pack_color, unpack_color},
    restyle::painted::StrandShape,
    srgb::linear,
};
use glam::Vec3;

/// Change of width and stiffness per dab.
const CHANGE: f32 = 0.1;
/// Smallest and largest width and stiffness, relative to those before the first stroke.
const RANGE: (f32, f32) = (0.2, 5.0);
/// Change of clumps, curls and frizz per dab, of 255.
const AMOUNT: f32 = 40.0;
/// Share of the way to a color per dab.
const TINT: f32 = 0.3;

/// Painted values in a stroke.
#[derive(Debug)]
pub(super) struct PaintStroke {
    pub painted_values: PaintedValues,
    /// Whether they differ from those before.
    is_changed: bool,
    /// Each strand at the press, with a sphere around it; empty unless the tool paints strands.
    lines: Vec<((Vec3, f32), Vec<Vec3>)>,
}

impl PaintStroke {
    pub fn new(brush: &Brush, hair: &EditedHair) -> Self {
        let lines = match brush.tool.paints_strands() {
            true => hair.map_strands(|line| (sphere(line), line.to_vec())),
            false => Vec::new(),
        };
        Self { painted_values: hair.painted_values.clone(), is_changed: false, lines }
    }

    /// Paints strands or guides under `dabs`. `seed` is the seed of the stroke.
    pub fn dab(&mut self, hair: &EditedHair, brush: &Brush, seed: u32, dabs: &[Dab]) {
        let Self { painted_values, is_changed, lines } = self;
        let influence = |dab: &Dab| (dab.overlap_test(brush.region), dab.falloff(brush), dab.strength);
        let influences: Vec<_> = dabs.iter().map(influence).collect();
        let weight = |sphere: (Vec3, f32), line: &[Vec3]| {
            let overlapping = influences.iter().filter(|(overlaps, ..)| overlaps(sphere));
            let max_falloff = |near: &dyn Fn(Vec3) -> f32| line.iter().map(|p| near(*p)).fold(0.0, f32::max);
            overlapping.map(|(_, near, strength)| max_falloff(near) * strength).fold(0.0, f32::max)
        };
        let changed = |value: f32, first: f32, weight: f32| {
            let factor = 1.0 + CHANGE * weight;
            let after = if brush.inverted { value / factor } else { value * factor };
            after.clamp(first * RANGE.0, first * RANGE.1)
        };
        if !brush.tool.paints_strands() {
            for i in (0..hair.guides.len()).filter(|i| hair.is_open(brush, *i)) {
                let weight = weight(hair.guides.spheres[i], hair.guides.guide(i));
                let (stiffness, held) = (&mut painted_values.stiffness[i], &mut painted_values.held[i]);
                if weight <= 0.0 || brush.tool == BrushTool::Hold && *held != brush.inverted {
                    continue;
                }
                *is_changed = true;
                match brush.tool {
                    BrushTool::Hold => *held = !brush.inverted,
                    _ => *stiffness = changed(*stiffness, hair.base.guides.stiffness[i], weight),
                }
            }
            return;
        }
        let color = Vec3::from(brush.color.map(linear));
        if brush.tool.paints_shapes() && painted_values.shapes.is_empty() {
            painted_values.shapes = vec![StrandShape::default(); painted_values.strands.len()];
        }
        let base = &hair.base.strands;
        let strands = painted_values.strands.iter_mut().zip(&base.bindings).zip(&base.strands);
        for (i, (((strand, binding), first), (sphere, line))) in strands.zip(lines).enumerate() {
            let weight = weight(*sphere, line);
            if weight <= 0.0 || !hair.is_open(brush, binding.guides[0] as usize) {
                continue;
            }
            *is_changed = true;
            if brush.tool == BrushTool::Width {
                strand.radius = changed(strand.radius, first.radius, weight);
                continue;
            }
            if brush.tool.paints_shapes() {
                let shape = &mut painted_values.shapes[i];
                let amount = match brush.tool {
                    BrushTool::Clump => &mut shape.clump,
                    BrushTool::Curl => &mut shape.curl,
                    _ => &mut shape.frizz,
                };
                let step = (AMOUNT * weight).round() as u8;
                *amount =
                    if brush.inverted { amount.saturating_sub(step) } else { amount.saturating_add(step) };
                if brush.tool == BrushTool::Curl && !brush.inverted {
                    shape.curls = brush.curls as u8;
                }
                continue;
            }
            if brush.inverted {
                (strand.root_color, strand.tip_color) = (first.root_color, first.tip_color);
                continue;
            }
            // The pigment of strands without a color is not known here, so a random share of them takes the color
            // whole.
            let chance = chance(seed, i as u32);
            let mixed = |now: u32, fraction: f32| match unpack_color(now) {
                Some(now) => pack_color(now.lerp(color, (TINT * weight * fraction).min(1.0))),
                None if chance < weight * fraction => pack_color(color),
                None => 0,
            };
            let tip = if strand.tip_color == 0 { strand.root_color } else { strand.tip_color };
            strand.root_color = mixed(strand.root_color, brush.along(0.0));
            strand.tip_color = mixed(tip, brush.along(1.0));
        }
    }

    /// Returns `document` with the painted values; `None` without changes.
    pub fn applied(&self, document: &GroomDocument) -> Option<GroomDocument> {
        self.is_changed.then(|| document.with_painted_values(self.painted_values.clone()))
    }
}
