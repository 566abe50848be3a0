//! Hair on a skin that Bevy bends: what of the body it collides with, and where that is in each frame.

use super::prepare::Gpu;
use crate::skin::{OnSkin, Skin, Stance};
use bevy::prelude::Entity;
use std::sync::Arc;
use tresses::{
    Hair, Pose, Result,
    body::Body,
    collide::{Collider, FieldId, Shape, deform::DeformingField},
    groom::{
        Groom, SdfGrid,
        mesh::sdf,
        rig::anatomy::{Anatomy, Field, Flesh, PartForm},
    },
    skinning::Skinning,
    wgpu,
};

/// A body that bends, before hair is on it.
pub(crate) struct Plan {
    skin: Arc<Skin>,
    anatomy: Anatomy,
    /// The field of what hair goes with.
    pub head: SdfGrid,
    /// Those of other parts, in their order.
    pub fields: Vec<SdfGrid>,
}

impl Plan {
    /// Of the skin that `groom` grows on. To measure its parts takes a while.
    pub fn new(skin: Arc<Skin>, groom: &Groom) -> Result<Self> {
        let guides = (0..groom.guides.len()).map(|i| groom.guides.guide(i));
        let mut anatomy = Anatomy::new(skin.rig.clone(), &skin.mesh, guides)?;
        anatomy.measure();
        let mut fields = Vec::new();
        for part in anatomy.parts.iter_mut().filter(|part| part.form == PartForm::Field) {
            match &part.field {
                Field::Grid(grid) => fields.push(grid.clone()),
                // What encloses nothing pushes nothing.
                Field::Mesh(..) => part.form = PartForm::Nothing,
            }
        }
        let head = match &anatomy.head.field {
            Field::Mesh(mesh, options) => sdf::build(mesh, options)?,
            Field::Grid(grid) => grid.clone(),
        };
        Ok(Self { skin, anatomy, head, fields })
    }

    /// Puts `hair` on the body, whose fields follow so many others.
    pub fn attach(
        self,
        (device, queue, pipelines): Gpu<'_>,
        hair: &mut Hair,
        groom: &Groom,
        others: usize,
    ) -> Result<(Body, Living)> {
        let Self { skin, anatomy, .. } = self;
        let body = Body::new(device, &skin.mesh);
        let skinning = Skinning::new(device, queue, &pipelines.skinning, &skin.rig, &body)?;
        hair.attach(device, queue, pipelines, groom, &skin.mesh, &(&body).into(), skin.reach)?;
        let mut next = others as u32..;
        let (mut parts, mut colliders, mut fields) = (Vec::new(), Vec::new(), Vec::new());
        for part in anatomy.solids() {
            let (shape, own) = match part.form {
                PartForm::Capsule(capsule) => {
                    let [a, b] = capsule.ends;
                    Shape::capsule(a, b, capsule.radius)
                }
                _ => (Shape::Field(FieldId(next.next().unwrap_or_default())), Pose::IDENTITY),
            };
            fields.push(match shape {
                Shape::Field(id) => Some(id),
                _ => None,
            });
            parts.push((part.node, own));
            colliders.push(Collider { friction: part.friction, ..Collider::new(shape) });
        }
        let flesh = Flesh::new(&anatomy, &skin.mesh, true);
        let deforming = DeformingField::of(&flesh, fields.into_iter());
        hair.set_colliders(device, queue, &colliders)?;
        hair.colliders.deform(device, queue, &pipelines.deform, &skin.mesh, &(&body).into(), &deforming)?;
        let deforms = flesh.deforms();
        let head = anatomy.head.node;
        Ok((body, Living { skin, skinning, head, parts, colliders, deforms, stance: None }))
    }
}

/// A body that bends, with hair on it.
#[derive(Debug)]
pub(crate) struct Living {
    skin: Arc<Skin>,
    skinning: Skinning,
    /// The node that hair goes with.
    head: u32,
    /// Those of its other parts, and where what stands for each is at rest.
    parts: Vec<(u32, Pose)>,
    /// What stands for them.
    colliders: Vec<Collider>,
    /// Whether the head's field deforms, and those of the other parts.
    deforms: Vec<bool>,
    /// Where its joints were last; it stays there while the hair's skin is none, awaited or another one.
    stance: Option<Stance>,
}

impl Living {
    /// The entity with the mesh.
    pub fn entity(&self) -> Entity {
        self.skin.entity
    }

    /// What hair collides with besides the head.
    pub fn colliders(&self) -> &[Collider] {
        &self.colliders
    }

    /// What is recorded before hair moves.
    pub fn skinning(&self) -> &Skinning {
        &self.skinning
    }

    /// Takes note of where the joints of the skin are that its hair is on now, and says where what hair goes with is; nothing
    /// before that is known.
    pub fn head(&mut self, on: &OnSkin) -> Option<Pose> {
        if let OnSkin::Yes(skin, stance) = on
            && Arc::ptr_eq(skin, &self.skin)
        {
            self.stance.get_or_insert_default().clone_from(stance);
        }
        self.stance.as_ref().map(|stance| self.skin.node(self.head, stance))
    }

    /// Brings all of it to where it is in a frame, relative to `head`; the poses of its colliders go to `poses`.
    pub fn pose(
        &mut self,
        (queue, body, hair): (&wgpu::Queue, &mut Body, &mut Hair),
        head: &Pose,
        poses: &mut Vec<Pose>,
    ) -> Result<()> {
        let Some(stance) = &self.stance else { return Ok(()) };
        self.skinning.pose(queue, &self.skin.pose(head, stance), body)?;
        if let Some(roots) = &mut hair.roots {
            roots.pose = *head;
        }
        let parts: Vec<Pose> = self.parts.iter().map(|(node, _)| self.skin.node(*node, stance)).collect();
        if let Some(deformation) = &mut hair.colliders.deformation {
            let to_head = head.inverse();
            let all = std::iter::once(*head).chain(parts.iter().copied());
            let deforming = all.zip(&self.deforms).filter(|(_, deforms)| **deforms);
            deformation.poses = deforming.map(|(pose, _)| to_head.after(&pose)).collect();
        }
        poses.extend(parts.iter().zip(&self.parts).map(|(pose, (_, own))| pose.after(own)));
        Ok(())
    }
}
