//! Light on hair: how much of it arrives, and what comes back.
//!
//! ```text
//! strand vertices ─┬─► shadow maps (key, rim, above) ─► transmittance ─► shading ─► shaded
//! body ────────────┘   depth, one layer per light       per vertex       per vertex
//!                                                                        or per pixel
//! ```
//!
//! **Shadow** ([`ShadowMaps`]): one orthographic map per light. The body is rasterised into a depth
//! texture; hair, which is thinner than a texel, is walked into a buffer by a kernel, one thread
//! per segment, with an atomic maximum. What is stored is the surface nearest the light; hair
//! behind hair passes `exp(-absorption * way)` of the light, averaged over a disk (Halen's
//! absorption-weighted filter), hair behind the body none. For the body, blocks of texels hold how
//! much hair there is and how high: smooth skin wants smooth shadows. The third map looks down
//! from the zenith and, with the two others, tells how open the sky is.
//!
//! **Shade** ([`Shade`]): one thread per strand vertex evaluates the three transmittances and,
//! unless pixels are to be shaded, the whole radiance. Both are interpolated along the strand,
//! which hides the texels of the maps. Eight bytes per vertex.
//!
//! **Shading** (`shading.wesl`): Kajiya and Kay's fibre with two highlights whose tangents are
//! shifted per lock and per strand, sharp glints in the first, a lobe of light that shines through from behind, and the sky. Functions of
//! tangent, light, eye and strand only, so that a kernel and a fragment shader share them.
//!
//! Not taken: deep opacity maps (a chapter of their own; the seam is `hair_transmittance`), dual
//! scattering (needs a count of fibres, not a way through them).

pub mod fiber;
pub mod lights;
pub mod material;
pub mod shade;
pub mod shadow;
pub mod shadows;

pub use lights::{Directional, Lights, MAX_LIGHTS, Sky, Sphere};
pub use material::{FiberMaterial, HairMaterial, ShadingModel, ShadingRate};
pub use shade::Shade;
pub use shadow::ShadowMaps;
pub use shadows::{ShadowMethod, Shadows};
