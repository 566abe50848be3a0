//! Rig of the bust: joints for torso, neck and head, and blend shapes for breath, jaw and brows.
//!
//! Skin weights depend on the position on the sculpture. Along the axis of the neck they pass from torso to neck to
//! head. Skin on the form of the head, its jaw included, belongs to the head alone. Hair grows only there, so the scalp
//! stays rigid.
//!
//! A neck turns as a whole spine does: [`ROTATION_WEIGHTS`] divides a turn between the neck's joint and the head's
//! joint.

use super::{NECK_JOINT, forms::step, neck, skull};
use crate::{
    SdfGrid, TriMesh,
    rig::{
        Bind, Delta, INFLUENCES, Joint, MorphTarget, Node, Rig, Transform,
        anatomy::{Anatomy, BodyPart, DistanceFieldSource, PartForm},
    },
};
use glam::{Mat4, Quat, Vec3, vec3};

/// Joints, in the order of [`Rig::nodes`] and [`Rig::joints`]: shoulders and chest, neck, head.
pub const JOINTS: [(&str, Vec3); 3] =
    [("Torso", vec3(0.0, -0.25, -0.05)), ("Neck", NECK), ("Head", NECK_JOINT)];
/// Shares of the neck's and the head's joint in a turn of the head.
pub const ROTATION_WEIGHTS: [(u32, f32); 2] = [(1, 0.4), (2, 0.6)];
/// Names of the blend shapes: the chest rises, the jaw drops, the brows rise.
pub const SHAPES: [&str; 3] = ["Breath", "Jaw", "Brows"];

/// Pivot of the neck, meters: between the fifth and the sixth vertebra.
const NECK: Vec3 = vec3(0.0, -0.045, -0.042);
/// Axis of the neck: its foot, mm, and its direction.
const FOOT: Vec3 = vec3(0.0, -95.0, -52.0);
const UP: Vec3 = vec3(0.0, 0.980_58, 0.196_12);
/// Overlap of the fields of two neighboring parts beyond the point where they meet, mm.
const OVERLAP: f32 = 22.0;
/// Heights along the axis where neck meets torso and head meets neck, mm.
const BOUNDARY_HEIGHTS: [f32; 2] = [30.0, 86.0];

/// Returns the rig of `mesh`, a mesh of the bust ([`super::mesh`]). Poses are relative to groom space.
pub fn rig(mesh: &TriMesh) -> Rig {
    let parents = [None, Some(0), Some(1)];
    let nodes = JOINTS.iter().zip(parents).map(|((name, at), parent): (_, Option<u32>)| {
        let from = parent.map_or(Vec3::ZERO, |parent| JOINTS[parent as usize].1);
        let rest = Transform { translation: *at - from, ..Default::default() };
        Node { name: (*name).into(), parent, rest, ..Default::default() }
    });
    let joints = JOINTS
        .iter()
        .enumerate()
        .map(|(node, (_, at))| Joint { node: node as u32, inverse_bind: Mat4::from_translation(-*at) });
    let vertices = mesh.positions.iter().zip(&mesh.normals).map(|(position, normal)| {
        let mut weights = [0.0; INFLUENCES];
        weights[..3].copy_from_slice(&skin_weights(*position));
        Bind { position: *position, normal: *normal, joints: [0, 1, 2, 0, 0, 0, 0, 0], weights }
    });
    let shapes: [fn(Vec3) -> Vec3; 3] = [breath, jaw, brows];
    Rig {
        nodes: nodes.collect(),
        joints: joints.collect(),
        vertices: vertices.collect(),
        targets: SHAPES.iter().zip(shapes).map(|(name, shape)| target(name, mesh, shape)).collect(),
        animations: Vec::new(),
        to_groom: Mat4::IDENTITY,
    }
}

impl Anatomy {
    /// Returns the anatomy of the built-in character; `bust` is its distance field.
    pub fn built_in(mesh: &TriMesh, bust: &SdfGrid) -> Self {
        let [torso, neck, head] = parts(bust).map(DistanceFieldSource::Grid);
        let part = |node, field| BodyPart::new(node, field, PartForm::Field);
        Self {
            rig: rig(mesh),
            head: part(2, head),
            parts: vec![part(1, neck), part(0, torso)],
            rotation_weights: ROTATION_WEIGHTS.to_vec(),
            is_rigid: true,
        }
    }
}

/// Returns the skin weights of torso, neck and head at `p`, meters.
pub fn skin_weights(p: Vec3) -> [f32; 3] {
    let p = p * 1000.0;
    let mirrored = vec3(p.x.abs(), p.y, p.z);
    let up = (p - FOOT).dot(UP);
    // Skin on the form of the head follows the head; the weight fades where the head runs into the neck.
    let on_head = step(24.0, 5.0, skull::head(mirrored)) * step(70.0, 100.0, up);
    let head = step(56.0, 114.0, up).max(on_head);
    // Shoulders belong to the torso, however high they reach.
    let shoulder = step(45.0, 85.0, mirrored.x) * step(0.0, 25.0, neck::neck(mirrored));
    let torso = step(58.0, 2.0, up).max(shoulder) * (1.0 - head);
    [torso, 1.0 - torso - head, head]
}

