//! Poses with results known by hand.

use super::*;
use serde_json::json;

#[test]
fn arm_bends_at_its_elbow() {
    let raw = read(glb::arm().0.bytes()).unwrap();
    let rig = raw.rig.unwrap();
    assert_eq!((rig.nodes.len(), rig.joints.len(), rig.vertices.len()), (5, 3, 6));
    assert!(rig.nodes.iter().enumerate().all(|(i, n)| n.parent.is_none_or(|p| (p as usize) < i)));
    assert!(rig.vertices.iter().all(|v| (v.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6));
    // At rest, the joints place the mesh, not its node.
    let rest = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [2.0, 0.0, 0.0]].map(Vec3::from);
    assert_eq!(agree(&raw.mesh.positions[..3], &rest, 1e-6), Ok(()));
    assert_eq!(posed(&rig, &rig.rest_pose()).positions, raw.mesh.positions);

    // Bent by 90°: the hand is above the elbow. The vertex that follows both is halfway between its place under the
    // shoulder, (1, 0.5), and under the elbow, (0.5, 0).
    let bend = rig.animation("bend").unwrap();
    assert_eq!(bend.length, 2.0);
    let bent = posed(&rig, &rig.pose(bend, 1.5));
    let want = [[0.0, 0.0, 0.0], [0.75, 0.25, 0.0], [1.0, 1.0, 0.0]].map(Vec3::from);
    assert_eq!(agree(&bent.positions[..3], &want, 1e-6), Ok(()));
    // The second normal is half of (0, 1) and half of (-1, 0), the third is (-1, 0).
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let want = [Vec3::Z, Vec3::new(-half, half, 0.0), -Vec3::X];
    assert_eq!(agree(&bent.normals[..3], &want, 1e-6), Ok(()));
    // Half of the turn in half of the time, by the shorter arc; and the animation loops.
    for time in [0.5, 2.5, -1.5] {
        let hand = posed(&rig, &rig.pose(bend, time)).positions[2];
        assert_eq!(agree(&[hand], &[Vec3::new(1.0 + half, half, 0.0)], 1e-6), Ok(()));
    }
    // The check detects a weight that is too large by 0.01.
    let mut off = rig.clone();
    (off.vertices[1].weights[0], off.vertices[1].weights[1]) = (0.49, 0.51);
    let off = posed(&off, &rig.pose(bend, 1.5)).positions[1];
    assert!(agree(&[off], &[Vec3::new(0.75, 0.25, 0.0)], 1e-3).is_err());
}

#[test]
fn unskinned_mesh_follows_its_node_and_parents() {
    let rig = read(glb::arm().0.bytes()).unwrap().rig.unwrap();
    let corner = |pose: RigPose| posed(&rig, &pose).positions[4];
    assert_eq!(corner(rig.rest_pose()), Vec3::new(1.0, 3.0, 0.0));
    let step = rig.animation("Step").unwrap();
    assert_eq!(corner(rig.pose(step, 1.9)), Vec3::new(2.0, 3.0, 0.0));
    // Its parent moves along a spline; `curves` derives the value at 2 s.
    let spline = rig.animation("Spline").unwrap();
    let moved = corner(rig.pose(spline, 2.0));
    assert!(agree(&[moved], &[Vec3::new(1.0 + 1.625, 3.0 + 0.5 - 1.0, -0.5)], 1e-6).is_ok(), "{moved}");
    // The arm moves with it, through its joints.
    let hand = posed(&rig, &rig.pose(spline, 2.0)).positions[2];
    assert!(agree(&[hand], &[Vec3::new(3.625, -0.5, -0.5)], 1e-6).is_ok(), "{hand}");
}

#[test]
fn eight_weights_per_vertex_are_used() {
    let (mut glb, parts) = glb::arm();
    let joints = glb.accessor(glb::U8, "VEC4", 3, &[0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0]);
    // A quarter of the hand follows the elbow through the second set, three quarters follow the shoulder.
    let weights = glb.vectors(&[[0.0; 4], [0.0; 4], [0.125, 0.125, 0.0, 0.0]]);
    glb.poke(parts.joints, 16, &[0; 8]);
    glb.poke(parts.weights, 32, &0.75f32.to_le_bytes());
    let attributes = &mut glb.root["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_1"], attributes["WEIGHTS_1"]) = (json!(joints), json!(weights));
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    let hand = posed(&rig, &rig.pose(rig.animation("Bend").unwrap(), 1.5)).positions[2];
    let want = 0.75 * Vec3::new(2.0, 0.0, 0.0) + 0.25 * Vec3::new(1.0, 1.0, 0.0);
    assert_eq!(agree(&[hand], &[want], 1e-6), Ok(()));
}

#[test]
fn weights_may_be_normalized_integers() {
    let (mut glb, parts) = glb::arm();
    let weights = glb.shorts("VEC4", 4, &[65535, 0, 0, 0, 32768, 32767, 0, 0, 65535, 0, 0, 0]);
    glb.root["accessors"][weights]["normalized"] = json!(true);
    glb.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(weights);
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    assert!((rig.vertices[1].weights[0] - 0.5).abs() < 1e-4);
    // Without `normalized`, integers are invalid weights.
    glb.root["accessors"][weights]["normalized"] = json!(false);
    assert!(read(glb.bytes()).unwrap_err().to_string().contains("wrong data type"));
    let turns = glb.shorts("VEC4", 4, &[0, 0, 0, 65535, 0, 0, 65535, 65535, 0, 0, 65535, 65535]);
    glb.root["accessors"][turns]["normalized"] = json!(true);
    glb.root["animations"][0]["samplers"][0]["output"] = json!(turns);
    glb.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(parts.weights);
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    let hand = posed(&rig, &rig.pose(&rig.animations[0], 1.5)).positions[2];
    assert_eq!(agree(&[hand], &[Vec3::new(1.0, 1.0, 0.0)], 1e-6), Ok(()));
}

