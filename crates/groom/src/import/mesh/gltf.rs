//! glTF and GLB meshes through the `gltf` crate.
//!
//! Every accessor is checked against its view and its buffer before the crate reads it.

use std::borrow::Cow;

use glam::{Mat3, Mat4, Vec3};

use super::{PLAIN, Source};
use crate::{
    TriMesh,
    error::{At, Error, Result},
};

/// Reads all triangles of the default scene, with the nodes' transforms applied; skins and morphs rest.
pub(super) fn read(source: &Source) -> Result<TriMesh> {
    let unreadable =
        |e: ::gltf::Error| source.problem(At::File, format!("not a readable glTF file ({})", one_line(&e)));
    let file = ::gltf::Gltf::from_slice_without_validation(source.bytes).map_err(unreadable)?;
    let root = file.document.into_json();
    // The crate's own validation looks an accessor of positions up before it checks its index.
    let accessors = root.accessors.len();
    let primitives = root.meshes.iter().flat_map(|m| &m.primitives);
    let bad = primitives.flat_map(|p| p.attributes.values()).find(|i| i.value() >= accessors);
    if let Some(bad) = bad {
        let problem = format!("accessor {} does not exist, there are {accessors}", bad.value());
        return Err(source.problem(At::File, problem));
    }
    let document = ::gltf::Document::from_json(root).map_err(unreadable)?;
    let mut blob = file.blob;
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let data = match buffer.source() {
            ::gltf::buffer::Source::Uri(uri) if !uri.contains(':') => source.companion(&unescape(uri))?,
            other => Cow::Owned(
                ::gltf::buffer::Data::from_source_and_blob(other, None, &mut blob)
                    .map_err(|e| source.problem(At::File, format!("a buffer is missing ({})", one_line(&e))))?
                    .0,
            ),
        };
        if data.len() < buffer.length() {
            let (have, need) = (data.len(), buffer.length());
            let problem = format!("buffer {} has {have} bytes, but should have {need}", buffer.index());
            return Err(source.problem(At::File, problem));
        }
        buffers.push(data);
    }
    let mut reader =
        Reader { source, buffers: &buffers, mesh: TriMesh::default(), colored: false, bare: false };
    let scene = document.default_scene().or_else(|| document.scenes().next());
    match scene {
        Some(scene) => scene.nodes().try_for_each(|n| reader.node(&n, Mat4::IDENTITY, 0))?,
        None => document.meshes().try_for_each(|m| reader.mesh(&m, Mat4::IDENTITY))?,
    }
    let mut mesh = reader.mesh;
    if !reader.colored {
        mesh.colors.clear();
    }
    if reader.bare {
        mesh.normals.clear();
    }
    Ok(mesh)
}

struct Reader<'a> {
    source: &'a Source<'a>,
    buffers: &'a [Cow<'a, [u8]>],
    mesh: TriMesh,
    /// Whether any part has a colour of its own.
    colored: bool,
    /// Whether any part lacks normals.
    bare: bool,
}

