//! Guides become drawn strands.
//!
//! What: every strand vertex from one to three tessellated guides (S13, S14, S15), then exact
//! segment lengths, with tangents; 16 bytes per vertex, written once per frame and read by every
//! later pass (S18). Obstacles are not looked at here: [`crate::avoid`] corrects the few strands that
//! enter one.
//!
//! How: one thread per strand walks from root to tip. A vertex that rests at `p̄` wants to be at
//! `Σ w_k (g_k + R_k (p̄ - ḡ_k))` (see [`crate::strands::binding`]). A blend of guides that turn apart
//! would shorten the strand, so the walk keeps only the *direction* of each blended edge and gives
//! it its rest length: lengths are exact whatever the guides do.
//!
//! ```text
//! samples, sample rest (guide-major) ─┐
//! bindings (per strand)              ─┼─► blend ─► vertices (StrandVertex, strand-major)
//! rest (PackedRest, per vertex)      ─┘
//! ```
//!
//! Tangents are means of neighbouring unit edges: the quadratic B-spline of the edges at its knots
//! (S29).
//!
//! Why not a thread per vertex: exact lengths are a walk along the strand; there are thousands of
//! strands, which fills a GPU, and a software driver prefers few long threads. Untried: a workgroup
//! per strand with a scan.

mod blend;

pub use blend::{Interpolate, InterpolateParams};
