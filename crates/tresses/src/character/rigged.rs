//! A body that a rig deforms.

use super::{Gesture, skinned::HostSkin};
use crate::{
    Context, Error, Pose, Result,
    body::Body,
    collide::{
        FieldId,
        deform::{DeformPoints, DeformingField},
    },
    groom::{
        RigPose, TriMesh,
        rig::anatomy::{Anatomy, Flesh},
    },
    hair::Hair,
    skinning::{SkinAsset, Skinning},
};
use glam::{Mat4, Quat, Vec3};
use std::sync::{Arc, OnceLock};

/// The rig of a body on the GPU, shared by instances.
#[derive(Debug)]
pub(super) struct RigAsset {
    anatomy: Arc<Anatomy>,
    skin: Arc<SkinAsset>,
    rest: RigPose,
    /// The mesh at rest.
    mesh: Arc<TriMesh>,
    /// How fields deform with the skin; computed when the first instance bends.
    deforming: OnceLock<DeformingSkin>,
}

impl RigAsset {
    /// Uploads the rig of `anatomy`, whose mesh at rest is `mesh`, on the GPU `body`.
    ///
    /// # Errors
    /// As [`SkinAsset::new`].
    pub fn new(context: &Context, anatomy: Arc<Anatomy>, mesh: Arc<TriMesh>, body: &Body) -> Result<Self> {
        let skin = SkinAsset::new(context, &anatomy.rig, body)?.into();
        Ok(Self { rest: anatomy.rig.rest_pose(), anatomy, skin, mesh, deforming: OnceLock::new() })
    }
}

/// A skinned body: its rig, its animation and its blend shape weights.
#[derive(Debug)]
pub struct RiggedBody {
    asset: Arc<RigAsset>,
    skinning: Skinning,
    /// Whether this instance has bent. Its fields deform from then on.
    has_bent: bool,
    animation: Option<usize>,
    /// Weights by blend shape that override animations and gestures.
    shapes: Vec<(usize, f32)>,
    /// A pose by the host, in place of animation and gesture.
    host: Option<HostPose>,
    /// Whether the body has not moved since the last frame.
    pub(super) is_still: bool,
}

/// How the distance fields of a body deform with its skin.
#[derive(Debug)]
struct DeformingSkin {
    points: Option<DeformPoints>,
    /// Whether the field of each solid deforms; the head is first.
    deforms: Vec<bool>,
}

/// A pose by a host, in place of animation and gesture.
#[derive(Clone, Debug)]
enum HostPose {
    Joints(BodyPose),
    Vertices(HostSkin),
}

/// The pose of a skinned body's joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyPose {
    /// Joint palette and blend shape weights.
    pub rig: RigPose,
    /// Motion of the head's joint from its rest pose, relative to the body.
    pub head: Pose,
    /// Motion of the joints of the other solids, in the order of [`Anatomy::solids`].
    pub parts: Vec<Pose>,
}

impl RiggedBody {
    /// Deforms `body`, which has vertices of its own.
    ///
    /// # Errors
    /// As [`Skinning::of`].
    pub(super) fn new(asset: &Arc<RigAsset>, body: &Body) -> Result<Self> {
        Ok(Self {
            skinning: Skinning::of(&asset.skin, body)?,
            has_bent: false,
            animation: None,
            shapes: Vec::new(),
            host: None,
            is_still: false,
            asset: asset.clone(),
        })
    }

    /// Returns the rig and the parts of the body.
    pub fn anatomy(&self) -> &Anatomy {
        &self.asset.anatomy
    }

    /// Returns the names of the animations.
    pub fn animations(&self) -> impl Iterator<Item = &str> {
        self.asset.anatomy.rig.animations.iter().map(|animation| animation.name.as_str())
    }

    /// Returns the names of the blend shapes.
    pub fn shapes(&self) -> impl Iterator<Item = &str> {
        self.asset.anatomy.rig.targets.iter().map(|target| target.name.as_str())
    }

    /// Plays the animation of this name from the next frame on; `None` stops it.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] with a list of the available names.
    pub fn set_animation(&mut self, name: Option<&str>) -> Result<()> {
        let rig = &self.asset.anatomy.rig;
        let Some(name) = name else {
            self.animation = None;
            return Ok(());
        };
        let Some(animation) = rig.animation(name) else {
            let available = listed(self.animations());
            return Err(Error::unusable(format!("the body has no animation {name:?}; it has {available}")));
        };
        self.animation = rig.animations.iter().position(|other| std::ptr::eq(other, animation));
        Ok(())
    }

