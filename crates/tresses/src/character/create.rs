//! Creating characters: from files, built in, from parts, as an instance of another.

use super::{
    Character, CharacterFiles, CharacterParts, CharacterSource, FaceGroom, Fringe, Gesture, RiggedBody,
    Styling, aside::BackgroundTask, facial, obstacles::Obstacles, subject,
};
use crate::{
    Context, Error, Pose, Progress, Result,
    body::{Body, Skin},
    collide::{Collider, ColliderDescriptor, FieldBuilder, FieldSource},
    groom::{
        TriMesh,
        import::{self, FileBytes, ImportOptions},
        rig::anatomy::{Field, PartForm},
        styles::Style,
    },
    hair::{Hair, HairOptions},
    light::Sphere,
    roots::RootReport,
    space::Space,
    volume::VolumeOptions,
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Maximum distance of a face groom's roots from the skin, meters.
const FACE_REACH: f32 = 0.01;
/// Radius of the sphere covered by shadow maps, relative to the hair at rest. Keeps moving hair inside.
const SWING: f32 = 1.15;

/// Options for uploading a character.
#[derive(Clone, Copy, Debug)]
pub struct CharacterOptions<'a> {
    /// Options of the hair. Face grooms use its physics and level of detail.
    pub hair: HairOptions,
    /// Colliders besides the body; [`Character::place_obstacles`] moves them.
    pub obstacles: &'a [Collider],
    /// Distance fields that colliders refer to by [`FieldId`](crate::collide::FieldId).
    pub fields: &'a [FieldSource<'a>],
    /// Maximum resolution of the grid of ambient light that the body is drawn with, cells per edge
    /// ([`ViewOptions::ambient_cells`](crate::view::ViewOptions::ambient_cells)).
    pub ambient_cells: u32,
    /// Maximum distance of a root of the hair from a skinned mesh, meters. Grooms made for another head may be
    /// centimeters off.
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

impl Character {
    /// Reads and uploads the groom and the body in `files` with default options. `files` is, for example, a `.glb` with
    /// hair, or a groom and a head mesh.
    ///
    /// # Errors
    /// An error that names the file when one cannot be read, and the errors of [`new`](Self::new).
    pub async fn load<P: AsRef<Path>>(context: &Context, files: impl IntoIterator<Item = P>) -> Result<Self> {
        let mut grooms: Vec<PathBuf> = files.into_iter().map(|path| path.as_ref().to_owned()).collect();
        let mut heads = Vec::new();
        // Hair and body may be in one file.
        if grooms.len() > 1 {
            for path in std::mem::take(&mut grooms) {
                let read = |source| crate::groom::Error::Io { path: path.clone(), source };
                let bytes = std::fs::read(&path).map_err(read)?;
                let is_mesh = import::kind(&path, &bytes) == Some(import::FileKind::Mesh);
                if is_mesh { &mut heads } else { &mut grooms }.push(path);
            }
            if grooms.is_empty() {
                grooms = std::mem::take(&mut heads);
            }
        }
        let files = CharacterFiles::Disk { grooms: &grooms, heads: &heads };
        let source = CharacterSource::imported(&files, &ImportOptions::default(), &()).await?;
        Self::of_source(context, &source).await
    }

