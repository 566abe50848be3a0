//! Light on hair: shadows, ambient light and shading.
//!
//! ```text
//! strand vertices ─┬─► hair maps (each light that is on)   ─► fibres ─► shading ─► shaded
//! body ────────────┴─► depth maps, a layer each ──────────────────► solid    per vertex   per vertex
//!                                                                             or per pixel
//! ```
//!
//! **Lights** ([`Lights`]): four directional lights and a sky. A light that is off has neither a map nor a loop iteration.
//!
//! **Shadow** ([`ShadowMaps`]): one orthographic map per light, and one from the zenith where ambient
//! light is estimated, not computed. The body is rasterised into a depth texture; hair, which is thinner than
//! a texel, is drawn into a buffer by kernels, one thread per segment. The result is a fibre count, not a
//! transmittance: the mean number of fibres between a light and a point, from which each shading model derives
//! what it needs (`transmittance.wesl`). Bodies in between are a separate factor. There are three methods
//! ([`ShadowMethod`]), all with the same buffer:
//!
//! - *Deep opacity maps*: `splat` stores the nearest hair in each texel, `front` smooths it into a
//!   front that no single hair moves, `cover` adds width times length over area of every segment, in
//!   fixed point, to its layer behind the front, `stack` accumulates the layers. A lookup is a
//!   quadratic B-spline over three by three texels. `deep.wesl` has the layers: eight, 4 mm and thicker
//!   with the distance behind the front (Yuksel and Keyser take powers of a given depth; logarithms
//!   need no depth and erred less).
//! - *Absorption* and *opaque*: `splat` alone; a spline over nine by nine texels, each of which transmits
//!   `exp(-density * distance behind the hair nearest the light)`, with a given density (Halen) or that of a
//!   solid. For the body `blocks` sums the texels.
//!
//! The hair's texels are as large as the shadow is soft, and the filter reads every texel under it: that is
//! why shadows do not crawl when a light turns (`tests/gpu/shadows`), and why the maps are small.
//!
//! Of more than 8,192 strands every n-th lies in the layers, with the weight of all: the count is smooth anyway. Two
//! segments lie there as one arc (as a chord they would lie half a millimetre deeper on a round head, and what is seen
//! would be lit by a tenth more), two texels to a column, which takes half the atomic additions of four about each step.
//!
//! *Strand maps*, where a view asks for them, know which strand is nearest each light (`nearest.wesl`): `strand_map` draws
//! them after the layers, which tell it what lies too deep, and `shade` asks them at each vertex (`strand_light.wesl`).
//!
//! **Shade**: what arrives of the lights, ambient light and what other fibres scatter vary slowly along a strand and are
//! evaluated at its *knots*, eight spans or every third vertex (`knots.wesl`, 8 bytes each), up to three times as many
//! where strands stand for others at a level of detail; highlights and colours do not: `shade.wesl` adds them vertex by
//! vertex. Four bytes per vertex ([`radiance`]). With [`Chosen`] only what is seen is shaded: `choose.wesl` lists knots and spans, and
//! both kernels run over the lists. Where shading is per pixel, `arrive.wesl` looks up the shadows of every vertex instead.
//!
//! **Shading** (`shading.wesl`): two models, chosen by [`ShadingModel`], from the same fibre, eye, light and
//! fibre count, so that a kernel and a fragment shader share them. *Fiber* refracts, absorbs and
//! scatters: see [`fiber`]. *Kajiya and Kay* is set by eye: two highlights whose tangents are shifted per
//! lock and per strand, sharp glints in the first, a lobe of light that shines through from behind.
//!
//! **Environments** ([`Environment`], [`Sky`]): three colours by elevation, or a picture as spherical
//! harmonics; its small bright parts become directional lights, with shadows. Cube maps of engines are measured on the GPU
//! ([`CubeProbe`]).
//!
//! **Ambient light** ([`ambient`]): the visibility of the sky within the hair and the light that the body
//! reflects onto it, propagated through a grid of cells and read by hair and body.
//!
//! **Zones** ([`zone`]): heads of a crowd have maps and a grid each, as fine as they are seen.
//!
//! Rejected: filters of a few rotated taps (under a turning light they jittered twelve times as much as the
//! exact shadow), uniform slices (48 of them had hardly less error than these eight). Untried: moments instead
//! of layers.

pub mod ambient;
mod asked;
pub mod chosen;
pub mod cube;
pub mod environment;
pub mod fiber;
pub mod hair;
pub mod lights;
pub mod material;
mod pipelines;
pub mod probe;
pub mod radiance;
pub mod scene;
pub mod shadow;
pub mod shadows;
pub mod state;
pub mod terms;
pub mod zone;

pub use ambient::Ambient;
pub use chosen::Chosen;
pub use cube::{CubeLight, CubeMap, CubeProbe};
pub use environment::Environment;
pub(crate) use hair::Seen;
pub use hair::{HairSet, Shaded};
pub use lights::{Directional, Lights, MAX_LIGHTS, Sky, Sphere};
pub use material::{FiberMaterial, HairMaterial, ShadingModel, ShadingRate};
pub(crate) use pipelines::{FRAME, Pipelines};
pub use probe::{Shadow, ShadowProbe};
pub use radiance::unpack_radiance;
pub(crate) use scene::Brought;
pub use scene::SceneShadow;
pub use shadow::ShadowMaps;
pub use shadows::{ShadowMethod, Shadows};
pub(crate) use state::Lit;
pub use state::State;
pub use terms::{Term, Terms};
pub use zone::Zone;
pub(crate) use zone::{Part, Zones};
