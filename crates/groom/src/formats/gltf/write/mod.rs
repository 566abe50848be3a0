//! Writes characters as GLB (binary glTF 2.0): a mesh with skin, morph targets and animations, and hair as
//! `EXT_tresses_hair`.

mod hair;
#[cfg(test)]
mod tests;

use serde_json::{Value, json};

use crate::{
    Strands, TriMesh,
    error::{Error, Result},
    formats::{
        gltf::MESHOPT_COMPRESSION,
        writer::{EncodedFile, ExportHair},
    },
    orient::LengthUnit,
    rig::{Animation, Interpolation, Node, Property, Rig},
};

const SHORT: u32 = 5123;
pub(crate) const INT: u32 = 5125;
pub(crate) const FLOAT: u32 = 5126;

/// Encodes strands without a mesh.
///
/// # Errors
/// [`Error::Unusable`] for strands in an unknown unit: glTF is always in meters.
pub(crate) fn encode(strands: &Strands, unit: Option<LengthUnit>) -> Result<EncodedFile> {
    if unit.is_none() {
        return Err(Error::Unusable(
            "a .glb file is in meters, Y up, face +Z, but the unit and axes of this groom are unknown".into(),
        ));
    }
    Ok(character(None, &[ExportHair { name: "", strands, packed: false, look: None }])?.into())
}

/// Encodes `mesh` (meters, Y up) and, if given, the `rig` that deforms it. After reading, the mesh deforms as with
/// `rig`.
///
/// # Errors
/// [`Error::Unusable`] for a rig of another mesh.
pub(crate) fn body(mesh: &TriMesh, rig: Option<&Rig>) -> Result<Vec<u8>> {
    character(Some((mesh, rig)), &[])
}

