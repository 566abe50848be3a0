//! Tests of skeletons: a file of Pixar's USD (written by `apps/cli/tests/reference_usd.py`), files of this crate, and
//! broken ones.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

use glam::{Mat4, Quat, Vec3};

use super::super::tests::{SKELETON, farthest, read, text};
use crate::{
    Rig, Strands, TriMesh,
    export::{ExportHair, Writer},
    import::{
        Moment,
        mesh::{self, RawMesh},
    },
    mannequin,
    rig::{Animation, Channel, Curve, Property},
};

/// Returns the points of a prim of `reference_skel.usdc` as Pixar's `UsdSkel` skins them, at rest or in a frame.
fn skinned(moment: &str, name: &str) -> Vec<Vec3> {
    let line = |line: &str| -> Option<Vec3> {
        let mut words = line.split(' ');
        let of = [words.next()?, words.next()?];
        let numbers: Vec<f32> = words.map(|word| word.parse().unwrap()).collect();
        (of == [moment, name]).then(|| Vec3::from_slice(&numbers))
    };
    include_str!("../reference_skel.txt").lines().filter_map(line).collect()
}

#[test]
fn skinned_curves_match_reference() {
    let known = [skinned("rest", "whole"), skinned("24", "whole"), skinned("25", "whole")];
    assert!(
        known[0].len() == 6 && farthest(&known[0], &known[1]) > 1.0 && farthest(&known[1], &known[2]) > 1.0
    );
    for (moment, frame) in [(Moment::First, "rest"), (Moment::Frame(0), "24"), (Moment::Frame(1), "25")] {
        let raw = read("a.usdc", SKELETON, moment).unwrap();
        let expected = [skinned(frame, "whole"), skinned(frame, "parts")].concat();
        let off = farthest(&raw.strands.positions, &expected);
        assert!(off < 1e-3, "{frame}: {off}");
        let notes = raw.notes.join("\n");
        assert!(notes.contains("curves of 2 objects follow the joints of a skeleton"), "{notes}");
    }
}

#[test]
fn skinned_meshes_match_reference() {
    let raw =
        mesh::read_given(&[(PathBuf::from("a.usdc"), Cow::Borrowed(SKELETON))], Path::new("a.usdc")).unwrap();
    let (mut body, rig) = (raw.mesh, raw.rig.expect("it bends"));
    assert!(farthest(&body.positions, &skinned("rest", "body")) < 1e-3);
    assert!(body.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
    let names: Vec<_> = rig.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!((names, rig.joints.len()), (vec!["bones", "Torso", "Neck", "Head"], 3));
    let walk = rig.animation("walk").expect("it has the animation");
    assert!((walk.length - 1.0 / 24.0).abs() < 1e-6, "{}", walk.length);
    assert_eq!(rig.target("jaw"), Some(0));
    // The last key, just before the loop starts again.
    for (time, frame) in [(0.0, "24"), (walk.length * 0.99999, "25")] {
        rig.deform(&rig.pose(walk, time), &mut body);
        let off = farthest(&body.positions, &skinned(frame, "body"));
        assert!(off < 5e-3, "{frame}: {off}");
    }
    assert!(farthest(&skinned("24", "body"), &skinned("25", "body")) > 1.0, "frames differ");
}

#[test]
fn broken_skeletons_are_refused() {
    let scene = |skeleton: &str, binding: &str| {
        text(&format!(
            "def SkelRoot \"a\" {{
                def Skeleton \"s\" {{ {skeleton} }}
                def BasisCurves \"hair\" (prepend apiSchemas = [\"SkelBindingAPI\"]) {{
                    uniform token type = \"linear\"
                    int[] curveVertexCounts = [2]
                    point3f[] points = [(0, 1, 0), (0, 2, 0)]
                    rel skel:skeleton = </a/s>
                    {binding}
                }}
            }}"
        ))
    };
    let two = "uniform token[] joints = [\"A\", \"A/B\"]
        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,1,0,1))]
        uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(5,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,1,0,1))]";
    let on = |joints: &str, weights: &str, size: u32| {
        format!(
            "int[] primvars:skel:jointIndices = [{joints}] (elementSize = {size} interpolation = \"constant\")
            float[] primvars:skel:jointWeights = [{weights}] (elementSize = {size} interpolation = \"constant\")"
        )
    };
    let moved = scene(two, &on("1", "1", 1)).unwrap();
    assert!(farthest(&moved.strands.positions, &[Vec3::new(5.0, 1.0, 0.0), Vec3::new(5.0, 2.0, 0.0)]) < 1e-5);
    let alone = scene(two, "").unwrap();
    assert_eq!(alone.strands.positions[0], Vec3::Y, "without joints it is where it is");
    for (skeleton, binding, why) in [
        (two.to_owned(), on("2", "1", 1), "joint index 2 is out of range; there are 2"),
        (two.to_owned(), on("-1", "1", 1), "joint index -1 is out of range; there are 2"),
        (two.to_owned(), on("0, 1, 0", "1, 0, 1", 1), "3 joint indices and 3 weights do not match 2 points"),
        (two.to_owned(), on("0", "1, 2", 1), "1 joint indices and 2 weights"),
        (two.replace("\"A\", \"A/B\"", "\"A/B\", \"A\""), on("0", "1", 1), "precedes its parent"),
        (two.replacen("(0,0,0,1)", "(0,0,0,0)", 1), on("0", "1", 1), "have no inverse"),
        (two.replace("\"A\", ", ""), on("0", "1", 1), "2 bindTransforms do not match 1 joints"),
        (
            "uniform token[] joints = [\"A\"]".into(),
            on("0", "1", 1),
            "neither bindTransforms nor restTransforms",
        ),
    ] {
        let error = scene(&skeleton, &binding).err().unwrap_or_default();
        assert!(error.contains(why), "{why}: {error}");
    }
    // A point without weights stays where it was bound.
    let nothing = scene(two, &on("1", "0", 1)).unwrap();
    assert_eq!(nothing.strands.positions[0], Vec3::Y);
}

