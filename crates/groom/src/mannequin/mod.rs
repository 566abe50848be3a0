//! The built-in character: a mannequin's bust, modeled as a signed distance field.
//!
//! The sculpture is built from large to small: first the big forms (the egg of the cranium, the wedge of the face,
//! neck, shoulders), then the planes, then the features. Each is a solid of a few hand-set numbers, and fillets join
//! them. The same field is the hair's collider, so hair collides with the visible surface.
//!
//! Groom space: meters, Y up, face toward +Z, the character's left at +X. The two halves are mirror images. `y = 0` is
//! the underside of the chin, `x = z = 0` the vertical axis between the ears. The center of the skull is
//! [`SKULL_CENTER`]. Inside the modules the unit is the millimeter.
//!
//! A mesh from a file would need a third party, and hair needs the field anyway. The results for the most used
//! resolutions are stored in a file ([`cook`]).

mod cooked;
mod ears;
mod face;
pub mod facial;
mod forms;
mod meshing;
mod model;
mod neck;
pub mod rig;
mod scalp;
mod shoulders;
mod skull;
#[cfg(test)]
mod tests;

pub(crate) use cooked::STEP;
pub use cooked::cook;
pub use model::{mesh, mesh_with, sdf, sdf_with};
pub use scalp::scalp_point;

use crate::scalp::Landmarks;
use forms::{intersect, join};
use glam::{Vec3, vec3};

/// Recommended resolution for [`mesh`]: cells of 1.9 mm in the face, about 130,000 triangles.
pub const RESOLUTION: u32 = 160;
/// Nodes along the longest axis of the field [`sdf`] that the built-in styles grow on and collide with.
pub const FIELD_RESOLUTION: u32 = 96;
/// Center of the cranium, meters. Rays from here meet the scalp once.
pub const SKULL_CENTER: Vec3 = vec3(0.0, 0.130, -0.010);
/// Pivot of the head's nods and turns, meters: the top of the spine, between the ears.
pub const NECK_JOINT: Vec3 = vec3(0.0, 0.055, -0.022);
/// Highest point of the head, meters.
pub const CROWN: Vec3 = vec3(0.0, 0.2236, -0.010);
/// Middle of the brow, meters.
pub const BROW: Vec3 = vec3(0.0, 0.130, 0.093);
/// Left eye, on the closed lid, meters.
pub const EYE: Vec3 = vec3(0.0315, 0.110, 0.0812);
/// Tip of the nose, meters.
pub const NOSE_TIP: Vec3 = vec3(0.0, 0.0755, 0.1115);
/// Middle of the line between the lips, meters.
pub const MOUTH: Vec3 = vec3(0.0, 0.044, 0.0975);
/// Lowest point of the chin, meters.
pub const CHIN: Vec3 = vec3(0.0, 0.0024, 0.080);
/// Left ear, in front of its bowl, meters.
pub const EAR: Vec3 = vec3(0.0743, 0.085, 0.003);
/// Point where the rim of the left ear meets the head above, meters.
pub const EAR_TOP: Vec3 = vec3(0.0761, 0.116, -0.005);
/// Nape of the neck, at the end of the hair, meters.
pub const NAPE: Vec3 = vec3(0.0, 0.045, -0.0776);
/// Landmarks for the hairstyles.
pub const LANDMARKS: Landmarks =
    Landmarks { skull: SKULL_CENTER, brow: BROW, chin: CHIN, ear: EAR, nape: NAPE };

/// Returns the signed distance from `p` to the surface of the bust, meters, negative inside. Near the surface it is
/// accurate within a few percent; in creases where two forms meet, it is up to 40% short. Far away it is at most a
/// fifth too long.
pub fn distance(p: Vec3) -> f32 {
    let p = vec3(p.x.abs(), p.y, p.z) * 1000.0;
    let neck = neck::neck(p);
    // Skip the shoulders where they are too low to have an effect.
    let body = if p.y - shoulders::TOP > neck + 40.0 { neck } else { join(neck, shoulders::torso(p), 40.0) };
    let body = intersect(body, shoulders::cut(p), 18.0);
    // Skip the head outside of its bounding sphere.
    if (p - vec3(0.0, 112.0, 0.0)).length() - 150.0 > body + 18.0 {
        return body * 0.001;
    }
    let head = skull::head(p);
    // Features and ears add less than 60 mm to the bare head.
    if head > body + 80.0 {
        return body * 0.001;
    }
    let head = join(face::features(p, head), ears::ear(p), 6.0);
    join(head, body, 18.0) * 0.001
}
