//! USD writer, as text: strands as linear `BasisCurves`, with Unreal's `groom_*` primvars beside USD's own attributes;
//! caches of moving strands; meshes on skeletons with hair attached to them. The crate's feature `usd` adds USDC.

mod cache;
mod layer;
#[cfg(feature = "usd")]
pub(crate) mod packed;
mod skel;

pub(crate) use cache::cache;

use std::collections::HashMap;

use crate::{
    Error, Result, Rig, Strands, TriMesh,
    formats::{
        usd::DOC,
        writer::{EncodedFile, ExportHair},
    },
    orient::LengthUnit,
};
use layer::{Layer, per, point};

/// Metadata of a file.
struct LayerInfo<'a> {
    /// The default prim.
    prim: &'a str,
    /// Unit of the file, with Y up; `None` states neither.
    unit: Option<LengthUnit>,
}

fn layer_metadata(about: &LayerInfo<'_>) -> Vec<String> {
    let mut lines = vec![format!("defaultPrim = \"{}\"", about.prim), format!("doc = \"{DOC}\"")];
    if let Some(unit) = about.unit {
        lines.extend([format!("metersPerUnit = {}", unit.0), "upAxis = \"Y\"".into()]);
    }
    lines
}

/// Encodes strands as text.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
    let mut layer = Layer::new(&layer_metadata(&LayerInfo { prim: "groom", unit }));
    layer.open("Xform", "groom", &["GroomAPI"]);
    layer.open("BasisCurves", "strands", &[]);
    let curves = Curves { strands, scale: unit.map_or(1.0, |unit| unit.0) };
    curves.points(&mut layer);
    curves.attributes(&mut layer);
    layer.close();
    layer.close();
    Ok(layer.finish().into_bytes().into())
}

/// Encodes a character as text: a mesh (meters, Y up), its `rig` if given, and hair at rest. On a rig, each strand
/// follows the joints of the skin at its root. After reading, the mesh deforms as with `rig` at 24, 25, 30, 50 or 60
/// frames per second, with two differences: USD stores scales as half floats, and blend shapes with a weight at rest
/// become part of the mesh.
///
/// # Errors
/// [`Error::Unusable`] for a rig of another mesh, for a joint whose bind matrix has no inverse, for animations of more
/// than 100,000 frames or with scales beyond half floats, and for hair without strands.
pub(crate) fn character(body: Option<(&TriMesh, Option<&Rig>)>, hair: &[ExportHair<'_>]) -> Result<Vec<u8>> {
    if hair.iter().any(|hair| hair.strands.is_empty()) {
        return Err(Error::Unusable("a groom without strands cannot be written".into()));
    }
    let mut lines = layer_metadata(&LayerInfo { prim: "character", unit: Some(LengthUnit(1.0)) });
    let rig = body.and_then(|(_, rig)| rig);
    let rate = rig.map_or(0.0, skel::rate);
    if let Some(rig) = rig.filter(|rig| !rig.animations.is_empty()) {
        let longest = rig.animations.iter().map(|it| it.length).fold(0.0, f32::max);
        let last = (longest * rate).round();
        lines.extend([
            format!("timeCodesPerSecond = {rate}"),
            format!("framesPerSecond = {rate}"),
            "startTimeCode = 0".into(),
            format!("endTimeCode = {last}"),
        ]);
    }
    let mut layer = Layer::new(&lines);
    layer.open(if rig.is_some() { "SkelRoot" } else { "Xform" }, "character", &[]);
    match body {
        Some((mesh, Some(rig))) => skel::put(&mut layer, (mesh, rig), rate, hair)?,
        other => {
            if let Some((mesh, _)) = other {
                layer.open("Mesh", "body", &[]);
                skel::surface(&mut layer, mesh);
                layer.close();
            }
            let mut used = HashMap::from([("body".to_owned(), 1)]);
            for hair in hair {
                layer.open("BasisCurves", &skel::unique(&mut used, "", hair.name), &[]);
                let curves = Curves { strands: hair.strands, scale: 1.0 };
                curves.points(&mut layer);
                curves.attributes(&mut layer);
                layer.close();
            }
        }
    }
    layer.close();
    Ok(layer.finish().into_bytes())
}

/// Encodes a mesh without hair.
pub(crate) fn body(mesh: &TriMesh, rig: Option<&Rig>) -> Result<Vec<u8>> {
    character(Some((mesh, rig)), &[])
}

/// Strands as attributes of `BasisCurves`; `scale` is in meters per unit.
struct Curves<'a> {
    strands: &'a Strands,
    scale: f32,
}

