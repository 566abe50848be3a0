//! Third-party characters. Requires the folder that `TRESSES_ASSETS` names.

use std::path::PathBuf;

use super::*;
use crate::import::{ImportOptions, ImportedBody, read_body};

fn body(file: &str) -> Option<(TriMesh, Rig)> {
    let folder = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from).filter(|f| f.is_dir());
    let Some(folder) = folder else {
        let required = std::env::var_os("TRESSES_REQUIRE_ASSETS").is_some_and(|v| v == "1");
        assert!(!required, "TRESSES_ASSETS names no folder");
        println!("skipped: TRESSES_ASSETS names no folder");
        return None;
    };
    let ImportedBody { mesh, rig, .. } =
        read_body(&[folder.join("characters").join(file)], &ImportOptions::default()).unwrap();
    let rig = rig.unwrap();
    let rest = posed(&rig, &rig.rest_pose());
    assert_eq!(agree(&rest.positions, &mesh.positions, 1e-5), Ok(()));
    assert_eq!(agree(&rest.normals, &mesh.normals, 1e-5), Ok(()));
    assert_eq!(rig.to_groom, Mat4::IDENTITY);
    Some((mesh, rig))
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    points.iter().fold((Vec3::MAX, Vec3::MIN), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
}

/// Checks that all poses of all animations are finite and within three times the box at rest.
fn stays(rig: &Rig, rest: &TriMesh) -> Result<(), String> {
    let (lo, hi) = bounds(&rest.positions);
    let (middle, reach) = (0.5 * (lo + hi), 1.5 * (hi - lo).max_element());
    for animation in &rig.animations {
        for i in 0..20 {
            let time = animation.length * i as f32 / 20.0;
            let mesh = posed(rig, &rig.pose(animation, time));
            let far = |p: &Vec3| !p.is_finite() || (*p - middle).abs().max_element() > reach;
            let odd = |n: &Vec3| (n.length() - 1.0).abs() > 1e-3;
            if let Some(p) = mesh.positions.iter().find(|p| far(p)) {
                return Err(format!("{} has a vertex at {p} at {time} s", animation.name));
            }
            if let Some(n) = mesh.normals.iter().find(|n| odd(n)) {
                return Err(format!("{} has the normal {n} at {time} s", animation.name));
            }
        }
    }
    Ok(())
}

/// Returns the mean cosine between the normals at rest and the normals of their triangles.
fn outside(mesh: &TriMesh) -> f32 {
    let looks = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).normalize_or_zero().dot(mesh.normals[t[0] as usize])
    };
    mesh.triangles.iter().map(looks).sum::<f32>() / mesh.triangles.len() as f32
}

/// Checks that a body is upright along Y and has its feet near 0.
fn stands(mesh: &TriMesh) -> Result<(), String> {
    let (lo, hi) = bounds(&mesh.positions);
    let size = hi - lo;
    let upright = size.y > size.x && size.y > size.z && lo.y.abs() < 0.05 * size.y;
    if upright { Ok(()) } else { Err(format!("from {lo} to {hi}")) }
}

/// Returns the vertices that a pose moves.
fn moved(rig: &Rig, rest: &TriMesh, pose: &RigPose) -> Vec<usize> {
    let mesh = posed(rig, pose);
    let far = |i: &usize| mesh.positions[*i].distance(rest.positions[*i]) > 1e-4;
    (0..rest.positions.len()).filter(far).collect()
}

/// Checks that feet stay in a slab of a meter around the ground.
fn walks_on_the_ground(rig: &Rig) -> Result<(), String> {
    for i in 0..20 {
        let walk = &rig.animations[0];
        let pose = rig.pose(walk, walk.length * i as f32 / 20.0);
        let mesh = posed(rig, &pose);
        for (v, bind) in rig.vertices.iter().enumerate() {
            let name = &rig.nodes[rig.joints[bind.joints[0] as usize].node as usize].name;
            let p = mesh.positions[v];
            // The last two joints of each leg.
            let foot = ["leg_joint_L_5", "leg_joint_L_3", "leg_joint_R_5", "leg_joint_R_3"];
            if foot.contains(&name.as_str()) && !(-0.5..0.5).contains(&p.y) {
                return Err(format!("{name} is at {p}"));
            }
        }
    }
    Ok(())
}