impl Reader<'_> {
    fn problem(&self, problem: String) -> Error {
        self.source.problem(At::File, problem)
    }

    fn node(&mut self, node: &::gltf::Node, parent: Mat4, depth: u32) -> Result<()> {
        // A valid file is a tree; a broken one may be a loop.
        if depth > 256 {
            return Err(self.problem("its nodes are nested more than 256 deep".into()));
        }
        let here = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if let Some(mesh) = node.mesh() {
            self.mesh(&mesh, here)?;
        }
        node.children().try_for_each(|child| self.node(&child, here, depth + 1))
    }

    fn mesh(&mut self, mesh: &::gltf::Mesh, transform: Mat4) -> Result<()> {
        mesh.primitives().try_for_each(|p| self.primitive(&p, transform))
    }

    fn primitive(&mut self, primitive: &::gltf::Primitive, transform: Mat4) -> Result<()> {
        use ::gltf::{Semantic, mesh::Mode};
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let Some(accessor) = primitive.get(&Semantic::Positions) else { return Ok(()) };
        self.check(&accessor, ::gltf::accessor::DataType::F32, 3)?;
        let normals = primitive.get(&Semantic::Normals);
        if let Some(normals) = &normals {
            self.check(normals, ::gltf::accessor::DataType::F32, 3)?;
        }
        if let Some(indices) = primitive.indices() {
            self.check(&indices, indices.data_type(), 1)?;
        }
        let buffers = self.buffers;
        let reader = primitive.reader(|b| buffers.get(b.index()).map(|bytes| &**bytes));
        let base = self.mesh.positions.len() as u32;
        let Some(positions) = reader.read_positions() else {
            return Err(self.problem("positions that cannot be read".into()));
        };
        self.mesh.positions.extend(positions.map(|p| transform.transform_point3(Vec3::from(p))));
        let count = self.mesh.positions.len() as u32 - base;
        let turn = Mat3::from_mat4(transform).inverse().transpose();
        match reader.read_normals() {
            Some(list) if list.len() == count as usize => {
                self.mesh.normals.extend(list.map(|n| (turn * Vec3::from(n)).normalize_or(Vec3::Y)));
            }
            _ => {
                self.bare = true;
                self.mesh.normals.resize((base + count) as usize, Vec3::Y);
            }
        }
        let material = primitive.material().pbr_metallic_roughness();
        let [r, g, b, _] = material.base_color_factor();
        let own = material.base_color_texture().is_none() && primitive.material().index().is_some();
        self.colored |= own;
        self.mesh.colors.resize((base + count) as usize, if own { Vec3::new(r, g, b) } else { PLAIN });
        let indices: Vec<u32> = match reader.read_indices() {
            Some(list) => list.into_u32().collect(),
            None => (0..count).collect(),
        };
        if let Some(bad) = indices.iter().find(|i| **i >= count) {
            return Err(
                self.problem(format!("vertex {bad} of a primitive does not exist, there are {count}"))
            );
        }
        // A mirroring transform turns triangles inside out.
        let flip = transform.determinant() < 0.0;
        let mut push = |[a, b, c]: [u32; 3]| {
            let t = if flip { [a, c, b] } else { [a, b, c] };
            if a != b && b != c && c != a {
                self.mesh.triangles.push(t.map(|i| i + base));
            }
        };
        match mode {
            Mode::TriangleStrip => {
                for (i, w) in indices.windows(3).enumerate() {
                    push(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] });
                }
            }
            Mode::TriangleFan => {
                for w in indices.get(1..).unwrap_or_default().windows(2) {
                    push([indices[0], w[0], w[1]]);
                }
            }
            _ => indices.as_chunks().0.iter().for_each(|t| push(*t)),
        }
        Ok(())
    }

    /// That an accessor's items are of the kind the reader expects and inside their buffer.
    fn check(
        &self,
        accessor: &::gltf::Accessor,
        kind: ::gltf::accessor::DataType,
        components: usize,
    ) -> Result<()> {
        let index = accessor.index();
        if accessor.sparse().is_some() {
            return Err(self.problem(format!("accessor {index} is sparse, which is not supported")));
        }
        let Some(view) = accessor.view() else {
            return Err(self.problem(format!("accessor {index} has no data (compression is not supported)")));
        };
        let size = kind.size() * components;
        let index_kind = matches!(
            kind,
            ::gltf::accessor::DataType::U8
                | ::gltf::accessor::DataType::U16
                | ::gltf::accessor::DataType::U32
        );
        if accessor.data_type() != kind
            || accessor.dimensions().multiplicity() != components
            || (components == 1 && !index_kind)
        {
            return Err(self.problem(format!("accessor {index} holds the wrong kind of numbers")));
        }
        let stride = view.stride().unwrap_or(size);
        let end = accessor
            .count()
            .checked_sub(1)
            .and_then(|n| n.checked_mul(stride))
            .and_then(|n| n.checked_add(size))
            .and_then(|n| n.checked_add(accessor.offset()));
        let view_end = view.offset().checked_add(view.length());
        let have = self.buffers.get(view.buffer().index()).map_or(0, |bytes| bytes.len());
        let inside = end.is_some_and(|end| end <= view.length()) && view_end.is_some_and(|end| end <= have);
        if inside && stride >= size {
            return Ok(());
        }
        Err(self.problem(format!("accessor {index} with {} items does not fit its buffer", accessor.count())))
    }
}

/// An URI's `%20` and the like.
fn unescape(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let code = bytes.get(i + 1..i + 3).filter(|_| bytes[i] == b'%');
        let code =
            code.and_then(|c| std::str::from_utf8(c).ok()).and_then(|c| u8::from_str_radix(c, 16).ok());
        out.push(code.unwrap_or(bytes[i]));
        i += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Another crate's message without its line ends.
fn one_line(error: &dyn std::fmt::Display) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
