//! Guides become drawn strands.
//!
//! What: every strand vertex from one to three tessellated guides (S13, S14, S15), then exact
//! segment lengths, clear of the head, with tangents; 16 bytes per vertex, written once per frame
//! and read by every later pass (S18).
//!
//! How: one thread per strand walks from root to tip. A vertex that rests at `p̄` wants to be at
//! `Σ w_k (g_k + R_k (p̄ - ḡ_k))` (see [`crate::strands::binding`]). A blend of guides that turn apart
//! would shorten the strand, so the walk keeps only the *direction* of each blended edge and gives
//! it its rest length: lengths are exact whatever the guides do. A vertex that ends up in the head
//! is pushed out along the distance field's gradient and its edge takes its length again; what
//! follows goes on from there, so a strand slides along the head instead of being cut by it. The
//! clearance is never more than the vertex has at rest.
//!
//! ```text
//! samples, sample rest (guide-major) ─┐
//! bindings (per strand)              ─┼─► blend ─► vertices (StrandVertex, strand-major)
//! rest (PackedRest, per vertex)      ─┤
//! the head among the colliders       ─┘
//! ```
//!
//! Tangents are means of neighbouring unit edges: the quadratic B-spline of the edges at its knots
//! (S29).
//!
//! Why not a thread per vertex: exact lengths and sliding contact are walks along the strand; there
//! are thousands of strands, which fills a GPU, and a software driver prefers few long threads.
//! Untried: a workgroup per strand with a scan.

mod blend;

pub use blend::{Interpolate, InterpolateParams};
