//! Draws hair, bodies and background into a linear HDR target.
//!
//! ```text
//! strand vertices ─► tiles, or strips (vertex pulling) ─┐
//! shaded          ─┘                                    ├─► HDR, depth ─► present
//! body            ─► triangles ─────────────────────────┘
//! ```
//!
//! A [`Renderer`](crate::renderer::Renderer) draws hair that is thinner than a pixel: [`tiles`], the default, is a
//! compute rasterizer; `masks` and [`classic`] draw camera-facing strips with the hardware rasterizer (`strips`).
//! One 16-bit index buffer covers as many strands as fit. It is drawn repeatedly with a different base vertex
//! (`strands::indices`). `docs/validation/coverage.md` compares them.
//!
//! **Cards** are textured strips between strands ([`HairDescriptor::cards`](crate::HairDescriptor::cards)). They are
//! drawn after the bodies by every renderer.

pub(crate) mod canvas;
pub(crate) mod cards;
pub mod classic;
pub mod embed;
pub(crate) mod masks;
mod pipelines;
mod record;
pub mod soft;
mod strips;
pub mod targets;
pub mod tiles;

pub use embed::{Compositor, HostFrame};
pub(crate) use pipelines::Pipelines;
pub use targets::Targets;
