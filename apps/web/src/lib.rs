//! The web pages of Tresses: built into a folder of static files, and served from one.
//!
//! A page is a program for `wasm32-unknown-unknown`, the output of wasm-bindgen for it, and an HTML file of
//! `pages/`. wasm-bindgen is used as a library, so that nothing needs to be installed beside Rust.

mod pack;
mod serve;

pub use pack::{LIMIT, Page, Sizes, pack};
pub use serve::Server;
