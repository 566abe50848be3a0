//! Characters: the grooms on one body, and the work of a frame that every host of hair would otherwise repeat.
//!
//! ```text
//! files, style ─► CharacterSource ─ dress ─► CharacterParts ─► Character ─ instance ─► Character
//!                                                                  │
//! each frame:  set_pose, animate …  ─► Frame::advance: pose the skin, deform fields, move roots, choose detail, step
//!                                   ─► Frame::draw, composite: shadow focus and zones, then the stages of a picture
//! ```
//!
//! A [`Character`] is what a host holds: hair, brows, lashes and a beard ([`facial`]), the mesh that they grow on, how that
//! is skinned, what the hair collides with, and the level of detail. The body is one of
//! - rigid: [`Character::set_pose`] moves all of it;
//! - deformed by a rig of its own: [`Character::animate`], [`Character::gesture`], or joints of the host
//!   ([`RiggedBody::set_pose`]);
//! - deformed by the host: [`Character::skinned_by`] reads the host's vertex buffer.
//!
//! [`Character::instance`] shares everything that does not move: a crowd is a `Vec<Character>`, and a [`CrowdBudget`]
//! keeps it within a time and a memory. [`Hair`], [`View`](crate::View) and [`Recorder`](crate::frame::Recorder) stay
//! public below it.
//!
//! **Why not an entity per groom?** Brows follow the hair's clock, color and detail; a beard collides with the same body;
//! shadow focus and zones belong to the head. Hosts that had one object per groom wrote these rules again, each a little
//! differently.
//!
//! **A lost device** takes all buffers with it. The host keeps the [`CharacterParts`], makes a new [`Context`] and
//! [`Character::new`], and calls [`Character::continue_from`].

mod aside;
pub mod facial;
mod frame;
mod gesture;
mod light;
mod obstacles;
mod parts;
mod rigged;
pub mod source;

pub use facial::{FaceGroom, FaceHair};
pub use frame::{CrowdBudget, Drawing, Frame};
pub use gesture::Gesture;
pub use light::Foci;
pub use obstacles::Obstacle;
pub use parts::{Bounds, CharacterParts, subject};
pub use rigged::{BodyPose, RiggedBody};
pub use source::{CharacterFiles, CharacterSource, Styling};

use crate::{
    Context, Error, Pose, Progress, Result,
    body::{Body, Skin},
    collide::{Collider, ColliderDescriptor, ColliderPoses, FieldBuilder, FieldSource},
    frame::Recorder,
    groom::{
        Look, SdfGrid, TriMesh,
        import::{self, ImportOptions},
        rig::anatomy::{Field, PartForm},
        styles::Style,
    },
    hair::{Hair, HairFrame, HairOptions},
    light::{HairMaterial, Sphere},
    lod::LodOptions,
    roots::RootReport,
    simulate::SimulationParams,
    space::Space,
    volume::VolumeOptions,
};
use aside::Aside;
use glam::Vec3;
use obstacles::Obstacles;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// The farthest that roots of a face groom may lie from the skin, metres.
const FACE_REACH: f32 = 0.01;
/// Shadow maps cover more than the hair at rest, by this factor, so that hair that swings stays in them.
const SWING: f32 = 1.15;

/// Options for uploading a character.
#[derive(Clone, Copy, Debug)]
pub struct CharacterOptions<'a> {
    /// Options of the hair. Face grooms take their physics and level of detail from it.
    pub hair: HairOptions,
    /// Colliders besides the body; [`Character::place_obstacles`] moves them.
    pub obstacles: &'a [Collider],
    /// Distance fields that colliders name by [`FieldId`](crate::collide::FieldId).
    pub fields: &'a [FieldSource<'a>],
    /// Cells along each edge of the finest grid of ambient light that the body is drawn with
    /// ([`ViewOptions::ambient_cells`](crate::view::ViewOptions::ambient_cells)).
    pub ambient_cells: u32,
    /// The farthest that a root of the hair may lie from a skinned mesh, metres. Grooms made for another head may be
    /// centimetres off.
    pub root_reach: f32,
}

