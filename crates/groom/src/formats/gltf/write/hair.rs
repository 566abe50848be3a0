//! Writes hair to a glTF file: `EXT_tresses_hair`, specified in `docs/reference/EXT_tresses_hair.md`.

use glam::Vec3;
use meshoptimizer_rs::{
    Workspace,
    codec::{VertexEncoding, encode_vertex_buffer},
};
use serde_json::{Value, json};

use super::{FLOAT, File, INT, SHORT};
use crate::{
    Strands,
    error::{Error, Result},
    formats::{
        gltf::{GUIDE, HAIR, MESHOPT_COMPRESSION, TIP_PINNED},
        writer::ExportHair,
    },
    strands::Mark,
};

/// Positions are stored in 16 bits if a quantization step is at most this fraction of the mean segment length.
const FINE: f32 = 5e-3;

/// Writes all of `hair`.
pub(super) fn put(file: &mut File, hair: &[ExportHair<'_>]) -> Result<()> {
    if hair.is_empty() {
        return Ok(());
    }
    let mut grooms = Vec::new();
    for hair in hair {
        if hair.strands.is_empty() {
            return Err(Error::Unusable("a groom without strands cannot be written".into()));
        }
        let mut groom = json!({"strands": strands(file, hair)?});
        if !hair.name.is_empty() {
            groom["name"] = json!(hair.name);
        }
        if let Some(look) = hair.look {
            look.check()?;
            let [along, around] = look.roughness;
            groom["material"] = json!({"eumelanin": look.eumelanin, "pheomelanin": look.pheomelanin,
                "longitudinalRoughness": along, "azimuthalRoughness": around,
                "cuticleTilt": look.tilt, "ior": look.ior});
        }
        grooms.push(groom);
    }
    file.root["extensions"] = json!({HAIR: {"grooms": grooms}});
    let packed = hair.iter().any(|hair| hair.packed);
    file.root["extensionsUsed"] = if packed { json!([HAIR, MESHOPT_COMPRESSION]) } else { json!([HAIR]) };
    if packed {
        file.root["extensionsRequired"] = json!([MESHOPT_COMPRESSION]);
    }
    Ok(())
}

/// Items of an accessor: component type, item type and bytes.
struct Items {
    component: u32,
    kind: &'static str,
    bytes: Vec<u8>,
    /// Bytes per item, padded to a multiple of four.
    stride: usize,
}

fn strands(file: &mut File, hair: &ExportHair<'_>) -> Result<Value> {
    let strands = hair.strands;
    let mut out = json!({"count": strands.len()});
    let counts: Vec<u32> = strands.offsets.windows(2).map(|w| w[1] - w[0]).collect();
    let mut put = |out: &mut Value, key: &str, items: Items| -> Result<()> {
        out[key] = json!(file.items(items, hair.packed)?);
        Ok(())
    };
    if counts.iter().all(|count| *count == counts[0]) {
        out["vertexCount"] = json!(counts[0]);
    } else {
        put(&mut out, "vertexCounts", integers("SCALAR", counts.into_iter()))?;
    }
    let vertices = vertices(strands, &mut out);
    put(&mut out, "vertices", vertices)?;
    if !strands.colors.is_empty() {
        let bytes = strands
            .colors
            .iter()
            .flat_map(|c| c.extend(1.0).to_array().map(quantize_unorm16))
            .flat_map(u16::to_le_bytes);
        put(&mut out, "colors", Items { component: SHORT, kind: "VEC4", bytes: bytes.collect(), stride: 8 })?;
    }
    if !strands.root_uvs.is_empty() {
        let bytes = strands.root_uvs.iter().flat_map(|uv| uv.to_array()).flat_map(f32::to_le_bytes);
        put(
            &mut out,
            "rootUvs",
            Items { component: FLOAT, kind: "VEC2", bytes: bytes.collect(), stride: 8 },
        )?;
    }
    let pinned = |i: usize| strands.tip_pinned.get(i).copied().unwrap_or(false);
    let guide = |i: usize| strands.marks.get(i).is_some_and(|mark| mark.guide);
    let flags = (0..strands.len()).map(|i| GUIDE * u32::from(guide(i)) + TIP_PINNED * u32::from(pinned(i)));
    if flags.clone().any(|flags| flags != 0) {
        put(&mut out, "flags", integers("SCALAR", flags))?;
    }
    let marks = &strands.marks;
    if !marks.is_empty() {
        put(&mut out, "ids", integers("SCALAR", marks.iter().map(|mark| mark.id as u32)))?;
        put(&mut out, "groups", integers("SCALAR", marks.iter().map(|mark| mark.group as u32)))?;
    }
    if marks.iter().any(|Mark { weights, .. }| *weights != [0.0; 3]) {
        let closest = marks.iter().flat_map(|mark| mark.closest).map(|id| id as u32);
        put(&mut out, "closest", integers("VEC3", closest))?;
        let bytes = marks.iter().flat_map(|mark| mark.weights).flat_map(f32::to_le_bytes);
        put(
            &mut out,
            "weights",
            Items { component: FLOAT, kind: "VEC3", bytes: bytes.collect(), stride: 12 },
        )?;
    }
    let mut attributes = serde_json::Map::new();
    for attribute in &strands.attributes {
        let width = attribute.width as usize;
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let bytes = attribute.numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let items = Items { component: FLOAT, kind, bytes, stride: 4 * width };
        let mut about = json!({"accessor": file.items(items, hair.packed)?});
        about["per"] = json!(if attribute.per_vertex { "vertex" } else { "strand" });
        if attribute.is_integer {
            about["integer"] = json!(true);
        }
        attributes.insert(attribute.name.clone(), about);
    }
    if !attributes.is_empty() {
        out["attributes"] = attributes.into();
    }
    Ok(out)
}

fn integers(kind: &'static str, values: impl Iterator<Item = u32>) -> Items {
    let stride = if kind == "VEC3" { 12 } else { 4 };
    Items { component: INT, kind, bytes: values.flat_map(u32::to_le_bytes).collect(), stride }
}

/// Returns positions and widths: as 16-bit fractions of the bounding box and of the largest width if these are precise
/// enough, else as floats.
fn vertices(strands: &Strands, out: &mut Value) -> Items {
    let (low, high) = strands.bounds().unwrap_or_default();
    let size = (high - low).max_element();
    let widest = 2.0 * strands.radii.iter().copied().fold(0.0, f32::max);
    let width = |i: usize| if widest > 0.0 { 2.0 * strands.radii[i] / widest } else { 0.0 };
    if widest > 0.0 {
        out["width"] = json!(widest);
    }
    let length: f32 = (0..strands.len()).map(|i| strands.length(i)).sum();
    let segment = length / strands.positions.len().saturating_sub(strands.len()).max(1) as f32;
    let all = strands.positions.iter().enumerate();
    if size.is_finite() && size / 65535.0 <= FINE * segment {
        out["offset"] = json!(low.to_array());
        out["scale"] = json!(size);
        let item =
            |(i, p): (usize, &Vec3)| ((*p - low) / size).extend(width(i)).to_array().map(quantize_unorm16);
        let bytes = all.flat_map(item).flat_map(u16::to_le_bytes).collect();
        return Items { component: SHORT, kind: "VEC4", bytes, stride: 8 };
    }
    let bytes = all.flat_map(|(i, p)| p.extend(width(i)).to_array()).flat_map(f32::to_le_bytes).collect();
    Items { component: FLOAT, kind: "VEC4", bytes, stride: 16 }
}

/// Quantizes a value from 0 to 1 to 16 bits.
fn quantize_unorm16(s: f32) -> u16 {
    (s.clamp(0.0, 1.0) * 65535.0).round() as u16
}

impl File {
    /// Writes items and returns the index of their accessor.
    fn items(&mut self, items: Items, packed: bool) -> Result<usize> {
        let Items { component, kind, bytes, stride } = items;
        let count = bytes.len() / stride;
        let view = if packed { self.packed(&bytes, count, stride)? } else { self.view(&bytes) };
        let index = self.items_of(view, component, kind, count);
        if component == SHORT {
            self.root["accessors"][index]["normalized"] = json!(true);
        }
        Ok(index)
    }

    /// Writes a compressed view and returns its index.
    fn packed(&mut self, bytes: &[u8], count: usize, stride: usize) -> Result<usize> {
        let failed = |problem| Error::Unusable(format!("hair cannot be compressed ({problem})"));
        // The extension requires version 0 of the codec.
        let encoding = VertexEncoding::new(0, 0).map_err(failed)?;
        let coded = encode_vertex_buffer(bytes, count, stride, encoding, &mut Workspace::default())
            .map_err(failed)?;
        let how = json!({"buffer": 0, "byteOffset": self.append(&coded), "byteLength": coded.len(),
            "byteStride": stride, "count": count, "mode": "ATTRIBUTES"});
        let offset = self.unpacked;
        self.unpacked += bytes.len().next_multiple_of(4);
        let view = json!({"buffer": 1, "byteOffset": offset, "byteLength": bytes.len(), "extensions": {MESHOPT_COMPRESSION: how}});
        Ok(self.push("bufferViews", view))
    }
}