impl Curves<'_> {
    fn scaled(&self, v: f32) -> f32 {
        if self.scale == 1.0 { v } else { v / self.scale }
    }

    fn scaled_point(&self, p: &glam::Vec3) -> String {
        point(&glam::Vec3::from(p.to_array().map(|v| self.scaled(v))))
    }

    /// Writes the positions and their bounds.
    fn points(&self, layer: &mut Layer) {
        layer.list("point3f[] points", self.strands.positions.iter().map(|p| self.scaled_point(p)), &[]);
        if let Some((lo, hi)) = self.strands.bounds() {
            layer.list("float3[] extent", [lo, hi].iter().map(|p| self.scaled_point(p)), &[]);
        }
    }

    /// Writes all attributes except positions.
    fn attributes(&self, layer: &mut Layer) {
        let strands = self.strands;
        layer.line("uniform token type = \"linear\"");
        layer.line("uniform token wrap = \"nonperiodic\"");
        layer.list("int[] curveVertexCounts", strands.iter().map(<[_]>::len), &[]);
        if !strands.radii.is_empty() {
            let widths = strands.radii.iter().map(|radius| self.scaled(2.0 * radius));
            layer.list("float[] widths", widths, &per("vertex"));
        }
        if !strands.colors.is_empty() {
            layer.list("color3f[] primvars:displayColor", strands.colors.iter().map(point), &per("vertex"));
        }
        if !strands.root_uvs.is_empty() {
            let uvs: Vec<_> = strands.root_uvs.iter().map(|uv| format!("({}, {})", uv.x, uv.y)).collect();
            layer.list("texCoord2f[] primvars:st", &uvs, &per("uniform"));
            layer.list("float2[] primvars:groom_root_uv", &uvs, &per("uniform"));
        }
        self.custom(layer);
        let marks = &strands.marks;
        if marks.is_empty() {
            return;
        }
        let each = per("uniform");
        layer.list("int[] primvars:groom_guide", marks.iter().map(|m| i32::from(m.guide)), &each);
        layer.list("int[] primvars:groom_id", marks.iter().map(|m| m.id), &each);
        layer.list("int[] primvars:groom_group_id", marks.iter().map(|m| m.group), &each);
        if marks.iter().any(|mark| mark.weights != [0.0; 3]) {
            let closest = marks.iter().map(|m| m.closest).map(|[a, b, c]| format!("({a}, {b}, {c})"));
            // Blender drops `int3[]`. Floats are exact up to this number.
            let is_exact = marks.iter().flat_map(|m| m.closest).all(|id| id.unsigned_abs() < 1 << 24);
            let kind = if is_exact { "float3" } else { "int3" };
            layer.list(&format!("{kind}[] primvars:groom_closest_guides"), closest, &each);
            let weights = marks.iter().map(|m| m.weights).map(|[a, b, c]| format!("({a}, {b}, {c})"));
            layer.list("float3[] primvars:groom_guide_weights", weights, &each);
        }
    }

    /// Writes the custom attributes. Their names become identifiers.
    fn custom(&self, layer: &mut Layer) {
        let mut used = HashMap::new();
        for attribute in &self.strands.attributes {
            let kind = if attribute.is_integer { "int" } else { "float" };
            let width = match attribute.width {
                1 => String::new(),
                width => width.to_string(),
            };
            let name = skel::unique(&mut used, "", &attribute.name);
            let values = attribute.numbers.chunks_exact(attribute.width as usize).map(|value| match value {
                [number] => number.to_string(),
                many => format!("({})", many.iter().map(f32::to_string).collect::<Vec<_>>().join(", ")),
            });
            let each = per(if attribute.per_vertex { "vertex" } else { "uniform" });
            layer.list(&format!("{kind}{width}[] primvars:{name}"), values, &each);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::strands::Mark;

    #[test]
    fn attribute_counts_match_interpolation() {
        let mut strands = Strands::default();
        strands.push(&[Vec3::ZERO, Vec3::new(0.125, -0.5, 1e-7)]);
        strands.push(&[Vec3::X, Vec3::Y, Vec3::Z]);
        strands.radii = vec![5e-5; 5];
        strands.colors = vec![Vec3::ONE; 5];
        strands.root_uvs = vec![Vec2::new(0.5, 0.25); 2];
        strands.marks = vec![Mark { guide: true, id: 7, weights: [1.0, 0.0, 0.0], ..Default::default() }; 2];
        let text = |unit| String::from_utf8(encode(&strands, unit).unwrap().bytes).unwrap();
        let meters = text(Some(LengthUnit(1.0)));
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
            assert_eq!(values(&meters, name).len(), count, "{name}: {meters}");
        }
        assert_eq!(values(&meters, "points")[5].parse::<f32>(), Ok(1e-7));
        let centimeters = text(Some(LengthUnit(0.01)));
        assert!(meters.contains("metersPerUnit = 1\n") && centimeters.contains("metersPerUnit = 0.01\n"));
        assert_eq!(values(&centimeters, "points")[4].parse::<f32>(), Ok(-50.0));
        assert!(!text(None).contains("upAxis") && meters.contains("upAxis = \"Y\""));
    }
}