impl Default for CharacterOptions<'_> {
    fn default() -> Self {
        Self {
            hair: HairOptions::default(),
            obstacles: &[],
            fields: &[],
            ambient_cells: u32::MAX,
            root_reach: 0.2,
        }
    }
}

/// A groom beside the hair.
#[derive(Debug)]
struct Fringe {
    hair: Hair,
    hangs: bool,
}

/// The grooms on one body, on the GPU, with their state of motion.
#[derive(Debug)]
pub struct Character {
    hair: Hair,
    face: Vec<Fringe>,
    body: Option<Body>,
    /// Further meshes that stand where the body does and are drawn with it.
    pub props: Vec<Body>,
    /// The physics of the hair, wind included.
    pub physics: SimulationParams,
    /// Where the body is and what it does by hand.
    pub gesture: Gesture,
    /// The space in which the poses of body and obstacles are given ([`crate::space`]).
    pub space: Space,
    /// The space in which it is drawn; `None` for [`space`](Self::space).
    pub drawn_in: Option<Space>,
    /// Characters with the same number are on one mesh, which is drawn once.
    pub body_id: Option<u64>,
    rigged: Option<RiggedBody>,
    roots: Option<RootReport>,
    obstacles: Obstacles,
    field: Option<Arc<SdfGrid>>,
    look: Option<Look>,
    neck: Vec3,
    subject: Bounds,
    focus: Sphere,
    /// Seconds since the hair was at rest: the time of animations.
    time: f64,
    /// Where body, head and the other parts are in the frame that is recorded.
    pose: Pose,
    head: Pose,
    parts: Vec<Pose>,
    /// Octaves of bias that a budget has chosen.
    bias: f32,
}

impl Character {
    /// Reads the groom and the body of `files`, for example a `.glb` with hair, or a groom and a head mesh, and uploads
    /// them with default options.
    ///
    /// # Errors
    /// An error that names the file when one cannot be read, and those of [`new`](Self::new).
    pub async fn load<P: AsRef<Path>>(context: &Context, files: impl IntoIterator<Item = P>) -> Result<Self> {
        let (mut grooms, mut heads): (Vec<PathBuf>, Vec<PathBuf>) = (Vec::new(), Vec::new());
        for path in files {
            let path = path.as_ref();
            let read = |source| crate::groom::Error::Io { path: path.to_owned(), source };
            let bytes = std::fs::read(path).map_err(read)?;
            let is_mesh = import::kind(path, &bytes) == Some(import::Kind::Mesh);
            if is_mesh { &mut heads } else { &mut grooms }.push(path.to_owned());
        }
        // Hair and body may be one file.
        if grooms.is_empty() {
            grooms = std::mem::take(&mut heads);
        }
        let files = CharacterFiles::Disk { grooms: &grooms, heads: &heads };
        let source = CharacterSource::imported(&files, &ImportOptions::default(), &()).await?;
        Self::of_source(context, &source).await
    }

