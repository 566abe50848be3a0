//! Hair, body and background into a linear target.
//!
//! ```text
//! strand vertices ─► strips (vertex pulling) ─┐
//! shaded          ─┘                          ├─► HDR, depth ─► present
//! body            ─► triangles ───────────────┘
//! ```
//!
//! Hair is drawn as camera-facing strips: two vertices per strand vertex, made in the vertex
//! shader from the shared strand buffer. One 16-bit index list covers as many strands as fit
//! and is drawn repeatedly with another base vertex (`strands::indices`).
//!
//! **Coverage.** Hair is mostly thinner than a pixel. [`Coverage`] names three methods that preserve
//! its area; `docs/appearance/edges.md` compares them.
//!
//! ```text
//! SampleMask       strips ≥ min_width px ─► depth, colour of the strand's own samples
//! AlphaToCoverage  strips + 1 px ─► depth of samples made from alpha ─► colour where depth is equal
//! DepthPeeling     body ─► depth ─┬─► layer 1 ─► under ─► layer 2 ─► under ... ─► front ──────┐
//!                                 └─► hair behind the last layer, weighted by depth ─► rest ─┴─► present
//! ```
//!
//! With masks, a strip is drawn at least [`min_width`](crate::light::HairMaterial::min_width) pixels
//! wide, so that it meets samples everywhere along its length, and covers only the fraction
//! `width / drawn width` of the samples. The set of samples is a property of the strand: overlapping strands
//! then combine as statistically independent, and there is no noise along a strand. A pixel of few samples is
//! filtered over its neighbours' samples too (`present::footprint`), so that moving hair does not shimmer. With
//! a single sample per pixel the fraction becomes the probability that the strand is drawn there.
//!
//! The two others draw a strip one pixel wider than the strand, and compute for each pixel the fraction that
//! the strand covers (`coverage.wesl`): exact for a square pixel, so that nothing need be widened. Peeling (`strips/peel.rs`) blends strands in order, as many as there are layers. One more pass
//! measures the optical thickness of the hair behind them at eight depths (`thickness.wesl`), so that in the
//! last pass each strand is weighted by the transmittance in front of it.
//!
//! Rejected: linked lists of fragments (memory without bound, atomics per fragment), sorting strands
//! (they cross), moments of transmittance. Untried: analytic coverage in a compute rasteriser, for
//! which `light::shade`'s output is ready; peeling several layers per pass.

pub mod coverage;
pub mod embed;
mod pipelines;
pub(crate) mod record;
pub mod soft;
pub(crate) mod strips;
pub mod targets;
pub mod tiles;

pub use coverage::Coverage;
pub use embed::{Embed, Shade, Surroundings};
pub(crate) use pipelines::Pipelines;
pub use targets::Targets;
