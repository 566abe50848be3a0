//! Large worlds: hair moves the same at another place, on a platform, or in other coordinates, bit-identical where
//! positions can be represented. Hair at several places is drawn together.

use crate::{common, golden::difference};
use tresses::{
    Camera, Context, HairOptions, Picture, Pose, SimulationParams, Space, Velocity, View, ViewOptions, Wind,
    collide::{Anchor, Collider, ColliderDescriptor, ColliderPoses, Shape},
    glam::{DQuat, DVec3, Quat, Vec3},
    groom::{BindOptions, GuideCount, bind},
    light::Sphere,
    low_level::{Drawing, Hair, HairFrame, StrandVertex},
    renderer::Renderer,
};

/// Creates a hanging groom, a ball that passes by, and glasses. `size` scales the head, the ball and the glasses.
fn hair(context: &Context, size: f32) -> Hair {
    let options = BindOptions { guides: GuideCount::Count(30), ..Default::default() };
    let groom = bind(&common::hanging(90, 12, 0.15), &options).unwrap();
    let field = common::ball(0.085 * size, 32);
    let ball = Collider::new(Shape::sphere(0.04 * size));
    let colliders = [ball, Collider { anchor: Anchor::Head, ..ball }];
    let what = ColliderDescriptor { head: Some(&field), colliders: &colliders, ..Default::default() };
    let options = HairOptions::default();
    common::hair_among(context, &groom, &options, &what).unwrap()
}

fn nod(t: f64) -> Pose {
    let t = t as f32;
    let rotation = Quat::from_rotation_y(0.5 * (7.0 * t).sin());
    Pose { rotation, translation: Vec3::new(0.1 * (5.0 * t).sin(), 0.02 * (9.0 * t).sin(), 0.0) }
}

/// Inputs of a frame.
struct Given {
    space: Space,
    head: Pose,
    /// Pose from the space in which the ball's motion is defined to the space in which it is given.
    given: Pose,
    drawn_in: Option<Space>,
}

impl Given {
    fn at(space: Space, t: f64) -> Self {
        Self { space, head: nod(t), given: Pose::IDENTITY, drawn_in: None }
    }
}

/// Simulates 0.3 s at 50 frames per second.
fn ride(context: &Context, size: f32, physics: &SimulationParams, given: &dyn Fn(f64) -> Given) -> Hair {
    let mut hair = hair(context, size);
    for i in 0..=15 {
        let t = f64::from(i) / 50.0;
        let Given { space, head, given, drawn_in } = given(t);
        let ball = Pose { translation: Vec3::new(0.13 - 0.1 * t as f32, -0.1, 0.0), ..Pose::IDENTITY };
        let glasses = Pose { translation: Vec3::Z * 0.08, ..Pose::IDENTITY };
        let colliders = &ColliderPoses { head: None, colliders: vec![given.after(&ball), glasses] };
        let dt = if i == 0 { 0.0 } else { 0.02 };
        let frame = HairFrame { dt, head, colliders, simulation: physics, space, drawn_in };
        common::advance(&mut hair, &frame);
    }
    hair
}

/// Simulates and returns the drawn strands.
fn run(context: &Context, physics: &SimulationParams, given: &dyn Fn(f64) -> Given) -> Vec<StrandVertex> {
    common::vertices(&ride(context, 1.0, physics, given))
}

/// Returns the largest distance between the strands `a`, moved by `way`, and the strands `b`, meters.
fn apart(a: &[StrandVertex], way: Vec3, b: &[StrandVertex]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a.position + way).distance(b.position)).fold(0.0, f32::max)
}

fn same(a: &[StrandVertex], b: &[StrandVertex]) -> bool {
    bytemuck::cast_slice::<_, u8>(a) == bytemuck::cast_slice::<_, u8>(b)
}

#[test]
fn distant_and_carried_hair_is_bit_identical() {
    let Some(context) = common::context() else { return };
    let physics = SimulationParams::default();
    let here = run(context, &physics, &|t| Given::at(Space::WORLD, t));
    let far = DVec3::new(1e4 + 0.1, -3.7, 2e3);
    let there = |t| Given::at(Space::at(far), t);
    assert!(same(&here, &run(context, &physics, &there)), "10 km from the origin");
    let moves = DVec3::new(100.0, 0.0, 7.0);
    let platform = |t: f64| Given::at(Space { moves_air: true, ..Space::at(10.0 * far + moves * t) }, t);
    assert!(same(&here, &run(context, &physics, &platform)), "on a platform at 100 m/s");
    let jumps = |t: f64| {
        let i = (t * 50.0).round();
        Given::at(Space::at(DVec3::new(i % 2.0, (i * 7.0) % 5.0, 0.0) * 1e3), t)
    };
    assert!(same(&here, &run(context, &physics, &jumps)), "kilometers from where it was in each frame");
    // Poses that contain the place, in single precision.
    let folded = |t: f64| {
        let given = Pose { translation: far.as_vec3(), ..Pose::IDENTITY };
        Given { head: given.after(&nod(t)), given, ..Given::at(Space::WORLD, t) }
    };
    let off = apart(&run(context, &physics, &folded), -far.as_vec3(), &here);
    assert!(off > 1e-4, "folded {off} m");
}

