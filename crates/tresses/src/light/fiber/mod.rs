//! Light in fibres: scattering by a single hair, and by many together.
//!
//! ```text
//! FiberShape ──► bsdf ─────► far ──────────────────► 4 layers, φ × cos θ ──┐
//! (roughness,    lobes at    means over the width,                        ├─► fiber.wesl ─► radiance
//!  tilt, eta)    an offset   as moments of the   ───► mean ─► 2 layers, ──┘   per channel
//!                            path length              cos θ × absorption
//! ```
//!
//! **One fibre** ([`bsdf`]): reflection (R), transmission (TT), one internal reflection (TRT) and all
//! further ones, each the product of a longitudinal and an azimuthal distribution (Chiang et al. 2016).
//! Absorption is per fibre radius; it comes from melanin or from a colour.
//!
//! **Thinner than a pixel** ([`far`]): a pixel sees the whole width of a hair, so the lobes are averaged
//! over it. Absorption acts as `exp(-σ l)` on the path length `l` inside the fibre, and for a given azimuth
//! those lengths hardly differ. The table therefore holds weights, mean path lengths and their variances:
//! every channel and every strand's own melanin share one fetch. The obvious table over (φ, θ, σ) needs a
//! fetch per channel, is a hundred times as large, and interpolates what an exponential gives exactly.
//!
//! **Many fibres** ([`mean`]): dual scattering (Zinke et al. 2008). Light that has passed fibres arrives
//! from a half circle of azimuths and from inclinations whose spread grows with the number of fibres passed
//! (global scattering); the hair around a fibre scatters light back (local scattering). All averages are
//! integrals of the same lobes. Shadow maps give the mean number of fibres in the way; for hair in no
//! particular order the actual number has a Poisson distribution, so `exp(-n)` of the light meets none and
//! `exp(-n (1 - a))` arrives when each fibre passes the fraction `a` on. (The paper raises `a` to an
//! integer power.)
//!
//! **Spread lobes** conserve energy: where the paper adds variances of Gaussians in the inclination, which
//! lose what falls beyond the poles, the normalised distribution of the lobes themselves is widened.
//!
//! **Ambient light** and light reflected by bodies: integrated over the half circle in front of the fibre
//! and the half behind it, with the light that arrives from each given by [`super::ambient`]. Without that,
//! the visibility of each half is estimated from the shadow maps of the lights nearest in direction;
//! towards the eye it is full, since the eye sees the fibre.
//!
//! Verified: the near field against 256 directions and four colours of Mitsuba's plugin; white furnaces of
//! the near field, the tables and the shader; the shader against its CPU twin [`FarField::scatter`]
//! (`tests/gpu/fiber.rs`). Pictures against path tracing: `docs/appearance/shading.md`.
//!
//! **Light leaves hair** at each fibre that it meets near the edge of the hair, where all that is seen lies: as a walk by
//! chance beside a wall that takes what touches it, of which one over the root of the steps is left. With Zinke's constant
//! share hair beyond the terminator, behind two to eight fibres, was 1.4 to 1.9 times as bright as path traced.
//!
//! `density_forward` is set by path-traced pictures (`docs/appearance/truth.md`); what hair scatters back is that of
//! the fibres behind (`shading.wesl`). Untried: a fit of `density_back` (0.7 is the paper's value); the
//! offset across the strip where hair is wider than pixels (near field); elliptical fibres.

pub mod bsdf;
pub mod far;
pub mod mean;
pub mod tables;

pub use bsdf::FiberShape;
pub use far::FarField;
pub use tables::FiberTables;
