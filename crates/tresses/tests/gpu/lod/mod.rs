//! Levels of detail: coverage and luminance match full detail, and levels change without jumps.

mod changes;
mod looks;
pub mod stage;
mod strands;
