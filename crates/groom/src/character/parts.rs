//! The parts of a character.

use super::face::FaceGroom;
#[cfg(feature = "cards")]
use crate::cards::{CardStrands, Cards};
use crate::{
    Groom, Look, Result, Rig, SdfGrid, TriMesh,
    card_sheet::CardSheet,
    light::PunctualLight,
    mannequin,
    mesh::{
        MeshLevel,
        sdf::{self, SdfOptions},
    },
    rig::anatomy::{Anatomy, DistanceFieldSource},
    scalp::ScalpMap,
    tie::Tie,
};
use glam::Vec3;
use std::sync::Arc;

/// Offset from the crown to the joint that a head nods and turns about, meters.
const NECK_BELOW_CROWN: Vec3 = Vec3::new(0.0, -0.165, -0.012);

/// Offset from that joint to the center of the braincase, meters.
pub(super) const SKULL_ABOVE_NECK: Vec3 = Vec3::new(0.0, 0.075, 0.012);

/// A painted level of detail for one projected size of the hair. Factors between two levels are interpolated by the
/// logarithm of the size; beyond the largest and smallest size they are constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LodLevel {
    /// Diameter of the hair's bounding sphere in the image, pixels.
    pub size: f32,
    /// Share of the strands that is drawn, 0 to 1; `None` for all. Strands are dropped in a fixed order, and one that
    /// is being dropped becomes narrower.
    pub density: Option<ScalpMap>,
    /// Factor on strand widths, 0 to about 4; `None` for 1.
    pub thickness: Option<ScalpMap>,
}

/// A character on the CPU, in groom space: meters, Y up, face towards +Z.
///
/// `CharacterAsset::new` of `tresses` uploads it. A host that must survive a lost device keeps it.
#[derive(Clone, Debug)]
pub struct CharacterParts {
    /// Guides and strands of the hair.
    pub groom: Groom,
    /// Draws the hair as cards: their strips, if [`groom`](Self::groom) has the columns of cards.
    pub cards: Option<Arc<CardSheet>>,
    /// Brows, lashes, beard: further grooms on the same skin. They require [`head`](Self::head).
    pub face: Vec<FaceGroom>,
    /// The mesh of the head or the whole body, drawn with the hair.
    pub head: Option<TriMesh>,
    /// Precomputed coarser levels of the mesh; `None` to compute them.
    pub levels_of_head: Option<Vec<MeshLevel>>,
    /// The distance field of the rigid part that the hair grows on.
    pub field: Option<SdfGrid>,
    /// Distance field that the hair rests on, where it covers more than [`field`](Self::field).
    pub rest: Option<SdfGrid>,
    /// The joint that the head turns about.
    pub neck: Vec3,
    /// The rig of a skinned body with the collider of each body part; `None` for a rigid body.
    pub anatomy: Option<Anatomy>,
    /// Painted levels of detail.
    pub levels: Vec<LodLevel>,
    /// Bands, braids and pins.
    pub ties: Vec<Tie>,
    /// The fiber that the groom's file describes.
    pub look: Option<Look>,
    /// Lights that the files brought, in groom space.
    pub lights: Vec<PunctualLight>,
    /// Warnings for the user, one sentence each.
    pub notes: Vec<String>,
}

impl CharacterParts {
    /// Creates a character with hair on `head`: rigid, or deformed by `rig`. Builds the distance field that the hair
    /// collides with.
    ///
    /// # Errors
    /// [`Unusable`](crate::Error::Unusable) when no root lies on the rig's mesh, or when the mesh encloses no volume.
    pub fn new(groom: Groom, head: Option<TriMesh>, rig: Option<Rig>) -> Result<Self> {
        let guides = (0..groom.guides.len()).map(|i| groom.guides.guide(i));
        let anatomy =
            rig.zip(head.as_ref()).map(|(rig, head)| Anatomy::new(rig, head, guides)).transpose()?;
        let field = match rigid(anatomy.as_ref(), head.as_ref()) {
            Some(mesh) => Some(sdf::build(mesh, &SdfOptions::default())?),
            None => None,
        };
        let roots = (0..groom.guides.len()).filter_map(|i| groom.guides.guide(i).first().copied());
        let neck = neck(roots, head.as_ref());
        Ok(Self { head, field, neck, anatomy, ..Self::without_body(groom) })
    }

    /// Creates a character of hair without a body.
    pub fn without_body(groom: Groom) -> Self {
        Self {
            groom,
            cards: None,
            face: Vec::new(),
            head: None,
            levels_of_head: None,
            field: None,
            rest: None,
            neck: mannequin::NECK_JOINT,
            anatomy: None,
            levels: Vec::new(),
            ties: Vec::new(),
            look: None,
            lights: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Returns the character with a level of `cards` as its hair, instead of the strands. The cards must be baked from
    /// the strands of the groom at rest ([`BoundStrands::unbound`](crate::BoundStrands::unbound)).
    ///
    /// # Errors
    /// As [`Cards::strands`].
    #[cfg(feature = "cards")]
    pub fn with_cards(self, cards: &Cards, level: usize) -> Result<Self> {
        let CardStrands { groom, sheet } = cards.strands(level, &self.groom)?;
        Ok(Self { groom, cards: Some(sheet.into()), levels: Vec::new(), ..self })
    }

    /// Returns the distance field of the whole body as one rigid piece.
    pub fn body_field(&self) -> Option<&SdfGrid> {
        self.rest.as_ref().or(self.field.as_ref())
    }

    /// Returns the number of vertices per guide, for every groom.
    pub fn guide_vertices(&self) -> Vec<u32> {
        let face = self.face.iter().map(|face| face.groom.guides.vertex_count);
        std::iter::once(self.groom.guides.vertex_count).chain(face).collect()
    }

    /// Returns the center of the braincase.
    pub fn skull(&self) -> Vec3 {
        self.neck + SKULL_ABOVE_NECK
    }
}

/// Returns the rigid part of `head` that hair grows on: all of it without a rig.
pub(super) fn rigid<'a>(anatomy: Option<&'a Anatomy>, head: Option<&'a TriMesh>) -> Option<&'a TriMesh> {
    match anatomy.map(|anatomy| &anatomy.head.field) {
        Some(DistanceFieldSource::Mesh(mesh, _)) => Some(mesh),
        _ => head,
    }
}

/// Estimates the joint that the head turns about: below the highest root, centered between the sides of the head.
pub(super) fn neck(roots: impl Iterator<Item = Vec3>, head: Option<&TriMesh>) -> Vec3 {
    let Some((lo, hi)) = roots.map(|p| (p, p)).reduce(|(lo, hi), (p, _)| (lo.min(p), hi.max(p))) else {
        return Vec3::ZERO;
    };
    let center = 0.5 * (lo + hi);
    let x = head.and_then(TriMesh::bounds).map_or(center.x, |(lo, hi)| 0.5 * (lo.x + hi.x));
    Vec3::new(x, hi.y, center.z) + NECK_BELOW_CROWN
}
