//! Hair occupies volume: one grid of density and velocity around the head, from the guides.
//!
//! Before each fixed step the hair of the guide vertices, weighted by the strands that they represent, is
//! splatted into a cube of cells that moves with the head. Where hair is denser than at rest, it is pushed
//! along the negative gradient of the excess; everywhere friction draws it towards the mean velocity of the
//! surrounding hair (Petrovic, Henne and Anderson 2005). For comparison there is the push of fixed
//! magnitude between neighbouring cells (Bertails, Ménier and Cani 2005).
//!
//! `splat` adds integers, whose sum is bit-identical in any order; `sum` converts them to floats; `blur_x`,
//! `blur_y` and `density` blur along one axis each, one thread per four cells; `push` takes the gradient.
//! `simulate::forces` then samples the two textures at every guide vertex. `obstacles` runs only when a
//! collider has moved relative to the head; the head's own field never does.
//!
//! ```text
//! guide state ─► splat ─► cells (i32 × 8) ─► sum ─► blur_x ─► blur_y ─► density ─► hair (rgba16float: mean velocity, density)
//! colliders ───► obstacles ──────────────────┘                           ▲  └─► excess ─► push (rgba16float: acceleration)
//!                                                         rest density ──┘
//! ```
//!
//! **Blur.** A discrete Gaussian, whose variance is exact however narrow it is. Between the passes a cell
//! is one texel of four words, and a thread fetches each texel once for four cells. On a CPU driver that
//! takes half the time of the earlier recursive averages over lines of cells in buffers (at 32³, a texel
//! costs as much as a word of a buffer), and the push depends less on the resolution (7.74, 7.70, 7.71 m/s²
//! on 24³, 32³, 64³ cells; before 7.04, 6.90, 6.71).
//!
//! **Samples.** Vertices closer than about a cell are splatted together, at their centre and with their
//! mean motion. With two vertices each, the density is off by 0.7 % and the momentum by 0.8 %; with a
//! quarter of a thousand guides, by 10 and 13 % with or without that.
//!
//! **Rest density.** The density allowed at a place is that of the rest pose at that place *of the head*,
//! or that of the hair now there where it rests, whichever is larger. A style at rest thus feels nothing,
//! whatever its density, and a lock that swings as a whole does not expand. The first step after a reset
//! splats the rest pose with the obstacles of that moment.
//!
//! **Pressure.** With the excess `e = max(ρ - (1 + τ) ρ₀, 0)` the acceleration is `-c² ∇e / ρ`: the
//! pressure of a fluid with the speed of sound `c`, which only pushes. Blur and `c` are in metres and
//! metres per second, so that the force does not depend on the resolution.
//!
//! **Obstacles** displace hair: the density is that in the free part of a cell's neighbourhood.
//!
//! **Friction** has the most visible effect: without it neighbouring locks separate in a shake and keep
//! swinging for seconds. It acts towards the mean velocity of the neighbourhood, so a swing of all hair is
//! not slowed.
//!
//! **Cost.** A third of it is the splat: 40 atomic additions per sample. Grooms of more than
//! [`VolumeOptions::most_splatted`] samples splat every second, third, ... guide with its share of the
//! hair.
//!
//! **Other grooms** that are met ([`Hair::meet`](crate::Hair::meet)) are splatted into the same cells: what they are too
//! dense for together pushes both apart.
//!
//! **Known limits.** Hair outside the grid is not counted and feels nothing. The push cannot resolve
//! strands within a cell: locks in one cell may interpenetrate.
//!
//! **Why not a pressure solve?** An incompressible projection would hold the volume exactly, but also where
//! hair is thin, and takes tens of passes. The excess is sparse and small.
//!
//! **Untried:** FLIP-like transfer of velocity differences (McAdams 2009); anisotropic friction; a grid
//! that follows the hair's bounds.

mod base;
mod grid;
mod met;
mod others;
pub mod params;
mod pipelines;
mod state;

#[cfg(test)]
mod gpu_tests;
#[cfg(test)]
mod reference;

pub use grid::Grid;
pub(crate) use others::Other;
pub(crate) use params::offset;
pub use params::{HairHair, HairHairMode};
pub(crate) use pipelines::Pipelines;
pub use state::{Volume, VolumeOptions};
