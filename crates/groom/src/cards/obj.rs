//! Cards as OBJ files with a material and textures.

use super::{CardLevel, CardLook, Cards};
use crate::Result;
use std::fmt::Write;

/// A file by its name.
pub type NamedFile = (String, Vec<u8>);

impl Cards {
    /// Encodes each level as an OBJ file, with a material and textures that all levels share. File names begin with
    /// `name`.
    ///
    /// # Errors
    /// [`crate::Error::Unusable`] if a texture cannot be encoded.
    pub fn obj(&self, name: &str, look: &CardLook) -> Result<Vec<NamedFile>> {
        let textures = &self.textures;
        let tint = if textures.has_colors { glam::Vec3::ONE } else { look.color };
        let [r, g, b] = tint.to_array();
        let material = format!(
            "newmtl hair\nKd {r} {g} {b}\nmap_Kd {name}_color.png\nmap_d -imfchan m {name}_color.png\n\
             # Shade, roughness: {name}_surface.png. Direction across the strands: {name}_anisotropy.png.\n\
             # Height over the card, position on the strand, random number, coverage: {name}_data.png.\n"
        );
        let mut files = vec![
            (format!("{name}.mtl"), material.into_bytes()),
            (format!("{name}_color.png"), textures.color_png()?),
            (format!("{name}_surface.png"), textures.surface_png()?),
            (format!("{name}_anisotropy.png"), textures.anisotropy_png()?),
            (format!("{name}_data.png"), textures.data_png()?),
        ];
        for level in &self.levels {
            files.push((format!("{name}_LOD{}.obj", level.index), encoded(level, name)));
        }
        Ok(files)
    }
}

/// Encodes the triangles of a level.
fn encoded(level: &CardLevel, name: &str) -> Vec<u8> {
    let mesh = &level.mesh;
    let mut text = format!("mtllib {name}.mtl\no Hair_LOD{}\nusemtl hair\n", level.index);
    for p in &mesh.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for uv in &mesh.uvs {
        // OBJ counts V from the bottom.
        let _ = writeln!(text, "vt {} {}", uv.x, 1.0 - uv.y);
    }
    for n in &mesh.normals {
        let _ = writeln!(text, "vn {} {} {}", n.x, n.y, n.z);
    }
    for [a, b, c] in &mesh.triangles {
        let [a, b, c] = [a + 1, b + 1, c + 1];
        let _ = writeln!(text, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}");
    }
    text.into_bytes()
}
