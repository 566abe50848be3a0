//! Components and resources.

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
    LodOptions, SimulationParams, ViewOptions, Wind,
    collide::{Collider, FieldId, Shape},
    groom::{SdfGrid, TriMesh, mesh::sdf},
    light::HairMaterial,
};

/// Hair with the origin of its groom's space at the entity.
///
/// Make it a child of the head, or of the joint that turns the head. The entity's scale is ignored: hair has the size
/// of its groom. Nothing is drawn until the groom is loaded and uploaded. When the asset changes, the old hair is shown
/// until the new hair is ready.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq)]
#[require(Transform, Visibility, HairMaterial3d, HairPhysics, HairDetail, HairReady)]
pub struct Hair3d(pub Handle<HairGroom>);

impl AsAssetId for Hair3d {
    type Asset = HairGroom;

    fn as_asset_id(&self) -> AssetId<HairGroom> {
        self.0.id()
    }
}

/// Whether hair is ready to be drawn: the current groom of its [`Hair3d`] is on the GPU. Use it to wait before a
/// fade-in or a screenshot.
#[derive(Component, Debug, Default)]
pub struct HairReady(pub(crate) Arc<AtomicBool>);

impl HairReady {
    /// Returns whether hair was ready in the last rendered frame.
    pub fn get(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Whether the adapter can draw hair, set before startup. Strands need compute shaders, which WebGL 2 and some old
/// adapters do not have; there, show a scene with cards (`tresses cards`).
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct HairSupport(pub bool);

/// Material of hair.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct HairMaterial3d(pub HairMaterial);

impl Default for HairMaterial3d {
    /// Returns brown hair.
    fn default() -> Self {
        Self(HairMaterial::brown())
    }
}

/// Simulation parameters of hair. Their [`wind`](SimulationParams::wind) is ignored: [`GlobalHairWind`] or [`HairWind`]
/// replaces it.
///
/// The rest shape is computed with the values at the time that the groom is uploaded. Later changes deform the hair.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct HairPhysics(pub SimulationParams);

/// Level-of-detail options of hair. The level depends on the camera in which the hair is largest. The error of each
/// level is measured with the widths and errors at the time that the groom is uploaded.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct HairDetail(pub LodOptions);

/// Marks hair that collides with other hair that has this component: nearby strands repel each other and rub. Not for
/// hair and brows of one head, which overlap at rest.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct HairHairCollision;

/// Wind on all hair; calm by default.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct GlobalHairWind(pub Wind);

/// Wind on the hair of this entity, in place of [`GlobalHairWind`]: for example a fan, or calm air in a room.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct HairWind(pub Wind);

/// Rendering options of a camera, in place of [`TressesPlugin::view`](crate::TressesPlugin::view).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct HairView(pub ViewOptions);

/// Makes hair write depth for this camera, in pixels where it covers more than half of the background. For depth of
/// field, volumetric fog and other effects that read depth after the main pass. Needs hair drawn [by
/// tiles](tresses::renderer::Renderer::Tiles), the default.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct HairDepth;

/// A 3D camera that does not see hair, and does not need [`Hdr`](bevy::camera::Hdr).
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct NoHair;

/// Shape of a [`HairCollider`], in its entity's space, meters. The entity's scale is ignored.
#[derive(Clone, Debug)]
pub enum ColliderShape {
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f32,
    },
    /// All points within `radius` of a segment along the entity's Y axis.
    Capsule {
        /// Half the length of the segment.
        half_length: f32,
        /// Radius.
        radius: f32,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Semi-axes along the entity's X, Y and Z axes.
        radii: Vec3,
    },
    /// The inside of a distance field. Adding or removing a field rebuilds all hair, at rest.
    Field(Arc<SdfGrid>),
}

/// An obstacle for all hair at its entity: a hand, a shoulder, a ball. At most 127 of them. Hair on a
/// [skin](crate::HairSkin) allows fewer, because up to 72 parts of the body count too.
///
/// The head of a groom needs no collider, because the groom has its distance field ([`HairGroom::head`]).
#[derive(Component, Clone, Debug)]
#[require(Transform)]
pub struct HairCollider {
    /// Shape.
    pub shape: ColliderShape,
    /// Factor on the hair's [`friction`](SimulationParams::friction).
    pub friction: f32,
}

impl HairCollider {
    /// Creates a collider with the hair's friction.
    pub fn new(shape: ColliderShape) -> Self {
        Self { shape, friction: 1.0 }
    }

    /// Creates a sphere of `radius` meters.
    pub fn sphere(radius: f32) -> Self {
        Self::new(ColliderShape::Sphere { radius })
    }

    /// Creates a collider from a closed `mesh` in the entity's space ([`tri_mesh`](crate::tri_mesh) converts Bevy's
    /// meshes). Computing its distance field takes a while; clones share it.
    ///
    /// # Errors
    /// Returns the errors of [`sdf::build`].
    pub fn mesh(mesh: &TriMesh) -> tresses::groom::Result<Self> {
        Ok(Self::new(ColliderShape::Field(Arc::new(sdf::build(mesh, &Default::default())?))))
    }

    /// Converts the collider for hair built with `fields`. Returns `None` if its own field is not among them.
    pub(crate) fn collider(&self, fields: &[Arc<SdfGrid>]) -> Option<Collider> {
        let shape = match &self.shape {
            ColliderShape::Sphere { radius } => Shape::sphere(*radius),
            ColliderShape::Capsule { half_length, radius } => {
                Shape::Capsule { half_length: *half_length, radius: *radius }
            }
            ColliderShape::Ellipsoid { radii } => Shape::Ellipsoid { radii: *radii },
            ColliderShape::Field(field) => {
                let index = fields.iter().position(|other| Arc::ptr_eq(field, other))?;
                Shape::Field(FieldId(index as u32))
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