/// Returns the part of the bust's field for each joint. The parts overlap where they meet.
pub fn parts(bust: &SdfGrid) -> [SdfGrid; 3] {
    let up = |p: Vec3| 0.001 * (p * 1000.0 - FOOT).dot(UP);
    let [low, high] = BOUNDARY_HEIGHTS.map(|mm| 0.001 * mm);
    let lap = 0.001 * OVERLAP;
    let part = |bottom: f32, top: f32| {
        let inside = |p: Vec3| (bottom - up(p)).max(up(p) - top);
        clipped(bust, inside)
    };
    [part(-1.0, low + lap), part(low - lap, high + lap), part(high - lap, 1.0)]
}

/// Returns the intersection of `field` with the region where `inside` is negative, cropped to it with a margin.
fn clipped(field: &SdfGrid, inside: impl Fn(Vec3) -> f32) -> SdfGrid {
    let at = |i: u32| {
        glam::uvec3(i % field.size.x, i / field.size.x % field.size.y, i / (field.size.x * field.size.y))
    };
    let both = |i: u32| field.distances[i as usize].max(inside(field.node(i)));
    let all = 0..field.size.element_product();
    // Hair samples the field some centimeters away from the surface.
    let near = all.clone().filter(|i| both(*i) < 0.02).map(at);
    let (lo, hi) = near.fold((field.size, glam::UVec3::ZERO), |(lo, hi), at| (lo.min(at), hi.max(at)));
    let hi = hi.max(lo + 1).min(field.size - 1);
    let lo = lo.min(hi);
    let size = hi - lo + 1;
    let kept = all.filter(|i| (at(*i).cmpge(lo) & at(*i).cmple(hi)).all());
    SdfGrid {
        size,
        origin: field.origin + lo.as_vec3() * field.cell,
        cell: field.cell,
        distances: kept.map(both).collect(),
    }
}

/// Returns a blend shape that adds `displacement` to each position of `mesh`.
fn target(name: &str, mesh: &TriMesh, displacement: impl Fn(Vec3) -> Vec3) -> MorphTarget {
    // Half a millimeter: the normal follows from the deformation of a small disc of skin.
    const H: f32 = 5e-4;
    let deltas = mesh.positions.iter().zip(&mesh.normals).enumerate().filter_map(|(i, (p, n))| {
        let position = displacement(*p);
        let (a, b) = n.any_orthonormal_pair();
        let along = |t: Vec3| t + (displacement(*p + H * t) - displacement(*p - H * t)) / (2.0 * H);
        let normal = along(a).cross(along(b)).normalize_or(*n) - *n;
        let is_displaced = position.length_squared() > 1e-12 || normal.length_squared() > 1e-8;
        is_displaced.then_some(Delta { vertex: i as u32, position, normal })
    });
    MorphTarget { name: name.into(), deltas: deltas.collect() }
}

/// Breath: ribs move out and up, and the shoulders rise.
fn breath(p: Vec3) -> Vec3 {
    let q = p * 1000.0;
    let low = step(-70.0, -150.0, q.y);
    let front = step(-90.0, 20.0, q.z);
    low * vec3(0.012 * q.x, 2.6, 1.5 + 3.5 * front) * 0.001
}

/// Jaw: drops by 9 degrees about the axis through its joints in front of the ears. Lips part where they meet; cheeks
/// and chin follow from there.
fn jaw(p: Vec3) -> Vec3 {
    const HINGE: Vec3 = vec3(0.0, 66.0, 8.0);
    let q = p * 1000.0;
    let x = q.x.abs();
    // The line where the lips meet, which bends back to the corners and from there to the hinge.
    let seam = 43.6 + 0.0025 * x * x;
    let back = step(92.0, 20.0, q.z);
    let line = seam + (HINGE.y - seam) * back;
    let soft = 1.2 + 26.0 * step(14.0, 40.0, x).max(back);
    let below = step(0.0, soft, line - q.y);
    // The neck stays.
    let on_head = step(20.0, 2.0, skull::head(vec3(x, q.y, q.z)));
    let front = step(5.0, 40.0, q.z);
    let weight = below * on_head * front;
    let rotated = HINGE + Quat::from_rotation_x(9f32.to_radians() * weight) * (q - HINGE);
    (rotated - q) * 0.001
}

/// Brows: rise by 6 mm and fold the forehead above them.
fn brows(p: Vec3) -> Vec3 {
    let q = p * 1000.0;
    let x = q.x.abs();
    // The same arch as the brow ridge of the sculpture.
    let arch = 131.0 - 0.009 * (x - 33.0) * (x - 33.0);
    let up = step(arch - 12.0, arch - 1.0, q.y) * step(arch + 32.0, arch + 4.0, q.y);
    let along = step(56.0, 40.0, x) * step(30.0, 65.0, q.z);
    up * along * vec3(0.0, 6.0, -0.9) * 0.001
}

#[cfg(test)]
#[path = "rig_tests.rs"]
mod tests;