    /// [`load`](Self::load) from files in memory, as a browser has them: name and bytes of each.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub async fn load_bytes(context: &Context, files: &[crate::groom::import::Given<'_>]) -> Result<Self> {
        let files = CharacterFiles::Given(files);
        let source = CharacterSource::imported(&files, &ImportOptions::default(), &()).await?;
        Self::of_source(context, &source).await
    }

    /// The built-in character with hair of a style of this name ([`Style::NAMES`]), brows and lashes.
    ///
    /// # Errors
    /// [`Error::Parameter`] for another name, and those of [`new`](Self::new).
    pub async fn built_in(context: &Context, style: &str) -> Result<Self> {
        let source = CharacterSource::built_in(context, &style.parse::<Style>()?, &()).await?;
        Self::of_source(context, &source).await
    }

    async fn of_source(context: &Context, source: &CharacterSource) -> Result<Self> {
        let parts = source.dress(&Styling::default(), &()).await?;
        Self::new(context, parts, &CharacterOptions::default(), &()).await
    }

    /// Uploads a character, at rest at the origin of its space.
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it; [`Error::Groom`], [`Error::Parameter`] and [`Error::Colliders`]
    /// when parts or options make no sense.
    pub async fn new(
        context: &Context,
        mut parts: CharacterParts,
        options: &CharacterOptions<'_>,
        progress: &impl Progress,
    ) -> Result<Self> {
        let hair_bounds = parts.groom.bounds().ok_or_else(|| Error::unusable("the groom is empty"))?;
        let head_bounds = parts.head.as_ref().and_then(|head| head.bounds());
        // Collapsing edges takes as long as everything else of a small character.
        let known = parts.levels_of_head.take();
        let levels =
            parts.head.clone().map(|head| Aside::start(move || known.unwrap_or_else(|| head.levels())));
        if let Some(anatomy) = &mut parts.anatomy
            && context.tier().software
            && !cfg!(target_arch = "wasm32")
        {
            // A software driver takes many times as long for fields as the threads that it runs on.
            anatomy.measure();
        }
        let anatomy = parts.anatomy.take().map(Arc::new);
        let obstacles = Obstacles::new(options.obstacles, anatomy.as_deref(), options.fields.len());
        let builder = FieldBuilder::new(context);
        let solids = anatomy.iter().flat_map(|anatomy| anatomy.solids());
        let part_fields = solids.filter(|part| part.form == PartForm::Field).map(|part| match &part.field {
            Field::Mesh(mesh, options) => FieldSource::Mesh { builder: &builder, mesh, options },
            Field::Grid(grid) => FieldSource::Grid(grid),
        });
        let fields: Vec<_> = options.fields.iter().copied().chain(part_fields).collect();
        let what = ColliderDescriptor {
            head: parts.field.as_ref(),
            rest: parts.rest.as_ref(),
            fields: &fields,
            colliders: &obstacles.list,
        };
        let groom = &parts.groom;
        let mut hair = Hair::with_progress(context, groom, &options.hair, &what, progress).await?;
        if !parts.levels.is_empty() {
            hair.paint_levels(groom, &parts.levels, parts.skull())?;
        }
        let subject = subject(hair_bounds, head_bounds);
        let mut focus = Sphere::around(subject.0, subject.1);
        focus.radius *= SWING;
        let levels = levels.map(Aside::get).unwrap_or_default();
        let cells = options.ambient_cells;
        let mut body = parts.head.as_ref().map(|head| Body::with_levels(context, head, &levels, cells));
        let (mut face, mut rigged, mut roots) = (Vec::new(), None, None);
        if let (Some(body), Some(head)) = (&mut body, &parts.head) {
            if let Some(paint) = &head.paint {
                body.paint(paint)?;
            }
            for groom in &parts.face {
                face.push(Fringe::new(context, groom, &options.hair, &what, (body, head), progress).await?);
            }
            if let Some(anatomy) = anatomy {
                if !anatomy.is_rigid {
                    roots = Some(hair.attach(groom, head, &Skin::from(&*body), options.root_reach)?);
                }
                rigged = Some(RiggedBody::new(context, anatomy, body, Arc::new(head.clone()))?);
            }
        }
        hair.tie(groom, &parts.ties)?;
        Ok(Self {
            hair,
            face,
            body,
            props: Vec::new(),
            physics: options.hair.simulation,
            gesture: Gesture::default(),
            space: Space::WORLD,
            drawn_in: None,
            body_id: None,
            rigged,
            roots,
            obstacles,
            field: parts.field.map(Arc::new),
            look: parts.look,
            neck: parts.neck,
            subject,
            focus,
            time: 0.0,
            pose: Pose::IDENTITY,
            head: Pose::IDENTITY,
            parts: Vec::new(),
            bias: 0.0,
        })
    }

    /// Another character with the same grooms and body, at rest, that shares with this one all that does not move. It has
    /// a pose, an animation, a material, a level of detail and obstacles of its own, which begin as they are here; those
    /// that come and go ([`set_obstacles`](Self::set_obstacles)) and props are not taken over.
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it.
    pub fn instance(&self) -> Result<Self> {
        let mut obstacles = self.obstacles.clone();
        obstacles.set_free(&[]);
        let list = &obstacles.list;
        // A body that bends has vertices of its own.
        let body = self.body.as_ref().map(|body| match &self.rigged {
            Some(_) => body.unshared(),
            None => body.another(),
        });
        let skin = body.as_ref().filter(|_| self.rigged.is_some()).map(Skin::from);
        let another = |hair: &Hair, list: &[Collider]| -> Result<Hair> {
            let mut other = hair.another_on(list, skin.as_ref())?;
            other.set.material = hair.set.material;
            other.lod.options = hair.lod.options;
            other.avoidance.options = hair.avoidance.options;
            Ok(other)
        };
        let face = self.face.iter().map(|face| {
            let list = if face.hangs { &list[..] } else { &[] };
            Ok(Fringe { hair: another(&face.hair, list)?, hangs: face.hangs })
        });
        Ok(Self {
            hair: another(&self.hair, list)?,
            face: face.collect::<Result<_>>()?,
            props: Vec::new(),
            physics: self.physics,
            gesture: self.gesture.clone(),
            space: self.space,
            drawn_in: self.drawn_in,
            body_id: None,
            rigged: self.rigged.as_ref().zip(body.as_ref()).map(|(rigged, body)| rigged.instance(body)),
            roots: self.roots,
            obstacles,
            field: self.field.clone(),
            look: self.look,
            neck: self.neck,
            subject: self.subject,
            focus: self.focus,
            time: self.time,
            pose: self.pose,
            head: self.head,
            parts: Vec::new(),
            bias: 0.0,
            body,
        })
    }

    /// Makes the roots follow a mesh that the host deforms: `skin` holds the vertices of `parts.head` in each frame, in a
    /// space whose pose is [`set_pose`](Self::set_pose). `parts` are those that the character was made of. No root may be
    /// farther than `reach` metres from the mesh.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for other parts, for parts without a mesh, and for a root that is farther away;
    /// [`Error::Limit`].
    pub fn skinned_by(&mut self, parts: &CharacterParts, skin: &Skin<'_>, reach: f32) -> Result<RootReport> {
        let mesh =
            parts.head.as_ref().ok_or_else(|| Error::unusable("roots follow a mesh: parts.head is none"))?;
        let report = self.hair.attach(&parts.groom, mesh, skin, reach)?;
        for (face, groom) in self.face.iter_mut().zip(&parts.face) {
            face.hair.attach(&groom.groom, mesh, skin, reach.max(FACE_REACH))?;
        }
        self.roots = Some(report);
        Ok(report)
    }

    /// Replaces the grooms and the body by those of `parts`; pose, animation, time and look go on. The hair begins at rest.
    ///
    /// # Errors
    /// As [`new`](Self::new); then nothing has changed.
    pub async fn replace(
        &mut self,
        context: &Context,
        parts: CharacterParts,
        options: &CharacterOptions<'_>,
        progress: &impl Progress,
    ) -> Result<()> {
        let mut other = Self::new(context, parts, options, progress).await?;
        other.continue_from(self);
        other.props = std::mem::take(&mut self.props);
        *self = other;
        Ok(())
    }

    /// Goes on from `other`, for example one on a device that was lost: pose, animation, blend shapes, time, physics,
    /// material, levels of detail. The hair begins at rest.
    pub fn continue_from(&mut self, other: &Self) {
        self.physics = other.physics;
        self.gesture = other.gesture.clone();
        (self.space, self.drawn_in, self.time) = (other.space, other.drawn_in, other.time);
        if let (Some(own), Some(rigged)) = (&mut self.rigged, &other.rigged) {
            own.continue_from(rigged);
        }
        if self.obstacles.fixed.len() == other.obstacles.fixed.len() {
            self.obstacles.fixed.clone_from(&other.obstacles.fixed);
        }
        self.set_material(other.hair.set.material);
        self.set_lod(other.hair.lod.options);
        self.set_avoidance(other.hair.avoidance.options);
    }

    /// Places the body: from groom space to the world. A rigid body and its hair go there with the head straight.
    pub fn set_pose(&mut self, body: Pose) {
        self.gesture.body = body;
    }

    /// Plays the rig's animation of this name, at `time`, s. It goes on with the time that frames take.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] when the body has no rig or no such animation; the message lists those that
    /// there are.
    pub fn animate(&mut self, name: &str, time: f64) -> Result<()> {
        let rigged = self.rigged.as_mut().ok_or_else(|| Error::unusable("the body has no rig to animate"))?;
        rigged.set_animation(Some(name))?;
        self.time = time;
        Ok(())
    }

    /// The rig of the body, if it has one.
    pub fn rig(&self) -> Option<&RiggedBody> {
        self.rigged.as_ref()
    }

    /// The rig of the body, to set animation, blend shapes or joints.
    pub fn rig_mut(&mut self) -> Option<&mut RiggedBody> {
        self.rigged.as_mut()
    }

    /// Seconds since the hair was put to rest, or what was [sought](Self::seek).
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Sets the time of animations, s. The hair is not put to rest.
    pub fn seek(&mut self, time: f64) {
        self.time = time;
    }

    /// Puts the hair to rest at the next frame, wherever the head is then, and time to 0.
    pub fn reset(&mut self) {
        self.grooms_mut().for_each(Hair::reset);
        self.time = 0.0;
    }

    /// Lets the next frame carry the hair along, whatever way the head goes in it, without moving it against the head.
    pub fn teleport(&mut self) {
        self.grooms_mut().for_each(Hair::teleport);
    }

    /// Moves the obstacles that the character was made with, in the space of each one's anchor.
    ///
    /// # Errors
    /// [`Error::Colliders`] unless there are as many poses.
    pub fn place_obstacles(&mut self, poses: &[Pose]) -> Result<()> {
        let fixed = &mut self.obstacles.fixed;
        if poses.len() != fixed.len() {
            let problem = format!("{} poses do not place {} obstacles", poses.len(), fixed.len());
            return Err(Error::Colliders(problem));
        }
        fixed.copy_from_slice(poses);
        Ok(())
    }

    /// Replaces the obstacles that come and go. One that keeps its place in the list and its id moves from where it is to
    /// its new pose; others appear.
    ///
    /// # Errors
    /// [`Error::Colliders`] for too many, and for fields that the character was not made with.
    pub fn set_obstacles(&mut self, obstacles: &[Obstacle]) -> Result<()> {
        let before = self.obstacles.clone();
        let Some(kept) = self.obstacles.set_free(obstacles) else { return Ok(()) };
        let list = &self.obstacles.list;
        let changed = colliding(&mut self.hair, &mut self.face).try_for_each(|hair| {
            // What takes the place of another must not fly over from there.
            hair.set_colliders(&list[..kept])?;
            hair.set_colliders(list)
        });
        if changed.is_err() {
            self.obstacles = before;
            let list = &self.obstacles.list;
            colliding(&mut self.hair, &mut self.face).try_for_each(|hair| hair.set_colliders(list))?;
        }
        changed
    }

    /// Where the obstacles are drawn, relative to the body: those it was made with, then those that come and go. Empty
    /// until a frame has placed them.
    pub fn drawn_obstacles(&self) -> Vec<Pose> {
        let drawn = self.hair.colliders.drawn();
        // The head's field comes first, where there is one. A collider that has just come has no place yet.
        let Some(own) = drawn.len().checked_sub(self.obstacles.list.len()) else { return Vec::new() };
        let to_body = self.pose.inverse();
        self.obstacles.visible(&drawn[own..]).map(|pose| to_body.after(&pose)).collect()
    }

    /// The distance fields of the head and the other parts of the body that are known on the CPU, with their poses.
    pub fn solids(&self) -> Vec<(&SdfGrid, Pose)> {
        let head = self.field.as_deref().map(|field| (field, self.head));
        let solids = self.rigged.iter().flat_map(|rigged| rigged.anatomy().solids());
        let parts = solids.zip(&self.parts).filter_map(|(part, pose)| match (&part.form, &part.field) {
            (PartForm::Field, Field::Grid(grid)) => Some((grid, *pose)),
            _ => None,
        });
        head.into_iter().chain(parts).collect()
    }

    /// The distance field of the head, groom space.
    pub fn field(&self) -> Option<&SdfGrid> {
        self.field.as_deref()
    }

    /// The hair.
    pub fn hair(&self) -> &Hair {
        &self.hair
    }

    /// The hair, to grab it and to set what this type does not.
    pub fn hair_mut(&mut self) -> &mut Hair {
        &mut self.hair
    }

    /// All grooms, the hair first.
    pub fn grooms(&self) -> impl Iterator<Item = &Hair> {
        std::iter::once(&self.hair).chain(self.face.iter().map(|face| &face.hair))
    }

    fn grooms_mut(&mut self) -> impl Iterator<Item = &mut Hair> {
        std::iter::once(&mut self.hair).chain(self.face.iter_mut().map(|face| &mut face.hair))
    }

    /// Removes brows, lashes and beard.
    pub fn shave(&mut self) {
        self.face.clear();
    }

    /// The mesh of head or body.
    pub fn body(&self) -> Option<&Body> {
        self.body.as_ref()
    }

    /// The mesh of head or body, to set its material.
    pub fn body_mut(&mut self) -> Option<&mut Body> {
        self.body.as_mut()
    }

    /// The look of the hair; face grooms are a shade darker.
    pub fn set_material(&mut self, material: HairMaterial) {
        self.hair.set.material = material;
        let darker = facial::darker(&material);
        self.face.iter_mut().for_each(|face| face.hair.set.material = darker);
    }

    /// The options of the level of detail, of all grooms.
    pub fn set_lod(&mut self, options: LodOptions) {
        self.grooms_mut().for_each(|hair| hair.lod.options = options);
    }

    /// The options of strand collision, of the hair.
    pub fn set_avoidance(&mut self, options: crate::avoid::AvoidOptions) {
        self.hair.avoidance.options = options;
    }

    /// The fiber that the groom's file describes.
    pub fn look(&self) -> Option<&Look> {
        self.look.as_ref()
    }

    /// How far roots lie from the skinned mesh, where there is one.
    pub fn roots(&self) -> Option<RootReport> {
        self.roots
    }

    /// The box that a portrait shows while the character rests, metres.
    pub fn subject(&self) -> Bounds {
        self.subject
    }

    /// The joint that the head turns about, groom space, metres.
    pub fn neck(&self) -> Vec3 {
        self.neck
    }

    /// Where the head was in the last frame, from where it rests.
    pub fn head(&self) -> Pose {
        self.head
    }

    /// Where the body was in the last frame.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The sphere that shadow maps cover: the hair, with room to swing.
    pub fn focus(&self) -> Sphere {
        // A rigid head turns within its sphere.
        let pose = if self.rigged.is_some() { &self.head } else { &self.gesture.body };
        Sphere { center: pose.point(self.focus.center), ..self.focus }
    }

    /// Bytes of GPU memory of all grooms.
    pub fn hair_bytes(&self) -> u64 {
        self.grooms().map(Hair::bytes).sum()
    }

    /// Bytes of GPU memory that instances share.
    pub fn shared_bytes(&self) -> u64 {
        self.grooms().map(Hair::shared_bytes).sum::<u64>() + self.body.as_ref().map_or(0, Body::shared_bytes)
    }

    /// Bytes of GPU memory that are this instance's alone.
    pub fn own_bytes(&self) -> u64 {
        let body = self.body.as_ref().map_or(0, |body| body.bytes() - body.shared_bytes());
        self.grooms().map(Hair::own_bytes).sum::<u64>() + body
    }

    /// Lets hair of several characters touch in the next frame, where they are near each other: call it before
    /// [`Frame::advance`].
    ///
    /// # Errors
    /// As [`Hair::meet_each_other`].
    pub fn meet_each_other(characters: &mut [&mut Self]) {
        let mut hair: Vec<_> = characters.iter_mut().map(|character| &mut character.hair).collect();
        Hair::meet_each_other(&mut hair);
    }

    /// The poses of a frame that ends `dt` seconds after the last one: first part of a frame.
    fn find_pose(&mut self, dt: f32) -> Result<()> {
        self.time += f64::from(dt);
        self.parts.clear();
        self.head = self.gesture.rigid();
        // A mesh that the host deforms has the turn of the head already.
        self.pose = if self.hair.roots.is_some() { self.gesture.body } else { self.head };
        if let (Some(rigged), Some(body)) = (&mut self.rigged, &mut self.body) {
            let pose = rigged.pose(self.time, &self.gesture, body)?;
            self.pose = self.gesture.body;
            self.head = self.pose.after(&pose.head);
            self.parts.extend(pose.parts.iter().map(|part| self.pose.after(part)));
            if rigged.bends(&pose) {
                let hair = colliding(&mut self.hair, &mut self.face);
                rigged.deform(body, self.field.is_some(), &self.obstacles.part_fields(), hair)?;
            }
            for hair in colliding(&mut self.hair, &mut self.face) {
                if let Some(deformation) = &mut hair.colliders.deformation {
                    deformation.poses.clear();
                    deformation.poses.extend(rigged.deforming(&pose));
                }
            }
        }
        let (pose, is_still) = (self.pose, self.rigged.as_ref().is_some_and(|rigged| rigged.is_still));
        for hair in self.grooms_mut() {
            hair.motion.skin_is_still = is_still;
            if let Some(roots) = &mut hair.roots {
                roots.pose = pose;
            }
        }
        let drawn = self.drawn(&pose);
        for body in self.body.iter_mut().chain(&mut self.props) {
            body.pose = drawn;
        }
        Ok(())
    }

    /// `pose` in the space that the character is drawn in.
    fn drawn(&self, pose: &Pose) -> Pose {
        match self.drawn_in {
            Some(_) => HairFrame { space: self.space, drawn_in: self.drawn_in, ..HairFrame::default() }
                .way_to_view()
                .pose(pose),
            None => *pose,
        }
    }

    /// Records the motion of all grooms: last part of a frame.
    fn advance(&mut self, recorder: &mut Recorder<'_>, dt: f32) -> Result<()> {
        let colliders = self.obstacles.poses(&self.parts);
        let nowhere = ColliderPoses::default();
        let (physics, head, space, drawn_in) = (self.physics, self.head, self.space, self.drawn_in);
        let frame = HairFrame { dt, head, colliders: &colliders, simulation: &physics, space, drawn_in };
        recorder.advance(&mut self.hair, &frame)?;
        for Fringe { hair, hangs } in &mut self.face {
            hair.lod.options = self.hair.lod.options;
            hair.set.share_fibers(&self.hair.set);
            let simulation = &facial::physics(&physics, *hangs);
            let colliders = if *hangs { &colliders } else { &nowhere };
            recorder.advance(hair, &HairFrame { simulation, colliders, ..frame })?;
        }
        Ok(())
    }
}

