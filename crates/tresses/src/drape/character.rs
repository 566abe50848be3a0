//! A complete built-in character: the mannequin with a draped hairstyle.

use super::{DrapeOptions, drape};
use crate::{
    Context, Progress, Result,
    groom::{
        Groom, SdfGrid, TriMesh,
        curve::resample_chords,
        grow::{self, Growth},
        mannequin,
        scalp::GridScalp,
        styles::{self, GUIDE_VERTICES, Hold, Recipe, Style, StyledGuides},
    },
    simulate::{GuideTraits, RootToTip, SimulationParams},
};
use glam::Vec3;

/// Minimum distance of settled guides from the skin, meters.
const CLEARANCE: f32 = 1e-3;

/// A groom on a head, on the CPU, in meters.
#[derive(Clone, Debug)]
pub struct DrapedCharacter {
    /// Guides and strands.
    pub groom: Groom,
    /// Mesh that is drawn with the hair.
    pub mesh: TriMesh,
    /// Distance field that the hair collides with.
    pub field: SdfGrid,
    /// Joint that the head turns about, meters.
    pub neck: Vec3,
}

/// Creates the mannequin with hair. Traces the guides of `style`, lets them fall onto the head under gravity (on the
/// GPU, by the same step that later simulates them), and grows the strands from the settled guides. `strands` is the
/// exact number of strands; `None` for the style's own.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for an invalid style or number of strands,
/// [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn character(context: &Context, style: &Style, strands: Option<u32>) -> Result<DrapedCharacter> {
    let growth = Growth::for_style(style);
    let growth = match strands {
        Some(count) => growth.with_strands(count),
        None => growth,
    };
    character_with(context, style, &growth, &()).await
}

/// [`character()`] with the given growth of strands. Reports to `progress`.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) and [`Error::Groom`](crate::Error::Groom) for an invalid style or
/// growth, [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn character_with(
    context: &Context,
    style: &Style,
    growth: &Growth,
    progress: &impl Progress,
) -> Result<DrapedCharacter> {
    growth.check()?;
    let (styled, scalp) = settled(context, style, progress).await?;
    let grown = grow::grow_with(&styled, growth, &scalp, progress).await?;
    Ok(DrapedCharacter {
        groom: grown.bind(&styled),
        mesh: mannequin::mesh_with(mannequin::RESOLUTION, progress).await,
        field: scalp.field,
        neck: mannequin::NECK_JOINT,
    })
}

/// Returns the draped guides of `style` on the mannequin, and its scalp: the inputs of [`grow::grow_with`] and
/// [`GrownStrands::bind`](grow::GrownStrands::bind). The guides of default styles are stored ([`styles::settled`]) and
/// need no GPU.
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
