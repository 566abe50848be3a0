//! A body that bends: what becomes of its parts, and the poses of its motions.

use anyhow::{Context, Result, bail};
use tresses::{
    Hair, Pipelines, Pose,
    body::Body,
    collide::{FieldId, deform::DeformingField},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::{
        RigPose, TriMesh,
        rig::anatomy::{Anatomy, Capsule, Flesh, PartForm},
    },
    skinning::Skinning,
};

use crate::{
    colliders::{Joint, Role},
    motion::Gesture,
};

/// What `joints` say becomes of the parts of a body that they name; `mesh` is the body's.
///
/// # Errors
/// One sentence for a joint that is not there, that holds nothing, or that is the head's.
pub fn arrange(anatomy: &mut Anatomy, joints: &[Joint], mesh: &TriMesh) -> Result<()> {
    for joint in joints {
        let named = anatomy.named(&joint.joint)?;
        if named.contains(&anatomy.head.node) {
            bail!("hair grows on the joint {:?}: its part is always a distance field", joint.joint);
        }
        let mut found = false;
        for i in 0..anatomy.parts.len() {
            let node = anatomy.parts[i].node;
            if !named.contains(&node) {
                continue;
            }
            found = true;
            let known = anatomy.parts[i].fitted;
            let fitted = match joint.shape {
                Role::Fitted => known.or_else(|| anatomy.fit(node, mesh)),
                _ => known,
            };
            let part = &mut anatomy.parts[i];
            part.fitted = fitted;
            part.friction = joint.friction;
            part.form = match joint.shape {
                Role::Nothing => PartForm::Nothing,
                Role::Field => PartForm::Field,
                Role::Capsule { from, to, radius } => {
                    PartForm::Capsule(Capsule { ends: [from, to].map(Vec3::from), radius })
                }
                Role::Fitted => {
                    let fitted = fitted.with_context(|| {
                        format!("the joint {:?} holds too little to fit a capsule to", joint.joint)
                    })?;
                    PartForm::Capsule(fitted.capsule)
                }
            };
        }
        if !found {
            bail!("the joint {:?} holds nothing", joint.joint);
        }
    }
    Ok(())
}

/// A body on the GPU that bends.
pub struct Living {
    anatomy: Anatomy,
    skinning: Skinning,
    rest: RigPose,
    /// Whether the head's field deforms with the skin, and those of the other solids: nothing of a body that has not bent.
    deforms: Vec<bool>,
    animation: Option<usize>,
    /// How much there is of shapes, whatever motions and gestures say.
    shapes: Vec<(usize, f32)>,
}

/// Where everything is at one time, relative to the body.
pub struct Stance {
    /// The head.
    pub head: Pose,
    /// What carries the other parts that hair collides with, relative to where it rests.
    pub parts: Vec<Pose>,
    /// Whether anything of the body is not where it rests.
    pub is_bent: bool,
}

