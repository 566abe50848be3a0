use super::*;
use crate::{Colliders, Shelf};
use std::path::Path;
use tresses::{
    collide::Shape,
    groom::rig::{Bind, Joint, Node, Transform},
};

/// A head on a neck on shoulders, each a ball that a node of its own carries, and an eye that goes with the head.
fn body() -> (Rig, TriMesh) {
    let places = [
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(0.0, 1.3, 0.0),
        Vec3::new(0.0, 1.5, 0.0),
        Vec3::new(0.0, 1.5, 0.1),
    ];
    let sizes = [0.2, 0.06, 0.1, 0.02];
    let (mut rig, mut mesh) = (Rig::default(), TriMesh::default());
    for (i, (place, size)) in places.into_iter().zip(sizes).enumerate() {
        let mut ball = tresses::groom::mesh::shapes::sphere(size, 12);
        ball.compute_normals();
        let parent = i.checked_sub(1).map(|parent| parent as u32);
        let from = parent.map_or(Vec3::ZERO, |parent| places[parent as usize]);
        let rest = Transform { translation: place - from, ..Default::default() };
        rig.nodes.push(Node { name: format!("{i}"), parent, rest, ..Default::default() });
        rig.joints.push(Joint { node: i as u32, inverse_bind: Mat4::from_translation(-place) });
        let first = mesh.positions.len() as u32;
        for (p, n) in ball.positions.iter().zip(&ball.normals) {
            rig.vertices.push(Bind::rigid(place + *p, *n, i as u16));
            mesh.positions.push(place + *p);
            mesh.normals.push(*n);
        }
        mesh.triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    rig.to_groom = Mat4::IDENTITY;
    (rig, mesh)
}

fn hair(length: f32) -> Strands {
    let mut strands = Strands::default();
    for i in 0..20 {
        let root = Vec3::new(0.02 * (i as f32).sin(), 1.6, 0.02 * (i as f32).cos());
        strands.push(&[root, root + Vec3::Y * length]);
    }
    strands
}

#[test]
fn hair_goes_with_what_it_grows_on() {
    let (rig, mesh) = body();
    let anatomy = Anatomy::new(rig, &mesh, &hair(0.4)).unwrap();
    assert_eq!(anatomy.head.node, 2);
    // The eye belongs to it.
    let Field::Mesh(mesh, _) = &anatomy.head.field else { panic!("a mesh was given") };
    let (lo, hi) = mesh.bounds().unwrap();
    assert!((hi.z - 0.12).abs() < 1e-3 && (lo.y - 1.4).abs() < 1e-3, "{lo} {hi}");
    let nodes: Vec<_> = anatomy.parts.iter().map(|part| part.node).collect();
    assert_eq!(nodes, [1, 0], "the nearest first");
    assert!(anatomy.solids().count() == 2 && anatomy.solids().all(|part| part.form == PartForm::Field));
    // Short hair reaches the neck, not the shoulders: those are a capsule.
    let (rig, mesh) = body();
    let short = Anatomy::new(rig, &mesh, &hair(0.2)).unwrap();
    assert_eq!(short.parts.iter().map(|part| part.node).collect::<Vec<_>>(), [1, 0]);
    assert_eq!(short.parts[0].form, PartForm::Field);
    let PartForm::Capsule(Capsule { ends: [a, b], radius }) = short.parts[1].form else { panic!("far away") };
    assert!((radius - 0.2).abs() < 2e-3 && a.distance(b) < 0.01, "{a} {b} {radius}");
    assert!((0.5 * (a + b)).distance(Vec3::Y) < 2e-3 && short.parts[1].vertices == mesh.positions.len() / 4);
}

#[test]
fn a_file_says_what_joints_are_to_hair() {
    let (mut rig, mesh) = body();
    rig.nodes[0].name = "Torso".into();
    let text = |joints: &str| {
        let path = Path::new("joints.json");
        let mut files = Shelf::default();
        files.put(path.to_owned(), format!(r#"{{"joints": [{joints}]}}"#).into_bytes());
        Colliders::read(path, &files)
    };
    let arranged = |joints: &str| {
        let mut anatomy = Anatomy::new(rig.clone(), &mesh, &hair(0.2)).unwrap();
        let colliders = text(joints)?;
        anatomy.arrange(colliders.joints(), &mesh)?;
        Ok::<_, anyhow::Error>((anatomy, colliders))
    };
    let (anatomy, mut colliders) = arranged(
        r#"{"joint": "torso", "shape": {"capsule": {"from": [0, 1, 0], "to": [0.3, 1, 0], "radius": 0.1}}, "friction": 2},
           {"joint": "1", "shape": "none"}"#,
    )
    .unwrap();
    colliders.add_parts(anatomy.solids());
    let [one] = &colliders.list[..] else { panic!("the neck is none") };
    assert!(one.friction == 2.0 && matches!(one.shape, Shape::Capsule { radius: 0.1, .. }), "{one:?}");
    // It is where it was given, and goes with its joint.
    let turn = Pose { rotation: Quat::from_rotation_z(1.0), translation: Vec3::X };
    for node in [Pose::IDENTITY, turn] {
        let at = colliders.poses(0.0, &[node]).colliders[0];
        assert!(at.point(Vec3::Y * 0.15).distance(node.point(Vec3::new(0.3, 1.0, 0.0))) < 1e-6);
        assert_eq!(colliders.carried(node).colliders, [at]);
    }
    let (anatomy, _) =
        arranged(r#"{"joint": "1", "shape": "fit"}, {"joint": "Torso", "shape": "field"}"#).unwrap();
    assert!(
        matches!(anatomy.parts[0].form, PartForm::Capsule(_)) && anatomy.parts[1].form == PartForm::Field
    );
    for (joints, why) in [
        (r#"{"joint": "Tail", "shape": "none"}"#, "no joint \"Tail\"; parts are carried by 1, Torso"),
        (r#"{"joint": "2", "shape": "none"}"#, "hair grows on"),
        (r#"{"joint": "1", "shape": "none", "friction": null}"#, "friction"),
    ] {
        let error = arranged(joints).err().map(|error| format!("{error:#}")).unwrap_or_default();
        assert!(error.contains(why) || error.contains("joints.json"), "{joints}: {error}");
    }
}

#[test]
fn poses_are_rigid_and_about_the_joint() {
    let rest = Mat4::from_scale_rotation_translation(Vec3::splat(2.0), Quat::from_rotation_x(0.3), Vec3::Y);
    let turn = Quat::from_rotation_z(0.7);
    let now =
        Mat4::from_scale_rotation_translation(Vec3::splat(2.0), turn * Quat::from_rotation_x(0.3), Vec3::X);
    let pose = moved(&now, &rest);
    assert!(pose.point(Vec3::Y).distance(Vec3::X) < 1e-6);
    assert!(pose.rotation.dot(turn).abs() > 0.999_999);
    // What is stretched is no pose; its joint is where it should be all the same.
    let stretched = now * Mat4::from_scale(Vec3::new(3.0, 1.0, 1.0));
    let pose = moved(&stretched, &rest);
    assert!(pose.point(Vec3::Y).distance(Vec3::X) < 1e-6 && pose.rotation.is_normalized());
    // A joint that is flattened has no turn.
    let flat = Mat4::from_scale(Vec3::ZERO);
    assert!(moved(&flat, &rest).rotation.is_finite());
}

#[test]
fn a_gesture_turns_the_head_and_a_neck_below_it() {
    let (mut rig, mesh) = body();
    let anatomy = Anatomy::new(rig.clone(), &mesh, &hair(0.4)).unwrap();
    assert_eq!(anatomy.turns, [(2, 1.0)], "no node is called a neck");
    rig.nodes[1].name = "mixamorig:Neck".into();
    let anatomy = Anatomy::new(rig, &mesh, &hair(0.4)).unwrap();
    assert_eq!(anatomy.turns, [(1, NECK_SHARE), (2, 1.0 - NECK_SHARE)]);
    // In all the head turns as it was told, about its own place on the neck; eyes go with it.
    let turn = Quat::from_rotation_x(0.5);
    let turns = anatomy.turns.iter().map(|(node, share)| (*node, Quat::IDENTITY.slerp(turn, *share)));
    let pose = anatomy.rig.pose_turned(None, &[], &turns.collect::<Vec<_>>());
    let rest = anatomy.rig.rest_pose();
    let of = |node: usize| moved(&pose.globals[node], &rest.globals[node]);
    assert!(of(0) == Pose::IDENTITY, "the torso stays");
    assert!(of(2).rotation.angle_between(turn) < 1e-3 && of(3).rotation.angle_between(turn) < 1e-3);
    let neck = Vec3::new(0.0, 1.3, 0.0);
    assert!(of(1).point(neck).distance(neck) < 1e-6, "the neck turns where it is");
    let bent = Quat::from_rotation_x(0.5 * NECK_SHARE) * Vec3::Y * 0.2;
    assert!(of(2).point(neck + Vec3::Y * 0.2).distance(neck + bent) < 1e-6, "and the head is on it");
}

#[test]
fn the_built_in_character_has_parts() {
    let mesh = mannequin::mesh(60);
    let bust = mannequin::sdf(mannequin::FIELD_RESOLUTION);
    let anatomy = Anatomy::built_in(&mesh, &bust);
    assert_eq!((anatomy.head.node, anatomy.parts.len(), anatomy.is_rigid), (2, 2, true));
    let field = |part: &Part| match &part.field {
        Field::Grid(grid) => grid.clone(),
        Field::Mesh(..) => panic!("it is known"),
    };
    assert!(field(&anatomy.head).sample(mannequin::CROWN).abs() < 2e-3);
    let shoulder = Vec3::new(0.12, -0.095, -0.06);
    assert!(
        field(&anatomy.parts[1]).sample(shoulder).abs() < 0.02
            && field(&anatomy.head).sample(shoulder) > 0.05
    );
}
