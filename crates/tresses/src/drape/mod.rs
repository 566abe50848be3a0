//! Draping: built-in styles that have settled on the head.
//!
//! The guides that [`styles`](crate::groom::styles) traces are close to their equilibrium under gravity and
//! contact; the simulation finishes them, with as much hold as the style needs to keep its volume and its
//! wave ([`Hold`](crate::groom::styles::Hold)). This is done once, before the hair is used, and is the only
//! use of the GPU before a groom is drawn, which is why it is here and not in `groom`.
//!
//! ```text
//! Style ─┬─ default: stored guides ─────────────────────────────────────────┬─► grow (CPU) ─► Character
//!        └─ else: trace (CPU) ─► settle: drape on the head (GPU), read back ┘
//! ```

mod character;
mod fall;

pub use character::{Character, character, character_with, fallen, settle, settled};
pub use fall::{DrapeOptions, drape};
