//! Invalid files: each gives a one-sentence error, and none does harm.

use super::*;
use glb::{Parts, U8, arm};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Returns the error for a modified arm.
fn says(change: impl FnOnce(&mut Glb, &Parts)) -> String {
    let (mut glb, parts) = arm();
    change(&mut glb, &parts);
    let error = read(glb.bytes()).unwrap_err().to_string();
    assert!(error.starts_with("a.glb: ") && !error.contains('\n') && error.len() < 500, "{error}");
    error
}

#[track_caller]
fn refuses(with: &str, change: impl FnOnce(&mut Glb, &Parts)) {
    let error = says(change);
    assert!(error.contains(with), "{error}");
}

#[test]
fn invalid_joints_are_rejected() {
    refuses("joint 7, which does not exist; there are 2", |glb, p| glb.poke(p.joints, 0, &[7, 0]));
    refuses("follows joint 9", |glb, p| glb.poke(p.joints, 16, &[9, 0]));
    refuses("skin 0 has no joints", |glb, _| glb.root["skins"][0]["joints"] = json!([]));
    refuses("skins[0].joints[1]", |glb, _| glb.root["skins"][0]["joints"] = json!([1, 77]));
    refuses("not in the scene", |glb, _| glb.root["nodes"][1]["children"] = json!([]));
    refuses("skin 0 has 2 matrices for 3 joints", |glb, _| glb.root["skins"][0]["joints"] = json!([1, 2, 0]));
    refuses("not finite", |glb, p| glb.poke(p.inverse, 20, &f32::NAN.to_le_bytes()));
    refuses("only one of JOINTS_0", |glb, _| {
        glb.root["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("WEIGHTS_0");
    });
    // Joints with weight 0 may have any index.
    let (mut glb, parts) = arm();
    glb.poke(parts.joints, 2, &[200, 200]);
    assert!(read(glb.bytes()).is_ok());
}

#[test]
fn invalid_weights_are_rejected() {
    for bad in [f32::NAN, f32::INFINITY] {
        refuses("not finite", |glb, p| glb.poke(p.weights, 4, &bad.to_le_bytes()));
    }
    refuses("too large", |glb, p| {
        glb.poke(p.weights, 16, &[3e38f32.to_le_bytes(), 3e38f32.to_le_bytes()].concat())
    });
    refuses("3 joints and 2 weights for 3", |glb, p| glb.root["accessors"][p.weights]["count"] = json!(2));
    refuses("weights that are not finite", |glb, _| glb.root["meshes"][0]["weights"] = json!([1e39, 0]));
}

#[test]
fn invalid_node_trees_are_rejected() {
    refuses("more than once", |glb, _| glb.root["nodes"][2]["children"] = json!([0]));
    refuses("more than once", |glb, _| glb.root["nodes"][4]["children"] = json!([4]));
    // A graph of 40 nodes with 2^40 paths.
    refuses("more than once", |glb, _| {
        let nodes = glb.root["nodes"].as_array_mut().unwrap();
        nodes.extend((5..45).map(|i| json!({"children": [(i + 1).min(44), (i + 1).min(44)]})));
        nodes[4]["children"] = json!([5]);
    });
    refuses("256 levels deep", |glb, _| {
        let nodes = glb.root["nodes"].as_array_mut().unwrap();
        nodes.extend((5..500).map(|i| if i < 499 { json!({"children": [i + 1]}) } else { json!({}) }));
        nodes[4]["children"] = json!([5]);
    });
    refuses("position is not finite", |glb, _| glb.root["nodes"][0]["translation"] = json!([1e39, 0, 0]));
}

#[test]
fn accessors_out_of_range_are_rejected() {
    refuses("accessor 99 does not exist", |glb, _| {
        glb.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(99);
    });
    let morph = |glb: &mut Glb, accessor: usize| {
        glb.root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = json!(accessor);
    };
    refuses("targets", |glb, _| morph(glb, 99));
    refuses("inverseBindMatrices", |glb, _| glb.root["skins"][0]["inverseBindMatrices"] = json!(99));
    for huge in [4u64, 1 << 32, u64::MAX >> 1, u64::MAX] {
        refuses("does not fit", |glb, p| glb.root["accessors"][p.inverse]["count"] = json!(huge));
        refuses("does not fit", |glb, p| glb.root["accessors"][p.bend[0]]["count"] = json!(huge));
        refuses("does not fit", |glb, p| glb.root["accessors"][p.joints]["count"] = json!(huge));
        refuses("sparse items", |glb, p| glb.root["accessors"][p.sparse]["sparse"]["count"] = json!(huge));
        refuses("morph target", |glb, p| glb.root["accessors"][p.sparse]["count"] = json!(huge));
    }
    refuses("does not fit", |glb, p| glb.root["accessors"][p.bend[1]]["byteOffset"] = json!(u64::MAX));
    refuses("does not fit", |glb, p| glb.root["bufferViews"][p.inverse]["byteOffset"] = json!(u64::MAX));
    refuses("wrong data type", |glb, p| glb.root["accessors"][p.inverse]["type"] = json!("VEC4"));
    refuses("has 2 vertices", |glb, p| glb.root["accessors"][p.sparse]["count"] = json!(2));
    refuses("wrong data type", |glb, p| morph(glb, p.joints));
    // Only morph targets may omit their data.
    refuses("has no data", |glb, p| {
        glb.root["accessors"][p.weights].as_object_mut().unwrap().remove("bufferView");
    });
}

#[test]
fn invalid_sparse_indices_are_rejected() {
    let index = |glb: &mut Glb, parts: &Parts, indices: &[u8]| {
        let (at, to) = (glb.view(indices), glb.view(&[0; 24]));
        glb.root["accessors"][parts.sparse]["sparse"] = json!({"count": indices.len(),
            "indices": {"bufferView": at, "componentType": U8}, "values": {"bufferView": to}});
    };
    refuses("sparse index 3", |glb, p| index(glb, p, &[3]));
    refuses("sparse index 1", |glb, p| index(glb, p, &[2, 1]));
    refuses("sparse index 1", |glb, p| index(glb, p, &[1, 1]));
    refuses("sparse items", |glb, p| index(glb, p, &[0, 1, 2]));
    let (mut glb, parts) = arm();
    index(&mut glb, &parts, &[0, 2]);
    assert!(read(glb.bytes()).is_ok());
}

#[test]
fn invalid_animations_are_rejected() {
    refuses("not ascending", |glb, p| glb.poke(p.bend[0], 8, &1.0f32.to_le_bytes()));
    refuses("not ascending", |glb, p| glb.poke(p.bend[0], 0, &(-1.0f32).to_le_bytes()));
    refuses("not finite", |glb, p| glb.poke(p.bend[0], 4, &f32::NAN.to_le_bytes()));
    refuses("not finite", |glb, p| glb.poke(p.bend[1], 4, &f32::INFINITY.to_le_bytes()));
    refuses("length zero", |glb, p| glb.poke(p.bend[1], 0, &[0; 16]));
    let channel =
        |glb: &mut Glb, key: &str, value: Value| glb.root["animations"][0]["channels"][0][key] = value;
    refuses("node 99, which does not exist", |glb, _| {
        channel(glb, "target", json!({"node": 99, "path": "scale"}))
    });
    refuses("channels[0].sampler", |glb, _| channel(glb, "sampler", json!(5)));
    refuses("12 numbers for 3 keys, which need 9", |glb, _| {
        let output = glb.floats("VEC3", 3, &[0.0; 12]);
        glb.root["animations"][0]["samplers"][0]["output"] = json!(output);
        channel(glb, "target", json!({"node": 2, "path": "scale"}));
    });
    refuses("node 2, which has none", |glb, _| channel(glb, "target", json!({"node": 2, "path": "weights"})));
    refuses("input", |glb, _| glb.root["animations"][0]["samplers"][0]["input"] = json!(99));
    refuses("need 36", |glb, _| {
        glb.root["animations"][0]["samplers"][0]["interpolation"] = json!("CUBICSPLINE")
    });
    // A property that an extension animates, and a node outside of every scene, are ignored.
    let (mut glb, _) = arm();
    channel(&mut glb, "target", json!({"node": 2, "path": "pointer"}));
    glb.push("nodes", json!({}));
    glb.root["animations"][1]["channels"][0]["target"]["node"] = json!(5);
    let rig = read(glb.bytes()).unwrap().rig.unwrap();
    let names: Vec<&str> = rig.animations.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["Spline", "Blend"]);
}

