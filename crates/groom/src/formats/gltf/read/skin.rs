//! Joints of skins, and the joints and weights of vertices.

use std::ops::Range;

use glam::Mat4;
use gltf::Semantic;

use super::file::File;
use crate::{
    error::Result,
    rig::{INFLUENCES, Joint, MAX_JOINTS},
};

/// Joints and weights of a vertex.
pub(super) type Follows = ([u16; INFLUENCES], [f32; INFLUENCES]);

/// Skins whose joints are already in the palette.
pub(super) struct Skins {
    /// Index in the scene of each node of the file.
    scene_indices: Vec<Option<u32>>,
    known: std::collections::HashMap<usize, Range<usize>>,
}

impl Skins {
    pub fn new(scene_indices: &[Option<u32>]) -> Self {
        Self { scene_indices: scene_indices.to_vec(), known: Default::default() }
    }

    /// Adds an entry to the palette and returns its index.
    pub fn push(&self, file: &File, joints: &mut Vec<Joint>, joint: Joint) -> Result<u16> {
        let Ok(index) = u16::try_from(joints.len()) else {
            return Err(file.problem(format!("the vertices follow more than {MAX_JOINTS} joints and nodes")));
        };
        file.spend(1, size_of::<Joint>())?;
        joints.push(joint);
        Ok(index)
    }

    /// Returns the palette entries of a skin, and adds them on first use.
    pub fn palette(
        &mut self,
        file: &File,
        joints: &mut Vec<Joint>,
        skin: &gltf::Skin,
    ) -> Result<Range<usize>> {
        let index = skin.index();
        if let Some(known) = self.known.get(&index) {
            return Ok(known.clone());
        }
        let nodes: Vec<usize> = skin.joints().map(|n| n.index()).collect();
        if nodes.is_empty() {
            return Err(file.problem(format!("skin {index} has no joints")));
        }
        let inverse = match skin.inverse_bind_matrices() {
            Some(accessor) => file.numbers(&accessor, 16)?,
            None => Mat4::IDENTITY.to_cols_array().repeat(nodes.len()),
        };
        let inverse = inverse.as_chunks().0;
        if inverse.len() < nodes.len() {
            let (have, need) = (inverse.len(), nodes.len());
            return Err(file.problem(format!("skin {index} has {have} matrices for {need} joints")));
        }
        let first = joints.len();
        for (node, inverse) in nodes.into_iter().zip(inverse) {
            let Some(scene_index) = self.scene_indices.get(node).copied().flatten() else {
                let problem = format!("node {node}, a joint of skin {index}, is not in the scene");
                return Err(file.problem(problem));
            };
            let inverse_bind = Mat4::from_cols_array(inverse);
            self.push(file, joints, Joint { node: scene_index, inverse_bind })?;
        }
        self.known.insert(index, first..joints.len());
        Ok(first..joints.len())
    }
}

/// Returns the joints and weights of a primitive's vertices. `palette` is the range of the skin's entries, of which
/// each vertex follows up to eight. Weights are normalized to a sum of 1; a vertex without weights follows its first
/// joint.
pub(super) fn follows(
    file: &File,
    primitive: &gltf::Primitive,
    count: usize,
    palette: Range<usize>,
) -> Result<Vec<Follows>> {
    file.spend(count, size_of::<Follows>())?;
    let mut all: Vec<Follows> = vec![Default::default(); count];
    for set in 0..INFLUENCES / 4 {
        let joints = primitive.get(&Semantic::Joints(set as u32));
        let weights = primitive.get(&Semantic::Weights(set as u32));
        let (joints, weights) = match (joints, weights) {
            (None, None) => continue,
            (Some(joints), Some(weights)) => (file.joints(&joints)?, file.numbers(&weights, 4)?),
            _ => {
                return Err(
                    file.problem(format!("a primitive has only one of JOINTS_{set} and WEIGHTS_{set}"))
                );
            }
        };
        let weights = weights.as_chunks::<4>().0;
        if joints.len() != count || weights.len() != count {
            let (j, w) = (joints.len(), weights.len());
            return Err(
                file.problem(format!("a primitive has {j} joints and {w} weights for {count} vertices"))
            );
        }
        for ((all, joints), weights) in all.iter_mut().zip(joints).zip(weights) {
            all.0[4 * set..][..4].copy_from_slice(&joints);
            all.1[4 * set..][..4].copy_from_slice(weights);
        }
    }
    for (i, (joints, weights)) in all.iter_mut().enumerate() {
        // Negative weights come from rounding or from broken files.
        weights.iter_mut().for_each(|w| *w = w.max(0.0));
        let sum: f32 = weights.iter().sum();
        if sum > 0.0 && sum.is_finite() {
            weights.iter_mut().for_each(|w| *w /= sum);
        } else if sum == 0.0 {
            weights[0] = 1.0;
        } else {
            return Err(file.problem(format!("the weights of vertex {i} of a primitive are too large")));
        }
        for (joint, weight) in joints.iter_mut().zip(weights) {
            let entry = palette.start + usize::from(*joint);
            if palette.contains(&entry) {
                *joint = entry as u16;
            } else if *weight > 0.0 {
                let (bad, have) = (*joint, palette.len());
                let problem = format!(
                    "vertex {i} of a primitive follows joint {bad}, which does not exist; there are {have}"
                );
                return Err(file.problem(problem));
            } else {
                // Files may store any joint with weight 0.
                *joint = palette.start as u16;
            }
        }
    }
    Ok(all)
}
