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
//! is drawn again and again with another base vertex (`strands::indices`).
//!
//! **Coverage.** Hair is mostly thinner than a pixel. [`Coverage`] names three ways to cover as much
//! as it does; `docs/appearance/edges.md` holds them against each other.
//!
//! ```text
//! SampleMask       strips ≥ min_width px ─► depth, colour of the strand's own samples
//! AlphaToCoverage  strips + 1 px ─► depth of samples made from alpha ─► colour where depth is equal
//! DepthPeeling     body ─► depth ─┬─► layer 1 ─► under ─► layer 2 ─► under ... ─► front ──────┐
//!                                 └─► what lies behind the last layer, by its depth ─► rest  ─┴─► present
//! ```
//!
//! With masks, a strip is drawn at least [`min_width`](crate::light::HairMaterial::min_width) pixels
//! wide, so that it meets samples everywhere along its way, and covers only the share
//! `width / drawn width` of the samples. Which samples is a property of the strand: strands that
//! overlap then add up as independent things do, and there is no noise along a strand. A pixel of few
//! samples is made of its neighbours' too (`present::footprint`), so that hair in motion is quiet. With a
//! single sample per pixel the share becomes a probability that the strand is there at all.
//!
//! The two others draw a strip as wide as it is and a pixel more, and ask each pixel which share of it
//! the strand covers (`coverage.wesl`): exact for a pixel that is a square, so that nothing need be
//! widened. Peeling (`strips/peel.rs`) blends strands in order, as many as there are layers. How thick the hair
//! behind them is one more pass tells at eight depths (`thickness.wesl`), so that in the last one each
//! strand counts by what lies before it.
//!
//! Not taken: linked lists of fragments (memory without bound, atomics per fragment), sorting strands
//! (they cross), moments of transmittance. Untried: analytic coverage in a compute rasteriser, for
//! which `light::shade`'s output is ready; peeling several layers per pass.

pub mod coverage;
pub mod embed;
mod pipelines;
pub(crate) mod record;
pub(crate) mod strips;
pub mod targets;

pub use coverage::Coverage;
pub use embed::{Embed, Surroundings};
pub use pipelines::Pipelines;
pub use targets::Targets;