#[test]
fn small_file_cannot_exhaust_memory() {
    let (mut glb, _) = arm();
    let many = glb.floats("VEC3", 3, &vec![0.5; 3000]);
    glb.root["meshes"][1]["primitives"][0]["attributes"] = json!({"POSITION": many});
    let nodes: Vec<Value> = (0..4000).map(|_| json!({"mesh": 1})).collect();
    glb.root["scenes"][0]["nodes"] = json!((0..4000).collect::<Vec<_>>());
    glb.root["nodes"] = json!(nodes);
    for list in ["animations", "skins"] {
        glb.root[list] = json!([]);
    }
    let error = read(glb.bytes()).unwrap_err().to_string();
    assert!(error.contains("would expand"), "{error}");
}

/// Reads a file and, if it is valid, poses its rig.
fn survives(bytes: Vec<u8>) -> Result<(), TestCaseError> {
    let size = bytes.len();
    match read(bytes) {
        Ok(raw) => {
            let Some(rig) = raw.rig else { return Ok(()) };
            prop_assert!(raw.mesh.positions.len() == rig.vertices.len() && rig.vertices.len() <= size);
            prop_assert!(rig.vertices.iter().flat_map(|v| v.joints).all(|j| (j as usize) < rig.joints.len()));
            let all = rig.targets.iter().flat_map(|t| t.deltas.windows(2));
            prop_assert!(all.into_iter().all(|d| d[0].vertex < d[1].vertex));
            for animation in &rig.animations {
                prop_assert!(animation.length.is_finite());
                posed(&rig, &rig.pose(animation, 0.7));
            }
        }
        Err(error) => {
            let text = error.to_string();
            prop_assert!(!text.contains('\n') && text.len() < 500, "{}", text);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn corrupted_rigs_never_panic(
        share in 0.0f64..1.0,
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        digit in (any::<prop::sample::Index>(), b'0'..=b'9'),
    ) {
        let mut whole = arm().0.bytes();
        survives(whole[..(whole.len() as f64 * share) as usize].to_vec())?;
        let mut flipped = whole.clone();
        for (at, value) in &flips {
            let at = at.index(flipped.len());
            flipped[at] = *value;
        }
        survives(flipped)?;
        // Change digits in the JSON, which are in nodes, joints, accessors and sizes.
        let digits: Vec<usize> = (20..whole.len()).filter(|i| whole[*i].is_ascii_digit()).collect();
        whole[digits[digit.0.index(digits.len())]] = digit.1;
        survives(whole)?;
    }
}
