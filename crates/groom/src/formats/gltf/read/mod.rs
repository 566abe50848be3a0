//! Reads glTF and GLB meshes with the `gltf` crate.
//!
//! Every accessor is checked against its view and its buffer before it is read. The reader visits the nodes of the
//! scene in order, parents before children, then the meshes of the nodes, then the animations and the lights. Skinned
//! vertices are returned in the rest pose.

mod accessors;
mod animation;
mod file;
pub(super) mod hair;
mod lights;
mod morph;
mod packed;
#[cfg(feature = "textures")]
mod paint;
mod primitive;
mod skin;
mod walk;

use glam::Mat4;

use crate::{
    TriMesh,
    error::Result,
    formats::{raw::RawMesh, source::Source},
    rig::{Node, Rig},
};
use file::File;
use morph::Shapes;
use primitive::Reader;
use skin::Skins;
use walk::PlacedNode;

/// A rig being read.
struct Rigging {
    rig: Rig,
    skins: Skins,
    shapes: Shapes,
    /// Triangles of skinned primitives. Their winding depends on the rest pose, which is known after all joints are
    /// read.
    skinned: Vec<std::ops::Range<usize>>,
}

/// Reads all triangles of the default scene at rest, the rig if anything moves, and notes on skipped data.
pub(crate) fn read_mesh(source: &Source) -> Result<RawMesh> {
    let file = packed::open(source)?;
    let (placed, scene_indices) = walk::default_scene(&file)?;
    let moves = may_move(&file);
    let mut reader = Reader::new(&file, moves.then(|| Rigging::new(&placed, &scene_indices)));
    for (i, node) in placed.iter().enumerate() {
        if let Some(mesh) = node.node.mesh() {
            reader.mesh(&mesh, node.global, node.node.skin(), i as u32)?;
            reader.weights(&mesh, node.node.weights(), i as u32)?;
        }
    }
    if placed.is_empty() {
        for mesh in file.document.meshes() {
            let node = reader.add_orphan_node(mesh.name());
            reader.mesh(&mesh, Mat4::IDENTITY, None, node)?;
            reader.weights(&mesh, None, node)?;
        }
    }
    let mut raw = reader.finish(&placed, &scene_indices)?;
    let found = lights::read(&file, &placed);
    raw.lights = found.lights;
    raw.notes.extend(found.notes);
    Ok(raw)
}

/// Returns whether a file has skins, animations or morph targets.
fn may_move(file: &File) -> bool {
    let root = file.document.as_json();
    let mut primitives = root.meshes.iter().flat_map(|m| &m.primitives);
    !root.skins.is_empty() || !root.animations.is_empty() || primitives.any(|p| p.targets.is_some())
}

impl Rigging {
    fn new(placed: &[PlacedNode], scene_indices: &[Option<u32>]) -> Self {
        let nodes = placed.iter().map(PlacedNode::rest).collect();
        let rig = Rig { nodes, ..Default::default() };
        Self { rig, skins: Skins::new(scene_indices), shapes: Shapes::default(), skinned: Vec::new() }
    }

    /// Returns the rig and moves the mesh to the rest pose. `None` if nothing moves.
    fn finish(
        self,
        file: &File,
        placed: &[PlacedNode],
        scene_indices: &[Option<u32>],
        mesh: &mut TriMesh,
    ) -> Result<Option<Rig>> {
        let mut rig = self.rig;
        rig.animations = animation::read(file, placed, scene_indices, &self.shapes)?;
        rig.targets = self.shapes.targets;
        if self.skinned.is_empty() && rig.targets.is_empty() && rig.animations.is_empty() {
            return Ok(None);
        }
        let rest = rig.rest_pose();
        // Without skins and morph weights the mesh is already at rest, bit-identical to the file.
        if !self.skinned.is_empty() || rest.weights.iter().any(|w| *w != 0.0) {
            rig.deform(&rest, mesh);
        }
        for triangle in self.skinned.into_iter().flatten() {
            let t = &mut mesh.triangles[triangle];
            if t.iter().filter(|v| rig.mirrors(&rest, **v)).count() > 1 {
                t.swap(1, 2);
            }
        }
        Ok(Some(rig))
    }
}

/// Returns a node for a mesh that no scene contains.
fn lone(name: Option<&str>) -> Node {
    Node { name: name.unwrap_or_default().into(), ..Default::default() }
}
