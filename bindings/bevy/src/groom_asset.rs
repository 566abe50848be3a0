//! Grooms as assets.

use crate::meshes;
use bevy::{
    prelude::*,
    render::renderer::{RenderDevice, RenderQueue},
};
use std::sync::Arc;
use tresses::{
    Context, HairOptions, drape,
    groom::{BindOptions, Groom, SdfGrid, Strands, TriMesh, bind, mesh::sdf, styles::Style},
    simulate::Tie,
};

/// A groom, and the head that it grows on. Cheap to clone: what is large is shared.
///
/// Hair is made anew when `groom` or `head` become others, so change them as wholes.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct HairGroom {
    /// Guides and strands, in metres, Y up, the face towards +Z.
    pub groom: Arc<Groom>,
    /// The distance field of what the hair grows on, in the groom's space: it collides with that.
    pub head: Option<Arc<SdfGrid>>,
    /// The mesh of what it grows on, in the groom's space: its shadow falls on the hair, and light that it reflects. Bevy
    /// draws it where an entity has [`head_mesh`](Self::head_mesh).
    pub mesh: Option<Arc<TriMesh>>,
    /// What holds it together or to the head: bands, braids, pins, where they are at rest.
    pub ties: Vec<Tie>,
    /// How it is brought to the GPU; `simulation` is the entity's [`HairPhysics`](crate::HairPhysics), `lod` its
    /// [`HairDetail`](crate::HairDetail).
    pub options: HairOptions,
}

impl HairGroom {
    /// Hair without a head.
    pub fn new(groom: Groom) -> Self {
        let options = HairOptions::default();
        Self { groom: Arc::new(groom), head: None, mesh: None, ties: Vec::new(), options }
    }

    /// Guides chosen among `strands`, which all others follow.
    ///
    /// # Errors
    /// As [`bind()`].
    pub fn from_strands(strands: &Strands, options: &BindOptions) -> tresses::groom::Result<Self> {
        bind(strands, options).map(Self::new)
    }

    /// The same hair on `head`, a closed mesh in the groom's space, which it collides with ([`tri_mesh`](crate::tri_mesh) makes
    /// one of Bevy's).
    ///
    /// # Errors
    /// As [`sdf::build`].
    pub fn with_head(mut self, head: TriMesh) -> tresses::groom::Result<Self> {
        self.head = Some(Arc::new(sdf::build(&head, &Default::default())?));
        self.mesh = Some(Arc::new(head));
        Ok(self)
    }

    /// The built-in character with hair of `style`; `strands` for the style's own number. A style that is not one of the
    /// defaults falls into place on the GPU first, a second or so.
    ///
    /// # Errors
    /// As [`drape::character`].
    pub fn character(
        device: &RenderDevice,
        queue: &RenderQueue,
        style: &Style,
        strands: Option<u32>,
    ) -> tresses::Result<Self> {
        let context = Context::new(device.wgpu_device(), queue);
        let made = pollster::block_on(drape::character(&context, style, strands))?;
        let (head, mesh) = (Some(Arc::new(made.field)), Some(Arc::new(made.mesh)));
        Ok(Self { head, mesh, ..Self::new(made.groom) })
    }

    /// The same hair with what holds it together or to the head, where that is at rest.
    pub fn with_ties(mut self, ties: Vec<Tie>) -> Self {
        self.ties = ties;
        self
    }

    /// The mesh of what it grows on, for Bevy to draw.
    pub fn head_mesh(&self) -> Option<Mesh> {
        self.mesh.as_deref().map(meshes::mesh)
    }

    /// Whether it is the same as `other`, in the same memory.
    pub(crate) fn is(&self, other: &Self) -> bool {
        fn same<T>(a: &Option<Arc<T>>, b: &Option<Arc<T>>) -> bool {
            a.as_ref().map(Arc::as_ptr) == b.as_ref().map(Arc::as_ptr)
        }
        Arc::ptr_eq(&self.groom, &other.groom)
            && same(&self.head, &other.head)
            && same(&self.mesh, &other.mesh)
            && self.ties == other.ties
            && self.options == other.options
    }
}
