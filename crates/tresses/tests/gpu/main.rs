//! Tests across stages, on a GPU. One device and its pipelines serve all tests of this binary.
//!
//! `cargo test -p tresses --test gpu shadows` runs the tests of one file. Ignored tests take minutes and print the
//! tables of `docs/`; `make proof` runs them.

mod ambient;
mod asset;
mod avoid;
mod avoid_grooms;
#[cfg(feature = "cards")]
mod cards;
mod characters;
mod common;
mod counts;
mod crowd;
mod cube;
mod curls;
mod deform;
mod draw;
mod edges;
#[cfg(feature = "edit")]
mod edit;
mod embed;
mod embed_shadow;
mod frame;
mod golden;
mod grab;
mod grooms;
mod guide;
mod hair_collision;
mod labels;
mod lights;
mod lod;
mod moving;
mod order;
mod painted;
mod pipelines_draw;
mod present;
mod radiance;
mod renderers;
mod roots;
mod second_driver;
mod shading_subset;
mod shadows;
mod soft;
mod space;
#[cfg(feature = "debug-views")]
mod views;
mod volume;