/// Writes a mesh with its rig and hair, and reads it back.
fn written_body(body: &TriMesh, rig: &Rig, strands: &Strands, packed: bool) -> (RawMesh, Vec<u8>) {
    let hair = [ExportHair { name: "hair", strands, packed: false, look: None }];
    let name = if packed { "a.usdc" } else { "a.usda" };
    let bytes = Writer::of(name).unwrap().character(Some((body, Some(rig))), &hair).unwrap();
    let given = [(PathBuf::from(name), Cow::Borrowed(&bytes[..]))];
    (mesh::read_given(&given, Path::new(name)).unwrap(), bytes)
}

#[test]
fn bodies_with_hair_survive_round_trip() {
    let bust = mannequin::mesh(40);
    let mut built_in = mannequin::rig::rig(&bust);
    let turn = |angle: f32| Quat::from_rotation_y(angle).to_array();
    let curve = |values: Vec<f32>| Curve { times: vec![0.0, 0.5, 1.0], values, ..Default::default() };
    let turns = curve([0.0, 0.7, -0.3].map(turn).concat());
    let shape = built_in.target("Jaw").unwrap() as u32;
    built_in.animations.push(Animation {
        name: "Look around".into(),
        length: 1.0,
        channels: vec![
            Channel { node: 2, property: Property::Rotation, curve: turns },
            Channel { node: 0, property: Property::Weights(vec![shape]), curve: curve(vec![0.0, 1.0, 0.5]) },
        ],
    });
    // A mesh whose rest pose is not its bind pose, in centimeters.
    let given = [(PathBuf::from("a.usdc"), Cow::Borrowed(SKELETON))];
    let raw = mesh::read_given(&given, Path::new("a.usdc")).unwrap();
    let (mut other, mut rig) = (raw.mesh, raw.rig.unwrap());
    rig.to_groom =
        Mat4::from_scale_rotation_translation(Vec3::splat(0.01), Quat::from_rotation_y(0.4), Vec3::X);
    rig.deform(&rig.rest_pose(), &mut other);
    // A mesh that rests with its jaw half open.
    let mut open = built_in.clone();
    open.nodes[0].weights = vec![(shape, 0.5)];
    let mut opened = bust.clone();
    open.deform(&open.rest_pose(), &mut opened);
    assert!(farthest(&opened.positions, &bust.positions) > 1e-3);
    let all =
        [(&bust, &built_in, false), (&bust, &built_in, true), (&other, &rig, false), (&opened, &open, false)];
    for (body, rig, packed) in all {
        // A strand on every `step`th vertex, at least 40 if the mesh has as many vertices.
        let mut strands = Strands::default();
        let step = (body.positions.len() / 40).max(1);
        for (p, n) in body.positions.iter().zip(&body.normals).step_by(step) {
            strands.push(&[*p, *p + 0.01 * *n, *p + 0.03 * *n]);
        }
        strands.radii = vec![4e-5; strands.positions.len()];
        let (raw, bytes) = written_body(body, rig, &strands, packed);
        let (mut found, back) = (raw.mesh, raw.rig.expect("it bends"));
        assert_eq!(found.triangles, body.triangles);
        assert!(farthest(&found.positions, &body.positions) < 1e-5);
        let names = |rig: &Rig| rig.targets.iter().map(|target| target.name.clone()).collect::<Vec<_>>();
        assert_eq!((names(&back), back.animations.len()), (names(rig), 1));
        let (animation, own) = (&rig.animations[0], &back.animations[0]);
        let mut expected = body.clone();
        let mut most = 0.0f32;
        for part in [0.0, 0.25, 0.6, 0.99] {
            rig.deform(&rig.pose(animation, part * animation.length), &mut expected);
            back.deform(&back.pose(own, part * own.length), &mut found);
            let off = farthest(&found.positions, &expected.positions);
            assert!(off < 2e-3, "{part}: {off}");
            most = most.max(farthest(&expected.positions, &body.positions));
        }
        assert!(most > 0.01, "it moves by {most}");
        let name = if packed { "a.usdc" } else { "a.usda" };
        let raw = read(name, &bytes, Moment::First).unwrap();
        assert!(farthest(&raw.strands.positions, &strands.positions) < 1e-5);
        let thick = raw.strands.radii.iter().map(|radius| (radius / 4e-5 - 1.0).abs()).fold(0.0, f32::max);
        assert!(thick < 1e-3, "{thick}");
        // Roots follow the skin.
        let frames = (own.length * 24.0).round() as u32;
        let (late, middle) = (frames.div_ceil(2), frames.div_ceil(2) as f32 / frames as f32);
        let late = read(name, &bytes, Moment::Frame(late)).unwrap().strands;
        // Blend shapes do not move hair.
        let mut still = rig.pose(animation, own.length * middle.min(1.0 - 1e-6));
        still.weights = rig.rest_pose().weights;
        rig.deform(&still, &mut expected);
        let roots: Vec<Vec3> = late.iter().map(|line| line[0]).collect();
        let skin: Vec<Vec3> = expected.positions.iter().step_by(step).copied().collect();
        let off = farthest(&roots, &skin);
        assert!(off < 3e-3, "roots are {off} from their skin");
    }
    // A joint that is scaled to zero, and names that are invalid in paths or occur twice.
    let mut gone = built_in.clone();
    let scales = [Vec3::ONE, Vec3::ZERO, Vec3::ONE].map(|s| s.to_array()).concat();
    let vanish = Channel { node: 1, property: Property::Scale, curve: curve(scales) };
    gone.animations[0].channels.push(vanish);
    gone.animations.push(gone.animations[0].clone());
    gone.targets.push(gone.targets[0].clone());
    let usda = Writer::of("a.usda").unwrap();
    let text = usda.character(Some((&bust, Some(&gone))), &[]).unwrap();
    let said = String::from_utf8_lossy(&text);
    assert!(!said.contains("NaN") && said.contains("\"Breath 2\"") && said.contains("Look_around_2"));
    let given = [(PathBuf::from("a.usda"), Cow::Borrowed(&text[..]))];
    let back = mesh::read_given(&given, Path::new("a.usda")).unwrap().rig.unwrap();
    assert_eq!((back.animations.len(), back.targets.len()), (2, 4));
    let (mut found, mut expected) = (bust.clone(), bust.clone());
    back.deform(&back.pose(&back.animations[0], 0.5), &mut found);
    gone.deform(&gone.pose(&gone.animations[0], 0.5), &mut expected);
    assert!(farthest(&found.positions, &expected.positions) < 2e-3);
    gone.animations[0].length = 1e7;
    let error = usda.character(Some((&bust, Some(&gone))), &[]).unwrap_err().to_string();
    assert!(error.contains("100000 frames"), "{error}");
    let empty = [ExportHair { name: "hair", strands: &Strands::default(), packed: false, look: None }];
    assert!(usda.character(None, &empty).is_err());
    assert!(usda.character(Some((&other, Some(&built_in))), &[]).is_err(), "another's rig");
    // Without a rig nothing is bound.
    let plain = usda.character(Some((&bust, None)), &[]).unwrap();
    let given = [(PathBuf::from("a.usda"), Cow::Borrowed(&plain[..]))];
    let raw = mesh::read_given(&given, Path::new("a.usda")).unwrap();
    assert!(raw.rig.is_none() && farthest(&raw.mesh.positions, &bust.positions) == 0.0);
}

