//! Light scattering in fibers: by a single hair, and by many.
//!
//! ```text
//! FiberShape ──► bsdf ─────► far ──────────────────► 4 layers, φ × cos θ ──┐
//! (roughness,    lobes at    means over the width,                        ├─► fiber.wesl ─► radiance
//!  tilt, eta)    an offset   as moments of the   ───► mean ─► 2 layers, ──┘   per channel
//!                            path length              cos θ × absorption
//! ```
//!
//! **One fiber** ([`bsdf`]): reflection (R), transmission (TT), one internal reflection (TRT) and all further ones,
//! each the product of a longitudinal and an azimuthal distribution (Chiang et al. 2016). Absorption is per fiber
//! radius. It comes from melanin or from a color.
//!
//! **Thinner than a pixel** ([`far`]): a pixel sees the whole width of a hair, so the lobes are averaged over it.
//! Absorption acts as `exp(-σ l)` on the path length `l` inside the fiber, and at a given azimuth those lengths hardly
//! differ. The table therefore holds weights, mean path lengths and their variances. All channels, and all strands with
//! their own melanin, share one fetch. A table over (φ, θ, σ) would need a fetch per channel, be a hundred times as
//! large, and interpolate values that an exponential gives exactly.
//!
//! **Many fibers** ([`mean`]): dual scattering (Zinke et al. 2008). Light that has passed fibers arrives from a half
//! circle of azimuths, and from inclinations whose spread grows with the number of fibers passed (global scattering).
//! The hair around a fiber scatters light back (local scattering). All averages are integrals of the same lobes. Shadow
//! maps give the mean number of fibers on the way. For hair in random order the actual number has a Poisson
//! distribution: `exp(-n)` of the light hits none, and `exp(-n (1 - a))` arrives when each fiber passes on the fraction
//! `a`. (The paper raises `a` to an integer power.)
//!
//! **Spread lobes** conserve energy. The paper adds variances of Gaussians in the inclination, which lose the energy
//! beyond the poles. Here the normalized distribution of the lobes themselves is widened.
//!
//! **Ambient light** and light reflected by meshes are integrated over the half circles in front of and behind the
//! fiber; [`super::ambient`] gives the light that arrives from each. Without it, the visibility of each half is
//! estimated from the shadow maps of the lights nearest in direction. Towards the eye the visibility is 1, since the
//! eye sees the fiber.
//!
//! **Light leaves the hair** at each fiber near its boundary, where all visible fibers lie. The model is a random walk
//! next to an absorbing wall, which retains 1 / sqrt(n) after n steps. With Zinke's constant factor, hair beyond the
//! terminator, behind two to eight fibers, was 1.4 to 1.9 times as bright as path traced.
//!
//! `density_forward` is fitted to path-traced images (`docs/validation/path-tracing.md`). Backscattering is limited to
//! the fibers behind the visible one (`shading.wesl`).
//!
//! **Tests**: the near field against 256 directions and four colors of Mitsuba's plugin; white furnace tests of the
//! near field, the tables and the shader; the shader against its CPU reference `FarField::scatter`
//! (`tests/stages/fiber.rs`). Comparison with path-traced images: `docs/validation/shading.md`.
//!
//! Untried: a fit of `density_back` (0.7 as in the paper); the offset across the strip where hair is wider than pixels
//! (near field); elliptical fibers.

pub mod bsdf;
pub mod far;
pub mod mean;
pub mod tables;

pub use bsdf::FiberShape;
pub(crate) use tables::FiberTables;
