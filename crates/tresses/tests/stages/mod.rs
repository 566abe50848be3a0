//! Tests of single stages, on a GPU. `src/lib.rs` includes them, because they use types that are private to the crate.
//!
//! `cargo test -p tresses --lib stages::wind` runs the tests of one file.

mod character;
mod collide;
#[cfg(feature = "debug-views")]
mod errors;
mod fiber;
mod interpolate;
mod physics;
#[cfg(feature = "debug-views")]
mod pipelines;
mod skinning;
mod wind;
mod wind_hair;
