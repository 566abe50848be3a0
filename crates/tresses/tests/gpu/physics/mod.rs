//! The physics suite: the step on the GPU against closed forms and invariants.
//!
//! Every case prints a row: what is expected, what was measured, the tolerance. `docs/physics.md`
//! holds the same rows and is checked against them; `TRESSES_PHYSICS=write` writes them there.
//! Every comparison is run twice, the second time on an experiment that is wrong by a few per cent,
//! and must then say so.

mod carried;
mod cohesion;
mod friction;
mod grooms;
mod independence;
mod lab;
mod robust;
mod shapes;
mod squeeze;
mod swings;
mod table;
mod ties;
mod twist;
