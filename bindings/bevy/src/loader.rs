//! Loads grooms from files.

use crate::HairGroom;
use bevy::{
    asset::{AssetLoader, AssetPath, LoadContext, io::Reader},
    prelude::*,
};
use serde::{Deserialize, Serialize};
use std::{borrow::Cow, path::PathBuf, sync::Arc};
use tresses::groom::{
    BindOptions, Fill, Groom, GuideCount, Head, SdfGrid, TriMesh, bind, bind_filled, fill,
    import::{self, FileBytes},
    mesh::sdf,
};

/// Options for loading a groom.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct HairGroomSettings {
    /// Additional files, relative to the groom's: meshes of its head, files that these need (`.mtl`, `.bin`), further
    /// parts of the groom.
    pub beside: Vec<String>,
    /// Fills the groom with interpolated strands up to this count; `None` keeps the strands of the files.
    pub strands: Option<u32>,
    /// Number of guides; `None` for the guides marked in the file, or else one strand in sixteen.
    pub guides: Option<u32>,
}

/// Loads a [`HairGroom`] from every format that [`import`] reads: `assets.load::<HairGroom>(path)`, or a load whose
/// type is inferred. Untyped loads select this loader only for formats that hold nothing but grooms; `.glb` goes to
/// Bevy's scene loader. Unit and axes are guessed if the file does not state them.
#[derive(Debug, Default, TypePath)]
pub struct HairGroomLoader;

/// Error of a file that the groom needs.
#[derive(Debug)]
struct LoadError(String);

impl std::fmt::Display for LoadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for LoadError {}

impl AssetLoader for HairGroomLoader {
    type Asset = HairGroom;
    type Settings = HairGroomSettings;
    type Error = BevyError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        settings: &HairGroomSettings,
        context: &mut LoadContext<'_>,
    ) -> Result<HairGroom> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let path = context.path().clone();
        let mut files: Vec<FileBytes<'_>> = vec![(path.path().to_path_buf(), Cow::Owned(bytes))];
        for name in &settings.beside {
            let file: AssetPath<'static> = path.resolve_embed_str(name)?;
            let bytes = context.read_asset_bytes(file.clone()).await;
            let bytes = bytes.map_err(|error| LoadError(format!("{path} needs {name}: {error}")))?;
            files.push((PathBuf::from(file.path()), Cow::Owned(bytes)));
        }
        #[cfg(feature = "cooked")]
        if settings.strands.is_none()
            && settings.guides.is_none()
            && let Some((_, cooked)) = import::given_cooked(&files, &Default::default())?
        {
            for note in cooked.report(path.path()).files.iter().flat_map(|file| &file.notes) {
                info!("{path}: {note}");
            }
            // For a skinned mesh, the cooked field covers only the head. Build one of the whole mesh.
            let mesh = cooked.head.as_ref();
            let body_field = if cooked.rig.is_some() {
                mesh.map(|mesh| sdf::build(mesh, &Default::default()))
            } else {
                None
            };
            let head = body_field.transpose()?.or(cooked.field);
            return Ok(asset(cooked.groom, head, cooked.head));
        }
        #[cfg(feature = "edit")]
        if settings.strands.is_none()
            && settings.guides.is_none()
            && let Some((_, document)) = import::given_edited(&files, &Default::default())?
        {
            let mesh = import::edited_body(&document)?.map(|body| body.mesh);
            let head = mesh.as_ref().map(|mesh| sdf::build(mesh, &Default::default())).transpose()?;
            return Ok(asset(document.groom(), head, mesh));
        }
        let (strands, mesh, report) = import::read_given(&files, &Default::default())?;
        for note in report.files.iter().flat_map(|file| &file.notes) {
            info!("{path}: {note}");
        }
        let head = mesh.as_ref().map(|mesh| sdf::build(mesh, &Default::default())).transpose()?;
        let guides = settings.guides.map_or(BindOptions::default().guides, GuideCount::Count);
        let options = BindOptions { guides, ..Default::default() };
        let groom = match settings.strands {
            Some(count) => {
                let on = Head { mesh: mesh.as_ref(), field: head.as_ref() };
                bind_filled(
                    &fill(&strands, on, &Fill { strand_count: count, ..Default::default() })?,
                    &options,
                )?
            }
            None => bind(&strands, &options)?,
        };
        Ok(asset(groom, head, mesh))
    }

    fn extensions(&self) -> &[&str] {
        // For a labeled path, such as a scene in a file, Bevy chooses the loader by the extension alone.
        OWN
    }
}

/// Extensions of formats that hold nothing but hair.
const OWN: &[&str] = &["tfx", "hair", "tresses", "groom"];

fn asset(groom: Groom, head: Option<SdfGrid>, mesh: Option<TriMesh>) -> HairGroom {
    HairGroom { head: head.map(Arc::new), mesh: mesh.map(Arc::new), ..HairGroom::new(groom) }
}
