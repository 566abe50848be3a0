//! Skinned meshes on the GPU match the CPU.

use crate::common;
use tresses::{
    Body, Context,
    glam::{Mat4, Quat, Vec3},
    groom::{
        TriMesh, import,
        mesh::shapes,
        rig::{Bind, Delta, Joint, MorphTarget, Node, Rig, RigPose},
    },
    low_level::readback::blocking as readback,
    skinning::Skinning,
};

/// Skins a mesh on the GPU. Returns positions and normals.
fn bent(context: &Context, mesh: &TriMesh, rig: &Rig, pose: &RigPose) -> (Vec<Vec3>, Vec<Vec3>) {
    let mut body = Body::with_levels(context, mesh, &[], 4);
    let mut skinning = Skinning::new(context, rig, &body).unwrap();
    skinning.pose(pose, &mut body).unwrap();
    common::submit(|recorder| recorder.bend(&[&skinning]));
    let words: Vec<f32> = readback::buffer(context, body.vertices()).unwrap();
    let vertices = words.as_chunks::<{ Body::WORDS as usize }>().0;
    let three = |at: usize| vertices.iter().map(|v| Vec3::from_slice(&v[at..])).collect();
    (three(0), three(3))
}

/// Returns the largest differences: positions between GPU and CPU (meters), normals (chord), and positions from rest
/// (meters).
fn off(context: &Context, mesh: &TriMesh, rig: &Rig, pose: &RigPose) -> [f32; 3] {
    let (positions, normals) = bent(context, mesh, rig, pose);
    let mut twin = mesh.clone();
    rig.deform(pose, &mut twin);
    let most = |a: &[Vec3], b: &[Vec3]| {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
    };
    [most(&positions, &twin.positions), most(&normals, &twin.normals), most(&positions, &mesh.positions)]
}

/// Returns a ball of radius 30 cm with nine joints, up to eight per vertex, and three blend shapes.
fn knotted() -> (TriMesh, Rig) {
    let mut mesh = shapes::sphere(0.3, 20);
    mesh.compute_normals();
    let node = |i: u32| Node { name: format!("{i}"), ..Default::default() };
    let bind = |(i, position): (usize, &Vec3)| {
        let share = |k: usize| if k <= i % 8 { 1.0 + ((i + k) as f32).sin().abs() } else { 0.0 };
        let weights: [f32; 8] = std::array::from_fn(share);
        let sum: f32 = weights.iter().sum();
        let joints = std::array::from_fn(|k| ((i + 2 * k) % 9) as u16);
        Bind { position: *position, normal: mesh.normals[i], joints, weights: weights.map(|w| w / sum) }
    };
    let target = |s: usize| MorphTarget {
        name: format!("shape {s}"),
        deltas: (0..mesh.positions.len() as u32)
            .filter(|v| *v as usize % 3 != s)
            .map(|vertex| {
                let way = Vec3::new((vertex as f32).sin(), s as f32 - 1.0, (vertex as f32).cos());
                Delta { vertex, position: 0.05 * way, normal: 0.3 * way }
            })
            .collect(),
    };
    let rig = Rig {
        nodes: (0..9).map(node).collect(),
        joints: (0..9).map(|node| Joint { node, inverse_bind: Mat4::IDENTITY }).collect(),
        vertices: mesh.positions.iter().enumerate().map(bind).collect(),
        targets: (0..3).map(target).collect(),
        ..Default::default()
    };
    (mesh, rig)
}

/// Returns a pose that rotates, translates and scales. With `mirrors`, the joints also mirror.
fn pose(mirrors: bool) -> RigPose {
    let matrix = |i: usize| {
        let t = i as f32;
        let scale = Vec3::new(1.0 + 0.2 * t.sin(), 0.8, if mirrors { -1.0 } else { 1.0 });
        let turn = Quat::from_rotation_y(0.2 * t) * Quat::from_rotation_x(0.1 * t);
        Mat4::from_scale_rotation_translation(scale, turn, Vec3::new(0.05 * t, 0.1, 0.0))
    };
    RigPose { palette: (0..9).map(matrix).collect(), weights: vec![0.5, -0.7, 1.0], ..Default::default() }
}

#[test]
fn gpu_skinning_matches_the_cpu() {
    let Some(context) = common::context() else { return };
    let (mesh, rig) = knotted();
    for mirrors in [false, true] {
        let pose = pose(mirrors);
        let [position, normal, moved] = off(context, &mesh, &rig, &pose);
        println!("mirrored {mirrors}: {position:.1e} m, normals {normal:.1e}, moved by {moved:.2} m");
        assert!(position < 2e-5 && normal < 2e-4 && moved > 0.1);
    }
    // A change of one joint or of one weight of a blend shape is detected.
    let right = pose(false);
    let (seen, _) = bent(context, &mesh, &rig, &right);
    let differs = |rig: &Rig, pose: &RigPose| {
        let mut twin = mesh.clone();
        rig.deform(pose, &mut twin);
        seen.iter().zip(&twin.positions).any(|(a, b)| a.distance(*b) > 1e-3)
    };
    let mut other = rig.clone();
    other.vertices[40].joints.swap(0, 1);
    other.vertices[40].weights = [0.9, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!(differs(&other, &right));
    assert!(differs(&rig, &RigPose { weights: vec![0.5, -0.7, 0.9], ..right.clone() }));
    assert!(!differs(&rig, &right));
}

#[test]
fn imported_characters_match_the_cpu() {
    let Some(context) = common::context() else { return };
    for name in ["CesiumMan", "RobotExpressive"] {
        let Some(path) = common::asset(format!("characters/{name}.glb")) else { return };
        let import::ImportedBody { mesh, rig, .. } = import::read_body(&[path], &Default::default()).unwrap();
        let rig = rig.expect("it bends");
        for animation in &rig.animations {
            let morphs: Vec<_> = (0..rig.targets.len()).map(|i| (i, 0.4)).collect();
            let pose = rig.pose_with(Some((animation, 0.37 * animation.length)), &morphs);
            let [position, normal, _] = off(context, &mesh, &rig, &pose);
            // The robot is 4.5 m tall.
            assert!(position < 1e-4 && normal < 2e-3, "{name} {}: {position} m, {normal}", animation.name);
        }
    }
}

#[test]
fn mismatched_rigs_are_errors() {
    let Some(context) = common::context() else { return };
    let (mesh, rig) = knotted();
    let mut body = Body::with_levels(context, &mesh, &[], 4);
    let refused = |rig: &Rig| Skinning::new(context, rig, &body).unwrap_err().to_string();
    assert!(
        refused(&Rig { vertices: rig.vertices[1..].to_vec(), ..rig.clone() })
            .contains("does not match the body")
    );
    assert!(refused(&Rig { joints: rig.joints[..5].to_vec(), ..rig.clone() }).contains("missing joint"));
    let mut lost = rig.clone();
    lost.targets[0].deltas[0].vertex = 1 << 20;
    assert!(refused(&lost).contains("missing vertex"));
    let mut skinning = Skinning::new(context, &rig, &body).unwrap();
    let few = RigPose { weights: vec![], ..pose(false) };
    assert!(skinning.pose(&few, &mut body).unwrap_err().to_string().contains("does not match"));
}
