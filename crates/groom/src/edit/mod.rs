//! Editing: brushes comb the guides of a groom, and its strands are carried along.
//!
//! ```text
//! Groom ─► GroomDocument ──► GroomEditor ◄── rays or points of a stroke, Brush
//!              ▲                  │
//!              └── release ◄──────┘ guides, as they move
//! GroomDocument ─► groom: guides and carried strands      ─► file (`.groom`)
//! ```
//!
//! A [`GroomDocument`] holds the groom that it was made from and the current guides. It never changes: a stroke
//! returns another document, which shares all blocks of guides that the stroke has not touched. Undo keeps documents.
//!
//! **Strands are deformed** ([`deform`]): a strand is always the original one, carried by its guides from their original
//! pose to the current one, by the formula that the shaders of `tresses` use for moving hair. A
//! thousand strokes lose no detail.
//!
//! **A stroke is data** ([`script`]). It gives the same guides, bit for bit, with any number of threads, natively and
//! in WebAssembly: the code below uses only additions, multiplications, divisions and square roots of 32-bit floats.

pub mod brush;
mod cuts;
pub mod deform;
pub mod document;
mod editor;
pub mod file;
mod ground;
pub mod guide_blocks;
mod hair;
mod line;
mod paint;
mod painted_values;
mod plant;
mod posed_guides;
mod roots;
mod sample;
mod scissors;
pub mod script;
mod slide;
mod solve;
mod stroke;
mod tools;

pub use brush::{Brush, BrushRegion, BrushTool, CurlType, Falloff};
pub use document::{GroomDocument, HeadFiles};
pub use editor::GroomEditor;
pub use guide_blocks::GuideBlocks;
pub use sample::StrokeSample;
pub use script::{ScriptStep, StrokeScript};

#[cfg(test)]
mod tests;
