//! Builds the web pages of Tresses into a folder of static files, and serves such a folder.
//!
//! A page consists of a program for `wasm32-unknown-unknown`, the bindings that wasm-bindgen generates for it, and
//! files from `pages/` or `component/`. wasm-bindgen is linked as a library, so building needs no tools besides Rust.

mod pack;
mod serve;

pub use pack::{LIMIT, Page, Sizes, pack};
pub use serve::Server;
