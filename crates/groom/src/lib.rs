//! Hair processing on the CPU: imported or procedural strands and heads, guides, and render strands bound to guides.
//!
//! ```text
//! files ─► import ─► orient ─► lint, repair ─► fill ─► bind ──► restyle ─┐
//!                                                                        ├─► Groom ─► cards
//! mannequin ─► styles: guides of a recipe ─► grow ───────────────────────┘
//! ```
//!
//! A mesh with joints, blend shapes or animations has a [`Rig`], which poses it.
//!
//! A module uses only modules of the lines above its own (`tests/modules.rs` checks this list):
//!
//! ```text
//! attribute bulk columns curve error hash light near progress rotation sdf srgb │ plain data; columns of integers
//! mesh random range scalp strands                      │ triangle meshes; the scalp and maps on it; explicit strands
//! card_sheet skin tie                                  │ cards to draw; the skin under roots; bands, braids, pins
//! guides lint look rig                                 │ simulated strands; checks; materials; rigs of skinned meshes
//! bound mannequin orient                               │ render strands; the built-in character; units and axes
//! bind formats head report styles                      │ guides for strands; files; other heads; recipes of hairstyles
//! cooked export grow                                   │ precomputed grooms; writers; strands from guides
//! fill restyle retarget                                │ strands between strands; their curls and clumps; other heads
//! cards edit                                           │ textured ribbons in place of strands; brushes
//! import                                               │ readers
//! character                                            │ files or styles, then styled strands on their head
//! ```
//!
//! Everything in this crate runs on the CPU. The crate `tresses` simulates and renders a [`Groom`]; it re-exports this
//! crate as `tresses::groom`.

pub mod attribute;
pub mod bind;
pub mod bound;
#[cfg(feature = "cooked")]
mod bulk;
pub mod card_sheet;
#[cfg(feature = "cards")]
pub mod cards;
pub mod character;
mod columns;
#[cfg(feature = "cooked")]
pub mod cooked;
pub mod curve;
#[cfg(feature = "edit")]
pub mod edit;
pub mod error;
pub mod export;
pub mod fill;
pub mod formats;
pub mod grow;
pub mod guides;
pub mod hash;
pub mod head;
pub mod import;
pub mod light;
pub mod lint;
pub mod look;
pub mod mannequin;
pub mod mesh;
mod near;
pub mod orient;
pub mod progress;
mod random;
pub mod range;
mod report;
pub mod restyle;
pub mod retarget;
pub mod rig;
pub mod rotation;
pub mod scalp;
pub mod sdf;
pub mod skin;
pub mod srgb;
pub mod strands;
pub mod styles;
pub mod tie;

pub use bind::{BindOptions, GuideCount, bind};
pub use bound::{BoundStrands, Groom, Influence};
#[cfg(feature = "cooked")]
pub use cooked::CookedGroom;
pub use error::{Error, Result};
pub use fill::{Fill, FilledStrands, Head, bind_filled, fill};
pub use glam;
pub use guides::Guides;
pub use look::Look;
pub use mesh::TriMesh;
pub use progress::Progress;
pub use restyle::Restyle;
pub use retarget::retarget;
pub use rig::{Rig, RigPose};
pub use sdf::SdfGrid;
pub use strands::{Followers, Strands};

/// Maximum number of vertices per guide.
pub const MAX_GUIDE_VERTICES: u32 = 64;
/// Maximum number of vertices per render strand.
pub const MAX_STRAND_VERTICES: u32 = 64;
/// Maximum number of vertices of a groom. At 16 bytes each, they fill the largest buffer that WebGPU can bind.
pub const MAX_VERTICES: u64 = 1 << 28;
