//! Built-in styles on the heads of files.

use super::{CharacterFiles, CharacterSource, HairInput, SKULL_ABOVE_NECK, anatomy, field_of};
use crate::{
    Error, Progress, Result, SdfGrid,
    head::{HeadFit, HeadShape},
    import::{self, ImportOptions},
    scalp::GridScalp,
    styles::{Style, StyledGuides},
};

/// The head of a file under a built-in style, which grows in the built-in head's space.
#[derive(Debug)]
pub(super) struct OwnHead {
    /// From the style's space to groom space.
    pub fit: HeadFit,
    /// Distance field in groom space.
    pub field: Option<SdfGrid>,
    /// From the files to groom space.
    #[cfg(feature = "edit")]
    pub placement: crate::orient::Placement,
}

impl CharacterSource {
    /// Creates the source of `style` on the head of `files`: a mesh, with or without a body. The style is scaled to the
    /// head, whose landmarks are found by its shape ([`HeadShape`]). `drape` returns its guides on the scalp.
    ///
    /// # Errors
    /// An error that names the file when one cannot be read or no head is found in it, and the errors of `drape`.
    pub async fn styled<E: From<Error>>(
        style: &Style,
        files: &CharacterFiles<'_>,
        options: &ImportOptions,
        progress: &impl Progress,
        drape: impl AsyncFnOnce(&GridScalp) -> Result<StyledGuides, E>,
    ) -> Result<Self, E> {
        progress.step("reading the head", 0.0).await;
        let body = match files {
            CharacterFiles::Disk { heads, .. } => import::read_body(heads, options)?,
            CharacterFiles::Given(files) => import::read_given_body(files, options)?,
        };
        let name = files.head_name();
        let named = |error| Error::Unusable(format!("{name}: {error}"));
        let shape = HeadShape::of(&body.mesh).map_err(named)?;
        let fit = HeadFit::of(&shape);
        let scalp = fit.scalp(&shape, &body.mesh, progress).await.map_err(named)?;
        let styled = drape(&scalp).await?;
        let guides: Vec<_> = styled
            .guides
            .iter()
            .map(|guide| guide.iter().map(|p| fit.point(*p)).collect::<Vec<_>>())
            .collect();
        let anatomy = anatomy(body.rig, Some(&body.mesh), guides.iter().map(|guide| &guide[..]))?;
        let field = field_of(anatomy.as_ref(), Some(&body.mesh), &name, progress).await?;
        let notes = body.placement.doubts.iter().map(|doubt| format!("head {name}: {doubt}")).collect();
        Ok(Self {
            head: Some(body.mesh),
            neck: shape.landmarks.skull - SKULL_ABOVE_NECK,
            anatomy,
            hair: HairInput::BuiltIn {
                style: *style,
                styled,
                scalp,
                own: Some(OwnHead {
                    fit,
                    field,
                    #[cfg(feature = "edit")]
                    placement: body.placement,
                }),
            },
            lights: body.lights,
            notes,
            report: None,
        })
    }
}
