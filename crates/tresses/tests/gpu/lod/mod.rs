//! Hair at a level of detail covers and shines as hair in full detail does, and changes without a jump.

mod changes;
mod looks;
pub mod stage;
mod strands;