#[test]
fn other_coordinates_do_not_change_the_motion() {
    let Some(context) = common::context() else { return };
    // Without chaotic effects: strands that buckle or touch something, and self-collision, whose grid depends on
    // rounding.
    let mut physics = SimulationParams::default();
    physics.hair_hair.mode = tresses::HairHairMode::Off;
    physics.bending.root *= 100.0;
    physics.bending.tip *= 100.0;
    let go = |given: &dyn Fn(f64) -> Given| {
        let hair = ride(context, 0.01, &physics, given);
        (common::vertices(&hair), hair.colliders.drawn()[1].translation)
    };
    // An accelerating run of 2.7 m.
    let walk = |t: f64| Pose { translation: nod(t).translation + Vec3::X * 30.0 * (t * t) as f32, ..nod(t) };
    let start = Space::at(DVec3::new(3e4, 0.0, 50.0));
    let (here, ball) = go(&|t| Given { head: walk(t), given: walk(t), ..Given::at(start, t) });
    // The same motion given from elsewhere, from a floating origin, and from an origin that also rotates; drawn in the
    // first space. From elsewhere, rounding alone causes 0.15 mm.
    let elsewhere = |_: f64| Space::at(start.at + DVec3::new(0.7, 0.1, -0.3));
    let floats = |t: f64| Space::at(start.at + DVec3::X * (t / 0.1).floor());
    let turns = |t: f64| Space { rotation: DQuat::from_rotation_y((t / 0.12).floor() * 0.8), ..floats(t) };
    for space in [&elsewhere as &dyn Fn(f64) -> Space, &floats, &turns] {
        let (there, too) = go(&|t| {
            let given = space(t).pose_from(&start, &walk(t));
            Given { space: space(t), head: given, given, drawn_in: Some(start) }
        });
        let off = apart(&there, Vec3::ZERO, &here);
        println!("{off:.1e} m");
        assert!(off < 3e-4 && too.distance(ball) < 2e-6, "{off} {too} {ball}");
    }
    // A head that its space carries through the same places has other hair.
    let follows = |t: f64| Space::at(start.at + (walk(t).translation - nod(t).translation).as_dvec3());
    let (carried, _) = go(&|t| Given { drawn_in: Some(start), ..Given::at(follows(t), t) });
    assert!(apart(&carried, Vec3::ZERO, &here) > 1e-2);
}

#[test]
fn moving_platform_in_still_air_feels_wind() {
    let Some(context) = common::context() else { return };
    let wind = |v: f32| SimulationParams {
        wind: Wind { gusts: 0.0, resolution: 8, ..Wind::new(Vec3::X * v) },
        ..Default::default()
    };
    let stands = run(context, &wind(6.0), &|t| Given::at(Space::WORLD, t));
    let space = |t: f64, v: f64| Space {
        velocity: Some(Velocity { linear: DVec3::X * v, angular: DVec3::ZERO }),
        ..Space::at(DVec3::new(2e4 + v * t, 0.0, 0.0))
    };
    let moves = run(context, &wind(0.0), &|t| Given::at(space(t, -6.0), t));
    assert!(same(&stands, &moves));
    // Hair that moves with the wind does not feel it, in the simulated air and beside it.
    let calm = run(context, &wind(0.0), &|t| Given::at(Space::WORLD, t));
    assert!(same(&calm, &run(context, &wind(6.0), &|t| Given::at(space(t, 6.0), t))));
    assert!(apart(&calm, Vec3::ZERO, &stands) > 1e-2);
}

#[test]
fn hair_at_several_places_is_drawn_together() {
    let Some(context) = common::context() else { return };
    let spaces = |far: DVec3| {
        let turned = DQuat::from_rotation_y(0.6);
        [Space::at(far - DVec3::X * 0.2), Space { rotation: turned, ..Space::at(far + DVec3::X * 0.2) }]
    };
    let scene = Picture {
        camera: Camera::look_at(Vec3::Z * 1.2, Vec3::ZERO, 0.5, [128, 96]),
        focus: Sphere { center: Vec3::ZERO, radius: 0.5 },
        ..Default::default()
    };
    let options = ViewOptions { shadow_resolution: 256, renderer: Renderer::masks(4), ..common::coarse() };
    let see = |far: DVec3, seen: bool| {
        let mut pair = [(); 2].map(|()| hair(context, 1.0));
        let view = View::new(context, &options, [128, 96], 1).unwrap();
        let colliders =
            &ColliderPoses { head: None, colliders: vec![Pose { translation: Vec3::Y, ..nod(0.0) }; 2] };
        for i in 0..4 {
            let (head, dt) = (nod(0.02 * f64::from(i)), if i == 0 { 0.0 } else { 0.02 });
            for (hair, space) in pair.iter_mut().zip(spaces(far)) {
                let drawn_in = seen.then_some(Space::at(far));
                let frame = HairFrame { dt, head, colliders, space, drawn_in, ..Default::default() };
                common::advance(hair, &frame);
            }
        }
        let [one, other] = &pair;
        let done =
            common::try_submit(|recorder| recorder.draw(&[one, other], &[], &view, Drawing::new(&scene)));
        done.map(|()| pollster::block_on(view.targets().read()).unwrap())
    };
    let here = see(DVec3::ZERO, true).unwrap();
    for far in [DVec3::new(1e4, 3.0, -2e3), DVec3::new(4e6, 100.0, -1e5)] {
        let there = see(far, true).unwrap();
        assert!(here == there, "{far}: {:?}", difference(&here, &there));
    }
    assert!(difference(&here, &vec![0; here.len()]).0 > 1.0);
    // Without `drawn_in`, each groom would be drawn at the origin.
    let why = see(DVec3::ZERO, false).unwrap_err().to_string();
    assert!(why.contains("drawn_in"), "{why}");
}
