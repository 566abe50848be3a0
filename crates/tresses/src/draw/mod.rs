//! Hair, body and background into a linear target.
//!
//! ```text
//! strand vertices ─► strips (vertex pulling) ─┐
//! shaded          ─┘                          ├─► HDR, depth ─► present
//! body            ─► triangles ───────────────┘
//! ```
//!
//! Hair is drawn as camera-facing strips: two vertices per strand vertex, made in the vertex
//! shader from the shared strand buffer. One 16-bit index list for as many strands as it reaches
//! is drawn again and again with another base vertex (see `hair.rs`).
//!
//! **Width.** Hair is mostly thinner than a pixel. A strip is drawn at least
//! [`min_width`](crate::light::HairMaterial::min_width) pixels wide, so that it meets samples
//! everywhere along its way, and covers only the share `width / drawn width` of the samples. Which
//! samples is a property of the strand: strands that overlap then add up as independent things do,
//! and there is no noise along a strand. With a single sample per pixel the share becomes a
//! probability that the strand is there at all: it ends where it has become too thin for its hash,
//! only half of its taper counted, so that not too many end early.
//!
//! Not taken: alpha blending (needs sorting), alpha to coverage (the same samples for every
//! strand, so that overlapping thin hairs hide behind each other). Untried: analytic coverage in a
//! compute rasteriser, for which `light::shade`'s output is ready.

pub mod background;
pub mod body;
pub mod coverage;
pub mod debug;
pub mod hair;
pub(crate) mod peel;
pub(crate) mod pipeline;
pub mod scene;
pub mod stage;
pub(crate) mod strips;
pub mod targets;
pub mod view;

pub use background::Background;
pub use body::{Body, BodyMaterial};
pub use coverage::Coverage;
pub use hair::HairSet;
pub use scene::Scene;
pub use stage::{DrawOptions, DrawStage};
pub use targets::Targets;
pub use view::View;
