//! Roots on deforming skin: skin that moves like a head is equivalent to a head, and strands begin on the skin.

use crate::common::{self, SkinnedHair, moved};
use tresses::{
    Context, Error, HairHairMode, HairOptions, Pose, RootToTip, SimulationParams,
    glam::{Mat3, Quat, Vec3},
    groom::{BindOptions, Groom, GuideCount, TriMesh, bind, mesh::shapes},
    low_level::{HairFrame, Skin, Words},
};

/// Returns strands that are their own guides, or that follow some of them.
fn groom(guides: GuideCount) -> Groom {
    bind(&common::hanging(150, 12, 0.15), &BindOptions { guides, ..Default::default() }).unwrap()
}

/// Returns parameters without self-collision, whose grid moves with the head, and so stiff that no strand buckles.
/// Strands that buckle are chaotic: rounding decides where they swing.
fn stiff() -> SimulationParams {
    let mut params = SimulationParams::default();
    params.hair_hair.mode = HairHairMode::Off;
    let bending =
        RootToTip { root: 100.0 * params.bending.root, tip: 100.0 * params.bending.tip, ..params.bending };
    SimulationParams { bending, ..params }
}

/// Hair on a ball, attached to its skin if `living`.
struct Stage(SkinnedHair);

impl Stage {
    fn new(context: &Context, groom: &Groom, living: bool) -> Self {
        let hair = common::hair(context, groom, &HairOptions::default(), None).unwrap();
        // The ball on which `common::hanging` strands stand.
        let mut skinned = SkinnedHair::new(context, hair, &shapes::sphere(0.09, 24));
        if living {
            let SkinnedHair { hair, body, rest } = &mut skinned;
            let report = hair.attach(rest, &Skin::from(&*body), 0.005).unwrap();
            assert!(report.max_distance < 1e-3 && report.roots > 150, "{report:?}");
        }
        Self(skinned)
    }

    /// Advances by a frame. `place` moves the skin's rest positions, and the head moves to `head`.
    fn advance(&mut self, head: Pose, dt: f32, place: impl Fn(Vec3) -> Vec3) {
        self.0.advance(&HairFrame { simulation: &stiff(), ..common::frame(head, dt) }, place);
    }

    fn positions(&self) -> Vec<Vec3> {
        common::positions(&self.0.hair)
    }
}

/// Returns the pose of a head that turns, nods and moves along.
fn motion(t: f32) -> Pose {
    let rotation =
        Quat::from_euler(tresses::glam::EulerRot::YXZ, 0.5 * (4.0 * t).sin(), 0.15 * (3.0 * t).sin(), 0.0);
    Pose { rotation, translation: Vec3::new(0.1 * (4.0 * t).sin(), 0.02 * (3.0 * t).sin(), 0.0) }
}

#[test]
fn rigid_skin_motion_equals_head_motion() {
    let Some(context) = common::context() else { return };
    for guides in [GuideCount::All, GuideCount::Count(40)] {
        let groom = groom(guides);
        let mut rigid = Stage::new(context, &groom, false);
        // In `skinned` the skin does all of the motion; in `shared` skin and head share it.
        let mut skinned = Stage::new(context, &groom, true);
        let mut shared = Stage::new(context, &groom, true);
        let still = rigid.0.hair.strands.vertex_count as usize;
        let mut most = [0.0f32; 2];
        // Neither as long as a step nor a multiple of it.
        let dt = 0.0119;
        for i in 0..50 {
            let t = i as f32 * dt;
            let pose = motion(t);
            let half = Pose { translation: 0.5 * pose.translation, ..pose };
            rigid.advance(pose, dt, |p| p);
            skinned.advance(Pose::IDENTITY, dt, |p| pose.point(p));
            shared.0.hair.roots.as_mut().unwrap().pose = half;
            shared.advance(half, dt, |p| half.inverse().point(pose.point(p)));
            let there = rigid.positions();
            for (most, other) in most.iter_mut().zip([&skinned, &shared]) {
                *most = most.max(common::apart(&there, &other.positions()));
            }
        }
        println!("{guides:?}: skin alone {:.1e} m, with the head {:.1e} m", most[0], most[1]);
        assert!(most.iter().all(|most| *most < 3e-4), "{most:?}");
        // Hair on skin that does not move is elsewhere.
        let mut idle = Stage::new(context, &groom, true);
        idle.advance(Pose::IDENTITY, dt, |p| p);
        assert!(common::apart(&rigid.positions(), &idle.positions()) > 0.05);
        assert_eq!(rigid.positions().len(), 150 * still);
    }
}

#[test]
fn still_skin_changes_nothing() {
    let Some(context) = common::context() else { return };
    let groom = groom(GuideCount::Count(40));
    let (mut rigid, mut living) = (Stage::new(context, &groom, false), Stage::new(context, &groom, true));
    let mut most = 0.0f32;
    for i in 0..40 {
        let pose = motion(i as f32 / 60.0);
        living.0.hair.roots.as_mut().unwrap().pose = pose;
        rigid.advance(pose, 1.0 / 60.0, |p| p);
        living.advance(pose, 1.0 / 60.0, |p| p);
        most = most.max(common::apart(&rigid.positions(), &living.positions()));
    }
    println!("{most:.1e} m");
    assert!(most < 1e-4);
}

