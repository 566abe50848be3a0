//! Blend shapes.

use super::*;
use serde_json::json;

#[test]
fn blend_shapes_apply_before_skinning() {
    let rig = read(glb::arm().0.bytes()).unwrap().rig.unwrap();
    let names: Vec<&str> = rig.targets.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["Swell", "Hand"]);
    assert_eq!((rig.target("hand"), rig.target("Foot")), (Some(1), None));
    // The sparse shape keeps a single vertex.
    assert_eq!(rig.targets[1].deltas, [Delta { vertex: 2, position: Vec3::Y * 0.5, normal: Vec3::ZERO }]);
    let half = posed(&rig, &rig.pose_with(None, &[(0, 0.5)]));
    let want = [[0.0, 0.0, 0.125], [1.0, 0.5, 0.125], [2.0, 0.0, 0.125], [0.0, 3.0, 0.0]].map(Vec3::from);
    assert_eq!(agree(&half.positions[..4], &want, 1e-6), Ok(()));
    let slope = Vec3::new(0.0, 1.0, 0.5).normalize();
    assert_eq!(agree(&half.normals[1..2], &[slope], 1e-6), Ok(()));
    // The hand moves up, which the bent elbow turns to the left.
    let bend = rig.animation("Bend").unwrap();
    let bent = posed(&rig, &rig.pose_with(Some((bend, 1.5)), &[(1, 1.0)]));
    assert_eq!(agree(&bent.positions[2..3], &[Vec3::new(0.5, 1.0, 0.0)], 1e-6), Ok(()));
    // The check detects a different weight.
    let off = posed(&rig, &rig.pose_with(None, &[(0, 0.501)]));
    assert!(agree(&off.positions[..4], &want, 1e-4).is_err());
}

#[test]
fn explicit_weights_override_animation() {
    let rig = read(glb::arm().0.bytes()).unwrap().rig.unwrap();
    let blend = rig.animation("Blend").unwrap();
    assert_eq!(rig.pose(blend, 0.5).weights, [0.5, 0.25]);
    assert_eq!(rig.pose(blend, 2.0).weights, [1.0, 0.5]);
    assert_eq!(rig.pose_with(Some((blend, 2.0)), &[(1, 0.0)]).weights, [1.0, 0.0]);
    assert_eq!(rig.rest_pose().weights, [0.0, 0.0]);
}

#[test]
fn shapes_with_same_name_use_largest_weight() {
    let (mut glb, parts) = glb::arm();
    let shapes = json!([{"POSITION": parts.sparse}, {"POSITION": parts.sparse}, {"POSITION": parts.sparse}]);
    glb.root["meshes"][1]["primitives"][0]["targets"] = shapes;
    // The second shape has no name, the third one that is taken.
    glb.root["meshes"][1]["extras"] = json!({"targetNames": ["Hand", 7, "Hand"]});
    glb.root["meshes"][1]["weights"] = json!([0.25, 0, 0]);
    glb.root["meshes"][0]["weights"] = json!([0, 0.125]);
    let raw = read(glb.bytes()).unwrap();
    let rig = raw.rig.unwrap();
    let names: Vec<&str> = rig.targets.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["Swell", "Hand", "morph 1", "Hand 2"]);
    let moved: Vec<u32> = rig.targets[1].deltas.iter().map(|d| d.vertex).collect();
    assert_eq!(moved, [2, 5]);
    assert_eq!(rig.rest_pose().weights, [0.0, 0.25, 0.0, 0.0]);
    // The mesh includes its blend shapes at rest.
    assert_eq!(raw.mesh.positions[5], Vec3::new(0.0, 4.125, 0.0));
    // A node's own weights override those of its mesh.
    glb.root["nodes"][4]["weights"] = json!([-0.5, 0, 0]);
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    assert_eq!(rig.rest_pose().weights[1], -0.5);
    // Weights that the animation does not set stay at rest, also of the other node's shape with the same name.
    assert_eq!(rig.pose(rig.animation("Blend").unwrap(), 0.5).weights[1], -0.5);
}

#[test]
fn sparse_items_replace_dense_values() {
    let (mut glb, parts) = glb::arm();
    let dense = glb.vectors(&[[1.0, 0.0, 0.0], [0.0; 3], [3.0, 0.0, 0.0]]);
    let view = glb.root["accessors"][dense]["bufferView"].clone();
    glb.root["accessors"][parts.sparse]["bufferView"] = view;
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    let moved: Vec<(u32, Vec3)> = rig.targets[1].deltas.iter().map(|d| (d.vertex, d.position)).collect();
    assert_eq!(moved, [(0, Vec3::X), (2, Vec3::Y * 0.5)]);
}

/// `KHR_mesh_quantization`: normalized 16-bit offsets, 8 bytes apart.
#[test]
fn quantized_shapes_match_float_shapes() {
    let (mut glb, _) = glb::arm();
    let shares = [[32767i16, 0, 0, 0], [0; 4], [0, -16384, 0, 0]];
    let bytes: Vec<u8> = shares.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    let shape = glb.accessor(5122, "VEC3", 3, &bytes);
    glb.root["accessors"][shape]["normalized"] = json!(true);
    let view = glb.root["accessors"][shape]["bufferView"].as_u64().unwrap() as usize;
    glb.root["bufferViews"][view]["byteStride"] = json!(8);
    glb.root["meshes"][0]["primitives"][0]["targets"][1] = json!({"POSITION": shape});
    glb.root["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    glb.root["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    let moved: Vec<(u32, Vec3)> = rig.targets[1].deltas.iter().map(|d| (d.vertex, d.position)).collect();
    assert_eq!(moved.len(), 2);
    assert_eq!(agree(&[moved[0].1, moved[1].1], &[Vec3::X, Vec3::Y * -0.500_015_26], 1e-6), Ok(()));
    // Without `normalized`, the integers are the offsets.
    glb.root["accessors"][shape]["normalized"] = json!(false);
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    assert_eq!(rig.targets[1].deltas[0].position, Vec3::X * 32767.0);
}

#[test]
fn file_without_scene_keeps_its_shapes() {
    let (mut glb, _) = glb::arm();
    let root = glb.root.as_object_mut().unwrap();
    assert!(root.remove("scene").is_some() && root.remove("scenes").is_some());
    let raw = read(glb.bytes()).unwrap();
    let rig = raw.rig.unwrap();
    assert_eq!((rig.nodes.len(), rig.targets.len(), rig.animations.len()), (2, 2, 0));
    assert_eq!(posed(&rig, &rig.rest_pose()).positions, raw.mesh.positions);
}
