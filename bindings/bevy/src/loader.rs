//! Grooms from files.

use crate::HairGroom;
use bevy::{
    asset::{AssetLoader, AssetPath, LoadContext, io::Reader},
    prelude::*,
};
use serde::{Deserialize, Serialize};
use std::{borrow::Cow, path::PathBuf, sync::Arc};
use tresses::groom::{
    BindOptions, Fill, Groom, GuideCount, Head, SdfGrid, TriMesh, bind, bind_filled, fill,
    import::{self, Given},
    mesh::sdf,
};

/// How a groom is loaded.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct HairGroomSettings {
    /// Files that belong to it, relative to its own: the meshes of its head, what those need (`.mtl`, `.bin`), further
    /// parts of the groom.
    pub beside: Vec<String>,
    /// Grows strands between those of the files until there are so many; `None` for those of the files.
    pub strands: Option<u32>,
    /// How many strands are simulated; `None` for one in sixteen, or those that the file marks as guides.
    pub guides: Option<u32>,
}

/// Loads a [`HairGroom`] from every format that [`import`] reads: `assets.load::<HairGroom>(path)`, as a field of that type
/// has it. By their extensions alone only the formats of grooms come to it: `.glb` is left to the loader of scenes. Unit and
/// axes are guessed where files do not say them.
#[derive(Debug, Default, TypePath)]
pub struct HairGroomLoader;

/// A file beside the groom's own that cannot be read.
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
        let mut files: Vec<Given<'_>> = vec![(path.path().to_path_buf(), Cow::Owned(bytes))];
        for name in &settings.beside {
            let beside: AssetPath<'static> = path.resolve_embed_str(name)?;
            let bytes = context.read_asset_bytes(beside.clone()).await;
            let bytes = bytes.map_err(|error| LoadError(format!("{path} needs {name}: {error}")))?;
            files.push((PathBuf::from(beside.path()), Cow::Owned(bytes)));
        }
        #[cfg(feature = "cooked")]
        if settings.strands.is_none()
            && settings.guides.is_none()
            && let Some((_, cooked)) = import::given_cooked(&files, &Default::default())?
        {
            for note in cooked.report(path.path()).files.iter().flat_map(|file| &file.notes) {
                info!("{path}: {note}");
            }
            // Of a body that bends the field is that of its head alone.
            let mesh = cooked.head.as_ref();
            let whole = if cooked.rig.is_some() {
                mesh.map(|mesh| sdf::build(mesh, &Default::default()))
            } else {
                None
            };
            let head = whole.transpose()?.or(cooked.field);
            return Ok(asset(cooked.groom, head, cooked.head));
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
                bind_filled(&fill(&strands, on, &Fill { strands: count, ..Default::default() })?, &options)?
            }
            None => bind(&strands, &options)?,
        };
        Ok(asset(groom, head, mesh))
    }

    fn extensions(&self) -> &[&str] {
        // A label, as of a scene in a file, leaves nothing but the extension to choose a loader by.
        OWN
    }
}

/// What nothing but hair is in.
const OWN: &[&str] = &["tfx", "hair", "tresses"];

fn asset(groom: Groom, head: Option<SdfGrid>, mesh: Option<TriMesh>) -> HairGroom {
    HairGroom { head: head.map(Arc::new), mesh: mesh.map(Arc::new), ..HairGroom::new(groom) }
}
