//! Reads OBJ meshes with `tobj`.

use std::{
    cell::Cell,
    collections::HashMap,
    io::{BufRead, Read},
    path::Path,
};

use glam::Vec3;

use crate::{
    TriMesh,
    error::{At, Result},
    formats::{faces::PLAIN, raw::RawMesh, source::Source},
};

/// Counts the lines that `tobj` reads, because its errors do not state a position.
struct Lines<'a> {
    rest: &'a [u8],
    line: &'a Cell<u64>,
}

impl Read for Lines<'_> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let n = self.rest.read(out)?;
        self.line.set(self.line.get() + out[..n].iter().filter(|b| **b == b'\n').count() as u64);
        Ok(n)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, n: usize) {
        let (used, rest) = self.rest.split_at(n.min(self.rest.len()));
        self.line.set(self.line.get() + used.iter().filter(|b| **b == b'\n').count() as u64);
        self.rest = rest;
    }
}

/// Reads the whole file. Materials are read from files beside it, which may be missing.
pub(crate) fn read(source: &Source) -> Result<RawMesh> {
    let options =
        tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let line = Cell::new(0);
    let materials = |name: &Path| match source.resource(&name.to_string_lossy()) {
        Ok(bytes) => tobj::load_mtl_buf(&mut &*bytes),
        Err(_) => Err(tobj::LoadError::OpenFileFailed),
    };
    let bytes = without_lines(source.bytes);
    let mut lines = Lines { rest: &bytes, line: &line };
    let (models, materials) = tobj::load_obj_buf(&mut lines, &options, materials).map_err(|e| {
        source.problem(At::Line(line.get().max(1)), format!("the file is not a valid OBJ mesh ({e})"))
    })?;
    let materials = materials.unwrap_or_default();
    let color_of = |id: Option<usize>| {
        let material = materials.get(id?)?;
        // With a texture, the color is in the texture and the factor is usually white.
        let color = material.diffuse.filter(|_| material.diffuse_texture.is_none())?;
        Some(Vec3::from(color)).filter(|c| c.is_finite())
    };
    let colored = models.iter().any(|m| color_of(m.mesh.material_id).is_some());
    let smooth = models.iter().any(|m| m.mesh.normals.len() != m.mesh.positions.len());
    let mut out = TriMesh::default();
    // `tobj` splits vertices at texture seams. Merge vertices that have equal positions, normals and colors.
    let mut known: HashMap<[u32; 9], u32> = HashMap::new();
    for model in &models {
        let mesh = &model.mesh;
        let color = color_of(mesh.material_id).unwrap_or(PLAIN);
        let three = |list: &[f32], i: u32| {
            let at = 3 * i as usize;
            list.get(at..at + 3).map(Vec3::from_slice)
        };
        for triangle in mesh.indices.as_chunks::<3>().0 {
            let mut corners = [0; 3];
            for (corner, i) in corners.iter_mut().zip(triangle) {
                let position = three(&mesh.positions, *i).unwrap_or(Vec3::NAN) + Vec3::ZERO;
                let normal = if smooth { None } else { three(&mesh.normals, *i) };
                let normal = normal.and_then(Vec3::try_normalize).unwrap_or(Vec3::ZERO);
                let mut key = [0; 9];
                for (slot, value) in key
                    .iter_mut()
                    .zip(position.to_array().iter().chain(&normal.to_array()).chain(&color.to_array()))
                {
                    *slot = value.to_bits();
                }
                *corner = *known.entry(key).or_insert_with(|| {
                    out.positions.push(position);
                    if !smooth {
                        out.normals.push(normal);
                    }
                    if colored {
                        out.colors.push(color);
                    }
                    out.positions.len() as u32 - 1
                });
            }
            if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
                out.triangles.push(corners);
            }
        }
    }
    if out.normals.contains(&Vec3::ZERO) {
        out.normals.clear();
    }
    Ok(RawMesh { mesh: out, ..RawMesh::default() })
}

/// Comments out the line elements of a file: `tobj` reads one of three vertices as a face.
fn without_lines(bytes: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for line in out.split_mut(|b| *b == b'\n') {
        let start = line.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(line.len());
        if let [first @ b'l', next, ..] = &mut line[start..]
            && next.is_ascii_whitespace()
        {
            *first = b'#';
        }
    }
    out
}
