//! Characters: the grooms on one body, and the per-frame work that every host of hair would otherwise repeat.
//!
//! ```text
//! files, style ─► CharacterSource ─ parts ─► CharacterParts ─► CharacterAsset ─► Character, Character, …
//!                                                                                   │
//! each frame:  set_pose, animate …  ─► Frame::advance: pose the skin, deform fields, move roots, choose detail, step
//!                                   ─► Frame::draw, composite: shadow focus and zones, then the stages of an image
//! ```
//!
//! A [`Character`] holds everything about one character: hair, brows, lashes and a beard, the mesh that
//! they grow on, its skinning, the colliders of the hair, and the level of detail. The body is one of
//! - rigid: [`Character::set_pose`] moves all of it;
//! - deformed by its own rig: [`Character::animate`], [`Character::gesture`], or joints of the host
//!   ([`RiggedBody::set_pose`]);
//! - deformed by the host: [`Character::skinned_by`] reads the host's vertex buffer.
//!
//! Characters of one [`CharacterAsset`] share everything that does not move: a crowd is a `Vec<Character>`, and a
//! [`CrowdBudget`] keeps it within a time and a memory limit. The layer below is public as well: [`Hair`],
//! [`View`](crate::View) and [`Recorder`](crate::frame::Recorder).
//!
//! **Why not an entity per groom?** Brows follow the hair's clock, color and detail. A beard collides with the same
//! body. Shadow focus and zones belong to the head. With one object per groom, every host reimplemented these rules,
//! each a little differently.
//!
//! **A lost device** takes all buffers with it. The host keeps the [`CharacterParts`](crate::CharacterParts), creates a
//! new [`Context`](crate::Context), a [`CharacterAsset`] and a [`Character`], and calls [`Character::continue_from`].

mod asset;
mod background;
mod create;
mod facial;
mod frame;
mod gesture;
mod light;
mod motion;
mod obstacles;
mod rigged;
mod skinned;

pub use asset::{CharacterAsset, CharacterOptions};
pub use frame::{CrowdBudget, Frame};
pub use gesture::Gesture;
pub use light::Foci;
pub use obstacles::Obstacle;
pub use rigged::{BodyPose, RiggedBody};

use crate::{
    Error, Pose, Result,
    body::Body,
    camera::Bounds,
    groom::{
        Look, SdfGrid,
        rig::anatomy::{DistanceFieldSource, PartForm},
    },
    hair::GuideState,
    hair::Hair,
    light::{HairMaterial, Sphere},
    lod::LodOptions,
    roots::RootReport,
    simulate::{RestOptions, SimulationParams},
    space::Space,
};
use glam::Vec3;
use obstacles::Obstacles;
use std::sync::Arc;

/// A face groom on the GPU.
#[derive(Debug)]
struct Fringe {
    hair: Hair,
    hangs: bool,
}

/// The grooms on one body, on the GPU, with their state of motion.
#[derive(Debug)]
pub struct Character {
    asset: Arc<CharacterAsset>,
    hair: Hair,
    face: Vec<Fringe>,
    body: Option<Body>,
    /// Further meshes that are drawn at the body's pose.
    pub props: Vec<Body>,
    /// The physics of the hair, wind included.
    pub physics: SimulationParams,
    /// Pose of the body, turn of the head and blend shape weights that the host sets.
    pub gesture: Gesture,
    /// The space of the poses of body and obstacles.
    pub space: Space,
    /// The space in which it is drawn; `None` for [`space`](Self::space).
    pub drawn_in: Option<Space>,
    /// Identifies the body's mesh. Characters with the same id share one mesh, which is drawn once.
    pub body_id: Option<u64>,
    rigged: Option<RiggedBody>,
    roots: Option<RootReport>,
    obstacles: Obstacles,
    /// Time of animations: seconds since the hair was at rest.
    time: f64,
    /// Poses of body, head and the other parts in the frame that is recorded.
    pose: Pose,
    head: Pose,
    parts: Vec<Pose>,
    /// Bias chosen by a budget, octaves.
    bias: f32,
}

impl Character {
    /// Returns what this character shares with its other instances.
    pub fn asset(&self) -> &Arc<CharacterAsset> {
        &self.asset
    }

    /// Sets the pose of the body: from groom space to the world. A rigid body and its hair move there with the head
    /// straight.
    pub fn set_pose(&mut self, body: Pose) {
        self.gesture.body = body;
    }

    /// Plays the rig's animation of this name from `time` (s) on. Frames advance the time.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] when the body has no rig or no such animation; the message lists the available
    /// ones.
    pub fn animate(&mut self, name: &str, time: f64) -> Result<()> {
        let rigged = self.rigged.as_mut().ok_or_else(|| Error::unusable("the body has no rig to animate"))?;
        rigged.set_animation(Some(name))?;
        self.time = time;
        Ok(())
    }