    /// Sets the weight of a blend shape, overriding animation and gesture.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] with a list of the available names, or when `weight` is not finite.
    pub fn set_shape(&mut self, name: &str, weight: f32) -> Result<()> {
        if !weight.is_finite() {
            return Err(Error::unusable(format!("the weight of the blend shape {name:?} is not finite")));
        }
        let shape = self.find_shape(name)?;
        self.shapes.retain(|(other, _)| *other != shape);
        self.shapes.push((shape, weight));
        Ok(())
    }

    /// Returns the index of the blend shape of this name.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] with a list of the available names.
    pub fn find_shape(&self, name: &str) -> Result<usize> {
        let missing = || {
            let available = listed(self.shapes());
            Error::unusable(format!("the body has no blend shape {name:?}; it has {available}"))
        };
        self.asset.anatomy.rig.target(name).ok_or_else(missing)
    }

    /// Returns the name of the current animation; `None` without one.
    pub fn animation(&self) -> Option<&str> {
        self.animation.map(|i| self.asset.anatomy.rig.animations[i].name.as_str())
    }

    /// Returns the weight that [`set_shape`](Self::set_shape) set for a blend shape, by its index.
    pub fn shape(&self, number: usize) -> Option<f32> {
        self.shapes.iter().find(|(shape, _)| *shape == number).map(|(_, weight)| *weight)
    }

    /// Stops overriding the weight of a blend shape, by its index.
    pub fn free_shape(&mut self, number: usize) {
        self.shapes.retain(|(shape, _)| *shape != number);
    }

    /// Returns the length of the current animation, s; `None` without one.
    pub fn duration(&self) -> Option<f32> {
        self.animation.map(|i| self.asset.anatomy.rig.animations[i].length)
    }

    /// Sets the pose from an engine's own joints, in place of animation and gesture; `None` returns to these.
    pub fn set_pose(&mut self, pose: Option<BodyPose>) {
        self.host = pose.map(HostPose::Joints);
    }

    /// Sets the vertices that a host has deformed, from the next frame on, in place of animation and gesture.
    /// `positions` has one point per vertex of the body's mesh, relative to the pose of the body, meters. `joints` has
    /// the poses of the joints ([`pose_of`](Self::pose_of)); without it they are fitted to the vertices.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for another number of vertices, for vertices that are not finite, and if the
    /// body has bent by its joints before.
    pub fn set_vertices(&mut self, positions: &[Vec3], joints: Option<&BodyPose>) -> Result<()> {
        if !matches!(self.host, Some(HostPose::Vertices(_))) {
            if self.has_bent {
                let problem = "the body has been moved by its joints: set vertices from the first frame on";
                return Err(Error::unusable(problem));
            }
            self.host = Some(HostPose::Vertices(HostSkin::new(&self.asset.mesh, &self.asset.anatomy)));
        }
        match &mut self.host {
            Some(HostPose::Vertices(skin)) => {
                let all =
                    |pose: &BodyPose| std::iter::once(pose.head).chain(pose.parts.iter().copied()).collect();
                skin.set(positions, joints.map(all))
            }
            _ => Ok(()),
        }
    }

    /// Returns the pose of the body in which its nodes have the transforms `globals`, in the space of the rig's file.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for another number of nodes.
    pub fn pose_of(&self, globals: &[Mat4]) -> Result<BodyPose> {
        let rig = &self.asset.anatomy.rig;
        if globals.len() != rig.nodes.len() {
            let problem =
                format!("there are {} transforms, but the rig has {} nodes", globals.len(), rig.nodes.len());
            return Err(Error::unusable(problem));
        }
        Ok(self.posed(rig.pose_of(globals.to_vec(), self.asset.rest.weights.clone())))
    }

    /// Takes over the animation and shapes of `other`, as far as this body has them, and its pose if it is of the same
    /// asset.
    pub(super) fn continue_from(&mut self, other: &Self) {
        if Arc::ptr_eq(&self.asset, &other.asset) {
            self.host = other.host.clone();
        }
        self.animation = None;
        if let Some(name) = other.animation() {
            let _ = self.set_animation(Some(name));
        }
        self.shapes.clear();
        for (shape, weight) in &other.shapes {
            let _ = self.set_shape(&other.asset.anatomy.rig.targets[*shape].name, *weight);
        }
    }

