//! Draped hairstyles, on the mannequin or on the head of files.

use super::{DrapeOptions, drape};
use crate::{
    Context, Progress, Result,
    groom::{
        SdfGrid,
        character::{CharacterFiles, CharacterSource},
        curve::resample_chords,
        import::ImportOptions,
        mannequin,
        scalp::GridScalp,
        styles::{self, GUIDE_VERTICES, Hold, Recipe, Style, StyledGuides},
    },
    simulate::{GuideTraits, RootToTip, SimulationParams},
};

/// Minimum distance of settled guides from the skin, meters.
const CLEARANCE: f32 = 1e-3;

/// Creates the mannequin with hair: traces the guides of `style` and lets them fall onto the head under gravity (on the
/// GPU, by the same step that later simulates them). [`CharacterSource::parts`] grows the strands.
///
/// # Errors
/// [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn style(context: &Context, style: &Style, progress: &impl Progress) -> Result<CharacterSource> {
    let (styled, scalp) = settled(context, style, progress).await?;
    Ok(CharacterSource::built_in(style, styled, scalp, progress).await)
}

/// Returns the source of `style` on the head of `files`, draped ([`CharacterSource::styled`]).
///
/// # Errors
/// An error that names the file when one cannot be read or no head is found in it, and
/// [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn style_on(
    context: &Context,
    style: &Style,
    files: &CharacterFiles<'_>,
    options: &ImportOptions,
    progress: &impl Progress,
) -> Result<CharacterSource> {
    let drape = async |scalp: &GridScalp| fallen(context, &style.recipe(), scalp, progress).await;
    CharacterSource::styled(style, files, options, progress, drape).await
}

/// Returns the draped guides of `style` on the mannequin, and its scalp: the inputs of `CharacterSource::built_in`.
/// The guides of default styles are stored ([`styles::settled`]) and need no GPU.
///
/// # Errors
/// [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn settled(
    context: &Context,
    style: &Style,
    progress: &impl Progress,
) -> Result<(StyledGuides, GridScalp)> {
    let scalp = GridScalp::of_mannequin(mannequin::sdf_with(mannequin::FIELD_RESOLUTION, progress).await);
    let recipe = style.recipe();
    let styled = match styles::settled(&recipe, &scalp) {
        Some(cooked) => cooked,
        None => fallen(context, &recipe, &scalp, progress).await?,
    };
    Ok((styled, scalp))
}

/// Traces and drapes the guides of `recipe` on `scalp`: the slow path of [`settled`], for styles that are not stored.
///
/// # Errors
/// [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn fallen(
    context: &Context,
    recipe: &Recipe,
    scalp: &GridScalp,
    progress: &impl Progress,
) -> Result<StyledGuides> {
    let mut styled = styles::guides_with(recipe, scalp, progress).await;
    progress.step("draping the hair", 0.0).await;
    settle(context, &mut styled, &scalp.field).await?;
    Ok(styled)
}

/// Drapes `styled` on a head with the distance field `field`, as far as its recipe's [`Hold`] allows.
///
/// # Errors
/// As `drape()`.
pub async fn settle(context: &Context, styled: &mut StyledGuides, field: &SdfGrid) -> Result<()> {
    let traits: Vec<_> = styled
        .stiffness
        .iter()
        .map(|&stiffness| GuideTraits { stiffness, ..GuideTraits::default() })
        .collect();
    let settled = drape(
        context,
        &styled.guides.positions,
        GUIDE_VERTICES as u32,
        &traits,
        &draping(&styled.recipe.hold),
        Some(field),
        &DrapeOptions::default(),
    )
    .await?;
    // Contacts yield by about a millimeter where hair is pressed to the head, and edges are stretched slightly. Move
    // vertices out of the skin and make the steps along guides equal again.
    let lines = settled.as_chunks::<GUIDE_VERTICES>().0;
    for (guide, line) in styled.guides.positions.as_chunks_mut::<GUIDE_VERTICES>().0.iter_mut().zip(lines) {
        guide.copy_from_slice(&resample_chords(line, GUIDE_VERTICES));
        for p in guide.iter_mut().skip(2) {
            let depth = CLEARANCE - field.sample(*p);
            *p += field.normal(*p) * depth.max(0.0);
        }
    }
    Ok(())
}

/// Returns the physics of hair with styling hold.
fn draping(hold: &Hold) -> SimulationParams {
    let base = SimulationParams::default();
    let bending = RootToTip {
        root: base.bending.root * hold.bending,
        tip: base.bending.tip * hold.bending,
        ..base.bending
    };
    SimulationParams { bending, goal: RootToTip { root: hold.root, tip: hold.tip, falloff: 0.2 }, ..base }
}
