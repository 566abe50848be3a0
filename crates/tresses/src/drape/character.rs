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
    simulate::{Along, GuideTraits, SimulationParams},
};
use glam::Vec3;

/// Distance that settled guides keep from the skin at least, metres.
const CLEARANCE: f32 = 1e-3;

/// A groom on a head, in metres, not yet on the GPU.
#[derive(Clone, Debug)]
pub struct Character {
    /// Guides and strands.
    pub groom: Groom,
    /// What is drawn with the hair.
    pub mesh: TriMesh,
    /// What the hair collides with.
    pub field: SdfGrid,
    /// The joint about which the head turns, metres.
    pub neck: Vec3,
}

/// Dresses the mannequin: traces the guides of `style`, lets them fall under gravity on the head
/// (on the device, with the step that later moves them), and grows the strands from what settled.
/// `strands` is the exact number of strands, `None` for the style's own.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for a style or a number of strands that cannot be
/// grown, [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn character(context: &Context, style: &Style, strands: Option<u32>) -> Result<Character> {
    let growth = Growth::for_style(style);
    let growth = match strands {
        Some(count) => growth.with_strands(count),
        None => growth,
    };
    character_with(context, style, &growth, &()).await
}

/// The same with strands that grow as `growth` says, telling `progress`.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) and [`Error::Groom`](crate::Error::Groom) for a style or a
/// growth that cannot be, [`Error::Gpu`](crate::Error::Gpu) when the device is lost.
pub async fn character_with(
    context: &Context,
    style: &Style,
    growth: &Growth,
    progress: &impl Progress,
) -> Result<Character> {
    growth.check()?;
    let (styled, scalp) = settled(context, style, progress).await?;
    let grown = grow::grow_with(&styled, growth, &scalp, progress).await?;
    Ok(Character {
        groom: grown.bind(&styled),
        mesh: mannequin::mesh_with(mannequin::RESOLUTION, progress).await,
        field: scalp.field,
        neck: mannequin::NECK_JOINT,
    })
}

/// The draped guides of `style` on the mannequin, and its scalp: what strands are then grown from and on, with
/// [`grow::grow_with`] and [`GrownStrands::bind`](grow::GrownStrands::bind). Those of a default style are stored
/// ([`styles::settled`]) and need no GPU.
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

/// The guides of `recipe` on `scalp`, traced and draped: the result of [`settled`] for a style that is not
/// stored.
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
    progress.step("letting the hair fall", 0.0).await;
    settle(context, &mut styled, &scalp.field).await?;
    Ok(styled)
}

/// Lets `styled` fall into place on a head with the distance field `field`, as far as its recipe's
/// [`Hold`] lets it.
///
/// # Errors
/// What [`drape()`] says.
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
    // Contacts give way by a millimetre where hair is pressed to the head, and edges are stretched
    // a little: vertices leave the skin and steps are made equal again.
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

/// The physics of hair with something in it that holds.
fn draping(hold: &Hold) -> SimulationParams {
    let base = SimulationParams::default();
    let bending = Along {
        root: base.bending.root * hold.bending,
        tip: base.bending.tip * hold.bending,
        ..base.bending
    };
    SimulationParams { bending, goal: Along { root: hold.root, tip: hold.tip, falloff: 0.2 }, ..base }
}