#[test]
fn walking_man_stays_on_the_ground() {
    let Some((mesh, rig)) = body("CesiumMan.glb") else { return };
    assert_eq!((rig.joints.len(), rig.animations.len(), rig.targets.len()), (19, 1, 0));
    assert_eq!(stands(&mesh), Ok(()));
    let (lo, hi) = bounds(&mesh.positions);
    assert!((1.4..2.0).contains(&(hi.y - lo.y)), "{lo} {hi}");
    assert!(outside(&mesh) > 0.8, "{}", outside(&mesh));
    assert_eq!(stays(&rig, &mesh), Ok(()));
    assert_eq!(walks_on_the_ground(&rig), Ok(()));
    let walk = &rig.animations[0];
    let legs = moved(&rig, &mesh, &rig.pose(walk, 0.3 * walk.length));
    assert!(legs.len() > mesh.positions.len() / 2, "{}", legs.len());

    // The checks detect bodies that have fallen over, are inside out, lose a joint or are scaled.
    let mut fallen = mesh.clone();
    fallen.positions.iter_mut().for_each(|p| *p = Vec3::new(p.y, p.x, p.z));
    assert!(stands(&fallen).is_err());
    let mut inverted = mesh.clone();
    inverted.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    assert!(outside(&inverted) < -0.8);
    let mut astray = rig.clone();
    astray.nodes[5].rest.translation.x = f32::NAN;
    astray.animations[0].channels.retain(|c| c.node != 5);
    assert!(stays(&astray, &mesh).is_err());
    assert!(stays(&scaled(&rig, 20.0), &mesh).is_err());
    assert!(walks_on_the_ground(&scaled(&rig, 20.0)).is_err());
}

/// The same rig with scaled inverse bind matrices.
fn scaled(rig: &Rig, by: f32) -> Rig {
    let mut rig = rig.clone();
    rig.joints.iter_mut().for_each(|j| j.inverse_bind = Mat4::from_scale(Vec3::splat(by)) * j.inverse_bind);
    rig
}

#[test]
fn robot_blend_shapes_move_only_its_head() {
    let Some((mesh, rig)) = body("RobotExpressive.glb") else { return };
    let names: Vec<&str> = rig.targets.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["Angry", "Surprised", "Sad"]);
    assert!(rig.animations.len() >= 15 && rig.animation("headspin").is_some());
    assert_eq!(stands(&mesh), Ok(()));
    assert!(outside(&mesh) > 0.8, "{}", outside(&mesh));
    assert_eq!(stays(&rig, &mesh), Ok(()));
    assert!(stays(&scaled(&rig, 20.0), &mesh).is_err());

    // Vertices that follow the node of the head without a skin.
    let head = rig.nodes.iter().rposition(|n| n.name == "Head").unwrap();
    let of_head = |v: &usize| rig.joints[rig.vertices[*v].joints[0] as usize].node as usize == head;
    let all = (0..rig.vertices.len()).filter(of_head).count();
    assert!(all > 100 && all < rig.vertices.len() / 2);
    let spin = rig.animation("HeadSpin").unwrap();
    let spun = moved(&rig, &mesh, &rig.pose(spin, 0.25 * spin.length));
    assert!(spun.len() > all * 9 / 10 && spun.iter().all(of_head), "{} of {all}", spun.len());
    for target in 0..3 {
        let mood = moved(&rig, &mesh, &rig.pose_with(None, &[(target, 1.0)]));
        assert!(!mood.is_empty() && mood.iter().all(of_head), "{target}: {}", mood.len());
    }
    // The check detects a shape on another part.
    let mut off = rig.clone();
    off.targets[0].deltas[0].vertex = 0;
    let mood = moved(&off, &mesh, &off.pose_with(None, &[(0, 1.0)]));
    assert!(!of_head(&0) && !mood.iter().all(of_head));
}
