//! Draping: lets the guides of built-in styles settle on the head.
//!
//! The guides traced by [`styles`](crate::groom::styles) are close to equilibrium under gravity and contact. The
//! simulation finishes them, with enough hold for the style to keep its volume and its waves
//! ([`Hold`](crate::groom::styles::Hold)). This runs once, before the hair is used. It is the only step before drawing
//! that needs the GPU, and so it is here and not in `groom`.
//!
//! ```text
//! Style ─┬─ default: stored guides ─────────────────────────────────────────┬─► CharacterSource (CPU)
//!        └─ else: trace (CPU) ─► settle: drape on the head (GPU), read back ┘
//! ```

mod fall;
mod styles;

pub(crate) use fall::{DrapeOptions, drape};
pub use styles::{fallen, settle, settled, style, style_on};
