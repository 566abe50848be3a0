//! Hair takes up room: one grid of density and velocity around the head, from the guides.
//!
//! What (S6, S7): before each fixed step the hair of the guide vertices, weighted by the strands that they
//! stand for, goes into a cube of cells that moves with the head. Where hair is denser than it
//! is at rest, it is pushed along the negative gradient of the excess; everywhere it is rubbed
//! towards the mean velocity of the hair around it (Petrovic, Henne and Anderson 2005). For
//! comparison (S9) there is the push of fixed magnitude between neighbouring cells (Bertails, Ménier
//! and Cani 2005).
//!
//! How: `splat` adds integers, which need no order to give the same bits; `sum` makes numbers of them;
//! `blur_x`, `blur_y` and `density` blur along one axis each, a thread for four cells; `push` takes the gradient.
//! `simulate::forces` then samples the two textures at every guide vertex. `obstacles` runs only when
//! something has moved relative to the head; the head's own field has not.
//!
//! ```text
//! guide state ─► splat ─► cells (i32 × 8) ─► sum ─► blur_x ─► blur_y ─► density ─► hair (rgba16float: mean velocity, density)
//! colliders ───► obstacles ──────────────────┘                           ▲  └─► excess ─► push (rgba16float: acceleration)
//!                                                         rest density ──┘
//! ```
//!
//! **Blur.** A discrete Gaussian, whose variance is what it should be however narrow it is. All that a cell holds is
//! one texel of four words between the passes, and a thread fetches each texel once for four cells. On a CPU driver that
//! takes half the time of recursive averages over lines of cells in buffers, which were here before (at
//! 32³, a texel costs what a word of a buffer does), and the push depends less on the resolution
//! (7.74, 7.70, 7.71 m/s² on 24³, 32³, 64³ cells; before 7.04, 6.90, 6.71).
//!
//! **Samples.** Vertices closer than a cell or so are splatted together, at their middle and with their mean
//! motion. Of two vertices each, the density is off by 0.7 % and the momentum by 0.8 %; of a quarter of a
//! thousand guides, by 10 and 13 % with or without that.
//!
//! **Compared with rest.** The density that hair may have at a place is what the rest pose has at
//! that place *of the head*, or what the hair that is there has where it rests, whichever is more. So
//! a style at rest feels nothing, whatever its density, and a lock that swings as a whole is not blown up.
//! The first step after a reset splats the rest pose with the obstacles as they are then.
//!
//! **Pressure.** With the excess `e = max(ρ - (1 + τ) ρ₀, 0)` the acceleration is `-c² ∇e / ρ`: the
//! pressure of a fluid with the speed of sound `c`, which only pushes. Blur and `c` are in metres and
//! metres per second, so that the force does not depend on the resolution.
//!
//! **Obstacles** take room from the hair: the density is that in the part of a cell's surroundings that they leave free.
//!
//! **Friction** is what one sees most: without it neighbouring locks part in a shake and swing on for
//! seconds. It goes towards the mean velocity of the surroundings, so a swing of all hair is not slowed.
//!
//! **Cost.** A third of it is the splat: 40 atomic additions per sample. Grooms of more than
//! [`VolumeOptions::most_splatted`] samples splat every second, third, ... guide with its share of the hair.
//!
//! **Known limits.** What leaves the grid is not counted and feels nothing. The push cannot see
//! strands within a cell: locks of one cell may interleave.
//!
//! **Why not a pressure solve?** An incompressible projection would hold the volume exactly but
//! also where hair is thin, and costs tens of passes. The excess is sparse and small.
//!
//! **Untried:** FLIP-like transfer of velocity differences (McAdams 2009); anisotropic friction;
//! a grid that follows the hair's bounds.

mod base;
mod grid;
pub mod params;
mod stage;
mod state;

#[cfg(test)]
mod gpu_tests;
#[cfg(test)]
mod reference;

pub use grid::Grid;
pub use params::{HairHair, HairHairMode};
pub use stage::VolumeStage;
pub use state::{Volume, VolumeOptions};
