//! The kernels against the twin, closed forms and invariants.

mod push;
mod samples;
mod scene;
mod splat;
