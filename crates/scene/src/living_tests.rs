use super::*;
use crate::{Colliders, Shelf};
use std::path::Path;
use tresses::{collide::Shape, groom::mannequin};

#[test]
fn a_file_says_what_joints_are_to_hair() {
    let mesh = mannequin::mesh(60);
    let built_in = Anatomy::built_in(&mesh, &mannequin::sdf(mannequin::FIELD_RESOLUTION));
    let text = |joints: &str| {
        let path = Path::new("joints.json");
        let mut files = Shelf::default();
        files.put(path.to_owned(), format!(r#"{{"joints": [{joints}]}}"#).into_bytes());
        Colliders::read(path, &files)
    };
    let arranged = |joints: &str| {
        let mut anatomy = built_in.clone();
        let colliders = text(joints)?;
        arrange(&mut anatomy, colliders.joints(), &mesh)?;
        Ok::<_, anyhow::Error>((anatomy, colliders))
    };
    let (anatomy, mut colliders) = arranged(
        r#"{"joint": "torso", "shape": {"capsule": {"from": [0, 1, 0], "to": [0.3, 1, 0], "radius": 0.1}}, "friction": 2},
           {"joint": "Neck", "shape": "none"}"#,
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
        arranged(r#"{"joint": "Neck", "shape": "fit"}, {"joint": "Torso", "shape": "field"}"#).unwrap();
    let PartForm::Capsule(neck) = anatomy.parts[0].form else { panic!("it was to be fitted") };
    assert!((0.03..0.09).contains(&neck.radius), "{neck:?}");
    assert_eq!(anatomy.parts[1].form, PartForm::Field);
    for (joints, why) in [
        (r#"{"joint": "Tail", "shape": "none"}"#, "no joint \"Tail\"; parts are carried by Neck, Torso"),
        (r#"{"joint": "Head", "shape": "none"}"#, "hair grows on"),
        (r#"{"joint": "Neck", "shape": "none", "friction": null}"#, "friction"),
    ] {
        let error = arranged(joints).err().map(|error| format!("{error:#}")).unwrap_or_default();
        assert!(error.contains(why) || error.contains("joints.json"), "{joints}: {error}");
    }
}
