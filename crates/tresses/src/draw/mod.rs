//! Draws hair, bodies and background into a linear HDR target.
//!
//! ```text
//! strand vertices ─► tiles, or strips (vertex pulling) ─┐
//! shaded          ─┘                                    ├─► HDR, depth ─► present
//! body            ─► triangles ─────────────────────────┘
//! ```
//!
//! [`Coverage`] selects one of four modes in which hair covers pixels that it is thinner than.
//! `docs/validation/coverage.md` compares them.
//!
//! [`Coverage::Tiles`], the default, is a compute rasterizer ([`tiles`]). The other three modes draw hair as
//! camera-facing strips with the hardware rasterizer: two vertices per strand vertex, generated in the vertex shader
//! from the shared strand buffer. One 16-bit index buffer covers as many strands as fit. It is drawn repeatedly with a
//! different base vertex (`strands::indices`).
//!
//! ```text
//! SampleMask       strips ≥ min_width px ─► depth, color of the strand's own samples
//! AlphaToCoverage  strips + 1 px ─► depth of samples made from alpha ─► color where depth is equal
//! DepthPeeling     body ─► depth ─┬─► layer 1 ─► under ─► layer 2 ─► under ... ─► front ──────┐
//!                                 └─► hair behind the last layer, weighted by depth ─► rest ─┴─► present
//! ```
//!
//! **Sample masks.** A strip is drawn at least [`min_width`](crate::light::HairMaterial::min_width) pixels wide, so
//! that it meets samples along its whole length. It covers only the fraction `width / drawn width` of the samples. The
//! set of samples is a property of the strand: overlapping strands combine as statistically independent, and there is
//! no noise along a strand. A pixel with few samples also averages its neighbors' samples (`present::footprint`), so
//! that moving hair does not shimmer. With a single sample per pixel the fraction is the probability that the strand is
//! drawn there.
//!
//! **Alpha to coverage, depth peeling.** A strip is drawn one pixel wider than the strand. The exact fraction of each
//! square pixel that the strand covers becomes alpha (`coverage.wesl`). Depth peeling (`strips/peel.rs`) blends the
//! nearest strands in order, one per layer. One more pass measures the optical thickness of the hair behind the last
//! layer at eight depths (`thickness.wesl`). The last pass weights each of those strands by the transmittance in front
//! of it.
//!
//! **Cards** are textured strips between strands ([`Hair::set_cards`](crate::Hair::set_cards)). They are drawn after the
//! bodies in every mode.
//!
//! Rejected: linked lists of fragments (unbounded memory, one atomic per fragment), sorting strands (they cross),
//! moments of transmittance. Untried: peeling several layers per pass.

pub(crate) mod cards;
pub mod coverage;
pub mod embed;
mod pipelines;
pub(crate) mod record;
pub mod soft;
pub(crate) mod strips;
pub mod targets;
pub mod tiles;

pub use coverage::Coverage;
pub use embed::{Compositor, Shade, Surroundings};
pub(crate) use pipelines::Pipelines;
pub use targets::Targets;
