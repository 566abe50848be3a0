//! What entities are given.

use crate::HairGroom;
use bevy::{
    asset::AsAssetId,
    prelude::*,
    shape::{Capsule3d, Sphere},
};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use tresses::{
    collide::{Collider, FieldId, Shape},
    groom::{SdfGrid, TriMesh, mesh::sdf},
    light::HairMaterial,
    lod::LodOptions,
    simulate::SimulationParams,
    view::ViewOptions,
    wind::Wind,
};

/// Hair: the origin of the groom's space, that of the head, is where the entity is.
///
/// Make it a child of the head, or of the joint that turns the head. Scales are left out: hair has the size that its groom
/// has. While the groom is being loaded or brought to the GPU nothing is drawn; when the asset changes, the hair before is
/// shown until the new one is there.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq)]
#[require(Transform, Visibility, HairMaterial3d, HairPhysics, HairDetail, HairReady)]
pub struct Hair3d(pub Handle<HairGroom>);

impl AsAssetId for Hair3d {
    type Asset = HairGroom;

    fn as_asset_id(&self) -> AssetId<HairGroom> {
        self.0.id()
    }
}

/// Whether hair is on the GPU as the groom of its [`Hair3d`] has it now, so that it is drawn: for who waits before a fade
/// or a picture.
#[derive(Component, Debug, Default)]
pub struct HairReady(pub(crate) Arc<AtomicBool>);

impl HairReady {
    /// Whether it is, as of the last frame that was rendered.
    pub fn get(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// What hair looks like.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct HairMaterial3d(pub HairMaterial);

impl Default for HairMaterial3d {
    /// Brown.
    fn default() -> Self {
        Self(HairMaterial::brown())
    }
}

/// How hair moves. [`wind`](SimulationParams::wind) plays no part here: it is [`GlobalHairWind`]'s or [`HairWind`]'s.
///
/// The shape at rest is computed for the values that are there when the groom is brought to the GPU; later changes bend
/// it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct HairPhysics(pub SimulationParams);

/// How much of hair is drawn, by how large a pixel of the camera that is nearest to it is. What levels of detail cost is
/// measured for the widths and errors that are there when the groom is brought to the GPU.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct HairDetail(pub LodOptions);

/// Hair that touches other hair which has this too, where they are near each other: they push each other out and rub
/// against each other. Not for hair and brows of one head, which lie in each other at rest.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct HairMeets;

/// The wind on all hair; calm at first.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct GlobalHairWind(pub Wind);

/// The wind on the hair of this entity alone, in place of [`GlobalHairWind`]: that of a fan, or none in a room.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct HairWind(pub Wind);

/// How a camera draws hair, in place of [`TressesPlugin::view`](crate::TressesPlugin::view).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct HairView(pub ViewOptions);

/// A camera for which hair writes its depth, where it hides more than half of what is behind: for depth of field, fog in
/// volumes and what else goes by depth after the main pass. Of hair drawn [by tiles](tresses::draw::Coverage::Tiles), as
/// it is by default.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct HairDepth;

/// A 3D camera that sees no hair, and need not have [`Hdr`](bevy::camera::Hdr).
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct NoHair;

/// The form of a [`HairCollider`], in its entity's space, metres. The entity's scale is left out.
#[derive(Clone, Debug)]
pub enum ColliderShape {
    /// A ball.
    Sphere {
        /// Radius.
        radius: f32,
    },
    /// All that is within `radius` of a segment along the entity's Y axis.
    Capsule {
        /// Half the length of the segment.
        half_length: f32,
        /// Radius.
        radius: f32,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Half axes along the entity's X, Y and Z axes.
        radii: Vec3,
    },
    /// What a distance field has inside. Hair is made anew, at rest, when another field comes or one goes.
    Field(Arc<SdfGrid>),
}

/// An obstacle for all hair, where its entity is: a hand, a shoulder, a ball. At most 127 of them, less on a
/// [skin](crate::HairSkin), whose own parts are up to 72.
///
/// The head of a groom needs none, it has its distance field ([`HairGroom::head`]).
#[derive(Component, Clone, Debug)]
#[require(Transform)]
pub struct HairCollider {
    /// Its form.
    pub shape: ColliderShape,
    /// Factor of the hair's [`friction`](SimulationParams::friction).
    pub friction: f32,
}

impl HairCollider {
    /// One of this form, with the friction that the hair has.
    pub fn new(shape: ColliderShape) -> Self {
        Self { shape, friction: 1.0 }
    }

    /// A ball of `radius` metres.
    pub fn sphere(radius: f32) -> Self {
        Self::new(ColliderShape::Sphere { radius })
    }

    /// What `mesh` encloses, in the entity's space ([`tri_mesh`](crate::tri_mesh) makes one of Bevy's). To compute its
    /// field takes a while: clones of one share it.
    ///
    /// # Errors
    /// As [`sdf::build`].
    pub fn mesh(mesh: &TriMesh) -> tresses::groom::Result<Self> {
        Ok(Self::new(ColliderShape::Field(Arc::new(sdf::build(mesh, &Default::default())?))))
    }

    /// For hair that knows these fields; nothing where its own is not among them.
    pub(crate) fn collider(&self, fields: &[Arc<SdfGrid>]) -> Option<Collider> {
        let shape = match &self.shape {
            ColliderShape::Sphere { radius } => Shape::sphere(*radius),
            ColliderShape::Capsule { half_length, radius } => {
                Shape::Capsule { half_length: *half_length, radius: *radius }
            }
            ColliderShape::Ellipsoid { radii } => Shape::Ellipsoid { radii: *radii },
            ColliderShape::Field(field) => {
                let place = fields.iter().position(|other| Arc::ptr_eq(field, other))?;
                Shape::Field(FieldId(place as u32))
            }
        };
        Some(Collider { friction: self.friction, ..Collider::new(shape) })
    }
}

impl From<Sphere> for HairCollider {
    fn from(sphere: Sphere) -> Self {
        Self::sphere(sphere.radius)
    }
}

impl From<Capsule3d> for HairCollider {
    fn from(Capsule3d { radius, half_length }: Capsule3d) -> Self {
        Self::new(ColliderShape::Capsule { half_length, radius })
    }
}