    /// Poses `body` by the rig at `time` (s) with `gesture` on top. Skips shapes of the gesture that the body lacks.
    ///
    /// # Errors
    /// As [`Skinning::pose`].
    pub(super) fn pose(&mut self, time: f64, gesture: &Gesture, body: &mut Body) -> Result<BodyPose> {
        let pose = match &mut self.host {
            Some(HostPose::Vertices(skin)) => {
                self.is_still = !skin.upload(body);
                self.skinning.forget();
                let (head, parts) = skin.poses().split_first().unwrap_or((&Pose::IDENTITY, &[]));
                return Ok(BodyPose { head: *head, parts: parts.to_vec(), ..BodyPose::default() });
            }
            Some(HostPose::Joints(pose)) => pose.clone(),
            None => self.pose_at(time, gesture),
        };
        self.is_still = !self.skinning.pose(&pose.rig, body)?;
        Ok(pose)
    }

    fn pose_at(&self, time: f64, gesture: &Gesture) -> BodyPose {
        let rig = &self.asset.anatomy.rig;
        let animation = self.animation.map(|i| &rig.animations[i]);
        // Take the remainder in double precision: a long time has few digits left within a loop.
        let animation = animation.map(|it| (it, time.rem_euclid(f64::from(it.length.max(1e-3))) as f32));
        let rotation = gesture.head.rotation;
        let is_rotated = rotation != Quat::IDENTITY;
        let node_rotation = |(node, weight): &(u32, f32)| (*node, Quat::IDENTITY.slerp(rotation, *weight));
        let rotations: Vec<_> =
            self.asset.anatomy.rotation_weights.iter().filter(|_| is_rotated).map(node_rotation).collect();
        let named = gesture.shapes.iter().filter_map(|(name, weight)| Some((rig.target(name)?, *weight)));
        let shapes: Vec<_> = named.chain(self.shapes.iter().copied()).collect();
        self.posed(rig.pose_with_rotations(animation, &shapes, &rotations))
    }

    /// Adds the poses of head and parts.
    fn posed(&self, pose: RigPose) -> BodyPose {
        let rig = &self.asset.anatomy.rig;
        let node = |node: u32| {
            let [rest, now] =
                [&self.asset.rest, &pose].map(|pose| rig.to_groom * pose.globals[node as usize]);
            Pose::between(&rest, &now)
        };
        let parts = self.asset.anatomy.solids().map(|part| node(part.node)).collect();
        BodyPose { head: node(self.asset.anatomy.head.node), parts, rig: pose }
    }

    /// Whether `pose` bends the body for the first time, so that fields must deform from now on.
    pub(super) fn bends(&self, pose: &BodyPose) -> bool {
        !self.has_bent && (self.host.is_some() || pose.rig != self.asset.rest)
    }

    /// Makes the fields of `hair`'s colliders deform with the skin of `body`. `fields` are the fields of the solids.
    pub(super) fn deform<'a>(
        &mut self,
        body: &Body,
        has_head: bool,
        fields: &[Option<FieldId>],
        hair: impl Iterator<Item = &'a mut Hair>,
    ) -> Result<()> {
        if self.has_bent {
            return Ok(());
        }
        let asset = &self.asset;
        for hair in hair {
            let known = match asset.deforming.get() {
                Some(known) => known,
                None => {
                    let is_free = matches!(self.host, Some(HostPose::Vertices(_)));
                    let flesh = Flesh::new(&asset.anatomy, &asset.mesh, has_head, is_free);
                    let fields = DeformingField::of(&flesh, fields.iter().copied());
                    let points = hair.colliders.find_deform_points(&asset.mesh, &fields)?;
                    asset.deforming.get_or_init(|| DeformingSkin { points, deforms: flesh.deforms() })
                }
            };
            hair.colliders.deform_with(known.points.as_ref(), &body.into())?;
        }
        self.has_bent = true;
        Ok(())
    }

    /// Returns the poses of the fields that [deform](crate::collide::deform), the head's first, relative to the body.
    pub(super) fn deforming<'a>(&'a self, pose: &'a BodyPose) -> impl Iterator<Item = Pose> + 'a {
        let all = std::iter::once(&pose.head).chain(&pose.parts);
        let deforms = self.asset.deforming.get().map_or(&[][..], |skin| &skin.deforms);
        all.zip(deforms).filter(|(_, deforms)| **deforms).map(|(pose, _)| *pose)
    }

    pub(super) fn skinning(&self) -> &Skinning {
        &self.skinning
    }
}

/// Joins names for a message.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.collect();
    if names.is_empty() { "none".into() } else { names.join(", ") }
}
