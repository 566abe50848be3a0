//! Rigs in groom space, and several files as one rig.

use super::*;
use crate::import::{ImportOptions, read_given_body};
use crate::orient::{Axis, LengthUnit, OrientationOverride};

const CUBE: &str = "o cube
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
f 4 3 2 1
";

#[test]
fn oriented_rig_matches_oriented_mesh() {
    let file: FileBytes = ("a.glb".into(), glb::arm().0.bytes().into());
    for mirror in [false, true] {
        let orient_head = OrientationOverride {
            unit: Some(LengthUnit(0.01)),
            up: Some(Axis::Z),
            front: Some(Axis::NegX),
            is_mirrored: Some(mirror),
        };
        let options = ImportOptions { orient_head, ..Default::default() };
        let body = read_given_body(std::slice::from_ref(&file), &options).unwrap();
        let rig = body.rig.unwrap();
        let rest = posed(&rig, &rig.rest_pose());
        assert_eq!(agree(&rest.positions, &body.mesh.positions, 1e-7), Ok(()));
        assert_eq!(agree(&rest.normals, &body.mesh.normals, 1e-6), Ok(()));
        // Also in a pose: the hand of the bent arm is at (1, 1, 0) in the file.
        let bent = posed(&rig, &rig.pose(rig.animation("Bend").unwrap(), 1.5)).positions[2];
        assert_eq!(agree(&[bent], &[body.placement.point(Vec3::new(1.0, 1.0, 0.0))], 1e-7), Ok(()));
        // The check detects a rig that was not oriented.
        let left = Rig { to_groom: Mat4::IDENTITY, ..rig };
        assert!(agree(&posed(&left, &left.rest_pose()).positions, &body.mesh.positions, 1e-3).is_err());
    }
}

#[test]
fn files_merge_into_one_rig() {
    let (name, bytes): FileBytes = ("a.glb".into(), glb::arm().0.bytes().into());
    let again = ("b.glb".into(), bytes.clone());
    let still = ("c.obj".into(), CUBE.as_bytes().into());
    let options = ImportOptions::default();
    let read = |files: &[FileBytes]| read_given_body(files, &options).unwrap();
    for files in [
        [(name.clone(), bytes.clone()), still.clone()].as_slice(),
        &[still.clone(), (name.clone(), bytes.clone())],
        &[(name.clone(), bytes.clone()), still.clone(), again.clone()],
    ] {
        let body = read(files);
        let rig = body.rig.unwrap();
        let rest = posed(&rig, &rig.rest_pose());
        assert_eq!(agree(&rest.positions, &body.mesh.positions, 1e-6), Ok(()));
        assert_eq!((rig.targets.len(), rig.animations.len()), (2, 4));
        // Static meshes do not move; all arms do.
        let bent = posed(&rig, &rig.pose_with(rig.animation("Bend").map(|a| (a, 1.5)), &[(1, 1.0)]));
        let moved = bent.positions.iter().zip(&rest.positions).filter(|(a, b)| a.distance(**b) > 1e-3);
        let arms = files.iter().filter(|(name, _)| name.to_string_lossy().ends_with("glb")).count();
        assert_eq!(moved.count(), 2 * arms);
        let hands = bent.positions.iter().filter(|p| p.distance(Vec3::new(0.5, 1.0, 0.0)) < 1e-3);
        let scale = body.placement.unit.0;
        assert!(scale != 1.0 || hands.count() == arms);
    }
    assert!(read(&[still.clone(), ("d.obj".into(), still.1)]).rig.is_none());
}

#[test]
fn joint_count_is_limited_to_16_bits() {
    let joint = Joint { node: 0, inverse_bind: Mat4::IDENTITY };
    let mesh = TriMesh { positions: vec![Vec3::ZERO; 3], ..Default::default() };
    let mut rig = Rig { joints: vec![joint; MAX_JOINTS - 1], ..Rig::still(&mesh) };
    assert!(rig.append(Rig::still(&mesh)).is_ok());
    assert_eq!(rig.vertices[3].joints[0], u16::MAX);
    let error = rig.append(Rig::still(&mesh)).unwrap_err().to_string();
    assert_eq!(error, "the rig has 65537 joints, more than 65536");
}