/// Encodes a mesh with hair at rest, both in one space, or hair without a mesh.
///
/// # Errors
/// See [`body`]; also [`Error::Unusable`] for hair without strands.
pub(crate) fn character(body: Option<(&TriMesh, Option<&Rig>)>, hair: &[ExportHair<'_>]) -> Result<Vec<u8>> {
    let mut file = File::new();
    hair::put(&mut file, hair)?;
    match body {
        Some((mesh, rig)) => file.body(mesh, rig)?,
        None => {
            file.push("nodes", json!({"name": "Hair"}));
            file.root["scenes"] = json!([{"nodes": [0]}]);
        }
    }
    file.finish()
}

impl File {
    pub(crate) fn body(&mut self, mesh: &TriMesh, rig: Option<&Rig>) -> Result<()> {
        let file = self;
        let Some(rig) = rig else {
            let primitive = file.surface(mesh, &mesh.positions, &mesh.normals);
            file.push("meshes", json!({"primitives": [primitive]}));
            file.push("nodes", json!({"name": "Body", "mesh": 0}));
            file.root["scenes"] = json!([{"nodes": [0]}]);
            return Ok(());
        };
        if rig.vertices.len() != mesh.positions.len() {
            return Err(Error::Unusable("the rig does not match the mesh".into()));
        }
        let vertices = &rig.vertices;
        let positions: Vec<_> = vertices.iter().map(|v| v.position).collect();
        let normals: Vec<_> = vertices.iter().map(|v| v.normal).collect();
        let mut primitive = file.surface(mesh, &positions, &normals);
        let sets = if vertices.iter().any(|v| v.weights[4..].iter().any(|w| *w > 0.0)) { 2 } else { 1 };
        for set in 0..sets {
            let range = 4 * set..4 * set + 4;
            let joints: Vec<_> = vertices.iter().flat_map(|v| v.joints[range.clone()].to_vec()).collect();
            let weights: Vec<_> = vertices.iter().flat_map(|v| v.weights[range.clone()].to_vec()).collect();
            file.weights(&mut primitive["attributes"], set, &joints, &weights);
        }
        let targets: Vec<_> = rig.targets.iter().map(|target| file.target(target, vertices.len())).collect();
        let names: Vec<_> = rig.targets.iter().map(|target| &target.name).collect();
        let mut shape = json!({"primitives": [primitive]});
        if !targets.is_empty() {
            shape["primitives"][0]["targets"] = json!(targets);
            shape["weights"] = json!(vec![0.0; targets.len()]);
            shape["extras"] = json!({"targetNames": names});
        }
        file.push("meshes", shape);
        // Rig nodes keep their indices. The skinned node and the node with the transform to the groom's space follow
        // them.
        file.nodes(rig);
        let binds = rig.joints.iter().flat_map(|joint| joint.inverse_bind.to_cols_array());
        let binds = file.floats("MAT4", 16, binds);
        let joints: Vec<_> = rig.joints.iter().map(|joint| joint.node).collect();
        file.push("skins", json!({"joints": joints, "inverseBindMatrices": binds}));
        let skinned = file.push("nodes", json!({"name": "Body", "mesh": 0, "skin": 0}));
        let top = file.space(rig);
        // The skinned node is a root of the scene: some readers would add the transform of a parent to the joints'.
        file.root["scenes"] = json!([{"nodes": [top, skinned]}]);
        for animation in &rig.animations {
            let item = file.animation(animation, skinned, rig.targets.len());
            file.push("animations", item);
        }
        Ok(())
    }

    /// Writes four joints and weights of each vertex, the vertices' set of this number.
    pub(crate) fn weights(&mut self, attributes: &mut Value, set: usize, joints: &[u16], weights: &[f32]) {
        // The specification requires joint 0 where the weight is 0.
        let used = joints.iter().zip(weights).map(|(joint, weight)| if *weight > 0.0 { *joint } else { 0 });
        let used = used.flat_map(u16::to_le_bytes).collect();
        let joints = self.accessor(SHORT, "VEC4", weights.len() / 4, used);
        let weights = self.floats("VEC4", 4, weights.iter().copied());
        attributes[format!("JOINTS_{set}")] = json!(joints);
        attributes[format!("WEIGHTS_{set}")] = json!(weights);
    }

    /// Writes the nodes of a rig without a body to an empty scene.
    #[cfg(all(feature = "cards", feature = "textures"))]
    pub(crate) fn skeleton(&mut self, rig: &Rig) {
        self.nodes(rig);
        let top = self.space(rig);
        self.root["scenes"] = json!([{"nodes": [top]}]);
    }

    fn nodes(&mut self, rig: &Rig) {
        for (i, node) in rig.nodes.iter().enumerate() {
            let children: Vec<_> =
                (0..rig.nodes.len()).filter(|j| rig.nodes[*j].parent == Some(i as u32)).collect();
            self.push("nodes", node_of(node, &children));
        }
    }

    /// Writes the node with the transform from the rig's space to the groom's, the parent of all others.
    fn space(&mut self, rig: &Rig) -> usize {
        let roots: Vec<_> = (0..rig.nodes.len()).filter(|i| rig.nodes[*i].parent.is_none()).collect();
        let space = json!({"name": "Character", "matrix": rig.to_groom.to_cols_array(), "children": roots});
        self.push("nodes", space)
    }
}

fn node_of(node: &Node, children: &[usize]) -> Value {
    let mut item = json!({"name": node.name});
    match node.matrix {
        Some(matrix) => item["matrix"] = json!(matrix.to_cols_array()),
        None => {
            item["translation"] = json!(node.rest.translation.to_array());
            item["rotation"] = json!(node.rest.rotation.to_array());
            item["scale"] = json!(node.rest.scale.to_array());
        }
    }
    if !children.is_empty() {
        item["children"] = json!(children);
    }
    item
}

/// A file being written.
pub(crate) struct File {
    pub(crate) root: Value,
    bin: Vec<u8>,
    /// Size of the second buffer, bytes. It is a placeholder for data that the first buffer holds compressed.
    unpacked: usize,
}

impl File {
    pub(crate) fn new() -> Self {
        let asset = json!({"version": "2.0", "generator": concat!("tresses ", env!("CARGO_PKG_VERSION"))});
        Self { root: json!({"asset": asset, "scene": 0}), bin: Vec::new(), unpacked: 0 }
    }

    /// Adds an item to a list of the root and returns its index.
    pub(crate) fn push(&mut self, list: &str, item: Value) -> usize {
        let all = &mut self.root[list];
        if !all.is_array() {
            *all = json!([]);
        }
        let Some(all) = all.as_array_mut() else { return 0 };
        all.push(item);
        all.len() - 1
    }

    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.append(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    /// Appends `bytes` to the buffer and returns their offset.
    fn append(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        offset
    }

    pub(crate) fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: Vec<u8>) -> usize {
        let view = self.view(&bytes);
        self.items_of(view, component, kind, count)
    }

    /// Adds an accessor of a whole view.
    fn items_of(&mut self, view: usize, component: u32, kind: &str, count: usize) -> usize {
        let item = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
        self.push("accessors", item)
    }

    pub(crate) fn floats(&mut self, kind: &str, width: usize, values: impl Iterator<Item = f32>) -> usize {
        let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        self.accessor(FLOAT, kind, bytes.len() / (4 * width), bytes)
    }

    /// Sets the bounds of an accessor. The specification requires them for positions and for the times of keys.
    fn bounded(&mut self, accessor: usize, lo: &[f32], hi: &[f32]) -> usize {
        let item = &mut self.root["accessors"][accessor];
        (item["min"], item["max"]) = (json!(lo), json!(hi));
        accessor
    }

    pub(crate) fn position_accessor(&mut self, positions: &[glam::Vec3]) -> usize {
        let bounds = positions
            .iter()
            .fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let accessor = self.floats("VEC3", 3, positions.iter().flat_map(|p| p.to_array()));
        self.bounded(accessor, &bounds.0.to_array(), &bounds.1.to_array())
    }

    /// Returns a primitive with the triangles and colors of `mesh`, at the given positions.
    fn surface(&mut self, mesh: &TriMesh, positions: &[glam::Vec3], normals: &[glam::Vec3]) -> Value {
        let position = self.position_accessor(positions);
        let indices = mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        let indices = self.accessor(INT, "SCALAR", 3 * mesh.triangles.len(), indices);
        let mut primitive = json!({"attributes": {"POSITION": position}, "indices": indices});
        if normals.len() == positions.len() {
            let normals = self.floats("VEC3", 3, normals.iter().flat_map(|n| n.to_array()));
            primitive["attributes"]["NORMAL"] = json!(normals);
        }
        if mesh.colors.len() == positions.len() {
            let colors = self.floats("VEC3", 3, mesh.colors.iter().flat_map(|c| c.to_array()));
            primitive["attributes"]["COLOR_0"] = json!(colors);
        }
        primitive
    }

    /// Writes the deltas of a morph target as sparse accessors.
    fn target(&mut self, target: &crate::rig::MorphTarget, vertices: usize) -> Value {
        let at = target.deltas.iter().flat_map(|delta| delta.vertex.to_le_bytes()).collect::<Vec<u8>>();
        let at = self.view(&at);
        let mut part = |values: Vec<glam::Vec3>| {
            let bounds = values
                .iter()
                .fold((glam::Vec3::ZERO, glam::Vec3::ZERO), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
            let mut item = json!({"componentType": FLOAT, "type": "VEC3", "count": vertices,
                "min": bounds.0.to_array(), "max": bounds.1.to_array()});
            if !values.is_empty() {
                let bytes: Vec<u8> =
                    values.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
                item["sparse"] = json!({"count": values.len(),
                    "indices": {"bufferView": at, "componentType": INT},
                    "values": {"bufferView": self.view(&bytes)}});
            }
            self.push("accessors", item)
        };
        let position = part(target.deltas.iter().map(|delta| delta.position).collect());
        let normal = part(target.deltas.iter().map(|delta| delta.normal).collect());
        json!({"POSITION": position, "NORMAL": normal})
    }

    fn animation(&mut self, animation: &Animation, body: usize, targets: usize) -> Value {
        let (mut channels, mut samplers) = (Vec::new(), Vec::new());
        for channel in &animation.channels {
            let curve = &channel.curve;
            let parts = if curve.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
            let (path, kind, width, values) = match &channel.property {
                Property::Translation => ("translation", "VEC3", 3, curve.values.clone()),
                Property::Rotation => ("rotation", "VEC4", 4, curve.values.clone()),
                Property::Scale => ("scale", "VEC3", 3, curve.values.clone()),
                Property::Weights(of) => {
                    // glTF animates all morph targets of a mesh at once.
                    let mut all = vec![0.0; curve.times.len() * parts * targets];
                    for (row, values) in curve.values.chunks_exact(of.len().max(1)).enumerate() {
                        for (target, value) in of.iter().zip(values) {
                            all[row * targets + *target as usize] = *value;
                        }
                    }
                    ("weights", "SCALAR", 1, all)
                }
            };
            let (first, last) = (curve.times.first().copied(), curve.times.last().copied());
            let input = self.floats("SCALAR", 1, curve.times.iter().copied());
            let input = self.bounded(input, &[first.unwrap_or(0.0)], &[last.unwrap_or(0.0)]);
            let output = self.floats(kind, width, values.into_iter());
            let interpolation = match curve.interpolation {
                Interpolation::Step => "STEP",
                Interpolation::Linear => "LINEAR",
                Interpolation::CubicSpline => "CUBICSPLINE",
            };
            let node = if path == "weights" { body } else { channel.node as usize };
            channels.push(json!({"sampler": samplers.len(), "target": {"node": node, "path": path}}));
            samplers.push(json!({"input": input, "output": output, "interpolation": interpolation}));
        }
        json!({"name": animation.name, "channels": channels, "samplers": samplers})
    }

    pub(crate) fn finish(mut self) -> Result<Vec<u8>> {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.root["buffers"] = json!([{"byteLength": self.bin.len()}]);
        if self.unpacked > 0 {
            let stands_for = json!({MESHOPT_COMPRESSION: {"fallback": true}});
            self.push("buffers", json!({"byteLength": self.unpacked, "extensions": stands_for}));
        }
        let mut text = self.root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + self.bin.len();
        let length = u32::try_from(length);
        let length =
            length.map_err(|_| Error::Unusable("the file would exceed the 4 GB limit of GLB".into()))?;
        let mut bytes = Vec::with_capacity(length as usize);
        bytes.extend_from_slice(b"glTF");
        bytes.extend([2, length].into_iter().flat_map(u32::to_le_bytes));
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bin)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend_from_slice(kind);
            bytes.extend_from_slice(chunk);
        }
        Ok(bytes)
    }
}
