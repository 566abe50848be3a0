//! Compares the kernels with the CPU reference, closed forms and invariants.

mod push;
mod samples;
mod scene;
mod splat;
