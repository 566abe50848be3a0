//! Reads the triangles of meshes and, for a rig, the joints of their vertices.

use glam::{Mat3, Mat4, Vec3};
use gltf::{Semantic, mesh::Mode};

use super::{Rigging, file::File, lone, walk::PlacedNode};
use crate::{
    TriMesh,
    error::Result,
    formats::{faces::PLAIN, raw::RawMesh},
    orient::OrientationOverride,
    rig::{Bind, Joint},
};

/// Collects the meshes of a file in one mesh.
pub(super) struct Reader<'a> {
    file: &'a File<'a>,
    mesh: TriMesh,
    /// Whether any part has its own color.
    colored: bool,
    /// Whether any part lacks normals.
    lacks_normals: bool,
    /// The rig being read, if the file may have one.
    rigging: Option<Rigging>,
    #[cfg(feature = "textures")]
    painter: super::paint::Painter,
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a File<'a>, rigging: Option<Rigging>) -> Self {
        Self {
            file,
            mesh: TriMesh::default(),
            colored: false,
            lacks_normals: false,
            rigging,
            #[cfg(feature = "textures")]
            painter: Default::default(),
        }
    }

    /// Returns the mesh at rest, its rig if anything moves, and the notes.
    pub fn finish(mut self, placed: &[PlacedNode], scene_indices: &[Option<u32>]) -> Result<RawMesh> {
        #[cfg(not(feature = "textures"))]
        let notes = Vec::new();
        #[cfg(feature = "textures")]
        let (paint, notes) = self.painter.finish(self.mesh.positions.len());
        #[cfg(feature = "textures")]
        if let Some(paint) = paint {
            // Vertex colors serve for light bounced off the mesh, and wherever textures are not drawn.
            for (vertex, color) in self.mesh.colors.iter_mut().enumerate() {
                *color = paint.color(vertex).unwrap_or(*color);
            }
            self.mesh.paint = Some(std::sync::Arc::new(paint));
        }
        if !self.colored {
            self.mesh.colors.clear();
        }
        let rig = match self.rigging {
            Some(rigging) => rigging.finish(self.file, placed, scene_indices, &mut self.mesh)?,
            None => None,
        };
        if self.lacks_normals {
            self.mesh.normals.clear();
        }
        Ok(RawMesh { mesh: self.mesh, declared: OrientationOverride::METERS, rig, lights: Vec::new(), notes })
    }

    /// Adds a node for a mesh that no scene contains and returns its index.
    pub fn add_orphan_node(&mut self, name: Option<&str>) -> u32 {
        let Some(rigging) = &mut self.rigging else { return 0 };
        rigging.rig.nodes.push(lone(name));
        rigging.rig.nodes.len() as u32 - 1
    }

    /// Reads the morph weights at rest of a mesh: the node's if it has weights, else the mesh's own.
    pub fn weights(&mut self, mesh: &gltf::Mesh, own: Option<&[f32]>, node: u32) -> Result<()> {
        let Some(rigging) = &mut self.rigging else { return Ok(()) };
        let Some(weights) = own.or(mesh.weights()) else { return Ok(()) };
        if weights.iter().any(|w| !w.is_finite()) {
            let problem = format!("mesh {} has weights that are not finite", mesh.index());
            return Err(self.file.problem(problem));
        }
        let shapes = rigging.shapes.of(mesh.index());
        let weights = shapes.iter().zip(weights).filter(|(_, w)| **w != 0.0).map(|(t, w)| (*t, *w));
        rigging.rig.nodes[node as usize].weights = weights.collect();
        Ok(())
    }

    /// Reads the mesh of a node.
    pub fn mesh(
        &mut self,
        mesh: &gltf::Mesh,
        transform: Mat4,
        skin: Option<gltf::Skin>,
        node: u32,
    ) -> Result<()> {
        if let Some(rigging) = &mut self.rigging {
            rigging.shapes.name(self.file, mesh)?;
        }
        // Primitives without a skin follow the node.
        let mut joint = None;
        mesh.primitives()
            .try_for_each(|p| self.primitive(mesh, &p, transform, skin.as_ref(), (node, &mut joint)))
    }

    fn primitive(
        &mut self,
        mesh: &gltf::Mesh,
        primitive: &gltf::Primitive,
        transform: Mat4,
        skin: Option<&gltf::Skin>,
        (node, joint): (u32, &mut Option<u16>),
    ) -> Result<()> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let Some(accessor) = primitive.get(&Semantic::Positions) else { return Ok(()) };
        let positions = self.file.vec3s(&accessor)?;
        let normals =
            primitive.get(&Semantic::Normals).map(|normals| self.file.vec3s(&normals)).transpose()?;
        if let Some(indices) = primitive.indices() {
            self.file.check(&indices, indices.data_type(), 1)?;
            self.file.spend(indices.count(), size_of::<[u32; 4]>())?;
        }
        self.file.spend(accessor.count(), size_of::<[Vec3; 3]>())?;
        let buffers = &self.file.buffers;
        let reader = primitive.reader(|b| buffers.get(b.index()).map(|bytes| &**bytes));
        let base = self.mesh.positions.len();
        let normals = normals.filter(|list| list.len() == positions.len());
        let skinned = self.bind(primitive, &positions, normals.as_deref(), skin, (node, joint))?;
        if let Some(rigging) = &mut self.rigging {
            rigging.shapes.read(self.file, mesh, primitive, (base, positions.len()))?;
        }
        let count = positions.len() as u32;
        self.mesh.positions.extend(positions.into_iter().map(|p| transform.transform_point3(p)));
        let normal_matrix = Mat3::from_mat4(transform).inverse().transpose();
        match normals {
            Some(list) => {
                self.mesh.normals.extend(list.into_iter().map(|n| (normal_matrix * n).normalize_or(Vec3::Y)));
            }
            None => {
                self.lacks_normals = true;
                self.mesh.normals.resize(self.mesh.positions.len(), Vec3::Y);
            }
        }
        let material = primitive.material().pbr_metallic_roughness();
        let [r, g, b, _] = material.base_color_factor();
        let own = material.base_color_texture().is_none() && primitive.material().index().is_some();
        #[cfg(feature = "textures")]
        let own = self.painter.primitive(self.file, primitive, base, count as usize)? || own;
        self.colored |= own;
        self.mesh.colors.resize(self.mesh.positions.len(), if own { Vec3::new(r, g, b) } else { PLAIN });
        let indices: Vec<u32> = match reader.read_indices() {
            Some(list) => list.into_u32().collect(),
            None => (0..count).collect(),
        };
        if let Some(bad) = indices.iter().find(|i| **i >= count) {
            return Err(self
                .file
                .problem(format!("vertex {bad} of a primitive does not exist; there are {count}")));
        }
        // A mirroring transform reverses the winding. Skins ignore the node's transform.
        let flip = !skinned && transform.determinant() < 0.0;
        let first = self.mesh.triangles.len();
        triangles(mode, &indices, |[a, b, c]| {
            let t = if flip { [a, c, b] } else { [a, b, c] };
            if a != b && b != c && c != a {
                self.mesh.triangles.push(t.map(|i| i + base as u32));
            }
        });
        if let Some(rigging) = self.rigging.as_mut().filter(|_| skinned) {
            rigging.skinned.push(first..self.mesh.triangles.len());
        }
        Ok(())
    }

    /// Adds the joints of a primitive's vertices. Returns whether they come from a skin.
    fn bind(
        &mut self,
        primitive: &gltf::Primitive,
        positions: &[Vec3],
        normals: Option<&[Vec3]>,
        skin: Option<&gltf::Skin>,
        (node, joint): (u32, &mut Option<u16>),
    ) -> Result<bool> {
        let Some(rigging) = &mut self.rigging else { return Ok(false) };
        self.file.spend(positions.len(), size_of::<Bind>())?;
        let normal = |i: usize| normals.map_or(Vec3::Y, |n| n[i].normalize_or(Vec3::Y));
        let skin = skin.filter(|_| primitive.get(&Semantic::Joints(0)).is_some());
        let Some(skin) = skin else {
            let joint = match *joint {
                Some(joint) => joint,
                None => {
                    let own = Joint { node, inverse_bind: Mat4::IDENTITY };
                    *joint.insert(rigging.skins.push(self.file, &mut rigging.rig.joints, own)?)
                }
            };
            let binds = positions.iter().enumerate().map(|(i, p)| Bind::rigid(*p, normal(i), joint));
            rigging.rig.vertices.extend(binds);
            return Ok(false);
        };
        let palette = rigging.skins.palette(self.file, &mut rigging.rig.joints, skin)?;
        let follows = super::skin::follows(self.file, primitive, positions.len(), palette)?;
        let binds = follows.into_iter().zip(positions).enumerate();
        let binds = binds.map(|(i, ((joints, weights), p))| Bind {
            position: *p,
            normal: normal(i),
            joints,
            weights,
        });
        rigging.rig.vertices.extend(binds);
        Ok(true)
    }
}

/// Passes the triangles of a list, strip or fan to `push`.
fn triangles(mode: Mode, indices: &[u32], mut push: impl FnMut([u32; 3])) {
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
}
