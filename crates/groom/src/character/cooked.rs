//! Cooked characters: everything that opening their files computes is stored.

use super::{CharacterFiles, CharacterSource, CookedParts, HairInput, anatomy, neck};
use crate::{
    CookedGroom, Result,
    import::{self, ImportOptions},
    rig::anatomy::{BodyPart, DistanceFieldSource},
};
use std::path::{Path, PathBuf};

impl CharacterFiles<'_> {
    /// Returns the cooked groom with its path, if the files are one.
    pub(super) fn cooked(&self, options: &ImportOptions) -> Result<Option<(PathBuf, CookedGroom)>> {
        Ok(match self {
            Self::Disk { grooms, heads } => import::cooked(grooms, heads, options)?,
            Self::Given(files) => import::given_cooked(files, options)?,
        })
    }
}

impl CharacterSource {
    /// Creates the source from a cooked groom at `path`.
    pub(super) fn cooked(path: &Path, cooked: CookedGroom) -> Result<Self> {
        let report = cooked.report(path);
        let CookedGroom { strands, head, levels, field, rig, parts, groom, .. } = cooked;
        let mut anatomy = anatomy(rig, head.as_ref(), strands.iter())?;
        if let Some(anatomy) = &mut anatomy {
            anatomy.know(parts);
        }
        let known = Some(CookedParts { groom, levels_of_head: levels });
        let neck = neck(strands.iter().filter_map(|strand| strand.first().copied()), head.as_ref());
        let hair = HairInput::Imported { strands, field, known };
        let mut base =
            Self { head, neck, anatomy, hair, lights: Vec::new(), notes: Vec::new(), report: None };
        let name = path.display().to_string();
        base.tell(report, &name, &name);
        Ok(base)
    }

    /// Returns everything that opening the files has computed; `None` for a built-in style.
    ///
    /// # Errors
    /// As [`CookedGroom::new`].
    pub fn cook(&self) -> Result<Option<CookedGroom>> {
        #[cfg(feature = "edit")]
        let edited;
        let (strands, field, report, groom) = match (&self.hair, &self.report) {
            (HairInput::Imported { strands, field, .. }, Some(report)) => (strands, field, report, None),
            #[cfg(feature = "edit")]
            (HairInput::Edited { document, field }, _) => {
                edited = import::edited_complete(Path::new("the edited groom"), document)?;
                (&edited.0, field, &edited.2, Some(document.groom()))
            }
            _ => return Ok(None),
        };
        let (mut rig, mut parts) = (None, Vec::new());
        if let Some(mut anatomy) = self.anatomy.clone() {
            anatomy.measure();
            rig = Some(anatomy.rig);
            let grid = |part: BodyPart| match part.field {
                DistanceFieldSource::Grid(grid) => Some((part.node, grid)),
                DistanceFieldSource::Mesh(..) => None,
            };
            parts = anatomy.parts.into_iter().filter_map(grid).collect();
        }
        let mut cooked = CookedGroom::new(strands.clone(), self.head.clone(), field.clone(), rig, report)?;
        cooked.parts = parts;
        if let Some(groom) = groom {
            cooked.groom = groom;
        }
        Ok(Some(cooked))
    }
}
