//! Cards: textured ribbons in place of strands, for devices and engines that do not draw strands.
//!
//! ```text
//! strands ─► lines ─► clusters ─► ribbons ─► locks that look alike ─► tiles ─► atlas ─┐
//!    │                                └─► rows and columns ─► mesh ───────────────────┴─► level
//!    └─► pictures from 14 sides: coverage, visible area ─► width of strands, accuracy ──► report
//! ```
//!
//! - Strands with similar paths form a lock (`cluster`). A coarser level merges the locks of a finer one.
//! - A ribbon follows the middle of its lock, is as wide as the lock, bends across it, and faces out of the hair
//!   (`ribbon`).
//! - The strands of a lock are drawn in the frame of their ribbon (`tile`). Locks that look alike share a picture
//!   (`share`).
//! - A flat card covers less than its round strands do from most sides. Strands in the pictures are therefore wider, by
//!   one factor per level, so that cards and strands have the same mean coverage from 14 sides.
//! - Chains of bones may carry the cards (`chains`), or simulated guides (`strands`).
//! - The last level may be a helmet: an opaque shell around the hair (`helmet`).

mod accuracy;
mod atlas;
mod bake;
#[cfg(feature = "textures")]
mod chain_rig;
mod chains;
mod cluster;
#[cfg(feature = "textures")]
mod glb;
mod helmet;
#[cfg(feature = "textures")]
mod ktx2;
mod lines;
mod lock_classes;
mod mesh;
#[cfg(feature = "textures")]
mod obj;
mod options;
mod order;
mod picture;
mod ribbon;
mod scalp;
mod strands;
mod strip;
#[cfg(test)]
mod tests;
mod texture;
mod tile;
mod volume;

pub use crate::card_sheet::{CardSheet, CardStrip};
pub use accuracy::{CardAccuracy, SIZES};
pub use bake::{CardLevel, Cards, bake, bake_with};
#[cfg(feature = "textures")]
pub use chain_rig::ChainMotion;
pub use chains::{BONES, CardBind, CardChains};
#[cfg(feature = "textures")]
pub use glb::{CardAlpha, CardLook};
pub use mesh::CardMesh;
#[cfg(feature = "textures")]
pub use obj::NamedFile;
pub use options::CardOptions;
pub use scalp::CardScalp;
pub use strands::CardStrands;
pub use texture::CardTextures;
