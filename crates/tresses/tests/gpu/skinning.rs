//! Bodies that bend, on the GPU as on the CPU.

use crate::common;
use tresses::{
    Context,
    body::Body,
    glam::{Mat4, Quat, Vec3},
    gpu::readback::blocking as readback,
    groom::{
        TriMesh, import,
        mesh::shapes,
        rig::{Bind, Delta, Joint, Node, Rig, RigPose, Target},
    },
    skinning::Skinning,
};

/// What the GPU makes of a body in a pose: positions and normals.
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

/// How far the GPU is from the CPU: positions (metres), normals (their chord), and positions from those at rest.
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

/// A ball of 30 cm that follows nine joints, up to eight at a vertex, and has three shapes.
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
    let target = |s: usize| Target {
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

/// Turns, shifts, stretches; one joint mirrors.
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
fn skinning_is_as_on_the_cpu() {
    let Some(context) = common::context() else { return };
    let (mesh, rig) = knotted();
    for mirrors in [false, true] {
        let pose = pose(mirrors);
        let [position, normal, moved] = off(context, &mesh, &rig, &pose);
        println!("mirrored {mirrors}: {position:.1e} m, normals {normal:.1e}, moved by {moved:.2} m");
        assert!(position < 2e-5 && normal < 2e-4 && moved > 0.1);
    }
    // One weight, one shape, one joint: each is seen.
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
fn characters_of_other_makers_bend_as_on_the_cpu() {
    let Some(context) = common::context() else { return };
    for name in ["CesiumMan", "RobotExpressive"] {
        let Some(path) = common::asset(format!("characters/{name}.glb")) else { return };
        let import::Body { mesh, rig, .. } = import::read_body(&[path], &Default::default()).unwrap();
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
fn what_does_not_belong_together_is_said() {
    let Some(context) = common::context() else { return };
    let (mesh, rig) = knotted();
    let mut body = Body::with_levels(context, &mesh, &[], 4);
    let refused = |rig: &Rig| Skinning::new(context, rig, &body).unwrap_err().to_string();
    assert!(
        refused(&Rig { vertices: rig.vertices[1..].to_vec(), ..rig.clone() })
            .contains("not that of the body")
    );
    assert!(refused(&Rig { joints: rig.joints[..5].to_vec(), ..rig.clone() }).contains("does not have"));
    let mut lost = rig.clone();
    lost.targets[0].deltas[0].vertex = 1 << 20;
    assert!(refused(&lost).contains("does not have"));
    let mut skinning = Skinning::new(context, &rig, &body).unwrap();
    let few = RigPose { weights: vec![], ..pose(false) };
    assert!(skinning.pose(&few, &mut body).unwrap_err().to_string().contains("not one of"));
}
