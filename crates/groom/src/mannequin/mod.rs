//! The built-in character: a shop-window mannequin's bust, modelled as a signed distance field.
//!
//! The sculpture is built as a sculptor would: first the big forms (the egg of the cranium, the wedge of
//! the face, neck, shoulders), then the planes, then the features. Each is a solid of a few hand-set
//! numbers, and they are joined with fillets. The same field is the hair's collider, so hair collides with
//! exactly what is seen.
//!
//! Groom space: metres, Y up, face towards +Z, the character's left at +X, and the two halves are mirror
//! images. `y = 0` is the underside of the chin, `x = z = 0` the axis through the ears; the skull's centre
//! is [`SKULL_CENTRE`]. Inside the modules the unit is the millimetre, which is how one thinks of a face.
//!
//! Why not a mesh in a file? It would have to come from someone else, and hair needs the field anyway. The
//! results for the most used resolutions are stored in a file of our own ([`cook`]).

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
use forms::{join, meet};
use glam::{Vec3, vec3};

/// A good resolution for [`mesh`]: cells of 1.9 mm in the face, about 130,000 triangles.
pub const RESOLUTION: u32 = 160;
/// Nodes along the longest axis of the field, [`sdf`], that the built-in styles grow on and collide with.
pub const FIELD_RESOLUTION: u32 = 96;
/// The middle of the cranium, metres: rays from here meet the scalp once.
pub const SKULL_CENTRE: Vec3 = vec3(0.0, 0.130, -0.010);
/// The joint about which the head nods and turns, metres: the top of the spine, between the ears.
pub const NECK_JOINT: Vec3 = vec3(0.0, 0.055, -0.022);
/// The highest point of the head, metres.
pub const CROWN: Vec3 = vec3(0.0, 0.2236, -0.010);
/// The middle of the brow, metres.
pub const BROW: Vec3 = vec3(0.0, 0.130, 0.093);
/// The left eye, on the closed lid, metres.
pub const EYE: Vec3 = vec3(0.0315, 0.110, 0.0812);
/// The tip of the nose, metres.
pub const NOSE_TIP: Vec3 = vec3(0.0, 0.0755, 0.1115);
/// Where the lips meet, metres.
pub const MOUTH: Vec3 = vec3(0.0, 0.044, 0.0975);
/// The lowest point of the chin, metres.
pub const CHIN: Vec3 = vec3(0.0, 0.0024, 0.080);
/// The left ear, in front of its bowl, metres.
pub const EAR: Vec3 = vec3(0.0743, 0.085, 0.003);
/// Where the rim of the left ear meets the head above, metres.
pub const EAR_TOP: Vec3 = vec3(0.0761, 0.116, -0.005);
/// The nape of the neck, where the hair ends, metres.
pub const NAPE: Vec3 = vec3(0.0, 0.045, -0.0776);
/// The landmarks that hairstyles are measured from.
pub const LANDMARKS: Landmarks =
    Landmarks { skull: SKULL_CENTRE, brow: BROW, chin: CHIN, ear: EAR, nape: NAPE };

/// The signed distance from `p` to the bust's surface, metres, negative inside. Near the surface it is true
/// within a few percent, in the creases where two forms meet up to 40 % short; far away it is at
/// most a fifth too long.
pub fn distance(p: Vec3) -> f32 {
    let p = vec3(p.x.abs(), p.y, p.z) * 1000.0;
    let neck = neck::neck(p);
    // The shoulders end where they can no longer touch what is above them.
    let body = if p.y - shoulders::TOP > neck + 40.0 { neck } else { join(neck, shoulders::torso(p), 40.0) };
    let body = meet(body, shoulders::cut(p), 18.0);
    // Nor does the head reach below its own ball.
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
