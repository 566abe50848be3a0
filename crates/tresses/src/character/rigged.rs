//! The body of a character that a rig deforms.

use super::Gesture;
use crate::{
    Context, Error, Pose, Result,
    body::Body,
    collide::{
        FieldId,
        deform::{DeformPlaces, DeformingField},
    },
    groom::{
        RigPose, TriMesh,
        rig::anatomy::{Anatomy, Flesh},
    },
    hair::Hair,
    skinning::Skinning,
};
use glam::Quat;
use std::sync::{Arc, OnceLock};

/// A skinned body: its rig, its animation and the weights of its blend shapes.
#[derive(Debug)]
pub struct RiggedBody {
    anatomy: Arc<Anatomy>,
    skinning: Skinning,
    /// The mesh at rest, until the deforming skin is known.
    mesh: Option<Arc<TriMesh>>,
    /// Whether this instance has bent: its fields deform from then on.
    has_bent: bool,
    rest: Arc<RigPose>,
    /// How fields deform with the skin, once an instance of the body has bent.
    skin: Arc<OnceLock<DeformingSkin>>,
    animation: Option<usize>,
    /// Weights that override animations and gestures.
    shapes: Vec<(usize, f32)>,
    /// The pose that the host has set in place of animation and gesture.
    host: Option<BodyPose>,
    /// Whether the body has not moved since the last frame.
    pub(super) is_still: bool,
}

/// How the fields of a body deform with its skin.
#[derive(Debug)]
struct DeformingSkin {
    places: Option<DeformPlaces>,
    /// Whether the head's field does, and those of the other solids.
    deforms: Vec<bool>,
}

/// The joints of a skinned body at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyPose {
    /// The palette and the blend shape weights.
    pub rig: RigPose,
    /// The motion of the head's joint from where it rests, relative to the body.
    pub head: Pose,
    /// The same for the joints of the other parts that hair collides with, in the order of [`Anatomy::solids`].
    pub parts: Vec<Pose>,
}

impl RiggedBody {
    /// Deforms `body`, which was made of the anatomy's mesh.
    ///
    /// # Errors
    /// As [`Skinning::new`].
    pub(super) fn new(
        context: &Context,
        anatomy: Arc<Anatomy>,
        body: &Body,
        mesh: Arc<TriMesh>,
    ) -> Result<Self> {
        let skinning = Skinning::new(context, &anatomy.rig, body)?;
        let rest = Arc::new(anatomy.rig.rest_pose());
        let (skin, shapes) = (Arc::default(), Vec::new());
        Ok(Self {
            skinning,
            mesh: Some(mesh),
            has_bent: false,
            rest,
            skin,
            animation: None,
            shapes,
            host: None,
            is_still: false,
            anatomy,
        })
    }

    /// The same rig for another `body` of the same mesh, with the same animation and shapes.
    pub(super) fn instance(&self, body: &Body) -> Self {
        Self {
            anatomy: self.anatomy.clone(),
            skinning: self.skinning.instance(body),
            mesh: self.mesh.clone(),
            has_bent: false,
            rest: self.rest.clone(),
            skin: self.skin.clone(),
            is_still: false,
            animation: self.animation,
            shapes: self.shapes.clone(),
            host: self.host.clone(),
        }
    }

    /// The rig and the parts of the body.
    pub fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    /// The names of its animations.
    pub fn animations(&self) -> impl Iterator<Item = &str> {
        self.anatomy.rig.animations.iter().map(|animation| animation.name.as_str())
    }

    /// The names of its blend shapes.
    pub fn shapes(&self) -> impl Iterator<Item = &str> {
        self.anatomy.rig.targets.iter().map(|target| target.name.as_str())
    }

    /// Plays the animation of this name from the next frame on; `None` stops.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] with the names that there are.
    pub fn set_animation(&mut self, name: Option<&str>) -> Result<()> {
        let rig = &self.anatomy.rig;
        let Some(name) = name else {
            self.animation = None;
            return Ok(());
        };
        let Some(animation) = rig.animation(name) else {
            let there = listed(self.animations());
            return Err(Error::unusable(format!("the body has no animation {name:?}; it has {there}")));
        };
        self.animation = rig.animations.iter().position(|other| std::ptr::eq(other, animation));
        Ok(())
    }

    /// Sets the weight of a blend shape, whatever animation and gesture say.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] with the names that there are, or when `weight` is not finite.
    pub fn set_shape(&mut self, name: &str, weight: f32) -> Result<()> {
        if !weight.is_finite() {
            return Err(Error::unusable(format!("the weight of the shape {name:?} is no number")));
        }
        let shape = self.find_shape(name)?;
        self.shapes.retain(|(other, _)| *other != shape);
        self.shapes.push((shape, weight));
        Ok(())
    }

    /// The number of the blend shape of this name.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] with the names that there are.
    pub fn find_shape(&self, name: &str) -> Result<usize> {
        let missing = || {
            let there = listed(self.shapes());
            Error::unusable(format!("the body has no shape {name:?}; it has {there}"))
        };
        self.anatomy.rig.target(name).ok_or_else(missing)
    }

    /// The name of its animation; `None` without one.
    pub fn animation(&self) -> Option<&str> {
        self.animation.map(|i| self.anatomy.rig.animations[i].name.as_str())
    }

