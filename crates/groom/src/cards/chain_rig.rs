//! Chains of bones as nodes of a rig.

use super::chains::{BONES, CardChains};
use crate::{
    Rig,
    near::PointTree,
    rig::{Channel, Curve, Node, Property, Transform},
};
use glam::{Mat4, Quat, Vec3};

/// Simulated motion of the chains in an animation of the rig.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChainMotion {
    /// Index of the animation.
    pub animation: usize,
    /// Times of the keys, seconds, ascending.
    pub times: Vec<f32>,
    /// Ends of the bones at each key, as [`CardChains::followed`] returns them.
    pub joints: Vec<Vec<Vec3>>,
}

/// Nodes of a chain: its bones, and the end of the last one.
const NODES: usize = BONES + 1;

/// A rig with chains.
pub(super) struct ChainRig {
    pub(super) rig: Rig,
    /// Node of each bone, and its transform from groom space at rest.
    pub(super) bones: Vec<(usize, Mat4)>,
}

/// Rotation of a matrix without its scale.
fn rotation(matrix: Mat4) -> Quat {
    Transform::from_matrix(matrix).rotation
}

impl CardChains {
    /// Adds the chains to `rig`, the rig of a mesh at `vertices`: a chain hangs on the node that moves the vertex
    /// nearest to its root. `motions` add their rotations to animations.
    pub(super) fn on(&self, rig: &Rig, vertices: &PointTree<'_>, motions: &[ChainMotion]) -> ChainRig {
        let mut rig = rig.clone();
        let first = rig.nodes.len();
        let rest = rig.rest_pose();
        let mut bones = Vec::new();
        let mut parents = Vec::new();
        for chain in 0..self.len() {
            let ends = self.chain(chain);
            let parent = vertices.closest(ends[0]).and_then(|i| {
                let bind = rig.vertices.get(i)?;
                let strongest = bind.joints.iter().zip(bind.weights).max_by(|a, b| a.1.total_cmp(&b.1))?.0;
                Some(rig.joints.get(usize::from(*strongest))?.node)
            });
            parents.push(parent);
            let above = parent.and_then(|node| rest.globals.get(node as usize)).copied().unwrap_or_default();
            let above = rig.to_groom * above;
            let mut global = above;
            for k in 0..NODES {
                let rest = match k {
                    0 => Transform::from_matrix(above.inverse() * Mat4::from_translation(ends[0])),
                    _ => Transform { translation: ends[k] - ends[k - 1], ..Transform::default() },
                };
                global *= rest.matrix();
                let node = rig.nodes.len();
                let name = match k {
                    BONES => format!("Hair_{chain:03}_tip"),
                    _ => format!("Hair_{chain:03}_{k}"),
                };
                let parent = if k == 0 { parent } else { Some(node as u32 - 1) };
                rig.nodes.push(Node { name, parent, rest, ..Node::default() });
                if k < BONES {
                    bones.push((node, global.inverse()));
                }
            }
        }
        for motion in motions {
            self.add_motion(&mut rig, (first, &parents), motion);
        }
        ChainRig { rig, bones }
    }

