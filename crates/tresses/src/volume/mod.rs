//! Hair volume: a grid of hair density and velocity around the head, computed from the guides.
//!
//! Before each fixed step the hair of the guide vertices, weighted by the strands that they represent, is splatted into
//! a cube of cells that moves with the head. Where hair is denser than at rest, it is pushed along the negative
//! gradient of the excess. Friction pulls all hair towards the mean velocity of the surrounding hair (Petrovic, Henne
//! and Anderson 2005). The push of fixed magnitude between neighboring cells (Bertails, Ménier and Cani 2005) is
//! available for comparison.
//!
//! `splat` adds integers, whose sum is bit-identical in any order; `sum` converts them to floats; `blur_x`, `blur_y`
//! and `density` blur along one axis each, one thread per four cells; `push` computes the gradient. `simulate::forces`
//! then samples `hair` and `push`, both rgba16float textures, at every guide vertex. `obstacles` runs only when a
//! collider has moved relative to the head; the head's own field never does.
//!
//! ```text
//! guide state ─► splat ─► cells (i32 × 8) ─► sum ─► blur_x ─► blur_y ─► density ─► hair (velocity, density)
//! colliders ───► obstacles ──────────────────┘                           ▲  └─► excess ─► push (acceleration)
//!                                                         rest density ──┘
//! ```
//!
//! **Blur.** A discrete Gaussian, whose variance is exact at any width. Between the passes a cell is one texel of four
//! words, and a thread fetches each texel once for four cells. On a CPU driver this takes half the time of recursive
//! averages over lines of cells in buffers (at 32³, a texel costs as much as a word of a buffer). The push also depends
//! less on the resolution: 7.74, 7.70 and 7.71 m/s² on 24³, 32³ and 64³ cells, against 7.04, 6.90 and 6.71.
//!
//! **Samples.** Vertices closer than about a cell are splatted as one sample, at their center and with their mean
//! motion. With two vertices per sample, the density is off by 0.7 % and the momentum by 0.8 %; with a quarter of a
//! thousand guides, by 10 and 13 % either way.
//!
//! **Rest density.** The allowed density at a point is the larger of two values: the density of the rest pose at that
//! point *of the head*, and the rest density of the hair that is there now. A style at rest therefore has no push,
//! whatever its density, and a lock that swings as a whole does not expand. The first step after a reset splats the
//! rest pose with the obstacles at that moment.
//!
//! **Pressure.** With the excess `e = max(ρ - (1 + τ) ρ₀, 0)` the acceleration is `-c² ∇e / ρ`: the pressure of a fluid
//! with the speed of sound `c` that only pushes. Blur and `c` are in meters and meters per second, so the force does
//! not depend on the resolution.
//!
//! **Obstacles** displace hair: the density is relative to the free part of a cell's neighborhood.
//!
//! **Friction** has the most visible effect: without it neighboring locks separate in a shake and keep swinging for
//! seconds. It acts towards the mean velocity of the neighborhood, so it does not slow a swing of all hair.
//!
//! **Cost.** A third of it is the splat, with 40 atomic additions per sample. Grooms of more than
//! [`VolumeOptions::max_samples`] samples splat every second, third, ... guide with the weight of all.
//!
//! **Other grooms** that meet this one ([`Hair::meet`](crate::Hair::meet)) are splatted into the same cells: a common
//! excess pushes both apart.
//!
//! **Known limits.** Hair outside the grid is neither counted nor pushed. The push cannot resolve strands within a
//! cell: locks in one cell may interpenetrate.
//!
//! **Why not a pressure solve?** An incompressible projection would preserve the volume exactly, but also where hair is
//! thin, and takes tens of passes. The excess is sparse and small.
//!
//! **Untried:** FLIP-like transfer of velocity differences (McAdams 2009); anisotropic friction; a grid that follows
//! the hair's bounds.

mod base;
mod grid;
mod neighbor;
mod others;
pub mod params;
mod pipelines;
mod state;

#[cfg(test)]
mod gpu_tests;

pub(crate) use grid::VolumeGrid;
pub(crate) use others::OtherGroom;
pub(crate) use params::offset;
pub use params::{HairHair, HairHairMode};
pub(crate) use pipelines::Pipelines;
pub use state::VolumeOptions;
pub(crate) use state::{Volume, VolumeAsset};
