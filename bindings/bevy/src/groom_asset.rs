//! The groom asset.

use crate::meshes;
use bevy::{
    prelude::*,
    render::renderer::{RenderDevice, RenderQueue},
};
use std::sync::Arc;
use tresses::{
    Context, HairOptions, Styling, Tie, drape,
    groom::{
        BindOptions, Groom, SdfGrid, Strands, TriMesh, bind, card_sheet::CardSheet, grow::Growth, mesh::sdf,
        styles::Style,
    },
};

/// A groom and its head. Cheap to clone: large data is shared.
///
/// Hair is rebuilt when `groom` or `head` point to other data, so replace them rather than modify them.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct HairGroom {
    /// Guides and strands: meters, Y up, face towards +Z.
    pub groom: Arc<Groom>,
    /// Distance field of the head, in the groom's space. Hair collides with it.
    pub head: Option<Arc<SdfGrid>>,
    /// Mesh of the head, in the groom's space. It casts shadows on the hair and reflects light onto it. Bevy draws it
    /// where an entity has [`head_mesh`](Self::head_mesh).
    pub mesh: Option<Arc<TriMesh>>,
    /// How the hair is drawn as cards, if `groom` has the columns of cards.
    pub cards: Option<Arc<CardSheet>>,
    /// Bands, braids and pins that hold hair together or to the head, at rest.
    pub ties: Vec<Tie>,
    /// Options for uploading the groom. [`HairPhysics`](crate::HairPhysics) replaces `simulation`, and
    /// [`HairDetail`](crate::HairDetail) replaces `lod`.
    pub options: HairOptions,
}

impl HairGroom {
    /// Creates hair without a head.
    pub fn new(groom: Groom) -> Self {
        let options = HairOptions::default();
        Self { groom: Arc::new(groom), head: None, mesh: None, cards: None, ties: Vec::new(), options }
    }

    /// Selects guides among `strands` and binds the others to them.
    ///
    /// # Errors
    /// Returns the errors of [`bind()`].
    pub fn from_strands(strands: &Strands, options: &BindOptions) -> tresses::groom::Result<Self> {
        bind(strands, options).map(Self::new)
    }

    /// Adds `head`, a closed mesh in the groom's space that hair collides with ([`tri_mesh`](crate::tri_mesh) converts
    /// Bevy's meshes).
    ///
    /// # Errors
    /// Returns the errors of [`sdf::build`].
    pub fn with_head(mut self, head: TriMesh) -> tresses::groom::Result<Self> {
        self.head = Some(Arc::new(sdf::build(&head, &Default::default())?));
        self.mesh = Some(Arc::new(head));
        Ok(self)
    }

    /// Creates the built-in character with hair of `style`. Without a `strand_count`, the style's own applies. A style
    /// with custom parameters first settles on the GPU, which takes about a second.
    ///
    /// # Errors
    /// Returns the errors of [`drape::style`], and an error for an invalid number of strands.
    pub fn character(
        device: &RenderDevice,
        queue: &RenderQueue,
        style: &Style,
        strand_count: Option<u32>,
    ) -> tresses::Result<Self> {
        let context = Context::new(device.wgpu_device(), queue);
        let growth = strand_count.map(|count| Growth::for_style(style).with_strands(count));
        let source = pollster::block_on(drape::style(&context, style, &()))?;
        let parts = pollster::block_on(source.parts(&Styling { growth, ..Default::default() }, &()))?;
        let head = parts.rest.or(parts.field).map(Arc::new);
        Ok(Self { head, mesh: parts.head.map(Arc::new), ..Self::new(parts.groom) })
    }

    /// Adds ties that hold hair together or to the head.
    pub fn with_ties(mut self, ties: Vec<Tie>) -> Self {
        self.ties = ties;
        self
    }

    /// Returns the groom with its hair drawn as `cards` textured cards, which move with the same guides. They cost a
    /// quarter of the strands or less, and suit hair from a few meters on. Takes about 20 seconds for 20,000 strands.
    ///
    /// # Errors
    /// Returns the errors of [`bake`](tresses::groom::cards::bake).
    #[cfg(feature = "cards")]
    pub fn with_cards(self, cards: u32) -> tresses::groom::Result<Self> {
        use tresses::groom::cards::{CardOptions, CardStrands, bake};
        let options = CardOptions { levels: vec![cards], ..Default::default() };
        let baked = bake(&self.groom.strands.unbound(), self.mesh.as_deref(), &options)?;
        let CardStrands { groom, sheet } = baked.strands(0, &self.groom)?;
        Ok(Self { groom: Arc::new(groom), cards: Some(Arc::new(sheet)), ..self })
    }

    /// Returns the head's mesh for Bevy to draw.
    pub fn head_mesh(&self) -> Option<Mesh> {
        self.mesh.as_deref().map(meshes::mesh)
    }

    /// Returns whether both share the same groom, head and cards in memory, and have equal ties and options.
    pub(crate) fn is(&self, other: &Self) -> bool {
        fn same<T>(a: &Option<Arc<T>>, b: &Option<Arc<T>>) -> bool {
            a.as_ref().map(Arc::as_ptr) == b.as_ref().map(Arc::as_ptr)
        }
        Arc::ptr_eq(&self.groom, &other.groom)
            && same(&self.head, &other.head)
            && same(&self.mesh, &other.mesh)
            && same(&self.cards, &other.cards)
            && self.ties == other.ties
            && self.options == other.options
    }
}
