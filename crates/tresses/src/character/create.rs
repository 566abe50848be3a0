//! Creating characters: from files, built in, from an asset, as an instance of another.

use super::{
    Character, CharacterAsset, CharacterOptions, Fringe, Gesture, RiggedBody,
    asset::{GroomAsset, MAX_FACE_ROOT_DISTANCE},
};
use crate::{
    Context, Pose, Result,
    body::Skin,
    collide::Collider,
    drape,
    groom::{
        TriMesh,
        character::{CharacterFiles, CharacterSource, Styling},
        import::{self, FileBytes, ImportOptions},
        styles::Style,
    },
    hair::Hair,
    light::HairMaterial,
    roots::RootReport,
    space::Space,
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

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
    /// [`crate::Error::Parameter`] for an unknown style, and the errors of [`new`](Self::new).
    pub async fn built_in(context: &Context, style: &str) -> Result<Self> {
        let source = drape::style(context, &style.parse::<Style>()?, &()).await?;
        Self::of_source(context, &source).await
    }

    async fn of_source(context: &Context, source: &CharacterSource) -> Result<Self> {
        let parts = source.parts(&Styling::default(), &()).await?;
        Self::new(&CharacterAsset::new(context, parts, &CharacterOptions::default(), &()).await?)
    }

    /// Creates a character at rest at the origin of its space.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold it.
    pub fn new(asset: &Arc<CharacterAsset>) -> Result<Self> {
        // A skinned mesh needs its own vertices.
        let body = asset.body.as_ref().map(|body| body.instance(asset.rig.is_some()));
        let skin = body.as_ref().filter(|_| asset.rig.is_some()).map(Skin::from);
        let create = |GroomAsset { hair, roots, .. }: &GroomAsset, colliders: &[Collider]| {
            Hair::on(hair, colliders, roots.as_ref().zip(skin.as_ref()))
        };
        let face = asset.face.iter().map(|face| {
            let colliders = if face.hangs { &asset.obstacles.list[..] } else { &[] };
            Ok(Fringe { hair: create(face, colliders)?, hangs: face.hangs })
        });
        let rig = asset.rig.as_ref().zip(body.as_ref());
        let mut character = Self {
            hair: create(&asset.hair, &asset.obstacles.list)?,
            face: face.collect::<Result<_>>()?,
            rigged: rig.map(|(rig, body)| RiggedBody::new(rig, body)).transpose()?,
            body,
            props: Vec::new(),
            physics: asset.physics,
            gesture: Gesture::default(),
            space: Space::WORLD,
            drawn_in: None,
            body_id: None,
            roots: asset.hair.roots.as_ref().map(|roots| roots.report),
            obstacles: asset.obstacles.clone(),
            time: 0.0,
            pose: Pose::IDENTITY,
            head: Pose::IDENTITY,
            parts: Vec::new(),
            bias: 0.0,
            asset: asset.clone(),
        };
        character.set_material(HairMaterial::default());
        Ok(character)
    }

    /// Creates another character of the same asset, at rest. Its pose, animation, material, level of detail, ties and
    /// the poses of its obstacles start as copies of this one's. Obstacles that come and go
    /// ([`set_obstacles`](Self::set_obstacles)) and props are not copied. A [shaved](Self::shave) character stays so.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the adapter cannot hold it.
    pub fn instance(&self) -> Result<Self> {
        let mut other = Self::new(&self.asset)?;
        other.continue_from(self);
        (other.body_id, other.pose, other.head) = (None, self.pose, self.head);
        if let (Some(body), Some(own)) = (&mut other.body, &self.body) {
            body.material = own.material;
        }
        other.face.truncate(self.face.len());
        other.hair.tie_as(&self.hair)?;
        Ok(other)
    }

    /// Makes the roots follow a mesh that the host deforms. `mesh` is the mesh at rest (groom space). `skin` holds its
    /// vertices in each frame, in a space whose pose is set by [`set_pose`](Self::set_pose). No root may be farther
    /// than `max_distance` meters from the mesh.
    ///
    /// # Errors
    /// [`crate::groom::Error::Unusable`] for a root that is too far away and for a skin that does not fit the mesh;
    /// [`crate::Error::Limit`].
    pub fn skinned_by(&mut self, mesh: &TriMesh, skin: &Skin<'_>, max_distance: f32) -> Result<RootReport> {
        let report = self.hair.attach(mesh, skin, max_distance)?;
        for face in &mut self.face {
            face.hair.attach(mesh, skin, max_distance.max(MAX_FACE_ROOT_DISTANCE))?;
        }
        self.roots = Some(report);
        Ok(report)
    }

    /// Replaces the grooms and the body by those of `asset`. Keeps pose, animation, time, material and props. The hair
    /// begins at rest.
    ///
    /// # Errors
    /// As [`new`](Self::new). The character is unchanged after an error.
    pub fn replace(&mut self, asset: &Arc<CharacterAsset>) -> Result<()> {
        let mut other = Self::new(asset)?;
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
