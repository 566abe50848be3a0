//! Evaluation of poses.

use glam::{Mat4, Quat, Vec3};

use super::{Animation, Joint, Property, Rig, Transform};

/// An evaluated pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigPose {
    /// Transform of each node to the file's space.
    pub globals: Vec<Mat4>,
    /// Transform of each joint from the space of the file's mesh to groom space.
    pub palette: Vec<Mat4>,
    /// Weight of each target, 1 for the whole shape.
    pub weights: Vec<f32>,
}

impl Rig {
    /// Returns the pose without any animation.
    pub fn rest_pose(&self) -> RigPose {
        self.pose_with(None, &[])
    }

    /// Returns the pose of an animation at `time` (seconds); the animation loops.
    pub fn pose(&self, animation: &Animation, time: f32) -> RigPose {
        self.pose_with(Some((animation, time)), &[])
    }

    /// Returns the pose of an animation at a time (seconds), or the rest pose. `morphs` sets the weights of some
    /// targets and overrides the animation.
    ///
    /// If several nodes have shapes with the same name, the largest of their weights counts, by magnitude.
    pub fn pose_with(&self, animation: Option<(&Animation, f32)>, morphs: &[(usize, f32)]) -> RigPose {
        self.pose_with_rotations(animation, morphs, &[])
    }

    /// [`pose_with`](Self::pose_with) that also turns some nodes, each about its current position, in groom space: for
    /// example, a head looks aside during a walk. Children turn with their node, so the turns along a chain multiply.
    pub fn pose_with_rotations(
        &self,
        animation: Option<(&Animation, f32)>,
        morphs: &[(usize, f32)],
        rotations: &[(u32, Quat)],
    ) -> RigPose {
        let mut locals: Vec<Transform> = self.nodes.iter().map(|n| n.rest).collect();
        let mut animated = vec![false; self.nodes.len()];
        let mut blended = vec![false; self.nodes.len()];
        let mut weights = vec![0.0f32; self.targets.len()];
        let mut raise = |target: u32, weight: f32| {
            if let Some(old) = weights.get_mut(target as usize).filter(|old| old.abs() < weight.abs()) {
                *old = weight;
            }
        };
        let mut values = Vec::new();
        let channels = animation.iter().flat_map(|(a, time)| {
            let time = a.wrap(*time);
            a.channels.iter().map(move |c| (c, time))
        });
        for (channel, time) in channels {
            let node = channel.node as usize;
            let Some(local) = locals.get_mut(node) else { continue };
            match &channel.property {
                Property::Translation => {
                    local.translation =
                        three(local.translation, |out| channel.curve.sample(time, false, out));
                }
                Property::Scale => {
                    local.scale = three(local.scale, |out| channel.curve.sample(time, false, out))
                }
                Property::Rotation => {
                    let mut out = local.rotation.to_array();
                    channel.curve.sample(time, true, &mut out);
                    local.rotation = Quat::from_array(out);
                }
                Property::Weights(targets) => {
                    values.clear();
                    values.resize(targets.len(), 0.0);
                    channel.curve.sample(time, false, &mut values);
                    targets.iter().zip(&values).for_each(|(target, weight)| raise(*target, *weight));
                    blended[node] = true;
                    continue;
                }
            }
            animated[node] = true;
        }
        let resting = self.nodes.iter().zip(&blended).filter(|(_, blended)| !**blended);
        resting.flat_map(|(node, _)| &node.weights).for_each(|(target, weight)| raise(*target, *weight));
        for (target, weight) in morphs {
            if let Some(old) = weights.get_mut(*target) {
                *old = *weight;
            }
        }
        let mut globals: Vec<Mat4> = Vec::with_capacity(self.nodes.len());
        for ((node, local), is_animated) in self.nodes.iter().zip(&locals).zip(&animated) {
            let local = node.matrix.filter(|_| !is_animated).unwrap_or_else(|| local.matrix());
            let parent = node.parent.and_then(|p| globals.get(p as usize));
            let mut global = parent.map_or(local, |parent| *parent * local);
            for (_, rotation) in rotations.iter().filter(|(node, _)| *node as usize == globals.len()) {
                let (_, to_groom, _) = self.to_groom.to_scale_rotation_translation();
                let file_rotation = to_groom.conjugate() * *rotation * to_groom;
                let at = global.w_axis.truncate();
                global = Mat4::from_rotation_translation(file_rotation, at - file_rotation * at) * global;
            }
            globals.push(global);
        }
        self.pose_of(globals, weights)
    }

    /// Returns the pose in which the nodes have the transforms `globals` to the file's space, and the targets
    /// `weights`.
    pub fn pose_of(&self, globals: Vec<Mat4>, weights: Vec<f32>) -> RigPose {
        let entry = |joint: &Joint| {
            let global = globals.get(joint.node as usize).copied().unwrap_or_default();
            self.to_groom * global * joint.inverse_bind
        };
        let palette = self.joints.iter().map(entry).collect();
        RigPose { globals, palette, weights }
    }
}

/// Returns three numbers that `sample` may overwrite.
fn three(old: Vec3, sample: impl FnOnce(&mut [f32])) -> Vec3 {
    let mut out = old.to_array();
    sample(&mut out);
    Vec3::from(out)
}
