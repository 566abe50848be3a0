//! Builds the web pages of Tresses and its book into folders of static files, and serves such a folder.
//!
//! A page consists of a program for `wasm32-unknown-unknown`, the bindings that wasm-bindgen generates for it, and
//! files from `pages/` or `component/`. wasm-bindgen is linked as a library, so building needs no tools besides Rust.

pub mod book;
mod pack;
pub mod serve;
pub mod three;

pub use book::build_book;
pub use pack::{CARDS_LIMIT, LIMIT, Sizes, WebPage, pack};
pub use serve::Server;
