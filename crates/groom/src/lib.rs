//! Grooms before the GPU: strands and heads, imported or procedural, guides, and the strands that follow
//! them.
//!
//! ```text
//! files ─► import ─► orient ─► lint, repair ─► fill ─► bind ──► restyle ─┐
//!                                                                        ├─► Groom
//! mannequin ─► styles: guides of a recipe ─► grow ───────────────────────┘
//! ```
//!
//! A mesh that comes with joints, shapes or animations comes with a [`Rig`], which poses it.
//!
//! Everything here runs on the CPU and needs no GPU. The crate `tresses` simulates and draws a [`Groom`];
//! it re-exports this one as `tresses::groom`.

pub mod bind;
pub mod bound;
#[cfg(feature = "cooked")]
pub mod cooked;
pub mod curve;
pub mod export;
pub mod fill;
pub mod formats;
pub mod grow;
pub mod guides;
pub mod import;
pub mod lint;
pub mod look;
pub mod mannequin;
pub mod mesh;
pub mod orient;
pub mod range;
pub mod restyle;
pub mod rig;
pub mod sdf;
pub mod srgb;
pub mod strands;
pub mod styles;

pub mod error;
pub mod hash;
pub mod progress;
mod rice;

pub use bind::{BindOptions, GuideCount, bind, bind_filled};
pub use bound::{BoundStrands, Groom, Influence};
#[cfg(feature = "cooked")]
pub use cooked::Cooked;
pub use error::{Error, Result};
pub use fill::{Fill, Filled, Followers, Head, fill};
pub use glam;
pub use guides::Guides;
pub use look::Look;
pub use mesh::TriMesh;
pub use progress::Progress;
pub use restyle::Restyle;
pub use rig::{Rig, RigPose};
pub use sdf::SdfGrid;
pub use strands::Strands;

/// The most vertices a guide may have.
pub const MAX_GUIDE_VERTICES: u32 = 64;
/// The most vertices a drawn strand may have.
pub const MAX_STRAND_VERTICES: u32 = 64;
