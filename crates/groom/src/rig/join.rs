//! Merging of several rigs, and rigs of static meshes.

use std::collections::HashMap;

use glam::Mat4;

use super::{Bind, Joint, MAX_JOINTS, Node, Property, Rig};
use crate::{
    TriMesh,
    error::{Error, Result},
};

impl Rig {
    /// Returns the rig of a static mesh: all vertices follow one node that never moves.
    pub fn still(mesh: &TriMesh) -> Self {
        let normals = mesh.normals.iter().copied().chain(std::iter::repeat(glam::Vec3::Y));
        Self {
            nodes: vec![Node::default()],
            joints: vec![Joint { node: 0, inverse_bind: Mat4::IDENTITY }],
            vertices: mesh.positions.iter().zip(normals).map(|(p, n)| Bind::rigid(*p, n, 0)).collect(),
            ..Self::default()
        }
    }

    /// Appends another rig, whose vertices come after this one's. Targets with the same name become one, and so do
    /// animations, which then last as long as the longer one. Both rigs share a space; `to_groom` stays.
    ///
    /// # Errors
    /// [`Error::Unusable`] for more than [`MAX_JOINTS`] joints.
    pub fn append(&mut self, other: Self) -> Result<()> {
        let (nodes, joints) = (self.nodes.len() as u32, self.joints.len());
        if joints + other.joints.len() > MAX_JOINTS {
            let all = joints + other.joints.len();
            return Err(Error::Unusable(format!("the rig has {all} joints, more than {MAX_JOINTS}")));
        }
        let vertices = self.vertices.len() as u32;
        let mut named: HashMap<String, usize> =
            self.targets.iter().enumerate().map(|(i, t)| (t.name.clone(), i)).collect();
        let mut targets = Vec::with_capacity(other.targets.len());
        for mut target in other.targets {
            target.deltas.iter_mut().for_each(|d| d.vertex += vertices);
            let index = *named.entry(target.name.clone()).or_insert(self.targets.len());
            targets.push(index as u32);
            match self.targets.get_mut(index) {
                Some(old) => old.deltas.append(&mut target.deltas),
                None => self.targets.push(target),
            }
        }
        let target = |i: u32| targets.get(i as usize).copied().unwrap_or(u32::MAX);
        for mut node in other.nodes {
            node.parent = node.parent.map(|p| p + nodes);
            node.weights.iter_mut().for_each(|(t, _)| *t = target(*t));
            self.nodes.push(node);
        }
        self.joints.extend(other.joints.into_iter().map(|j| Joint { node: j.node + nodes, ..j }));
        self.vertices.extend(other.vertices.into_iter().map(|v| {
            let joints = v.joints.map(|j| (j as usize + joints) as u16);
            Bind { joints, ..v }
        }));
        for mut animation in other.animations {
            for channel in &mut animation.channels {
                channel.node += nodes;
                if let Property::Weights(all) = &mut channel.property {
                    all.iter_mut().for_each(|t| *t = target(*t));
                }
            }
            match self.animations.iter_mut().find(|a| a.name == animation.name) {
                Some(old) => {
                    old.length = old.length.max(animation.length);
                    old.channels.append(&mut animation.channels);
                }
                None => self.animations.push(animation),
            }
        }
        Ok(())
    }
}
