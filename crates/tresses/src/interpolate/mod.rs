//! Guides become drawn strands.
//!
//! Every strand vertex is blended from one to three tessellated guides, with exact segment lengths and
//! tangents; 16 bytes per vertex, written once per frame and read by every later pass. Obstacles are
//! ignored here: [`crate::avoid`] corrects the few strands that enter one.
//!
//! One thread per strand walks from root to tip. The target of a vertex with rest position `p̄` is
//! `Σ w_k (g_k + R_k (p̄ - ḡ_k))` (see [`crate::strands::binding`]). A blend of guides that rotate apart
//! would shorten the strand, so the walk keeps only the *direction* of each blended edge and gives it its
//! rest length: lengths are exact whatever the guides do.
//!
//! ```text
//! samples (GuideSample, guide-major) ─┐
//! bindings (per strand)              ─┼─► blend ─► vertices (StrandVertex, strand-major)
//! rest (PackedRest, per vertex)      ─┘
//! ```
//!
//! Strands that are guides themselves (one guide each, and no fewer guides than strands) read no samples, which
//! nobody else would share: each thread walks along the segments of its own guide, as [`crate::tessellate`] does, and
//! evaluates the spline where its vertices are. That saves 32 bytes per vertex, and a third of both stages' time.
//!
//! ```text
//! current, velocity, rest (vertex-major), info, poses ─► follow ─► vertices
//! bindings, rest curves                               ─┘
//! ```
//!
//! Tangents are means of neighbouring unit edges: the quadratic B-spline of the edges at its knots.
//!
//! **Why not a thread per vertex?** Exact lengths are serial along the strand; there are thousands of
//! strands, which fills a GPU, and a software driver prefers few long threads. **Untried.** A workgroup per
//! strand with a scan.

mod blend;

pub(crate) use blend::Pipelines;
pub use blend::{InterpolateParams, Interpolation};
