//! The nodes of a scene, parents before children.

use glam::{Mat4, Quat, Vec3};

use super::file::File;
use crate::{
    error::Result,
    rig::{Node, Transform},
};

/// Maximum depth of nested nodes.
const DEEPEST: u32 = 256;

/// A node of the scene.
pub(super) struct PlacedNode<'a> {
    pub node: gltf::Node<'a>,
    parent: Option<u32>,
    pub global: Mat4,
}

/// Returns the nodes of the default scene in order, and the index in this list of each node of the file. Both are empty
/// in files without a scene.
pub(super) fn default_scene<'a>(file: &'a File) -> Result<(Vec<PlacedNode<'a>>, Vec<Option<u32>>)> {
    let found = file.document.default_scene().or_else(|| file.document.scenes().next());
    found.map_or_else(|| Ok(Default::default()), |found| scene(file, found))
}

fn scene<'a>(file: &'a File, scene: gltf::Scene<'a>) -> Result<(Vec<PlacedNode<'a>>, Vec<Option<u32>>)> {
    let mut walk = Walk { file, placed: Vec::new(), scene_indices: vec![None; file.document.nodes().len()] };
    scene.nodes().try_for_each(|node| walk.node(node, None, 0))?;
    Ok((walk.placed, walk.scene_indices))
}

struct Walk<'a, 'f> {
    file: &'f File<'f>,
    placed: Vec<PlacedNode<'a>>,
    scene_indices: Vec<Option<u32>>,
}

impl<'a> Walk<'a, '_> {
    fn node(&mut self, node: gltf::Node<'a>, parent: Option<u32>, depth: u32) -> Result<()> {
        let index = node.index();
        // A valid file is a tree. A broken one may have cycles, or a graph with too many paths to follow.
        if depth > DEEPEST {
            return Err(self.file.problem(format!("its nodes are nested more than {DEEPEST} levels deep")));
        }
        let scene_index = self.placed.len() as u32;
        if self.scene_indices[index].replace(scene_index).is_some() {
            return Err(self.file.problem(format!("node {index} is in the scene more than once")));
        }
        let local = Mat4::from_cols_array_2d(&node.transform().matrix());
        let above = parent.and_then(|p| self.placed.get(p as usize)).map_or(Mat4::IDENTITY, |p| p.global);
        let children = node.children();
        self.placed.push(PlacedNode { node, parent, global: above * local });
        for child in children {
            self.node(child, Some(scene_index), depth + 1)?;
        }
        Ok(())
    }
}

impl PlacedNode<'_> {
    /// Returns the node as a node of a rig.
    pub fn rest(&self) -> Node {
        let (rest, matrix) = match self.node.transform() {
            gltf::scene::Transform::Decomposed { translation, rotation, scale } => {
                let rest = Transform {
                    translation: Vec3::from(translation),
                    rotation: Quat::from_array(rotation),
                    scale: Vec3::from(scale),
                };
                (rest, None)
            }
            gltf::scene::Transform::Matrix { matrix } => {
                let matrix = Mat4::from_cols_array_2d(&matrix);
                (Transform::from_matrix(matrix), Some(matrix))
            }
        };
        let name = self.node.name().unwrap_or_default().into();
        Node { name, parent: self.parent, rest, matrix, weights: Vec::new() }
    }
}
