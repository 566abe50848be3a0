//! Tessellation of guides into smooth curves.
//!
//! For every guide, the stage computes `sample_count` points of a uniform cubic B-spline at equal parameter steps. Each
//! point has the rotation that carries its neighborhood from rest to the current state. This happens once per frame,
//! and every drawn strand reads the result.
//!
//! One thread per guide walks its control vertices from root to tip with four of them in registers. A vertex is first
//! interpolated between the last two simulation states, *in the head's frame*: both states are carried rigidly from the
//! head's pose at their step to its current pose, so the roots stay on the drawn head at any frame rate. Phantom
//! vertices `2 P[0] - P[1]` and `2 P[n-1] - P[n-2]` make the curve start at the root and end at the tip; with repeated
//! end vertices it would miss both by a sixth of a segment. Rotations are the head's at the root, then minimal
//! rotations from edge to edge (parallel transport), blended between edges.
//!
//! ```text
//! current, velocity (vertex-major)       ─┐
//! rest (PackedGuide, vertex-major), info ─┼─► spline ─► samples (GuideSample, guide-major)
//! poses (uniform)                        ─┘
//! ```
//!
//! A sample also holds its rest position, which never changes. It takes 32 bytes in total, of which the rotation takes
//! 8. The rotation's error, 3e-5, moves a hair 10 cm from its guide by 3 µm.
//!
//! If every strand has its own guide there are no samples: [`crate::interpolate`] walks the same segments
//! (`walk.wesl`).
//!
//! **Why not a thread per sample?** Parallel transport is serial along the strand, and a guide has at most 64 vertices.
//! **Untried.** A thread per sample after a scan of rotations.

mod spline;

pub(crate) use spline::Pipelines;
pub(crate) use spline::{TessellateParams, Tessellation, rest_samples};