    /// [`load`](Self::load) from files in memory, as in a browser: name and bytes of each.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub async fn load_bytes(context: &Context, files: &[FileBytes<'_>]) -> Result<Self> {
        let files = CharacterFiles::Given(files);
        let source = CharacterSource::imported(&files, &ImportOptions::default(), &()).await?;
        Self::of_source(context, &source).await
    }

    /// Creates the built-in character with hair of the named style ([`Style::NAMES`]), brows and lashes.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown style, and the errors of [`new`](Self::new).
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
    /// [`Error::Limit`] when the adapter cannot hold it; [`Error::Groom`], [`Error::Parameter`] and
    /// [`Error::Colliders`] when parts or options are invalid.
    pub async fn new(
        context: &Context,
        mut parts: CharacterParts,
        options: &CharacterOptions<'_>,
        progress: &impl Progress,
    ) -> Result<Self> {
        let hair_bounds = parts.groom.bounds().ok_or_else(|| Error::unusable("the groom is empty"))?;
        let head = parts.head.take().map(Arc::new);
        let head_bounds = head.as_ref().and_then(|head| head.bounds());
        // Collapsing edges takes as long as everything else for a small character, so it runs on its own thread.
        let known = parts.levels_of_head.take();
        let levels =
            head.clone().map(|head| BackgroundTask::start(move || known.unwrap_or_else(|| head.levels())));
        if let Some(anatomy) = &mut parts.anatomy
            && context.tier().software
            && !cfg!(target_arch = "wasm32")
        {
            // A software driver is many times slower at building fields than CPU threads.
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
        if let Some(sheet) = &parts.cards {
            hair.set_cards(&groom.strands, sheet)?;
        }
        if !parts.levels.is_empty() {
            hair.paint_levels(groom, &parts.levels, parts.skull())?;
        }
        let subject = subject(hair_bounds, head_bounds);
        let mut focus = Sphere::around(subject.0, subject.1);
        focus.radius *= SWING;
        let levels = levels.map(BackgroundTask::get).unwrap_or_default();
        let cells = options.ambient_cells;
        let mut body = head.as_ref().map(|head| Body::with_levels(context, head, &levels, cells));
        let (mut face, mut rigged, mut roots) = (Vec::new(), None, None);
        if let (Some(body), Some(head)) = (&mut body, head) {
            if let Some(paint) = &head.paint {
                body.paint(paint)?;
            }
            for groom in &parts.face {
                face.push(Fringe::new(context, groom, &options.hair, &what, (body, &head), progress).await?);
            }
            if let Some(anatomy) = anatomy {
                if !anatomy.is_rigid {
                    roots = Some(hair.attach(groom, &head, &Skin::from(&*body), options.root_reach)?);
                }
                rigged = Some(RiggedBody::new(context, anatomy, body, head)?);
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

    /// Creates another character with the same grooms and body, at rest, that shares with this one everything that does
    /// not move. Its pose, animation, material, level of detail and obstacles are its own and start as copies of this
    /// one's. Obstacles that come and go ([`set_obstacles`](Self::set_obstacles)) and props are not copied.
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it.
    pub fn instance(&self) -> Result<Self> {
        let mut obstacles = self.obstacles.clone();
        obstacles.set_free(&[]);
        let list = &obstacles.list;
        // A skinned mesh needs its own vertices.
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

    /// Makes the roots follow a mesh that the host deforms. `skin` holds the vertices of `parts.head` in each frame, in
    /// a space whose pose is set by [`set_pose`](Self::set_pose). `parts` are those that the character was created
    /// from. No root may be farther than `reach` meters from the mesh.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for other parts, parts without a mesh, or a root that is too far away;
    /// [`Error::Limit`].
    pub fn skinned_by(&mut self, parts: &CharacterParts, skin: &Skin<'_>, reach: f32) -> Result<RootReport> {
        let mesh = parts
            .head
            .as_ref()
            .ok_or_else(|| Error::unusable("roots need a mesh to follow, but parts.head is None"))?;
        let report = self.hair.attach(&parts.groom, mesh, skin, reach)?;
        for (face, groom) in self.face.iter_mut().zip(&parts.face) {
            face.hair.attach(&groom.groom, mesh, skin, reach.max(FACE_REACH))?;
        }
        self.roots = Some(report);
        Ok(report)
    }

    /// Replaces the grooms and the body by those of `parts`. Keeps pose, animation, time and material. The hair begins
    /// at rest.
    ///
    /// # Errors
    /// As [`new`](Self::new). The character is unchanged after an error.
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

    /// Continues from `other`, for example a character on a lost device: takes over pose, animation, blend shapes,
    /// time, physics, material and level-of-detail options. The hair begins at rest.
    pub fn continue_from(&mut self, other: &Self) {
        self.physics = other.physics;
        self.gesture = other.gesture.clone();
        (self.space, self.drawn_in, self.body_id) = (other.space, other.drawn_in, other.body_id);
        self.time = other.time;
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
}

impl Fringe {
    /// Creates a face groom on the skin of `body`, whose mesh at rest is `mesh`. A groom that hangs collides as
    /// described by `what`.
    async fn new(
        context: &Context,
        face: &FaceGroom,
        like: &HairOptions,
        what: &ColliderDescriptor<'_>,
        (body, mesh): (&Body, &TriMesh),
        progress: &impl Progress,
    ) -> Result<Self> {
        // A groom that lies on the skin reads its grid only with wind, which it does not have.
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
