//! Distance fields that deform with a skinned mesh: hair stays outside the skin, and moving skin drags hair along.

use crate::common::{self, SkinnedHair};
use tresses::{
    Context, Error, HairHairMode, HairOptions, Pose, SimulationParams,
    collide::{Collider, ColliderDescriptor, ColliderPoses, FieldId, FieldSource, Shape},
    glam::{Quat, Vec3},
    groom::{BindOptions, Groom, GuideCount, Strands, TriMesh, bind, mesh::shapes},
    low_level::{DeformTarget, DeformingField, HairFrame, Skin},
};

/// Radius of the ball on which the strands lie, meters.
const RADIUS: f32 = 0.09;
const DT: f32 = 1.0 / 60.0;
const BALL: DeformTarget = DeformTarget::Field(FieldId(0));

/// Returns strands that start around the top of the ball and lie on it, 15 cm down to its lower half.
fn groom() -> Groom {
    let mut strands = Strands::default();
    for i in 0..150 {
        let around = i as f32 * 2.399_963;
        let down = 0.25 + 0.4 * i as f32 / 150.0;
        let along = |j: u32| {
            let angle = down + 0.15 / RADIUS * j as f32 / 23.0;
            let out = Vec3::new(angle.sin() * around.cos(), angle.cos(), angle.sin() * around.sin());
            out * (RADIUS + 3e-3 * (j as f32 / 4.0).min(1.0))
        };
        strands.push(&(0..24).map(along).collect::<Vec<_>>());
    }
    bind(&strands, &BindOptions { guides: GuideCount::All, ..Default::default() }).unwrap()
}

/// Hair on a ball whose field is rigid or deforms with the skin.
struct Stage {
    skinned: SkinnedHair,
    physics: SimulationParams,
    /// Pose of the ball relative to the head.
    ball: Pose,
}

impl Stage {
    fn new(context: &Context, deforms: bool, friction: f32) -> Self {
        let mut physics = SimulationParams { friction, ..Default::default() };
        physics.hair_hair.mode = HairHairMode::Off;
        let options = HairOptions { simulation: physics, ..Default::default() };
        let field = common::ball(RADIUS, 64);
        let what = ColliderDescriptor {
            rest: Some(&field),
            fields: &[FieldSource::Grid(&field)],
            colliders: &[Collider::new(Shape::Field(FieldId(0)))],
            ..Default::default()
        };
        let hair = common::hair_among(context, &groom(), &options, &what).unwrap();
        let mut skinned = SkinnedHair::new(context, hair, &shapes::sphere(RADIUS, 48));
        if deforms {
            let SkinnedHair { hair, body, rest } = &mut skinned;
            let fields = [DeformingField { which: BALL, triangles: &rest.triangles }];
            hair.colliders.deform(rest, &Skin::from(&*body), &fields).unwrap();
        }
        Self { skinned, physics, ball: Pose::IDENTITY }
    }

    /// Advances by a frame. `place` moves the skin's rest positions; the head and the ball's field move to `head`.
    fn advance(&mut self, head: Pose, place: impl Fn(Vec3) -> Vec3) {
        if let Some(deformation) = &mut self.skinned.hair.colliders.deformation {
            deformation.poses = vec![head.after(&self.ball)];
        }
        let colliders = ColliderPoses { head: None, colliders: vec![head.after(&self.ball)] };
        let simulation = &self.physics;
        let frame = HairFrame { dt: DT, head, colliders: &colliders, simulation, ..Default::default() };
        self.skinned.advance(&frame, place);
    }

    fn positions(&self) -> Vec<Vec3> {
        common::positions(&self.skinned.hair)
    }
}

/// Returns the height of a bump on one side of the ball in the direction `out` (unit vector), up to 2 cm, in meters.
fn bump(out: Vec3) -> f32 {
    0.02 * (1.0 - ((out - Vec3::new(0.8, 0.0, 0.6)).length() / 0.9).min(1.0).powi(2)).powi(2)
}

#[test]
fn hair_stays_outside_swelling_skin() {
    let Some(context) = common::context() else { return };
    let deepest = |deforms: bool| {
        let mut stage = Stage::new(context, deforms, 0.2);
        let mut worst = 0.0f32;
        for i in 0..90 {
            // The bump grows for half a second, then stays.
            let much = (i as f32 / 30.0).min(1.0);
            stage.advance(Pose::IDENTITY, |p| p + much * bump(p.normalize()) * p.normalize());
            if i % 10 == 9 {
                let n = stage.skinned.hair.strands.vertex_count as usize;
                let vertices = stage.positions();
                // Skip strands that are rooted in the bump, because they start below it.
                let free = vertices.chunks(n).filter(|strand| bump(strand[0].normalize()) == 0.0);
                for p in free.flat_map(|strand| &strand[2..]) {
                    worst = worst.max(RADIUS + much * bump(p.normalize()) - p.length());
                }
            }
        }
        worst
    };
    let [with, without] = [true, false].map(deepest);
    println!("{:.2} mm inside, {:.2} mm where the field stays", 1e3 * with, 1e3 * without);
    assert!(with < 1e-3 && without > 8e-3);
}

