//! Characters that were cooked: what opening their files computes was computed before.

use super::{super::parts::neck, CharacterFiles, CharacterSource, Hair, Known, anatomy};
use crate::{
    Result,
    groom::{
        Cooked,
        import::{self, ImportOptions},
        rig::anatomy::{Field, Part},
    },
};
use std::path::{Path, PathBuf};

impl CharacterFiles<'_> {
    /// The cooked groom that they are, with its path.
    pub(super) fn cooked(&self, options: &ImportOptions) -> Result<Option<(PathBuf, Cooked)>> {
        Ok(match self {
            Self::Disk { grooms, heads } => import::cooked(grooms, heads, options)?,
            Self::Given(files) => import::given_cooked(files, options)?,
        })
    }
}

impl CharacterSource {
    /// What a groom was cooked from, of the file at `path`.
    pub(super) fn cooked(path: &Path, cooked: Cooked) -> Result<Self> {
        let report = cooked.report(path);
        let Cooked { strands, head, levels, field, rig, parts, groom, .. } = cooked;
        let mut anatomy = anatomy(rig, head.as_ref(), &strands)?;
        if let Some(anatomy) = &mut anatomy {
            anatomy.know(parts);
        }
        let known = Some(Known { groom, levels_of_head: levels });
        let neck = neck(strands.iter().filter_map(|strand| strand.first().copied()), head.as_ref());
        let hair = Hair::Imported { strands, field, known };
        let mut base = Self { head, neck, anatomy, hair, notes: Vec::new(), report: None };
        let name = path.display().to_string();
        base.tell(report, &name, &name);
        Ok(base)
    }

    /// All that opening its files has computed; `None` of a built-in style.
    ///
    /// # Errors
    /// As [`Cooked::new`].
    pub fn cook(&self) -> Result<Option<Cooked>> {
        let (Hair::Imported { strands, field, .. }, Some(report)) = (&self.hair, &self.report) else {
            return Ok(None);
        };
        let (mut rig, mut parts) = (None, Vec::new());
        if let Some(mut anatomy) = self.anatomy.clone() {
            anatomy.measure();
            rig = Some(anatomy.rig);
            let grid = |part: Part| match part.field {
                Field::Grid(grid) => Some((part.node, grid)),
                Field::Mesh(..) => None,
            };
            parts = anatomy.parts.into_iter().filter_map(grid).collect();
        }
        let mut cooked = Cooked::new(strands.clone(), self.head.clone(), field.clone(), rig, report)?;
        cooked.parts = parts;
        Ok(Some(cooked))
    }
}
