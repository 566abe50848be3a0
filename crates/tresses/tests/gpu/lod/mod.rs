//! Levels of detail: coverage and luminance match full detail, and levels change without jumps.

mod appearance;
mod changes;
pub mod stage;
mod strands;