impl Living {
    /// Bends `body`, which was made of the anatomy's mesh.
    ///
    /// # Errors
    /// When the adapter cannot hold it.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, anatomy: Anatomy, body: &Body) -> Result<Self> {
        let rig = &anatomy.rig;
        let skinning = Skinning::new(&gpu.device, &gpu.queue, &pipelines.skinning, rig, body)?;
        let rest = rig.rest_pose();
        Ok(Self { skinning, rest, deforms: Vec::new(), animation: None, shapes: Vec::new(), anatomy })
    }

    /// The names of its motions.
    pub fn animations(&self) -> impl Iterator<Item = &str> {
        self.anatomy.rig.animations.iter().map(|animation| animation.name.as_str())
    }

    /// The names of its shapes.
    pub fn shapes(&self) -> impl Iterator<Item = &str> {
        self.anatomy.rig.targets.iter().map(|target| target.name.as_str())
    }

    /// From here on it moves as the motion of this name has it, or stands still.
    ///
    /// # Errors
    /// One sentence with the names that there are.
    pub fn set_animation(&mut self, name: Option<&str>) -> Result<()> {
        let rig = &self.anatomy.rig;
        let Some(name) = name else {
            self.animation = None;
            return Ok(());
        };
        let Some(animation) = rig.animation(name) else {
            let names: Vec<_> = self.animations().collect();
            let there = if names.is_empty() { "none".into() } else { names.join(", ") };
            bail!("the body has no animation {name:?}; it has {there}");
        };
        self.animation = rig.animations.iter().position(|other| std::ptr::eq(other, animation));
        Ok(())
    }

    /// From here on there is as much of a shape as said, whatever the motion says.
    ///
    /// # Errors
    /// One sentence with the names that there are, or when `weight` is not finite.
    pub fn set_shape(&mut self, name: &str, weight: f32) -> Result<()> {
        if !weight.is_finite() {
            bail!("the weight of the shape {name:?} is no number");
        }
        let shape = self.find_shape(name)?;
        self.shapes.retain(|(other, _)| *other != shape);
        self.shapes.push((shape, weight));
        Ok(())
    }

    /// The number of the shape of this name.
    ///
    /// # Errors
    /// One sentence with the names that there are.
    pub fn find_shape(&self, name: &str) -> Result<usize> {
        self.anatomy.rig.target(name).with_context(|| {
            let names: Vec<_> = self.shapes().collect();
            let there = if names.is_empty() { "none".into() } else { names.join(", ") };
            format!("the body has no shape {name:?}; it has {there}")
        })
    }

    /// The name of its motion; `None` while it stands still.
    pub fn animation(&self) -> Option<&str> {
        self.animation.map(|i| self.anatomy.rig.animations[i].name.as_str())
    }

    /// How much there is of a shape, by its number, where that has been [set](Self::set_shape).
    pub fn shape(&self, number: usize) -> Option<f32> {
        self.shapes.iter().find(|(shape, _)| *shape == number).map(|(_, weight)| *weight)
    }

    /// From here on motions say how much there is of a shape, by its number.
    pub fn free_shape(&mut self, number: usize) {
        self.shapes.retain(|(shape, _)| *shape != number);
    }

    /// Does what `other` does, as far as it can: the same body with other hair.
    pub fn go_on(&mut self, other: &Self) {
        // What it does not have it does not do.
        self.animation = None;
        if let Some(name) = other.animation() {
            let _ = self.set_animation(Some(name));
        }
        self.shapes.clear();
        for (shape, weight) in &other.shapes {
            let _ = self.set_shape(&other.anatomy.rig.targets[*shape].name, *weight);
        }
    }

    /// How long its motion is, s; `None` while it stands still.
    pub fn duration(&self) -> Option<f32> {
        self.animation.map(|i| self.anatomy.rig.animations[i].length)
    }

    /// Brings `body` to where it is at `time`, s, while it makes a gesture. A shape that the gesture names and the body
    /// does not have is none of its own.
    ///
    /// # Errors
    /// When the body is another's.
    pub fn pose(&mut self, gpu: &Gpu, time: f64, gesture: &Gesture, body: &mut Body) -> Result<Stance> {
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
        self.skinning.pose(&gpu.queue, &pose, body)?;
        let is_bent = pose != self.rest;
        let node = |node: u32| {
            let [rest, now] = [&self.rest, &pose].map(|pose| rig.to_groom * pose.globals[node as usize]);
            Pose::between(&rest, &now)
        };
        let parts = self.anatomy.solids().map(|part| node(part.node)).collect();
        Ok(Stance { head: node(self.anatomy.head.node), parts, is_bent })
    }

    /// From here on the fields of `hair`'s colliders deform with the skin of `body`, whose mesh at rest is `mesh`;
    /// `fields` are those of the solids.
    pub(crate) fn deform<'a>(
        &mut self,
        (gpu, pipelines): (&Gpu, &Pipelines),
        (body, mesh): (&Body, &TriMesh),
        has_head: bool,
        fields: impl Iterator<Item = Option<FieldId>>,
        hair: impl Iterator<Item = &'a mut Hair>,
    ) -> Result<()> {
        let flesh = Flesh::new(&self.anatomy, mesh, has_head);
        let fields = DeformingField::of(&flesh, fields);
        for hair in hair {
            let colliders = &mut hair.colliders;
            colliders.deform(&gpu.device, &gpu.queue, &pipelines.deform, mesh, &body.into(), &fields)?;
        }
        self.deforms = flesh.deforms();
        Ok(())
    }

    /// Where the fields are that [deform](tresses::collide::deform): of the head's and those of the other parts, in the
    /// body's space.
    pub(crate) fn deforming<'a>(&'a self, stance: &'a Stance) -> impl Iterator<Item = Pose> + 'a {
        let all = std::iter::once(&stance.head).chain(&stance.parts);
        all.zip(&self.deforms).filter(|(_, deforms)| **deforms).map(|(pose, _)| *pose)
    }

    /// What the frame records.
    pub fn skinning(&self) -> &Skinning {
        &self.skinning
    }
}

#[cfg(test)]
#[path = "living_tests.rs"]
mod tests;
