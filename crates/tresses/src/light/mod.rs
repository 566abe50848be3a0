//! Light on hair: shadows, ambient light and shading.
//!
//! ```text
//! list of lights ──► selection ─► maps of the strongest; all others ─► grid of ambient light
//! strand vertices ─┬─► hair maps (each light with a map)   ─► fibers ─► shading ─► shaded
//! mesh ────────────┴─► depth maps, a layer each ──────────────────► solid    per vertex   per vertex
//!                                                                             or per pixel
//! ```
//!
//! **Lights** ([`Lights`]): a list of lights of any [shape](LightShape), a sky and an environment. Per zone, the lights
//! with the most irradiance get shadow maps; a light that hardly beats the next one fades between its map and the grid,
//! so that the choice never jumps (`Lights::select`). Direction and irradiance are evaluated at each shading sample and
//! vertex (`light.wesl`). Shaders have variants (`LIGHT_OPTIONS`): a frame whose lights are all distant and have maps
//! uses code without anything else, and costs what it cost before there were other lights.
//!
//! **Extent.** The size of an area light adds a variance to the inclination and azimuth of its light, which widens the
//! narrow lobes. Its shadow is averaged over eight points of the light (`transmittance::Penumbra`).
//!
//! **Shadows** (`ShadowMaps`): one map per light, and one from the zenith where ambient light is estimated instead of
//! computed. A map has one view, or six for a light within the hair (`map_view`). Maps are drawn again only if their
//! lights, hair or meshes have changed. Meshes are rasterized into a depth texture. Hair is thinner than a texel; kernels
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
//! screen. Hair and meshes of other zones that lie between a zone and a light are drawn into its maps as well, all in
//! front of its own hair.
//!
//! Rejected: directions and irradiance evaluated once per head, which is wrong for a lamp at arm's length; lights in
//! tiles or clusters, since hair is shaded at samples, not at pixels; filters of a few rotated taps (under a turning light they jittered twelve times as much as the exact
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
mod map_view;
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
mod sphere;
pub(crate) mod state;
pub(crate) mod zone;

pub(crate) use ambient::Ambient;
pub use environment::Environment;
pub(crate) use frame::FrameLight;
pub(crate) use hair::{HairSet, HairShading, HairView};
pub use light::{Light, LightShape};
pub use lights::{Lights, Sky};
pub use material::{FiberMaterial, HairMaterial};
pub(crate) use pipelines::Pipelines;
pub(crate) use scene::ImportedShadows;
pub use scene::SceneShadow;
pub(crate) use shading_subset::ShadingSubset;
pub(crate) use shadow::{Casters, ShadowMaps};
pub use shadows::Shadows;
pub use sphere::Sphere;
pub(crate) use state::LightState;
pub(crate) use zone::{Part, Zone, Zones};