#[test]
fn unweighted_points_follow_skeleton_and_invalid_animations_are_skipped() {
    let one = "((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))";
    let scene = format!(
        "#usda 1.0
        def SkelRoot \"a\" {{
            def Skeleton \"s\" {{
                uniform token[] joints = [\"A\"]
                uniform matrix4d[] bindTransforms = [{one}]
                uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,3,0,1))]
                double3 xformOp:translate = (7, 0, 0)
                uniform token[] xformOpOrder = [\"xformOp:translate\"]
                rel skel:animationSource = </a/turn>
            }}
            def SkelAnimation \"turn\" {{
                uniform token[] joints = [\"A\"]
                quatf[] rotations.timeSamples = {{ 0: [(1,0,0,0)], 24: [(0,1,0,0)] }}
            }}
            def SkelAnimation \"held\" {{
                uniform token[] joints = [\"A\"]
                float3[] translations = [(0, 5, 0)]
                quatf[] rotations = [(1, 0, 0, 0)]
            }}
            def Mesh \"m\" (prepend apiSchemas = [\"SkelBindingAPI\"]) {{
                int[] faceVertexCounts = [3]
                int[] faceVertexIndices = [0, 1, 2]
                point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
                rel skel:skeleton = </a/s>
                int[] primvars:skel:jointIndices = [0, 0, 0] (elementSize = 1 interpolation = \"vertex\")
                float[] primvars:skel:jointWeights = [1, 1, 0] (elementSize = 1 interpolation = \"vertex\")
            }}
        }}"
    );
    let given = [(PathBuf::from("a.usda"), Cow::Borrowed(scene.as_bytes()))];
    let raw = mesh::read_given(&given, Path::new("a.usda")).unwrap();
    let places = [Vec3::new(7.0, 3.0, 0.0), Vec3::new(8.0, 3.0, 0.0), Vec3::new(7.0, 1.0, 0.0)];
    assert!(farthest(&raw.mesh.positions, &places) < 1e-5, "{:?}", raw.mesh.positions);
    let rig = raw.rig.unwrap();
    let names: Vec<_> = rig.animations.iter().map(|animation| animation.name.as_str()).collect();
    assert_eq!((names, rig.animations[0].length), (vec!["held"], 0.0));
    let mut held = raw.mesh.clone();
    rig.deform(&rig.pose(&rig.animations[0], 0.0), &mut held);
    assert!(held.positions[0].distance(Vec3::new(7.0, 5.0, 0.0)) < 1e-5, "{}", held.positions[0]);
    let notes = raw.notes.join("\n");
    assert!(notes.contains("an animation is skipped") && notes.contains("/a/turn"), "{notes}");
}
