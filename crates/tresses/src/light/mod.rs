//! Light on hair: shadows, ambient light and shading.
//!
//! ```text
//! strand vertices ─┬─► hair maps (each light that is on)   ─► fibers ─► shading ─► shaded
//! mesh ────────────┴─► depth maps, a layer each ──────────────────► solid    per vertex   per vertex
//!                                                                             or per pixel
//! ```
//!
//! **Lights** ([`Lights`]): four directional lights and a sky. A light that is off has no map and costs no loop
//! iteration.
//!
//! **Shadows** (`ShadowMaps`): one orthographic map per light, and one from the zenith where ambient light is
//! estimated instead of computed. Meshes are rasterized into a depth texture. Hair is thinner than a texel; kernels
//! draw it into a buffer, one thread per segment. The result is a fiber count, not a transmittance: the mean number of
//! fibers between a light and a point, from which each shading model derives its terms (`transmittance.wesl`). Meshes
//! on the way are a separate factor. There are three methods ([`ShadowMethod`](crate::renderer::ShadowMethod)), which
//! use the same buffer:
//!
//! - *Deep opacity maps*: `splat` stores the nearest hair in each texel. `front` smooths it into the first depth layer,
//!   which no single hair moves. `cover` adds the width times length of every segment over the texel area, in fixed
//!   point, to the segment's layer. `stack` accumulates the layers. A lookup is a quadratic B-spline over 3×3 texels.
//!   There are eight layers (`deep.wesl`), 4 mm thick at first and thicker with depth. (Yuksel and Keyser use powers of
//!   a given depth; logarithms need no depth and had less error.)
//! - *Absorption* and *opaque*: `splat` alone. A lookup is a spline over 9×9 texels, each of which transmits
//!   `exp(-density * distance behind the hair nearest the light)`. The density is a setting (Halen), or a constant for
//!   solid hair. For meshes `blocks` sums the texels.
//!
//! Texels of the hair maps are as large as the shadow is soft, and the filter reads every texel that it covers.
//! Therefore shadows do not crawl when a light turns (`tests/gpu/shadows`), and the maps are small.
//!
//! With more than 8,192 strands, every n-th is added to the layers, with the weight of all; the count is smooth anyway.
//! Two segments are added as one arc. (A chord would lie half a millimeter deeper on a round head, and visible hair
//! would get a tenth more light.) A step adds to two texels of each column, with half the atomic additions that four
//! texels around each point would take.
//!
//! *Strand maps* are optional per view. They store which strand is nearest each light (`nearest.wesl`). `strand_map`
//! draws them after the layers, and leaves out hair that lies too deep in those. `shade` reads them at each vertex
//! (`strand_light.wesl`).
//!
//! **Shading rate**: light that arrives, ambient light and light scattered by other fibers vary slowly along a strand.
//! They are evaluated at *shading samples*: the ends of eight spans, or every third vertex
//! (`shading_samples.wesl`, 8 bytes each), and up to three times as many where strands represent others at a level of
//! detail. Highlights and colors vary fast; `shade.wesl` adds them at each vertex, with four bytes of output
//! (`radiance`). With `ShadingSubset`, only visible hair is shaded: `select_visible.wesl` lists samples and spans, and
//! both kernels run over the lists. For shading per pixel, `arrive.wesl` looks up the shadows of every vertex instead.
//!
//! **Shading models** (`shading.wesl`, [`ShadingModel`](crate::renderer::ShadingModel)): both have the same inputs,
//! fiber, eye, light and fiber count, so that a kernel and a fragment shader share the code. *Fiber* refracts, absorbs
//! and scatters: see `fiber`. *Kajiya and Kay* is set by eye: two highlights whose tangents are shifted per lock and
//! per strand, sharp glints in the first, and a lobe of light from behind.
//!
//! **Environments** ([`Environment`], [`Sky`]): three colors by elevation, or an environment map as spherical
//! harmonics, of which bright regions become directional lights with shadows. The GPU measures cube maps of
//! engines ([`CubeProbe`](cube::CubeProbe)).
//!
//! **Ambient light** (`ambient`): sky visibility within the hair, and the light that meshes reflect onto it,
//! propagated through a grid of cells. Hair and meshes read it.
//!
//! **Zones** (`zone`): the heads of a crowd have their own maps and grids, with a resolution that suits their size on
//! screen.
//!
//! Rejected: filters of a few rotated taps (under a turning light they jittered twelve times as much as the exact
//! shadow); uniform slices (48 of them had hardly less error than these eight layers). Untried: moments instead of
//! layers.

pub(crate) mod ambient;
pub(crate) mod ambient_probe;
pub(crate) mod cards;
pub(crate) mod cube;
mod environment;
pub(crate) mod fiber;
mod frame;
pub(crate) mod hair;
#[allow(clippy::module_inception)]
mod light;
mod lights;
pub(crate) mod material;
mod pipelines;
mod point_query;
pub(crate) mod probe;
pub(crate) mod radiance;
mod record;
pub(crate) mod scene;
pub(crate) mod shading_subset;
pub(crate) mod shadow;
mod shadows;
pub(crate) mod state;
pub(crate) mod zone;

pub(crate) use ambient::Ambient;
pub use environment::Environment;
pub(crate) use frame::FrameLight;
pub(crate) use hair::{HairSet, HairShading, HairView};
pub use light::{Light, LightShape};
pub use lights::{Lights, Sky, Sphere};
pub use material::{FiberMaterial, HairMaterial};
pub(crate) use pipelines::Pipelines;
pub(crate) use scene::ImportedShadows;
pub use scene::SceneShadow;
pub(crate) use shading_subset::ShadingSubset;
pub(crate) use shadow::ShadowMaps;
pub use shadows::Shadows;
pub(crate) use state::LightState;
pub(crate) use zone::{Part, Zone, Zones};