#[test]
fn normals_stay_perpendicular_and_outward() {
    // A slope under a nonuniform scale, by the joint's animation and by the node at rest.
    let mut glb = Glb::new();
    let positions = glb.vectors(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0, 0.0]]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let normals = glb.vectors(&[[half, half, 0.0]; 3]);
    glb.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions, "NORMAL": normals}}]}));
    glb.root["nodes"] = json!([{"mesh": 0}]);
    glb.animate(
        "Stretch",
        0,
        "scale",
        "STEP",
        (&[0.0, 1.0, 2.0], &[1.0, 1.0, 1.0, 2.0, 1.0, 1.0, -2.0, 1.0, 1.0]),
    );
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    let normal = posed(&rig, &rig.pose(&rig.animations[0], 1.0)).normals[0];
    let want = Vec3::new(1.0, 2.0, 0.0).normalize();
    assert_eq!(agree(&[normal], &[want], 1e-6), Ok(()));
    // Transforming the normal like a position would be wrong.
    assert!(agree(&[normal], &[Vec3::new(2.0, 1.0, 0.0).normalize()], 1e-2).is_err());
    // Mirrored at rest: the same as in the reader of static meshes, including flipped triangles.
    glb.root["nodes"] = json!([{"mesh": 0, "scale": [-2, 1, 1]}]);
    let raw = read(glb.bytes()).unwrap();
    glb.root["animations"] = json!([]);
    let still = read(glb.bytes()).unwrap();
    assert!(still.rig.is_none());
    assert_eq!(raw.mesh, still.mesh);
    let rig = raw.rig.unwrap();
    let rest = posed(&rig, &rig.rest_pose());
    assert_eq!(agree(&rest.normals, &still.mesh.normals, 1e-6), Ok(()));
    assert_eq!(agree(&rest.positions, &still.mesh.positions, 1e-6), Ok(()));
    let [a, b, c] = raw.mesh.triangles[0].map(|i| raw.mesh.positions[i as usize]);
    assert!((b - a).cross(c - a).dot(rest.normals[0]) > 0.0);
}

#[test]
fn mirrored_skin_flips_triangles() {
    let (mut glb, _) = glb::arm();
    let plain = read(glb.bytes()).unwrap().mesh;
    glb.root["nodes"][0]["scale"] = json!([1, 1, -1]);
    let mirrored = read(glb.bytes()).unwrap().mesh;
    assert_ne!(plain.triangles[0], mirrored.triangles[0]);
    let area = |m: &TriMesh| {
        let [a, b, c] = m.triangles[0].map(|i| m.positions[i as usize]);
        (b - a).cross(c - a)
    };
    assert!(area(&plain).z * area(&mirrored).z < 0.0);
    assert_eq!(mirrored.normals[0], -Vec3::Z);
    // A mesh's own node may mirror without effect.
    let (mut glb, _) = glb::arm();
    glb.root["nodes"][3]["scale"] = json!([-1, 1, 1]);
    assert_eq!(read(glb.bytes()).unwrap().mesh, plain);
}

#[test]
fn sheared_matrices_and_missing_normals_are_supported() {
    let mut glb = Glb::new();
    let positions = glb.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    glb.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions}}]}));
    let shear = [1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 0.25, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    glb.root["nodes"] = json!([{"children": [1]}, {"mesh": 0, "matrix": shear}]);
    glb.animate("Lift", 0, "translation", "LINEAR", (&[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
    let raw = read(glb.bytes()).unwrap();
    assert_eq!(raw.mesh.positions[2], Vec3::new(0.5, 1.0, 0.25));
    let rig = raw.rig.unwrap();
    let rest = posed(&rig, &rig.rest_pose());
    assert_eq!(agree(&rest.positions, &raw.mesh.positions, 1e-6), Ok(()));
    assert_eq!(agree(&rest.normals, &raw.mesh.normals, 1e-6), Ok(()));
    assert!(raw.mesh.normals[0].x.abs() < 1e-6 && raw.mesh.normals[0].y < -0.2);
    let lifted = posed(&rig, &rig.pose(&rig.animations[0], 0.5));
    assert_eq!(lifted.positions[0], Vec3::Y * 0.5);
}

#[test]
fn mismatched_pose_or_mesh_does_not_panic() {
    let rig = read(glb::arm().0.bytes()).unwrap().rig.unwrap();
    let mut mesh = TriMesh { positions: vec![Vec3::ZERO; 2], ..Default::default() };
    rig.deform(&RigPose::default(), &mut mesh);
    assert_eq!((mesh.positions.len(), mesh.normals.len()), (2, 2));
    let mut odd = rig;
    odd.joints[0].node = 99;
    odd.nodes[1].parent = Some(99);
    odd.animations[0].channels[0].node = 99;
    odd.pose_with(Some((&odd.animations[0], 1.0)), &[(99, 1.0)]);
}