/// Returns a position on deformed skin that twists with height and swells.
fn bent(p: Vec3, t: f32) -> Vec3 {
    let angle = 6.0 * t * p.y;
    Quat::from_rotation_y(angle) * p * (1.0 + 0.5 * t * (1.0 + (30.0 * p.x).sin()))
        + Vec3::new(0.0, 0.1 * t, 0.0)
}

/// Returns the place of `p`, near the ball's surface at rest, on the deformed skin `now`. Computed independently, from
/// the corners of the triangle.
fn on_skin(rest: &TriMesh, now: &TriMesh, p: Vec3) -> Vec3 {
    let closest = tresses::groom::mesh::Bvh::new(rest).closest_point(p).unwrap();
    let triangle = rest.triangles[closest.triangle as usize].map(|i| i as usize);
    let shares = closest.barycentric.to_array();
    let blend = |values: &[Vec3]| (0..3).map(|k| shares[k] * values[triangle[k]]).sum::<Vec3>();
    let frame = |mesh: &TriMesh| {
        let up = blend(&mesh.normals).normalize();
        let edge = mesh.positions[triangle[1]] - mesh.positions[triangle[0]];
        let x = (edge - up * up.dot(edge)).normalize();
        (blend(&mesh.positions), Mat3::from_cols(x, up, x.cross(up)))
    };
    let ((from, turned), (to, turns)) = (frame(rest), frame(now));
    to + turns * turned.transpose() * (p - from)
}

#[test]
fn strands_begin_on_the_deformed_skin() {
    let Some(context) = common::context() else { return };
    for guides in [GuideCount::All, GuideCount::Count(40)] {
        let groom = groom(guides);
        let mut stage = Stage::new(context, &groom, true);
        let mut arranged = groom.strands.clone();
        tresses::low_level::lod::arrange(&mut arranged);
        for i in 0..8 {
            let t = i as f32 / 16.0;
            stage.advance(Pose::IDENTITY, 1.0 / 45.0, |p| bent(p, t));
            let now = moved(&stage.0.rest, |p| bent(p, t));
            let vertices = stage.positions();
            let n = arranged.vertex_count as usize;
            let (mut most, mut traveled) = (0.0f32, 0.0f32);
            let mut longest = 0.0f32;
            for s in 0..arranged.len() {
                let rest: Vec<_> = arranged.rest_positions(s).collect();
                let wanted = on_skin(&stage.0.rest, &now, rest[0]);
                most = most.max(wanted.distance(vertices[s * n]));
                traveled = traveled.max(rest[0].distance(wanted));
                let length = common::length(&vertices[s * n..(s + 1) * n]);
                longest = longest.max((length / common::length(&rest) - 1.0).abs());
            }
            assert!(most < 2e-5, "{guides:?}, {t}: {most} m after {traveled} m");
            assert!(longest < 2e-3, "{guides:?}, {t}: lengths by {longest}");
            assert!(i < 2 || traveled > 0.01, "it is a test where roots move: {traveled}");
        }
    }
}

#[test]
fn first_frame_and_reset_use_the_current_skin() {
    let Some(context) = common::context() else { return };
    let groom = groom(GuideCount::All);
    let mut stage = Stage::new(context, &groom, true);
    // The first frame is on skin that is already deformed, so nothing swings there from rest.
    stage.advance(Pose::IDENTITY, 1.0 / 60.0, |p| bent(p, 0.4));
    let first = stage.positions();
    stage.advance(Pose::IDENTITY, 0.0, |p| bent(p, 0.4));
    assert!(common::apart(&first, &stage.positions()) < 1e-5);
    // The same after a reset, starting elsewhere.
    stage.advance(Pose::IDENTITY, 1.0 / 60.0, |p| bent(p, 0.1));
    stage.0.hair.reset();
    stage.advance(Pose::IDENTITY, 1.0 / 60.0, |p| bent(p, 0.4));
    assert!(common::apart(&first, &stage.positions()) < 1e-5);
}

#[test]
fn mismatched_skins_are_errors() {
    let Some(context) = common::context() else { return };
    let groom = groom(GuideCount::All);
    let SkinnedHair { mut hair, body, rest } = Stage::new(context, &groom, false).0;
    let small = shapes::sphere(0.05, 12);
    let skin = Skin::from(&body);
    let mut attach = |mesh: &TriMesh, skin: &Skin<'_>| {
        let attached = hair.attach(mesh, skin, 0.005);
        attached.map_err(|error: Error| error.to_string())
    };
    let far = attach(&small, &skin).unwrap_err();
    assert!(far.contains("40.0 mm from the mesh"), "{far}");
    let strides = Skin { positions: (skin.positions.0, Words { first: 1 << 20, stride: 7 }), ..skin };
    assert!(attach(&rest, &strides).unwrap_err().contains("too small"));
    let none = TriMesh { triangles: Vec::new(), ..rest.clone() };
    assert!(attach(&none, &skin).unwrap_err().contains("no triangles"));
    let mut wrong = rest.clone();
    wrong.triangles[0][1] = 1 << 30;
    assert!(attach(&wrong, &skin).unwrap_err().contains("missing vertex"));
    assert!(attach(&rest, &skin).is_ok());
}
