use super::*;
use crate::{
    grow::{self, Growth},
    mannequin,
    scalp::GridScalp,
    styles::{self, Style},
};

#[test]
fn skin_weights_sum_to_one_and_match_regions() {
    let mesh = mannequin::mesh(60);
    for p in &mesh.positions {
        let shares = skin_weights(*p);
        assert!(shares.iter().all(|share| (-1e-6..=1.0 + 1e-6).contains(share)), "{p}: {shares:?}");
        assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
    let whole = |p: Vec3, part: usize| assert!(skin_weights(p)[part] > 0.999, "{p}: {:?}", skin_weights(p));
    for p in [mannequin::CHIN, mannequin::NOSE_TIP, mannequin::EAR, mannequin::NAPE, mannequin::CROWN] {
        whole(p, 2);
    }
    whole(vec3(0.16, -0.13, -0.06), 0);
    whole(vec3(0.0, -0.15, 0.02), 0);
    assert!(skin_weights(NECK + vec3(0.0, 0.01, 0.04))[1] > 0.6);
}

/// The scalp is rigid, so hair follows the head's joint without skinning of its roots.
#[test]
fn hair_roots_follow_the_head_rigidly() {
    let scalp = GridScalp::of_mannequin(mannequin::sdf(mannequin::FIELD_RESOLUTION));
    let carried = |p: &Vec3| {
        let still = [jaw(*p), brows(*p)].iter().all(|by| by.length() < 1e-6);
        skin_weights(*p)[2] > 0.9999 && still
    };
    for name in Style::NAMES {
        let style: Style = name.parse().unwrap();
        let styled = styles::settled(&style.recipe(), &scalp).unwrap();
        let growth = Growth { strand_count: Some(2000), ..Growth::for_style(&style) };
        let grown = grow::grow(&styled, &growth, &scalp).unwrap();
        let roots = (0..grown.strands.len()).map(|i| grown.strand(i)[0]);
        let off: Vec<Vec3> = roots.filter(|root| !carried(root)).collect();
        assert!(off.is_empty(), "{name}: {off:?}");
    }
    assert!(!carried(&mannequin::NECK_JOINT.with_z(0.05).with_y(-0.03)), "the throat is not the head's");
}

fn bent(rig: &Rig, mesh: &TriMesh, pose: &crate::rig::RigPose) -> TriMesh {
    let mut mesh = mesh.clone();
    rig.deform(pose, &mut mesh);
    mesh
}

/// Returns the largest ratio of an edge's length in `mesh` to its length at `rest`.
fn stretch(mesh: &TriMesh, rest: &TriMesh) -> f32 {
    let edge =
        |mesh: &TriMesh, a: u32, b: u32| mesh.positions[a as usize].distance(mesh.positions[b as usize]);
    let of = |t: &[u32; 3]| {
        let pairs = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        pairs.map(|(a, b)| edge(mesh, a, b) / edge(rest, a, b).max(1e-3)).into_iter().fold(0.0, f32::max)
    };
    rest.triangles.iter().map(of).fold(0.0, f32::max)
}

#[test]
fn the_head_turns_and_the_shoulders_stay() {
    let mesh = mannequin::mesh(90);
    let rig = rig(&mesh);
    let at_rest = bent(&rig, &mesh, &rig.rest_pose());
    let off = at_rest.positions.iter().zip(&mesh.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(off < 1e-6, "at rest it is the bust: {off}");
    let turn = Quat::from_rotation_y(45f32.to_radians());
    let turns = ROTATION_WEIGHTS.map(|(node, share)| (node, Quat::IDENTITY.slerp(turn, share)));
    let turned = bent(&rig, &mesh, &rig.pose_with_rotations(None, &[], &turns));
    for ((now, was), p) in turned.positions.iter().zip(&mesh.positions).zip(&mesh.positions) {
        let (moved, shares) = (now.distance(*was), skin_weights(*p));
        if shares[0] > 0.9999 {
            assert!(moved < 2e-5, "{p} is the torso's and moves by {moved}");
        }
    }
    // Skin that belongs to the head turns by the whole angle.
    let nose =
        |mesh: &TriMesh| *mesh.positions.iter().max_by(|a, b| a.length().total_cmp(&b.length())).unwrap();
    let forward = mannequin::NOSE_TIP - mannequin::EAR.with_x(0.0);
    let tip = rig.pose_with_rotations(None, &[], &turns).palette[2].transform_vector3(forward);
    assert!(tip.angle_between(turn * forward) < 1e-3, "{}", nose(&turned));
    // Skin between the joints stretches but does not tear.
    let drawn = stretch(&turned, &mesh);
    assert!(drawn < 1.8, "{drawn}");
}

#[test]
fn blend_shapes_move_their_regions() {
    let mesh = mannequin::mesh(mannequin::RESOLUTION);
    let rig = rig(&mesh);
    let by = |name: &str, at: Vec3| {
        let pose = rig.pose_with(None, &[(rig.target(name).unwrap(), 1.0)]);
        let moved = bent(&rig, &mesh, &pose);
        let i = (0..mesh.positions.len())
            .min_by(|a, b| mesh.positions[*a].distance(at).total_cmp(&mesh.positions[*b].distance(at)));
        (moved.positions[i.unwrap()] - mesh.positions[i.unwrap()], moved)
    };
    let still = |by: Vec3| assert!(by.length() < 1e-4, "{by}");
    let (chin, opened) = by("Jaw", mannequin::CHIN);
    assert!(chin.y < -0.008 && chin.z < 0.0, "{chin}");
    still(by("Jaw", mannequin::NOSE_TIP).0);
    still(by("Jaw", vec3(0.16, -0.13, -0.06)).0);
    // The lips part at the line where they meet: just above nothing moves, just below everything does.
    still(jaw(mannequin::MOUTH + vec3(0.0, 0.002, 0.0)));
    assert!(jaw(mannequin::MOUTH - vec3(0.0, 0.003, 0.0)).y < -0.006);
    let (brow, _) = by("Brows", mannequin::BROW + vec3(0.033, 0.0, -0.005));
    assert!(brow.y > 0.004, "{brow}");
    still(by("Brows", mannequin::EYE).0);
    let (chest, _) = by("Breath", vec3(0.0, -0.16, 0.03));
    assert!(chest.z > 0.002 && chest.y > 0.0, "{chest}");
    still(by("Breath", mannequin::CHIN).0);
    // Normals follow the deformed skin.
    let mut again = TriMesh { normals: Vec::new(), ..opened.clone() };
    again.compute_normals();
    let wrong = opened.normals.iter().zip(&again.normals).filter(|(a, b)| a.dot(**b) < 0.7).count();
    assert!(wrong * 200 < mesh.positions.len(), "{wrong} of {}", mesh.positions.len());
}

#[test]
fn field_parts_cover_the_bust() {
    let bust = mannequin::sdf(mannequin::FIELD_RESOLUTION);
    let parts = parts(&bust);
    let mesh = mannequin::mesh(60);
    let mut farthest = 0f32;
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        for above in [0.0, 0.004, 0.01] {
            let p = *p + *n * above;
            let together = parts.iter().map(|part| part.sample(p)).fold(f32::INFINITY, f32::min);
            farthest = farthest.max((together - bust.sample(p)).abs());
        }
    }
    assert!(farthest < 1e-6, "{farthest}");
    // Each field covers one part: shoulders do not turn with the head.
    let shoulder = vec3(0.15, -0.1, -0.06);
    assert!(parts[0].sample(shoulder).abs() < 0.03 && parts[2].sample(shoulder) > 0.06);
    assert!(parts[0].sample(mannequin::CROWN) > 0.1 && parts[1].sample(mannequin::CROWN) > 0.06);
    let nodes = |grid: &SdfGrid| grid.distances.len();
    assert!(parts.iter().map(nodes).sum::<usize>() < 2 * nodes(&bust), "they are cut to what they hold");
}

#[test]
fn built_in_anatomy_has_head_neck_and_torso() {
    let mesh = mannequin::mesh(60);
    let bust = mannequin::sdf(mannequin::FIELD_RESOLUTION);
    let anatomy = Anatomy::built_in(&mesh, &bust);
    assert_eq!((anatomy.head.node, anatomy.parts.len(), anatomy.is_rigid), (2, 2, true));
    let field = |part: &BodyPart| match &part.field {
        DistanceFieldSource::Grid(grid) => grid.clone(),
        DistanceFieldSource::Mesh(..) => panic!("it is known"),
    };
    assert!(field(&anatomy.head).sample(mannequin::CROWN).abs() < 2e-3);
    let shoulder = Vec3::new(0.12, -0.095, -0.06);
    assert!(
        field(&anatomy.parts[1]).sample(shoulder).abs() < 0.02
            && field(&anatomy.head).sample(shoulder) > 0.05
    );
}