#[test]
fn rotating_skin_drags_hair_like_a_rotating_collider() {
    let Some(context) = common::context() else { return };
    // Hair lies on the ball, pressed down by four times the gravity. Either the ball rotates, or only its skin does.
    // Both must drag the hair along equally, compared with a ball at rest.
    let turn = |i: usize| Quat::from_rotation_y(0.35 * (i.saturating_sub(60) as f32 / 30.0).min(1.0));
    let moved = |ball: bool, skin: bool| {
        let mut stage = Stage::new(context, true, 0.8);
        stage.physics.gravity *= 4.0;
        for i in 0..100 {
            let [ball, skin] = [ball, skin].map(|turns| if turns { turn(i) } else { Quat::IDENTITY });
            stage.ball = Pose { rotation: ball, ..Pose::IDENTITY };
            stage.advance(Pose::IDENTITY, |p| skin * p);
        }
        stage.positions()
    };
    let (still, rigid, skinned) = (moved(false, false), moved(true, true), moved(false, true));
    let mean = |other: &[Vec3]| {
        still.iter().zip(other).map(|(a, b)| a.distance(*b)).sum::<f32>() / still.len() as f32
    };
    let off = rigid.iter().zip(&skinned).map(|(a, b)| a.distance(*b)).sum::<f32>() / still.len() as f32;
    let way = mean(&rigid);
    println!(
        "{:.2} mm taken along by a ball, {:.2} mm by its skin, {:.2} mm apart",
        1e3 * way,
        1e3 * mean(&skinned),
        1e3 * off
    );
    assert!(way > 5e-3 && off < 0.15 * way);
}

#[test]
fn still_skin_changes_nothing() {
    let Some(context) = common::context() else { return };
    let (mut rigid, mut skinned) = (Stage::new(context, false, 0.2), Stage::new(context, true, 0.2));
    let mut most = 0.0f32;
    for i in 0..40 {
        let t = i as f32 * DT;
        let rotation = Quat::from_rotation_y(0.5 * (4.0 * t).sin());
        let head = Pose { rotation, translation: Vec3::new(0.1 * (4.0 * t).sin(), 0.0, 0.0) };
        rigid.advance(head, |p| p);
        skinned.advance(head, |p| head.point(p));
        most = most.max(common::apart(&rigid.positions(), &skinned.positions()));
    }
    println!("{most:.1e} m");
    assert!(most < 1e-4);
}

#[test]
fn invalid_deforming_fields_are_errors() {
    let Some(context) = common::context() else { return };
    let SkinnedHair { mut hair, body, rest } = Stage::new(context, true, 0.2).skinned;
    let (skin, all) = (Skin::from(&body), &rest.triangles);
    let mut deform = |which, triangles: &[[u32; 3]], mesh: &TriMesh| {
        let fields = [DeformingField { which, triangles }];
        let done = hair.colliders.deform(mesh, &skin, &fields);
        done.map_err(|error: Error| error.to_string())
    };
    assert!(deform(DeformTarget::Field(FieldId(3)), all, &rest).unwrap_err().contains("no field"));
    assert!(deform(DeformTarget::Head, all, &rest).unwrap_err().contains("no field"));
    assert!(deform(BALL, &[], &rest).unwrap_err().contains("triangles"));
    assert!(deform(BALL, &[[0, 1, 1 << 30]], &rest).unwrap_err().contains("triangles"));
    let large = shapes::sphere(RADIUS, 96);
    assert!(deform(BALL, &large.triangles, &large).unwrap_err().contains("too small"));
    // A failed call changes nothing. An empty list removes the deformation.
    assert!(hair.colliders.deformation.is_some());
    hair.colliders.deform(&rest, &skin, &[]).unwrap();
    assert!(hair.colliders.deformation.is_none());
    // A frame has as many poses as fields.
    let fields = [DeformingField { which: BALL, triangles: all }];
    hair.colliders.deform(&rest, &skin, &fields).unwrap();
    hair.colliders.deformation.as_mut().unwrap().poses.clear();
    let colliders = ColliderPoses { head: None, colliders: vec![Pose::IDENTITY] };
    let frame = HairFrame { dt: DT, colliders: &colliders, ..Default::default() };
    let refused = common::try_submit(|recorder| recorder.advance(&mut hair, &frame)).unwrap_err();
    assert!(refused.to_string().contains("poses"));
}