    /// Returns the rig of the body, if it has one.
    pub fn rig(&self) -> Option<&RiggedBody> {
        self.rigged.as_ref()
    }

    /// Returns the rig of the body, to set animation, blend shapes or joints.
    pub fn rig_mut(&mut self) -> Option<&mut RiggedBody> {
        self.rigged.as_mut()
    }

    /// Returns the time of animations, s: seconds since the hair was put to rest, or the time set by
    /// [`seek`](Self::seek).
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Sets the time of animations, s. Does not put the hair to rest.
    pub fn seek(&mut self, time: f64) {
        self.time = time;
    }

    /// Puts the hair into its rest pose at the next frame, at the head's pose then, and sets the time to 0.
    pub fn reset(&mut self) {
        self.grooms_mut().for_each(Hair::reset);
        self.time = 0.0;
    }

    /// Makes the next frame carry the hair rigidly with the head, whatever the distance.
    pub fn teleport(&mut self) {
        self.grooms_mut().for_each(Hair::teleport);
    }

    /// Sets the poses of the obstacles that the character was created with, each in the space of its anchor.
    ///
    /// # Errors
    /// [`Error::Colliders`] unless there is one pose per obstacle.
    pub fn set_obstacle_poses(&mut self, poses: &[Pose]) -> Result<()> {
        let fixed = &mut self.obstacles.fixed;
        if poses.len() != fixed.len() {
            let problem = format!("{} poses were given for {} obstacles", poses.len(), fixed.len());
            return Err(Error::Colliders(problem));
        }
        fixed.copy_from_slice(poses);
        Ok(())
    }

    /// Replaces the obstacles that come and go. An obstacle that keeps its index and its id moves continuously to its
    /// new pose; others appear.
    ///
    /// # Errors
    /// [`Error::Colliders`] for too many obstacles, and for fields that the character was not created with.
    pub fn set_obstacles(&mut self, obstacles: &[Obstacle]) -> Result<()> {
        let before = self.obstacles.free.clone();
        let Some(kept) = self.obstacles.set_free(obstacles) else { return Ok(()) };
        let list = &self.obstacles.list;
        let changed = colliding(&mut self.hair, &mut self.face).try_for_each(|hair| {
            // An obstacle that replaces another must not sweep over from the other's pose.
            hair.set_colliders(&list[..kept])?;
            hair.set_colliders(list)
        });
        if changed.is_err() {
            self.obstacles.set_free(&before);
            let list = &self.obstacles.list;
            colliding(&mut self.hair, &mut self.face).try_for_each(|hair| hair.set_colliders(list))?;
        }
        changed
    }

    /// Returns the poses at which obstacles are drawn, relative to the body: first those from creation, then those that
    /// come and go. Empty until a frame has placed them.
    pub fn drawn_obstacles(&self) -> Vec<Pose> {
        let drawn = self.hair.colliders.drawn();
        // The head's field, where there is one, comes first. A collider added since the last frame has no pose yet.
        let Some(own) = drawn.len().checked_sub(self.obstacles.list.len()) else { return Vec::new() };
        let to_body = self.pose.inverse();
        self.obstacles.visible(&drawn[own..]).map(|pose| to_body.after(&pose)).collect()
    }

    /// Returns the distance fields of the head and of other body parts that exist on the CPU, with their poses.
    pub fn solids(&self) -> Vec<(&SdfGrid, Pose)> {
        let head = self.field().map(|field| (field, self.head));
        let solids = self.rigged.iter().flat_map(|rigged| rigged.anatomy().solids());
        let parts = solids.zip(&self.parts).filter_map(|(part, pose)| match (&part.form, &part.field) {
            (PartForm::Field, DistanceFieldSource::Grid(grid)) => Some((grid, *pose)),
            _ => None,
        });
        head.into_iter().chain(parts).collect()
    }

    /// Returns the distance field of the head, groom space.
    pub fn field(&self) -> Option<&SdfGrid> {
        self.asset.field.as_ref()
    }

    /// Returns the hair.
    pub fn hair(&self) -> &Hair {
        &self.hair
    }

    /// Returns the hair, for grabs and settings that this type does not offer.
    pub fn hair_mut(&mut self) -> &mut Hair {
        &mut self.hair
    }

    /// Returns all grooms, the hair first.
    pub fn grooms(&self) -> impl Iterator<Item = &Hair> {
        std::iter::once(&self.hair).chain(self.face.iter().map(|face| &face.hair))
    }

    fn grooms_mut(&mut self) -> impl Iterator<Item = &mut Hair> {
        std::iter::once(&mut self.hair).chain(self.face.iter_mut().map(|face| &mut face.hair))
    }