    /// Adds the rotations of bones, whose nodes start at `first`, to an animation.
    fn add_motion(&self, rig: &mut Rig, (first, parents): (usize, &[Option<u32>]), motion: &ChainMotion) {
        let Some(animation) = rig.animations.get(motion.animation) else { return };
        let rest = rig.rest_pose();
        let poses: Vec<_> = motion.times.iter().map(|time| rig.pose(animation, *time)).collect();
        let mut channels = Vec::new();
        for (chain, parent) in parents.iter().enumerate() {
            let above = |globals: &[Mat4]| {
                let node = parent.and_then(|node| globals.get(node as usize));
                rotation(rig.to_groom * node.copied().unwrap_or_default())
            };
            let still = self.chain(chain);
            let mut rotations = [const { Vec::new() }; BONES];
            for (pose, joints) in poses.iter().zip(&motion.joints) {
                let ends = &joints[chain * NODES..(chain + 1) * NODES];
                let body = above(&pose.globals);
                // Each bone continues the turn of the one before with the smallest rotation to its own direction.
                let mut bone_rotation = body * above(&rest.globals).conjugate();
                let mut over = body;
                for (k, bone_keys) in rotations.iter_mut().enumerate() {
                    let from = bone_rotation * (still[k + 1] - still[k]).normalize_or(Vec3::NEG_Y);
                    let to = (ends[k + 1] - ends[k]).normalize_or(from);
                    bone_rotation = (Quat::from_rotation_arc(from, to) * bone_rotation).normalize();
                    bone_keys.push(over.conjugate() * bone_rotation);
                    over = bone_rotation;
                }
            }
            for (k, bone_keys) in rotations.into_iter().enumerate() {
                let values = bone_keys.iter().flat_map(|key| key.to_array()).collect();
                let curve = Curve { times: motion.times.clone(), values, ..Curve::default() };
                let node = (first + chain * NODES + k) as u32;
                channels.push(Channel { node, property: Property::Rotation, curve });
            }
        }
        rig.animations[motion.animation].channels.extend(channels);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TriMesh, rig::Animation};

    #[test]
    fn bones_follow_simulated_joints_under_a_turning_body() {
        // A file in centimeters whose Z axis points up, with one node that turns about it.
        let mesh = TriMesh { positions: vec![Vec3::ZERO; 3], ..Default::default() };
        let mut rig = Rig::still(&mesh);
        rig.to_groom = Mat4::from_scale_rotation_translation(
            Vec3::splat(0.01),
            Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2),
            Vec3::new(0.1, 0.2, 0.3),
        );
        rig.nodes[0].rest.rotation = Quat::from_rotation_y(0.4);
        let quarter = Quat::from_rotation_z(1.5) * rig.nodes[0].rest.rotation;
        let values = [rig.nodes[0].rest.rotation.to_array(), quarter.to_array()].concat();
        let curve = Curve { times: vec![0.0, 1.0], values, ..Curve::default() };
        rig.animations.push(Animation {
            length: 2.0,
            channels: vec![Channel { node: 0, property: Property::Rotation, curve }],
            ..Default::default()
        });
        let joints: Vec<Vec3> =
            (0..NODES).map(|k| Vec3::new(0.01 * (k * k) as f32, 1.5 - 0.05 * k as f32, 0.1)).collect();
        let chains = CardChains { strands: vec![0], joints: joints.clone() };
        let vertices = PointTree::new(&mesh.positions);
        // The root moves with the body; the hair bends to another side.
        let plain = chains.on(&rig, &vertices, &[]);
        let root = |time: f32| {
            let pose = plain.rig.pose(&plain.rig.animations[0], time);
            plain.rig.to_groom * pose.globals[plain.bones[0].0]
        };
        let moved = |time: f32| -> Vec<Vec3> {
            let mut ends = vec![root(time).w_axis.truncate()];
            for k in 0..BONES {
                let long = joints[k].distance(joints[k + 1]);
                let way = Vec3::new(0.3, -1.0, 0.2 * k as f32 * time).normalize();
                ends.push(ends[k] + long * way);
            }
            ends
        };
        let times = vec![0.0, 0.5, 1.0];
        let motion = ChainMotion {
            animation: 0,
            joints: times.iter().map(|time| moved(*time)).collect(),
            times: times.clone(),
        };
        let made = chains.on(&rig, &vertices, &[motion]);
        let at_rest = made.rig.rest_pose();
        for (k, (node, back)) in made.bones.iter().enumerate() {
            let here = made.rig.to_groom * at_rest.globals[*node];
            assert!(here.w_axis.truncate().distance(joints[k]) < 1e-5);
            assert!((here * *back).abs_diff_eq(Mat4::IDENTITY, 1e-4));
        }
        for time in times {
            let pose = made.rig.pose(&made.rig.animations[0], time);
            for (k, end) in moved(time).into_iter().enumerate() {
                let here = made.rig.to_groom * pose.globals[made.bones[0].0 + k];
                assert!(here.w_axis.truncate().distance(end) < 1e-4, "{time}, {k}");
            }
        }
    }
}
