//! Light in fibres: what one hair does with light, and what many hairs do together.
//!
//! ```text
//! FiberShape ──► bsdf ─────► far ──────────────────► 4 layers, φ × cos θ ──┐
//! (roughness,    lobes at    means over the width,                        ├─► fiber.wesl ─► radiance
//!  tilt, eta)    a place     as moments of the way ─► mean ─► 2 layers, ──┘   per channel
//!                            in the fibre              cos θ × absorption
//! ```
//!
//! **One fibre** ([`bsdf`]): reflection (R), transmission (TT), one inner reflection (TRT) and all others,
//! each a distribution along times one around the fibre, after Chiang et al. 2016. Absorption is per
//! fibre radius; it comes from melanin or from a colour.
//!
//! **Thinner than a pixel** ([`far`]): a pixel sees the whole width of a hair, so the lobes are averaged
//! over it. Absorption acts as `exp(-σ l)` on the way `l` inside the fibre, and for one azimuth those ways
//! hardly differ. So the table holds weights, mean ways and their variances: every channel and every
//! strand's own melanin share one fetch. The obvious table over (φ, θ, σ) needs a fetch per channel, is
//! a hundred times as large, and interpolates what an exponential function does exactly.
//!
//! **Many fibres** ([`mean`]): dual scattering (Zinke et al. 2008). Light that has met fibres on its way
//! comes from a half circle of azimuths and from inclinations spread the wider, the more it has met
//! (global); and hair around a fibre throws light back (local). All averages are integrals of the same
//! lobes. Shadow maps count the mean number of fibres on the way; where hairs lie in no order, their actual
//! number has a Poisson distribution, so `exp(-n)` of the light meets none and `exp(-n (1 - a))` arrives
//! when each passes the share `a` on. (The paper raises `a` to a whole number.)
//!
//! **Spread lobes** keep their light: where the paper adds variances of Gaussians in the inclination,
//! which lose what falls beyond the poles, the normalised distribution of the lobes themselves is widened.
//!
//! **The sky** and what bodies throw: integrated over the half before and the half behind the fibre, with what
//! arrives from each as [`super::ambient`] tells. Without that, each is as open as the shadow maps of the lights
//! nearest in direction tell; towards the eye it is open, since the eye sees the fibre.
//!
//! Checked: the near field against 256 directions and four colours of Mitsuba's plugin; furnaces of the
//! near field, the tables and the shader; the shader against its twin [`FarField::scatter`]
//! (`tests/fiber.rs`). Pictures against path tracing: `docs/appearance/shading.md`.
//!
//! Untried: a fit of `density_forward` and `density_back` to path tracing (0.7 is the paper's value); the
//! position across the strip where hair is wider than pixels (near field); elliptic fibres.

pub mod bsdf;
pub mod far;
pub mod mean;
pub mod tables;

pub use bsdf::FiberShape;
pub use far::FarField;
pub use tables::FiberTables;