impl Fringe {
    /// On the skin of `body`, whose mesh at rest is `mesh`; what hangs collides as `what` says.
    async fn new(
        context: &Context,
        face: &FaceGroom,
        like: &HairOptions,
        what: &ColliderDescriptor<'_>,
        (body, mesh): (&Body, &TriMesh),
        progress: &impl Progress,
    ) -> Result<Self> {
        // Without wind nothing asks the grid of what lies on the skin.
        let volume = match face.hangs {
            true => VolumeOptions::default(),
            false => VolumeOptions { resolution: 8, ..Default::default() },
        };
        let simulation = facial::physics(&like.simulation, face.hangs);
        let options = HairOptions { simulation, volume, ..Default::default() };
        let nothing = ColliderDescriptor::default();
        let what = if face.hangs { what } else { &nothing };
        let mut hair = Hair::with_progress(context, &face.groom, &options, what, progress).await?;
        hair.attach(&face.groom, mesh, &Skin::from(body), FACE_REACH)?;
        Ok(Self { hair, hangs: face.hangs })
    }
}

/// The grooms that collide with the body.
fn colliding<'a>(hair: &'a mut Hair, face: &'a mut [Fringe]) -> impl Iterator<Item = &'a mut Hair> {
    let hanging = face.iter_mut().filter(|face| face.hangs).map(|face| &mut face.hair);
    std::iter::once(hair).chain(hanging)
}
