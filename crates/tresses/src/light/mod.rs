//! Light on hair: how much of it arrives, and what comes back.
//!
//! ```text
//! strand vertices ─┬─► hair maps (each light that is on)   ─► fibres ─► shading ─► shaded
//! body ────────────┴─► depth maps, a layer each ──────────────────► solid    per vertex   per vertex
//!                                                                             or per pixel
//! ```
//!
//! **Lights** ([`Lights`]): four from afar and a sky. What is off has neither a map nor a turn of a loop.
//!
//! **Shadow** ([`ShadowMaps`]): one orthographic map per light, and one from the zenith where light from all
//! sides is guessed, not followed. The body is rasterised into a depth texture; hair, which is thinner than
//! a texel, is walked into a buffer by kernels, one thread per segment. What comes out is a count, not a
//! share: the mean number of fibres between a light and a point, so that every model of shading may take
//! of each what it needs (`transmittance.wesl`). Bodies in between are a factor of their own. Three
//! methods ([`ShadowMethod`]) answer, all from the same buffer:
//!
//! - *Deep opacity maps*: `splat` leaves the nearest hair in each texel, `front` smooths it into a
//!   front that no single hair moves, `cover` adds width times length over area of every segment, in
//!   fixed point, to the layer behind the front that it is in, `stack` sums the layers up. A lookup is a
//!   quadratic B-spline over three by three texels. `deep.wesl` has the layers: eight, 4 mm and thicker
//!   with the distance behind the front (Yuksel and Keyser take powers of a given depth; logarithms
//!   need no depth and erred less).
//! - *Absorption* and *opaque*: `splat` alone; a spline over nine by nine texels, each of which passes
//!   `exp(-density * way behind the hair nearest the light)`, the density a given one (Halen) or that of
//!   something solid. For the body `blocks` sums the texels up.
//!
//! The hair's texels are as large as the shadow is soft, and every texel under the filter is met: that
//! is why shadows do not crawl when a light turns (`tests/shadows`), and why the maps are small.
//!
//! **Shade** ([`State::shade`]): one thread per strand vertex asks for all lights and, unless pixels are to be
//! shaded, evaluates the whole radiance. Both are interpolated along the strand. Eight bytes per vertex.
//!
//! **Shading** (`shading.wesl`): two models, chosen by [`ShadingModel`], from the same fibre, eye, light and
//! count of fibres, so that a kernel and a fragment shader share them. *Fiber* refracts, absorbs and
//! scatters: see [`fiber`]. *Kajiya and Kay* is set by eye: two highlights whose tangents are shifted per
//! lock and per strand, sharp glints in the first, a lobe of light that shines through from behind.
//!
//! **Surroundings** ([`Environment`], [`Sky`]): three colours by elevation, or a picture as spherical
//! harmonics; its small bright parts become directional lights, with shadows.
//!
//! **All sides** ([`ambient`]): how open the sky is in the hair, and what the body throws on it, in a grid of
//! cells that light is followed through. Hair and body ask it instead of guessing.
//!
//! Not taken: filters of a few turned taps (they trembled twelve times as much as hair in a turning
//! light truly does), uniform slices (48 of them hardly erred less than these eight). Untried: moments
//! instead of layers.

pub mod ambient;
mod asked;
pub mod environment;
pub mod fiber;
pub mod hair;
pub mod lights;
pub mod material;
mod pipelines;
pub mod probe;
pub mod shadow;
pub mod shadows;
pub mod state;
pub mod terms;

pub use ambient::Ambient;
pub use environment::Environment;
pub(crate) use hair::Seen;
pub use hair::{HairSet, Shaded};
pub use lights::{Directional, Lights, MAX_LIGHTS, Sky, Sphere};
pub use material::{FiberMaterial, HairMaterial, ShadingModel, ShadingRate};
use pipelines::FRAME;
pub use pipelines::Pipelines;
pub use probe::{Shadow, ShadowProbe};
pub use shadow::ShadowMaps;
pub use shadows::{ShadowMethod, Shadows};
pub(crate) use state::Lit;
pub use state::State;
pub use terms::{Term, Terms};
