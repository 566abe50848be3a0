//! Interpolation: blends drawn strands from guides.
//!
//! Every strand vertex is blended from one to three tessellated guides, with exact segment lengths and tangents. It
//! takes 16 bytes, is written once per frame and read by every later pass. This stage ignores obstacles;
//! [`crate::avoid`] corrects the few strands that enter one.
//!
//! One thread per strand walks from root to tip. The target of a vertex with rest position `p̄` is `Σ w_k (g_k + R_k
//! (p̄ - ḡ_k))` (see [`crate::strands::binding`]). A blend of guides that rotate apart would shorten the strand. The
//! walk therefore keeps only the *direction* of each blended edge and gives it its rest length, so lengths are exact
//! whatever the guides do.
//!
//! ```text
//! samples (GuideSample, guide-major) ─┐
//! bindings (per strand)              ─┼─► blend ─► vertices (StrandVertex, strand-major)
//! rest (PackedRest, per vertex)      ─┘
//! ```
//!
//! Strands that are their own guides (one guide each, and no fewer guides than strands) need no shared samples. Each
//! thread walks along the segments of its own guide, as [`crate::tessellate`] does, and evaluates the spline at its
//! vertices. This saves 32 bytes per vertex and a third of both stages' time.
//!
//! ```text
//! current, velocity, rest (vertex-major), info, poses ─► follow ─► vertices
//! bindings, rest curves                               ─┘
//! ```
//!
//! Tangents are means of neighboring unit edges: the quadratic B-spline of the edges at its knots.
//!
//! **Why not a thread per vertex?** Exact lengths are serial along the strand. Thousands of strands fill a GPU, and a
//! software driver prefers few long threads. **Untried.** A workgroup per strand with a scan.

mod blend;

pub(crate) use blend::Interpolation;
pub(crate) use blend::Pipelines;
