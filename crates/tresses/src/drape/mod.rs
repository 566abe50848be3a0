//! Draping: lets the guides of built-in styles settle on the head.
//!
//! The guides traced by [`styles`](crate::groom::styles) are close to equilibrium under gravity and contact. The
//! simulation finishes them, with enough hold for the style to keep its volume and its waves
//! ([`Hold`](crate::groom::styles::Hold)). This runs once, before the hair is used. It is the only step before drawing
//! that needs the GPU, and so it is here and not in `groom`.
//!
//! ```text
//! Style ─┬─ default: stored guides ─────────────────────────────────────────┬─► grow (CPU) ─► Character
//!        └─ else: trace (CPU) ─► settle: drape on the head (GPU), read back ┘
//! ```

mod character;
mod fall;

pub use character::{DrapedCharacter, character, character_with, fallen, settle, settled};
pub(crate) use fall::{DrapeOptions, drape};
