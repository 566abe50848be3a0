//! Edited characters: versions of a groom under a brush, and their files.

use super::{CharacterFiles, CharacterSource, HairInput, Styling, anatomy, field_of, neck, rebound};
use crate::{
    Groom, GuideCount, Progress, Result, SdfGrid,
    edit::{GroomDocument, GroomEditor, HeadFiles},
    import::{self, ImportOptions},
    mannequin,
    mesh::sdf::{self, SdfOptions},
    orient::Placement,
    rig::anatomy::Anatomy,
    scalp::GridScalp,
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Number of guides below which an edited groom gets more.
const MIN_GUIDES: usize = 600;
/// Number of strands that follow one of these.
const STRANDS_PER_GUIDE: u32 = 16;

impl CharacterFiles<'_> {
    /// Returns the edited groom with its path, if the files are one.
    pub(super) fn edited(&self, options: &ImportOptions) -> Result<Option<(PathBuf, GroomDocument)>> {
        Ok(match self {
            Self::Disk { grooms, heads } => import::edited(grooms, heads, options)?,
            Self::Given(files) => import::given_edited(files, options)?,
        })
    }
}

impl CharacterSource {
    /// Creates the source from an edited groom. `path` names it in errors.
    ///
    /// # Errors
    /// An error when a file of its head cannot be read.
    pub async fn edited(path: &Path, document: GroomDocument, progress: &impl Progress) -> Result<Self> {
        let base = document.base();
        let guides = || (0..base.guides.len()).map(|i| base.guides.guide(i));
        if *document.head() == HeadFiles::BuiltIn {
            let head = mannequin::mesh_with(mannequin::RESOLUTION, progress).await;
            let scalp =
                GridScalp::of_mannequin(mannequin::sdf_with(mannequin::FIELD_RESOLUTION, progress).await);
            return Ok(Self {
                anatomy: Some(Anatomy::built_in(&head, &scalp.field)),
                head: Some(head),
                neck: mannequin::NECK_JOINT,
                hair: HairInput::Edited { document, field: Some(scalp.field) },
                lights: Vec::new(),
                notes: Vec::new(),
                report: None,
            });
        }
        let (head, rig, lights) = match import::edited_body(&document)? {
            Some(body) => (Some(body.mesh), body.rig, body.lights),
            None => (None, None, Vec::new()),
        };
        let anatomy = anatomy(rig, head.as_ref(), guides())?;
        let field = field_of(anatomy.as_ref(), head.as_ref(), &path.display().to_string(), progress).await?;
        let neck = neck(guides().map(|guide| guide[0]), head.as_ref());
        let hair = HairInput::Edited { document, field };
        Ok(Self { head, neck, anatomy, hair, lights, notes: Vec::new(), report: None })
    }

    /// Returns the version of the groom, if the source is an edited one.
    pub fn document(&self) -> Option<&GroomDocument> {
        match &self.hair {
            HairInput::Edited { document, .. } => Some(document),
            _ => None,
        }
    }

    /// Returns a document to edit `groom`, made from this source by [`parts`](Self::parts). `files` and nothing else
    /// have made the source, unless it is a built-in style. A groom of fewer than `MIN_GUIDES` guides gets more, chosen
    /// among its strands, because a brush moves guides; its strands do not move.
    ///
    /// # Errors
    /// An error when a file of the head cannot be read again, and when the groom is empty.
    pub fn edit(&self, groom: Groom, files: &CharacterFiles<'_>) -> Result<GroomDocument> {
        let head = match &self.hair {
            HairInput::BuiltIn { own: None, .. } => HeadFiles::BuiltIn,
            HairInput::BuiltIn { own: Some(own), .. } => head_files(files, &own.placement)?,
            HairInput::Edited { document, .. } => document.head().clone(),
            HairInput::Imported { .. } => {
                let report = self.report.as_ref().and_then(|report| report.head_placement.as_ref());
                report.map_or(Ok(HeadFiles::None), |placement| head_files(files, placement))?
            }
        };
        let more = GuideCount::OneIn(STRANDS_PER_GUIDE);
        let is_sparse = groom.guides.len() < MIN_GUIDES.min(more.among(groom.strands.len()));
        let groom = if is_sparse { rebound(&groom, more)? } else { groom };
        GroomDocument::new(groom, head, self.neck.x)
    }

    /// Returns this source with `document`, a groom on the same head.
    #[must_use]
    pub fn with_document(&self, document: GroomDocument) -> Self {
        Self {
            head: self.head.clone(),
            neck: self.neck,
            anatomy: self.anatomy.clone(),
            hair: HairInput::Edited { document, field: self.field().cloned() },
            lights: self.lights.clone(),
            notes: self.notes.clone(),
            report: self.report.clone(),
        }
    }

    /// Returns an editor of `document`, a groom on this source's head. No hair enters the body, whole and at rest.
    ///
    /// # Errors
    /// [`Unusable`](crate::Error::Unusable) when the body encloses no volume.
    pub async fn editor(&self, document: GroomDocument, progress: &impl Progress) -> Result<GroomEditor> {
        let is_part = self.anatomy.is_some() && *document.head() != HeadFiles::BuiltIn;
        let field = match &self.head {
            Some(body) if is_part => Some(sdf::build_with(body, &SdfOptions::default(), progress).await?),
            _ => self.field().cloned(),
        };
        let editor = GroomEditor::new(document, field.map(Arc::new));
        Ok(match &self.head {
            Some(body) => editor.on_skin(body),
            None => editor,
        })
    }

    /// Returns the distance field of the head.
    pub fn field(&self) -> Option<&SdfGrid> {
        match &self.hair {
            HairInput::BuiltIn { scalp, own: None, .. } => Some(&scalp.field),
            HairInput::BuiltIn { own: Some(own), .. } => own.field.as_ref(),
            HairInput::Edited { field, .. } | HairInput::Imported { field, .. } => field.as_ref(),
        }
    }
}

/// Returns the files of the head of `files`, which the import has placed as in `placement`.
fn head_files(files: &CharacterFiles<'_>, placement: &Placement) -> Result<HeadFiles> {
    Ok(match files {
        CharacterFiles::Disk { grooms, heads } => import::head_files(grooms, heads, placement)?,
        CharacterFiles::Given(files) => import::given_head_files(files, placement)?,
    })
}

impl Styling {
    /// Returns a note for the first setting that an edited groom ignores.
    pub(super) fn ignored_by_edited(&self) -> Option<String> {
        let ignored = [
            (self.max_strands.is_some(), "style.strands"),
            (self.guides.is_some(), "style.guides"),
            (self.fill.strand_count.is_some(), "style.grow"),
            (self.paint != Default::default(), "maps and style.length"),
        ];
        let (_, name) = ignored.into_iter().find(|(given, _)| *given)?;
        Some(format!("{name}: no effect on an edited groom, which has its strands and guides"))
    }
}
