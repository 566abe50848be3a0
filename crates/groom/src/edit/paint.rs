//! Strokes that paint: widths, colors, clumps, curls and frizz of strands, stiffness of guides.

use super::{BrushTool, GroomDocument, GroomEditor, editor::ActiveStroke, tools::Dab};
use crate::{
    bound::strand::{pack_color, unpack_color},
    hash::{self, pcg},
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

impl GroomEditor {
    /// Paints strands or guides under `dabs`.
    pub(super) fn paint(&self, stroke: &mut ActiveStroke, dabs: &[Dab]) {
        let brush = stroke.brush;
        let looks = stroke.looks.get_or_insert_with(|| self.document.looks());
        let reach = |dab: &Dab| (dab.meets(brush.reach), dab.falloff(&brush), dab.strength);
        let reaches: Vec<_> = dabs.iter().map(reach).collect();
        let weight = |sphere: (Vec3, f32), line: &[Vec3]| {
            let met = reaches.iter().filter(|(meets, ..)| meets(sphere));
            let most = |near: &dyn Fn(Vec3) -> f32| line.iter().map(|p| near(*p)).fold(0.0, f32::max);
            met.map(|(_, near, strength)| most(near) * strength).fold(0.0, f32::max)
        };
        let guide = |i: usize| weight(self.spheres[i], self.guide(i));
        let changed = |value: f32, first: f32, weight: f32| {
            let factor = 1.0 + CHANGE * weight;
            let after = if brush.inverted { value / factor } else { value * factor };
            after.clamp(first * RANGE.0, first * RANGE.1)
        };
        if brush.tool == BrushTool::Stiffness {
            for (i, stiffness) in
                looks.stiffness.iter_mut().enumerate().filter(|(i, _)| self.is_open(&brush, *i))
            {
                let weight = guide(i);
                if weight > 0.0 {
                    *stiffness = changed(*stiffness, self.base.guides.stiffness[i], weight);
                    stroke.painted = true;
                }
            }
            return;
        }
        if brush.tool == BrushTool::Hold {
            for (i, held) in looks.held.iter_mut().enumerate().filter(|(i, _)| self.is_open(&brush, *i)) {
                let changes = *held == brush.inverted && guide(i) > 0.0;
                *held ^= changes;
                stroke.painted |= changes;
            }
            return;
        }
        let color = Vec3::from(brush.color.map(linear));
        if brush.tool.paints_shapes() && looks.shapes.is_empty() {
            looks.shapes = vec![StrandShape::default(); looks.strands.len()];
        }
        let base = &self.base.strands;
        let strands = looks.strands.iter_mut().zip(&base.bindings).zip(&base.strands);
        for (i, (((strand, binding), first), (sphere, line))) in strands.zip(&stroke.roots.lines).enumerate()
        {
            let weight = weight(*sphere, line);
            if weight <= 0.0 || !self.is_open(&brush, binding.guides[0] as usize) {
                continue;
            }
            stroke.painted = true;
            if brush.tool == BrushTool::Width {
                strand.radius = changed(strand.radius, first.radius, weight);
                continue;
            }
            if brush.tool.paints_shapes() {
                let shape = &mut looks.shapes[i];
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
            // The pigment of strands without a color is not known here, so a random share of them takes the color whole.
            let chance = hash::unit(pcg(stroke.seed ^ i as u32));
            let mixed = |now: u32, share: f32| match unpack_color(now) {
                Some(now) => pack_color(now.lerp(color, (TINT * weight * share).min(1.0))),
                None if chance < weight * share => pack_color(color),
                None => 0,
            };
            let tip = if strand.tip_color == 0 { strand.root_color } else { strand.tip_color };
            strand.root_color = mixed(strand.root_color, brush.along(0.0));
            strand.tip_color = mixed(tip, brush.along(1.0));
        }
    }

    /// Returns root, normal of the skin and stiffness of each guide. The last is relative to that before the first stroke.
    pub fn stiffness(&self) -> Vec<(Vec3, Vec3, f32)> {
        let looks = self.stroke.as_ref().and_then(|stroke| stroke.looks.as_ref());
        let now = looks.map_or(self.document.stiffness(), |looks| &looks.stiffness);
        let first = &self.base.guides.stiffness;
        let of = |i: usize| (self.guide(i)[0], self.normals[i], now[i] / first[i].max(1e-6));
        (0..first.len()).map(of).collect()
    }

    /// Returns root and normal of the skin of each guide, and whether it is held.
    pub fn held(&self) -> impl Iterator<Item = (Vec3, Vec3, bool)> {
        let held =
            self.stroke.as_ref().and_then(|stroke| stroke.looks.as_ref()).map_or(&self.held, |it| &it.held);
        held.iter().enumerate().map(|(i, held)| (self.guide(i)[0], self.normals[i], *held))
    }

    /// Returns root and normal of the skin of each guide, and how much of the effect of `tool` its hair has, 0 to 1.
    pub fn amounts(&self, tool: BrushTool) -> Vec<(Vec3, Vec3, f32)> {
        let looks = self.stroke.as_ref().and_then(|stroke| stroke.looks.as_ref());
        let shapes = looks.map_or(self.document.shapes(), |looks| &looks.shapes);
        let mut sums = vec![(0.0, 0.0f32); self.spheres.len()];
        for (shape, binding) in shapes.iter().zip(&self.base.strands.bindings) {
            let amount = match tool {
                BrushTool::Clump => shape.clump,
                BrushTool::Curl => shape.curl,
                _ => shape.frizz,
            };
            let sum = &mut sums[binding.guides[0] as usize];
            *sum = (sum.0 + f32::from(amount) / 255.0, sum.1 + 1.0);
        }
        let of = |i: usize| (self.guide(i)[0], self.normals[i], sums[i].0 / sums[i].1.max(1.0));
        (0..sums.len()).map(of).collect()
    }

    /// Returns the version with the painted values of a stroke, if it has any.
    pub(super) fn with_paint(&self, stroke: &ActiveStroke) -> Option<GroomDocument> {
        let looks = stroke.looks.as_ref().filter(|_| stroke.painted)?;
        Some(self.document.with_looks(looks.clone()))
    }
}
