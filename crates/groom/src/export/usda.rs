//! USD as text: strands as linear `BasisCurves`, with Unreal's `groom_*` as primvars beside USD's own names. Rust
//! prints a float so that it reads back exactly.

use std::fmt::{Display, Write};

use super::{Encoded, lost};
use crate::{Strands, orient::Unit};

/// What the file says of itself.
pub(crate) const DOC: &str = "Tresses groom";
/// Where every attribute stands.
const INDENT: &str = "        ";

/// `unit` is that of the file, where the strands are in metres, Y up; `None` says nothing of either.
pub(super) fn encode(strands: &Strands, unit: Option<Unit>) -> Encoded {
    let scale = unit.map_or(1.0, |unit| unit.0);
    let mut text = format!("#usda 1.0\n(\n    defaultPrim = \"groom\"\n    doc = \"{DOC}\"\n");
    if let Some(unit) = unit {
        // Writing into a string cannot fail.
        let _ = write!(text, "    metersPerUnit = {}\n    upAxis = \"Y\"\n", unit.0);
    }
    text += ")\n\ndef Xform \"groom\" (\n    prepend apiSchemas = [\"GroomAPI\"]\n)\n{\n    def BasisCurves \"strands\"\n    {\n";
    text += "        uniform token type = \"linear\"\n        uniform token wrap = \"nonperiodic\"\n";
    let scaled = |v: f32| if scale == 1.0 { v } else { v / scale };
    let points = |values: &[glam::Vec3]| -> Vec<String> {
        values.iter().map(|p| format!("({}, {}, {})", scaled(p.x), scaled(p.y), scaled(p.z))).collect()
    };
    list(&mut text, "int[] curveVertexCounts", strands.iter().map(<[_]>::len), "");
    list(&mut text, "point3f[] points", points(&strands.positions), "");
    if let Some((lo, hi)) = strands.bounds() {
        list(&mut text, "float3[] extent", points(&[lo, hi]), "");
    }
    if !strands.radii.is_empty() {
        list(&mut text, "float[] widths", strands.radii.iter().map(|r| scaled(2.0 * r)), "vertex");
    }
    let three = strands.colors.iter().map(|c| format!("({}, {}, {})", c.x, c.y, c.z));
    if !strands.colors.is_empty() {
        list(&mut text, "color3f[] primvars:displayColor", three, "vertex");
    }
    if !strands.root_uvs.is_empty() {
        let uvs: Vec<_> = strands.root_uvs.iter().map(|uv| format!("({}, {})", uv.x, uv.y)).collect();
        list(&mut text, "texCoord2f[] primvars:st", &uvs, "uniform");
        list(&mut text, "float2[] primvars:groom_root_uv", &uvs, "uniform");
    }
    let marks = &strands.marks;
    if !marks.is_empty() {
        list(&mut text, "int[] primvars:groom_guide", marks.iter().map(|m| i32::from(m.guide)), "uniform");
        list(&mut text, "int[] primvars:groom_id", marks.iter().map(|m| m.id), "uniform");
        list(&mut text, "int[] primvars:groom_group_id", marks.iter().map(|m| m.group), "uniform");
        if marks.iter().any(|mark| mark.weights != [0.0; 3]) {
            let closest =
                marks.iter().map(|m| format!("({}, {}, {})", m.closest[0], m.closest[1], m.closest[2]));
            list(&mut text, "int3[] primvars:groom_closest_guides", closest, "uniform");
            let weights =
                marks.iter().map(|m| format!("({}, {}, {})", m.weights[0], m.weights[1], m.weights[2]));
            list(&mut text, "float3[] primvars:groom_guide_weights", weights, "uniform");
        }
    }
    text += "    }\n}\n";
    let mut notes = Vec::new();
    lost(&mut notes, strands.tip_pinned.contains(&true), "the pinned tips");
    Encoded { bytes: text.into_bytes(), notes }
}

/// One attribute, and what its values belong to.
fn list<T: Display>(text: &mut String, name: &str, values: impl IntoIterator<Item = T>, interpolation: &str) {
    let _ = write!(text, "{INDENT}{name} = [");
    for (i, value) in values.into_iter().enumerate() {
        let _ = write!(text, "{}{value}", if i == 0 { "" } else { ", " });
    }
    text.push(']');
    if !interpolation.is_empty() {
        let _ = write!(text, " (\n{INDENT}    interpolation = \"{interpolation}\"\n{INDENT})");
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::strands::Mark;

    #[test]
    fn every_attribute_has_as_many_values_as_it_belongs_to() {
        let mut strands = Strands::default();
        strands.push(&[Vec3::ZERO, Vec3::new(0.125, -0.5, 1e-7)]);
        strands.push(&[Vec3::X, Vec3::Y, Vec3::Z]);
        strands.radii = vec![5e-5; 5];
        strands.colors = vec![Vec3::ONE; 5];
        strands.root_uvs = vec![Vec2::new(0.5, 0.25); 2];
        strands.marks = vec![Mark { guide: true, id: 7, weights: [1.0, 0.0, 0.0], ..Default::default() }; 2];
        let text = |unit| String::from_utf8(encode(&strands, unit).bytes).unwrap();
        let metres = text(Some(Unit(1.0)));
        let values = |text: &str, name: &str| {
            let line = text.lines().find(|line| line.contains(&format!("{name} = ["))).unwrap().to_owned();
            let list = line.split_once('[').and_then(|(_, rest)| rest.split_once(" = [")).unwrap().1;
            list.trim_end_matches([' ', '(', ']'])
                .replace(['(', ')'], "")
                .split(", ")
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        for (name, count) in [
            ("points", 15),
            ("extent", 6),
            ("curveVertexCounts", 2),
            ("widths", 5),
            ("displayColor", 15),
            ("primvars:st", 4),
            ("groom_guide", 2),
            ("groom_id", 2),
            ("groom_group_id", 2),
            ("groom_closest_guides", 6),
            ("groom_guide_weights", 6),
        ] {
            assert_eq!(values(&metres, name).len(), count, "{name}: {metres}");
        }
        assert_eq!(values(&metres, "points")[5].parse::<f32>(), Ok(1e-7));
        let centimetres = text(Some(Unit(0.01)));
        assert!(metres.contains("metersPerUnit = 1\n") && centimetres.contains("metersPerUnit = 0.01\n"));
        assert_eq!(values(&centimetres, "points")[4].parse::<f32>(), Ok(-50.0));
        assert!(!text(None).contains("upAxis") && metres.contains("upAxis = \"Y\""));
    }
}
