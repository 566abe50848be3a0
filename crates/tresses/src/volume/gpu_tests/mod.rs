//! Compares the kernels with closed forms and invariants.

mod push;
mod samples;
mod scene;
mod splat;
