//! Writes OBJ. Rust prints floats so that they read back exactly.

use std::fmt::Write;

use crate::{
    Result, Rig, Strands, TriMesh,
    formats::{raw::MARK, writer::EncodedFile},
    orient::LengthUnit,
};

/// Encodes strands: a `v` per vertex, an `l` per strand.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
    let mut text = String::from("# Tresses groom\n");
    if unit.is_some() {
        text += "# ";
        text += MARK;
        text.push('\n');
    }
    // Writing into a string cannot fail.
    for p in &strands.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for i in 0..strands.len() {
        text.push('l');
        for v in strands.range(i) {
            let _ = write!(text, " {}", v + 1);
        }
        text.push('\n');
    }
    Ok(text.into_bytes().into())
}

/// Encodes a mesh (meters, Y up, face +Z) with its normals. The format has no rigs.
pub(crate) fn encode_mesh(mesh: &TriMesh, _: Option<&Rig>) -> Result<Vec<u8>> {
    let mut text = format!("# {MARK}\n");
    // Writing into a string cannot fail.
    for (key, values) in [("v", &mesh.positions), ("vn", &mesh.normals)] {
        for v in values {
            let _ = writeln!(text, "{key} {} {} {}", v.x, v.y, v.z);
        }
    }
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| i + 1);
        let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}");
    }
    Ok(text.into_bytes())
}
