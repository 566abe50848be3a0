//! Colliders: capsules, ellipsoids and signed distance fields, up to
//! [`MAX_COLLIDERS`](crate::constants::MAX_COLLIDERS) in total, each with its own pose and rigid, but for what
//! [skin](deform) does to a field. This is a service, not a stage: every kernel that needs obstacles binds the same
//! group as `@group(1)` and calls `nearest.wesl`.
//!
//! ```text
//! SdfGrid, mesh ─► tiles of one 3-D texture ─┐
//! shapes ────────► uniform table            ─┼─► @group(1) ─► simulate, volume, wind, interpolate, avoid
//! poses of a frame ─► places [moment][collider] ┘
//! ```
//!
//! **Moments.** The simulation sees a collider at the start of the frame's first step (moment 0) and at the
//! end of every substep `k` of the frame (moment `k`), the last argument of `nearest(x, moment)`; the host
//! writes one [`Place`] per moment and collider, so that no kernel interpolates poses per vertex. The
//! velocity of a point of an obstacle is its rigid motion, rotation included, in the substep that ends at
//! the moment. Between frames a collider moves from its pose at the end of the last step towards its
//! current pose, just as the head does ([`crate::clock`]).
//!
//! **Now.** What is drawn is interpolated between the last two states *in the head's frame* and carried to
//! the head's current pose: hair is drawn as it was up to one step ago relative to the head. The moment
//! `NOW` gives the colliders in the same way, and [`ColliderSet::drawn`] returns that pose: draw a hand
//! there, and the hair that it pushes lies on it. Colliders attached to the head need no correction.
//!
//! **Fields.** All distance fields are tiles of one rgba16float texture: the unit gradient and the
//! distance. Bind groups hold a fixed number of textures, an atlas any number of fields; samples stay half
//! a texel inside their tile, so neighbours do not bleed. Several colliders may share one field. Outside
//! its box a field is never solid: the distance is that of the nearest point of the box plus the distance
//! to that point.
//!
//! **Ellipsoids.** The distance from a point to an ellipsoid has no closed form. With `k1 = |p / r|` and
//! `k2 = |p / r²|` (componentwise), `k1 (k1 - 1) / k2` is zero on the surface and has a unit gradient
//! there, the normal `(p / r²) / k2`: exact to first order where hair touches, too small far away and never
//! of the wrong sign.
//!
//! **Culling.** Every collider has a world-space bounding sphere in the list of places, a field also a box around what
//! is solid in it ([`Bounds`]). `nearest` skips those farther than the best so far, or than what the caller wants to know
//! of (`nearest_within`); `simulate` keeps, for every four predicted vertices of a strand, a
//! bit per collider whose sphere touches their box, rebuilt in each substep, and tests vertices against
//! those alone. The masks are exact: contacts are made at predicted positions. Without them, 64 capsules in
//! the hair cost eight times as much as one; a tree over the colliders would be worth its memory traffic
//! from about a thousand on.
//!
//! **Why not one union field?** Re-voxelising all obstacles once per step would make any number as cheap as
//! one, but at 4 mm per cell a finger is two cells wide, friction and velocity per collider are lost, and a
//! hand that passes at 3 m/s moves three cells per substep.
//!
//! **Skin.** A field that goes with a joint may deform with the skin around it ([`deform`]): it is asked where matter was at
//! rest. Measuring it anew in each frame would be as exact, at some hundred times the cost on a software driver, and
//! would not tell the velocity of the skin.

mod atlas;
pub mod build;
pub mod deform;
mod places;
mod set;
pub mod shape;
mod volume;

use crate::{
    Pose,
    groom::{
        SdfGrid,
        mesh::{SdfOptions, TriMesh},
    },
};
use glam::{Quat, Vec3};

pub use build::FieldBuilder;
pub(crate) use places::Journey;
pub use places::{Moments, Place, PlacesHead};
pub use set::ColliderSet;
pub(crate) use set::layout;
pub use shape::{ShapeData, ShapeTable};
pub use volume::{Bounds, FieldVolume};

/// A distance field of a [`ColliderDescriptor`], by its place in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FieldId(pub u32);

/// The form of a collider, in its own frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// All points within `radius` of the segment from `(0, -half_length, 0)` to `(0, half_length, 0)`; a
    /// sphere if that is zero.
    Capsule {
        /// Half the length of the axis.
        half_length: f32,
        /// Radius.
        radius: f32,
    },
    /// The ellipsoid around the origin with these half axes.
    Ellipsoid {
        /// Half axes along x, y and z.
        radii: Vec3,
    },
    /// A distance field in its own frame.
    Field(FieldId),
}

impl Shape {
    /// A sphere.
    pub const fn sphere(radius: f32) -> Self {
        Self::Capsule { half_length: 0.0, radius }
    }

    /// The capsule with its axis from `a` to `b`, and the pose that puts it there.
    pub fn capsule(a: Vec3, b: Vec3, radius: f32) -> (Self, Pose) {
        let axis = b - a;
        let rotation = match axis.try_normalize() {
            Some(axis) => Quat::from_rotation_arc(Vec3::Y, axis),
            None => Quat::IDENTITY,
        };
        let pose = Pose { rotation, translation: 0.5 * (a + b) };
        (Self::Capsule { half_length: 0.5 * axis.length(), radius }, pose)
    }
}

/// Whose motion a collider's poses are relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// Poses are in the frame's space, by default the world: a hand, a chair, shoulders with a motion of their own.
    #[default]
    World,
    /// Poses are relative to the head: glasses, horns, a hat.
    Head,
}

/// One obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    /// Its form.
    pub shape: Shape,
    /// What its poses are relative to.
    pub anchor: Anchor,
    /// Multiplies Coulomb's coefficient [`crate::simulate::SimulationParams::friction`].
    pub friction: f32,
}

impl Collider {
    /// A collider in the world with the friction that the parameters say.
    pub const fn new(shape: Shape) -> Self {
        Self { shape, anchor: Anchor::World, friction: 1.0 }
    }
}

/// Where a distance field comes from.
#[derive(Clone, Copy, Debug)]
pub enum FieldSource<'a> {
    /// From the CPU.
    Grid(&'a SdfGrid),
    /// From a mesh, made on the GPU, where it stays.
    Mesh {
        /// Makes it.
        builder: &'a FieldBuilder,
        /// The mesh, in the collider's frame, metres.
        mesh: &'a TriMesh,
        /// How fine.
        options: &'a SdfOptions,
    },
}

/// What a [`ColliderSet`] is made of.
#[derive(Clone, Copy, Debug, Default)]
pub struct ColliderDescriptor<'a> {
    /// The head's distance field, groom space: the first collider, which follows the head.
    pub head: Option<&'a SdfGrid>,
    /// The distance field of all that the groom lies on while it rests, groom space: hair that rests nearer to it than it
    /// would keep away is left there. `None` where that is the head's.
    pub rest: Option<&'a SdfGrid>,
    /// Fields that colliders refer to by [`FieldId`].
    pub fields: &'a [FieldSource<'a>],
    /// All other colliders.
    pub colliders: &'a [Collider],
}

/// Where the colliders are in a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColliderPoses {
    /// Pose of the head's field relative to the head; `None` when its frame is the head's.
    pub head: Option<Pose>,
    /// One pose per collider of [`ColliderDescriptor::colliders`], in the same order, relative to its
    /// [`Anchor`].
    pub colliders: Vec<Pose>,
}