    /// The weight that was [set](Self::set_shape) for a blend shape, by its number.
    pub fn shape(&self, number: usize) -> Option<f32> {
        self.shapes.iter().find(|(shape, _)| *shape == number).map(|(_, weight)| *weight)
    }

    /// Leaves the weight of a blend shape, by its number, to animation and gesture.
    pub fn free_shape(&mut self, number: usize) {
        self.shapes.retain(|(shape, _)| *shape != number);
    }

    /// The length of its animation, s; `None` without one.
    pub fn duration(&self) -> Option<f32> {
        self.animation.map(|i| self.anatomy.rig.animations[i].length)
    }

    /// The pose of an engine's own joints, in place of animation and gesture; `None` for these again.
    pub fn set_pose(&mut self, pose: Option<BodyPose>) {
        self.host = pose;
    }

    /// Takes over what `other` plays: animation and shapes that this body has as well.
    pub(super) fn continue_from(&mut self, other: &Self) {
        self.animation = None;
        if let Some(name) = other.animation() {
            let _ = self.set_animation(Some(name));
        }
        self.shapes.clear();
        for (shape, weight) in &other.shapes {
            let _ = self.set_shape(&other.anatomy.rig.targets[*shape].name, *weight);
        }
    }

    /// Poses `body` as the rig is at `time`, s, with a `gesture` on top. Shapes of the gesture that the body lacks are
    /// skipped.
    ///
    /// # Errors
    /// As [`Skinning::pose`].
    pub(super) fn pose(&mut self, time: f64, gesture: &Gesture, body: &mut Body) -> Result<BodyPose> {
        let pose = match &self.host {
            Some(pose) => pose.clone(),
            None => self.pose_at(time, gesture),
        };
        self.is_still = !self.skinning.pose(&pose.rig, body)?;
        Ok(pose)
    }

    fn pose_at(&self, time: f64, gesture: &Gesture) -> BodyPose {
        let rig = &self.anatomy.rig;
        let animation = self.animation.map(|i| &rig.animations[i]);
        // A long time has few digits left for what is within a loop.
        let animation = animation.map(|it| (it, time.rem_euclid(f64::from(it.length.max(1e-3))) as f32));
        let turn = gesture.head.rotation;
        let is_turned = turn != Quat::IDENTITY;
        let share = |(node, share): &(u32, f32)| (*node, Quat::IDENTITY.slerp(turn, *share));
        let turns: Vec<_> = self.anatomy.turns.iter().filter(|_| is_turned).map(share).collect();
        let named = gesture.shapes.iter().filter_map(|(name, weight)| Some((rig.target(name)?, *weight)));
        let shapes: Vec<_> = named.chain(self.shapes.iter().copied()).collect();
        let pose = rig.pose_turned(animation, &shapes, &turns);
        let node = |node: u32| {
            let [rest, now] = [&*self.rest, &pose].map(|pose| rig.to_groom * pose.globals[node as usize]);
            Pose::between(&rest, &now)
        };
        let parts = self.anatomy.solids().map(|part| node(part.node)).collect();
        BodyPose { head: node(self.anatomy.head.node), parts, rig: pose }
    }

    /// Whether fields have to deform in `pose` that did not so far.
    pub(super) fn bends(&self, pose: &BodyPose) -> bool {
        !self.has_bent && (self.host.is_some() || pose.rig != *self.rest)
    }

    /// Makes the fields of `hair`'s colliders deform with the skin of `body`; `fields` are those of the solids.
    pub(super) fn deform<'a>(
        &mut self,
        body: &Body,
        has_head: bool,
        fields: &[Option<FieldId>],
        hair: impl Iterator<Item = &'a mut Hair>,
    ) -> Result<()> {
        for hair in hair {
            let known = match self.skin.get() {
                Some(known) => known,
                None => {
                    let mesh = self.mesh.as_ref().ok_or_else(|| Error::unusable("the body has no mesh"))?;
                    let flesh = Flesh::new(&self.anatomy, mesh, has_head);
                    let fields = DeformingField::of(&flesh, fields.iter().copied());
                    let places = hair.colliders.deform_places(mesh, &fields)?;
                    self.skin.get_or_init(|| DeformingSkin { places, deforms: flesh.deforms() })
                }
            };
            hair.colliders.deform_with(known.places.as_ref(), &body.into())?;
        }
        (self.has_bent, self.mesh) = (true, None);
        Ok(())
    }

    /// The poses of the fields that [deform](crate::collide::deform): of the head's and those of the other parts, relative
    /// to the body.
    pub(super) fn deforming<'a>(&'a self, pose: &'a BodyPose) -> impl Iterator<Item = Pose> + 'a {
        let all = std::iter::once(&pose.head).chain(&pose.parts);
        let deforms = self.skin.get().map_or(&[][..], |skin| &skin.deforms);
        all.zip(deforms).filter(|(_, deforms)| **deforms).map(|(pose, _)| *pose)
    }

    pub(super) fn skinning(&self) -> &Skinning {
        &self.skinning
    }
}

/// Names for a message.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.collect();
    if names.is_empty() { "none".into() } else { names.join(", ") }
}
