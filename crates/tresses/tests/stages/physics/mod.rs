//! The physics suite: the step on the GPU compared with closed forms and invariants.
//!
//! Each case prints a row with the expected value, the measured value and the tolerance. `docs/validation/motion.md`
//! contains the same rows, and the tests compare with them; `TRESSES_PHYSICS=write` writes the file. Each comparison
//! runs twice. The second experiment is wrong by a few percent and must fail.

mod cohesion;
mod friction;
mod grooms;
mod independence;
pub mod lab;
mod moving_frames;
mod robust;
mod shapes;
mod squeeze;
mod swings;
mod table;
mod tiers;
mod ties;
mod twist;
