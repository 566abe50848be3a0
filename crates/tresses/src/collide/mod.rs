//! Colliders: capsules, ellipsoids and signed distance fields, up to [`MAX_COLLIDERS`](crate::constants::MAX_COLLIDERS)
//! in total. Each is rigid and has its own pose; a field may also `deform` with skin. This is a service, not a
//! stage: every kernel with obstacles binds the same group as `@group(1)` and calls `nearest.wesl`.
//!
//! ```text
//! SdfGrid, mesh ─► tiles of one 3-D texture ─┐
//! shapes ────────► uniform table            ─┼─► @group(1) ─► simulate, volume, wind, interpolate, avoid
//! poses of a frame ──► poses [moment][collider] ┘
//! ```
//!
//! **Moments.** The simulation evaluates a collider at the start of the frame's first step (moment 0) and at the end of
//! every substep `k` of the frame (moment `k`); the moment is the last argument of `nearest(x, moment)`. The host
//! writes one `PoseData` per moment and collider, so no kernel interpolates poses per vertex. The velocity of a point
//! of an obstacle is its rigid motion, rotation included, in the substep that ends at the moment. Between frames a
//! collider moves from its pose at the end of the last step towards its current pose, like the head.
//!
//! **Now.** The drawn hair is interpolated between the last two states *in the head's frame* and carried to the head's
//! current pose, so relative to the head it is up to one step old. The moment `NOW` has the colliders' poses delayed in
//! the same way, and `ColliderSet::drawn` returns them. Draw a hand at that pose, and the hair that it pushes lies on
//! it. Colliders attached to the head need no correction.
//!
//! **Fields.** All distance fields are tiles of one rgba16float texture with the unit gradient and the distance. A bind
//! group holds a fixed number of textures, an atlas any number of fields. Samples stay half a texel inside their tile,
//! so neighbors do not bleed. Several colliders may share one field. Outside its box a field is never solid: the
//! distance is that at the nearest point of the box plus the distance to that point.
//!
//! **Ellipsoids.** The distance from a point to an ellipsoid has no closed form. With `k1 = |p / r|` and
//! `k2 = |p / r²|` (componentwise), `k1 (k1 - 1) / k2` is zero on the surface and has a unit gradient there, the normal
//! `(p / r²) / k2`. It is exact to first order at the surface, too small far away, and its sign is always correct.
//!
//! **Culling.** Every collider has a world-space bounding sphere in the list of poses; a field also has a box around
//! its solid part (`SolidBounds`). `nearest` skips colliders farther than the best so far, or than the caller's limit
//! (`nearest_within`). In each substep, `simulate` selects the colliders whose spheres touch the box of a strand's
//! predicted vertices, and for each the vertices inside its sphere. The selection is exact, because contacts are
//! computed at predicted positions. Without it, 64 capsules in the hair cost eight times as much as one. A tree over
//! the colliders would be worth its memory traffic from about a thousand on.
//!
//! **Why not one union field?** Voxelizing all obstacles once per step would make any number as cheap as one. But at 4
//! mm per cell a finger is two cells wide, friction and velocity per collider are lost, and a hand that passes at 3 m/s
//! moves three cells per substep.
//!
//! **Skin.** The field of a joint may deform with the skin around it (`deform`): it is sampled at the rest position
//! of the matter. Rebuilding the field in each frame would be as exact, but cost some hundred times as much on a
//! software driver and provide no velocity of the skin.

mod atlas;
pub(crate) mod build;
pub(crate) mod deform;
mod poses;
mod set;
pub(crate) mod shape;
mod volume;

use crate::{
    Pose,
    groom::{
        SdfGrid,
        mesh::{SdfOptions, TriMesh},
    },
};
use glam::{Quat, Vec3};

pub(crate) use build::FieldBuilder;
pub(crate) use poses::Journey;
pub(crate) use poses::PoseHead;
pub(crate) use poses::{Moments, PoseData};
pub(crate) use set::ColliderSet;
pub(crate) use set::{FieldAtlas, layout};
pub(crate) use shape::{ShapeData, ShapeTable};
pub(crate) use volume::{FieldVolume, SolidBounds};

/// Index of a distance field in a [`ColliderDescriptor`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FieldId(pub u32);

/// Shape of a collider in its own frame, meters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// All points within `radius` of the segment from `(0, -half_length, 0)` to `(0, half_length, 0)`; a sphere if
    /// `half_length` is zero.
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
    /// Returns a sphere.
    pub const fn sphere(radius: f32) -> Self {
        Self::Capsule { half_length: 0.0, radius }
    }

    /// Returns the capsule with its axis from `a` to `b`, and its pose.
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

/// Frame of reference of a collider's poses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Anchor {
    /// Poses are in the frame's space, by default the world: a hand, a chair, shoulders that move on their own.
    #[default]
    World,
    /// Poses are relative to the head: glasses, horns, a hat.
    Head,
}

/// An obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    /// Shape of the collider.
    pub shape: Shape,
    /// Frame of reference of its poses.
    pub anchor: Anchor,
    /// Factor of the Coulomb friction coefficient [`crate::simulate::SimulationParams::friction`].
    pub friction: f32,
}

impl Collider {
    /// Returns a collider in world space with friction factor 1.
    pub const fn new(shape: Shape) -> Self {
        Self { shape, anchor: Anchor::World, friction: 1.0 }
    }
}

/// Source of a distance field.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum FieldSource<'a> {
    /// A field on the CPU.
    Grid(&'a SdfGrid),
    /// A mesh; the field is built on the GPU and stays there.
    Mesh {
        /// Builds the field.
        builder: &'a FieldBuilder,
        /// The mesh, in the collider's frame, meters.
        mesh: &'a TriMesh,
        /// Resolution of the field.
        options: &'a SdfOptions,
    },
}

/// Contents of a `ColliderSet`.
#[derive(Clone, Copy, Debug, Default)]
pub struct ColliderDescriptor<'a> {
    /// The head's distance field, in groom space: the first collider, which follows the head.
    pub head: Option<&'a SdfGrid>,
    /// Distance field of everything that the groom touches at rest, in groom space. Hair that rests closer to it than
    /// its clearance keeps that smaller distance. `None` to use the head's field.
    pub rest: Option<&'a SdfGrid>,
    /// Fields to which colliders refer by [`FieldId`].
    pub fields: &'a [FieldSource<'a>],
    /// All other colliders.
    pub colliders: &'a [Collider],
}

/// Poses of the colliders at the end of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColliderPoses {
    /// Pose of the head's field relative to the head; `None` for the head's own frame.
    pub head: Option<Pose>,
    /// One pose per collider of [`ColliderDescriptor::colliders`], in the same order, relative to its
    /// [`Anchor`].
    pub colliders: Vec<Pose>,
}