    /// Reads back the state of all grooms after the last frame, in the order of [`grooms`](Self::grooms).
    ///
    /// # Errors
    /// Fails if the GPU is lost.
    pub async fn state(&self) -> Result<Vec<GuideState>> {
        let mut all = Vec::new();
        for hair in self.grooms() {
            all.push(hair.state().await?);
        }
        Ok(all)
    }

    /// Continues from a [`state`](Self::state), as [`Hair::set_state`].
    ///
    /// # Errors
    /// As [`Hair::set_state`].
    pub fn set_state(&mut self, all: &[GuideState]) -> Result<()> {
        if all.len() != self.grooms().count() {
            return Err(Error::unusable("the state is of other hair"));
        }
        self.grooms_mut().zip(all).try_for_each(|(hair, state)| hair.set_state(state))
    }

    /// Removes brows, lashes and beard.
    pub fn shave(&mut self) {
        self.face.clear();
    }

    /// Returns the mesh of the head or body.
    pub fn body(&self) -> Option<&Body> {
        self.body.as_ref()
    }

    /// Returns the mesh of the head or body, to set its material.
    pub fn body_mut(&mut self) -> Option<&mut Body> {
        self.body.as_mut()
    }

    /// Sets the material of the hair; face grooms are a shade darker.
    pub fn set_material(&mut self, material: HairMaterial) {
        self.hair.set.material = material;
        let darker = facial::darker(&material);
        self.face.iter_mut().for_each(|face| face.hair.set.material = darker);
    }

    /// Computes the rest shape of all grooms again, as [`HairAsset::set_rest`](crate::hair::HairAsset::set_rest), for
    /// all instances. Face grooms take the physics and the support of the hair.
    ///
    /// # Errors
    /// As [`HairAsset::set_rest`](crate::hair::HairAsset::set_rest).
    pub fn set_rest(&mut self, physics: &SimulationParams, options: &RestOptions) -> Result<()> {
        for Fringe { hair, hangs } in &mut self.face {
            hair.set_rest(&facial::physics(physics, *hangs), &facial::rest(options))?;
        }
        self.hair.set_rest(physics, options)
    }

    /// Sets the level-of-detail options of all grooms.
    pub fn set_lod(&mut self, options: LodOptions) {
        self.grooms_mut().for_each(|hair| hair.lod.options = options);
    }

    /// Sets the strand collision options of the hair.
    pub fn set_avoidance(&mut self, options: crate::avoid::AvoidOptions) {
        self.hair.avoidance.options = options;
    }

    /// Returns the fiber that the groom's file describes.
    pub fn look(&self) -> Option<&Look> {
        self.asset.look.as_ref()
    }

    /// Returns the distances of the roots from the skinned mesh, if there is one.
    pub fn roots(&self) -> Option<RootReport> {
        self.roots
    }

    /// Returns the box that a portrait shows, for the character at rest, meters.
    pub fn subject(&self) -> Bounds {
        self.asset.subject
    }

    /// Returns the joint that the head turns about, groom space, meters.
    pub fn neck(&self) -> Vec3 {
        self.asset.neck
    }

    /// Returns the pose of the head in the last frame, relative to its rest pose.
    pub fn head(&self) -> Pose {
        self.head
    }

    /// Returns the pose of the body in the last frame.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Returns the sphere that shadow maps cover: the hair, with a margin for motion.
    pub fn focus(&self) -> Sphere {
        // A rigid head turns within its sphere.
        let pose = if self.rigged.is_some() { &self.head } else { &self.gesture.body };
        let focus = self.asset.focus;
        Sphere { center: pose.point(focus.center), ..focus }
    }

    /// Returns the GPU memory of all grooms, bytes.
    pub fn hair_bytes(&self) -> u64 {
        self.grooms().map(Hair::bytes).sum()
    }

    /// Returns the GPU memory that instances share, bytes.
    pub fn shared_bytes(&self) -> u64 {
        self.grooms().map(Hair::shared_bytes).sum::<u64>() + self.body.as_ref().map_or(0, Body::shared_bytes)
    }

    /// Returns the GPU memory of this instance alone, bytes.
    pub fn own_bytes(&self) -> u64 {
        let body = self.body.as_ref().map_or(0, |body| body.bytes() - body.shared_bytes());
        self.grooms().map(Hair::own_bytes).sum::<u64>() + body
    }

    /// Lets the hair of nearby characters collide in the next frame. Call it before [`Frame::advance`].
    pub fn collide_nearby(characters: &mut [&mut Self]) {
        let mut hair: Vec<_> = characters.iter_mut().map(|character| &mut character.hair).collect();
        Hair::collide_nearby(&mut hair);
    }
}

/// Returns the grooms that collide with the body.
fn colliding<'a>(hair: &'a mut Hair, face: &'a mut [Fringe]) -> impl Iterator<Item = &'a mut Hair> {
    let hanging = face.iter_mut().filter(|face| face.hangs).map(|face| &mut face.hair);
    std::iter::once(hair).chain(hanging)
}
