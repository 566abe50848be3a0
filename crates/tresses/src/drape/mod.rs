//! Built-in styles that have fallen into place.
//!
//! The guides that [`styles`](crate::groom::styles) traces are close to where gravity and the head would
//! leave them; the simulation finishes them, with as much hold as the style needs to keep its volume and its
//! wave ([`Hold`](crate::groom::styles::Hold)). This is done once, before the hair is used, and is all that
//! a groom ever needs of the GPU before it is drawn: so it stands here and not in `groom`.
//!
//! ```text
//! Style ─┬─ default: stored guides ─────────────────────────────────────────┬─► grow (CPU) ─► Character
//!        └─ else: trace (CPU) ─► settle: drape on the head (GPU), read back ┘
//! ```

mod character;
mod fall;

pub use character::{Character, character, character_with, fallen, settle, settled};
pub use fall::{DrapeOptions, drape};
