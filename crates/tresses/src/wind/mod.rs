//! Wind: a fluid on a coarse grid around the head, with solids and hair as obstacles.
//!
//! Incompressible air in a cube of cells with world axes, centered on the hair. One fixed step of the frame is one step
//! of the air, or a few in a storm, so that air does not jump over the head: per step it travels at most about a head's
//! width, 21 cm, and eight cells (six cells on grids too coarse to resolve a head). Velocities are stored on the faces
//! of cells (Harlow and Welch 1965).
//!
//! ```text
//! colliders ─► obstacles ─► solid, hair ──────────────────────────────┐
//! volume ────────┘                                                    ▼
//! faces, centers ─► predict ─► advected ─► correct ─► before, give ─► pressure ─► faces, centers
//!
//! pressure on a software driver: gather ─► relax × 2n ─► project × 2
//! pressure on a GPU:             smooth_level ─► coarse_solve ─► smooth_project
//! ```
//!
//! - **Advection.** `predict` traces the air backwards along its paths (Stam 1999). `correct` adds MacCormack's
//!   correction (Selle et al. 2008), clamped to the advected values of the cell and its six neighbors. Those are means
//!   of old values, so nothing grows at any speed. Gusts nine cells long keep 71 % of their strength until they leave
//!   the grid, against 62 % without the correction.
//! - **Inflow.** Air from outside the grid has the mean wind and its [`gusts`]. The upwind sides have that velocity;
//!   the others are open, with pressure 0. The last cells along each axis count as outside.
//! - **The grid moves by whole cells** with the head, so a moving head causes no interpolation. Pressures stay with the
//!   cells of the grid, because the pattern around the head moves with the head.
//! - **Solids** close parts of faces, by the distance to the nearest collider, and push with their own velocity. Both
//!   are evaluated up to two cells from a collider; farther away all faces are open anyway.
//! - **Hair** is a porous medium. Air in hair of length `λ` per volume and diameter `d` loses `½ C d λ |w| w` per mass
//!   and time, with `w` relative to the hair. At a head's 5,000 km/m³ that is a factor of a hundred within a cell, so
//!   the drag is part of the pressure solve: a face that responds to a force with only the fraction `1 / (1 + k h)`
//!   responds to pressure in the same way. If the drag were applied before the projection, the pressure would blow the
//!   air through the hair again. The quadratic drag is linearized by Newton's method; using only the last speed
//!   oscillates between two values.
//! - **Pressure on a software driver** (`blocks`). Red-black block relaxation, four cells of a row at once, started
//!   from the last step's pressure. At 32³ there are eight sweeps, over-relaxed by 1.7, the last but one by 1.3, the
//!   last not at all. The first sweeps spread the smooth part of the error over the grid but leave it rough; the last
//!   ones smooth it. This leaves 0.3 to 0.6 % of relative divergence (`tests/stages/wind.rs`), six sweeps up to 0.9 %.
//!   Twelve at a constant 1.5 left up to 0.8 %, although the air moved less far per step.
//! - **Pressure on a GPU** (`levels`). There each dispatch costs microseconds, whatever it does. At 32³ a step has 6
//!   dispatches instead of 22: `obstacles`, `predict`, `correct` and one cycle of multigrid. `smooth_level` damps the
//!   rough errors in tiles of 8³ cells in workgroup memory, and restricts the residual to a grid of 16³. `coarse_solve`
//!   solves that in one workgroup. `smooth_project` interpolates the correction, damps the errors that this causes, and
//!   projects. A smoothing is three Jacobi steps with the damping of a Chebyshev polynomial, and needs no dispatch per
//!   step: a workgroup also computes the four cells around its tile. Responses of coarse faces are sums of fine ones,
//!   and the interpolation is weighted by responses, so that no correction crosses a closed face. Finer grids have more
//!   levels: 40³ to 64³ need 8 dispatches, 72³ to 96³ 10. A fresh start has three cycles. This leaves
//!   0.3 to 0.4 % of relative divergence.
//! - **Effect on hair.** `simulate::forces` adds the drag of single hairs ([`drag`]) in the air of the cells with hair:
//!   hair receives the momentum that the air has lost. The outer hair thus shields the inner, and the head its lee,
//!   through the fluid alone.
//!
//! **Calm air** costs nothing: without wind there are no buffers and no dispatches.
//!
//! **Why textures?** A software driver fetches a texel of four values in half the time of one value from a buffer, and
//! filters eight texels in less time than two buffer reads. With buffers a step took five times as long. The cost is
//! half precision of velocities (0.1 %, and 0.05 % of relative divergence). The levels of a GPU are in buffers.
//!
//! **Why not multigrid on a software driver?** Started from the last step's pressure, eight sweeps are enough at 32³;
//! from 64³ on multigrid would be cheaper. In a scalar model of the solve, one correction on a grid of 8³ left as much
//! divergence after six sweeps as the decreasing over-relaxation leaves without it; one on 16³ left half.
//!
//! **Cost.** CPU time at 32³ on a software driver, in 8 m/s around long hair, measured with two steps of the air per
//! step: `relax` 22 ms with twelve sweeps, 11 with six; `correct` 11, `predict` 6, `project` 5, `gather` 1.5, and
//! `obstacles`, once per step, 10, or 5 to 6 near solids only. The same wind now needs one step of the air.
//!
//! **Tried, and no faster.** `correct` without the loads of hair and solids where there are none (loops of zero or one
//! iteration): the same time. No part of it dominates: leaving out its three samples, the drag, the gusts or the solids
//! saves 0 to 2 ms each.
//!
//! **Tried, and slower.** All of these together: faces as pairs of half floats, four cells to an integer texel, so that
//! `gather` is not needed and each sweep unpacks them; a thread of `correct` for four cells. The step of a frame took
//! 1.3 to 1.6 times the CPU time on a software driver. The cause was not isolated.
//!
//! A thread of `obstacles` for four cells, which reads each collider once for them: a sixth slower.
//!
//! **Why not one step of the air for several of the hair?** It would be possible in light wind. In the 8 m/s that
//! `tresses-evidence costs` measures the air travels 16 cm in a step, close to the limit of 21 cm.
//!
//! **Untried.** Blocks of 4 × 2 × 2 cells: two thirds of the fetches of a sweep per cell, and in the scalar model eight
//! such sweeps leave as much as twelve of rows. Anisotropic drag of the medium by the direction of its hairs; vorticity
//! confinement; velocities relative to the mean wind, for precision; heat.

pub mod air;
mod blocks;
pub mod drag;
mod grids;
pub mod gusts;
mod levels;
pub mod params;
mod pipelines;

pub(crate) use air::{Air, HairGrid};
pub use params::{MAX_CELLS, Wind};
pub(crate) use pipelines::Pipelines;
