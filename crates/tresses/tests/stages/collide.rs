//! Hair among moving obstacles: no vertex stays inside an obstacle, however it moves.

use crate::{
    common,
    moving::{Character, SHAKE, angle},
};

use tresses::{
    Context, HairHair, HairOptions, Pose, SimulationParams,
    collide::{Collider, ColliderDescriptor, ColliderPoses, Shape, shape},
    glam::{Quat, Vec3},
    groom::{BindOptions, GuideCount, SdfGrid, Strands, bind, styles::Style},
    low_level::{Hair, HairFrame, readback::blocking as readback},
    strands::{Guide, PackedGuide},
};

/// Depth from which a vertex counts as inside, meters.
const DEEP: f32 = 5e-4;
/// Steps in a row that a vertex may be inside.
const STEPS: u32 = 2;

fn sintel() -> Option<Character> {
    let (strands, head, field) = common::sintel()?;
    let crown = head.bounds().unwrap().1.y;
    let groom = bind(strands, &BindOptions::default()).unwrap();
    Some(Character::new(groom, field.clone(), Vec3::new(0.0, crown - 0.165, -0.012)))
}

/// Returns the head's pose at time `t` of the motion `shake`.
fn shake(character: &Character, t: f32) -> Pose {
    character.head(angle(SHAKE, t % 2.5))
}

/// Measurements of a run.
#[derive(Debug, Default)]
struct RunStatistics {
    /// Number of watched vertices: all but those that follow the head rigidly.
    vertices: usize,
    /// Number of watched vertices that rest inside. They may be as deep as at rest.
    rest_inside: usize,
    /// Largest depth beyond the allowed depth, meters.
    deepest: f32,
    /// Largest number of steps in a row that a vertex was too deep.
    longest: u32,
    /// Sum over all steps of the vertices that were too deep.
    deep: usize,
    /// Number of times that a vertex passed through an obstacle within one step.
    tunnelled: usize,
}

impl RunStatistics {
    fn holds(&self) -> bool {
        self.longest <= STEPS && self.tunnelled == 0
    }
}

struct Run<'a> {
    context: &'a Context,
    hair: Hair,
    params: SimulationParams,
}

impl Run<'_> {
    /// Simulates and measures `seconds`. `head(t)` and `poses(t)` give the poses of head and colliders, and
    /// `distance(x, t)` the signed distance of a point. `through(before, after, t)` is whether a vertex passed through
    /// an obstacle in the step that ends at `t`.
    fn watch(
        &mut self,
        seconds: f32,
        head: &dyn Fn(f32) -> Pose,
        poses: &dyn Fn(f32) -> ColliderPoses,
        distance: &dyn Fn(Vec3, f32) -> f32,
        through: &dyn Fn(Vec3, Vec3, f32) -> bool,
    ) -> RunStatistics {
        let context = self.context;
        let packed: Vec<PackedGuide> = readback::buffer(context, &self.hair.guides.rest).unwrap();
        let rest: Vec<_> = packed.iter().map(|packed| packed.rest(&Guide::default())).collect();
        let count = self.hair.guides.count as usize;
        let watched = 2 * count..rest.len();
        let mut seen = RunStatistics {
            vertices: watched.len(),
            rest_inside: rest[watched.clone()].iter().filter(|r| r.contact < 0.0).count(),
            ..RunStatistics::default()
        };
        let mut runs = vec![0; rest.len()];
        let mut before: Vec<Vec3> = Vec::new();
        for frame in 0..=(seconds / self.params.step) as u32 {
            let t = frame as f32 * self.params.step;
            let input = HairFrame {
                dt: if frame == 0 { 0.0 } else { self.params.step },
                head: head(t),
                colliders: &poses(t),
                simulation: &self.params,
                ..Default::default()
            };
            common::simulate(&mut self.hair, &input);
            let at = common::guides(&self.hair);
            for i in watched.clone() {
                let x = at[i];
                assert!(x.is_finite());
                let depth = rest[i].contact.min(0.0) - distance(x, t);
                seen.deepest = seen.deepest.max(depth);
                runs[i] = if depth > DEEP { runs[i] + 1 } else { 0 };
                seen.longest = seen.longest.max(runs[i]);
                seen.deep += usize::from(depth > DEEP);
                seen.tunnelled += usize::from(before.get(i).is_some_and(|was| through(*was, x, t)));
            }
            before = at;
        }
        seen
    }
}

fn run<'a>(context: &'a Context, character: &Character, colliders: &[Collider]) -> Run<'a> {
    let what = ColliderDescriptor { head: Some(&character.field), colliders, ..Default::default() };
    let options = HairOptions::default();
    let hair = common::hair_among(context, &character.groom, &options, &what).unwrap();
    Run { context, hair, params: options.simulation }
}

/// Shakes the head for `seconds`.
fn shaken(context: &Context, name: &str, character: &Character, seconds: f32) -> RunStatistics {
    let head = |t| shake(character, t);
    let seen = run(context, character, &[]).watch(
        seconds,
        &head,
        &|_| ColliderPoses::default(),
        &|x, t| character.field.sample(head(t).inverse().point(x)),
        &|_, _, _| false,
    );
    println!("{name}, {seconds} s of shake: {seen:?}");
    // Vertices that rest inside are exempt, so they must be few.
    assert!(seen.rest_inside < seen.vertices / 20);
    seen
}

#[test]
fn no_vertex_stays_in_the_head_during_a_shake() {
    let Some(context) = common::context() else { return };
    let character = Character::built_in("long", 500);
    assert!(shaken(context, "long", &character, 1.5).holds());
    // The test fails for a head that is larger by twice the clearance.
    let SdfGrid { distances, .. } = &character.field;
    let distances = distances.iter().map(|d| d - 3e-3).collect();
    let field = SdfGrid { distances, ..character.field.clone() };
    let mut run = run(context, &character, &[]);
    let head = |t| shake(&character, t);
    let inside = |x: Vec3, t: f32| field.sample(head(t).inverse().point(x));
    assert!(!run.watch(0.3, &head, &|_| ColliderPoses::default(), &inside, &|_, _, _| false).holds());
}

/// Prints the table of docs/validation/motion.md.
#[test]
#[ignore = "proof"]
fn no_vertex_of_any_groom_stays_in_the_head_during_a_shake() {
    let Some(context) = common::context() else { return };
    let mut all = true;
    for name in Style::NAMES {
        all &= shaken(context, name, &Character::built_in(name, 500), 10.0).holds();
    }
    if let Some(character) = sintel() {
        all &= shaken(context, "Sintel", &character, 10.0).holds();
    }
    assert!(all);
}

/// Radius of the forearm, meters.
const HAND: f32 = 0.035;

/// Moves a forearm of 30 cm through the hair below the head, from back to front, at `speed` m/s.
fn sweep(context: &Context, character: &Character, speed: f32) -> RunStatistics {
    let shape = Shape::Capsule { half_length: 0.15, radius: HAND };
    let neck = character.neck;
    let way = 0.6;
    let hand = |t: f32| Pose {
        rotation: Quat::from_rotation_z(1.4),
        translation: neck + Vec3::new(0.25, -0.02, -0.5 * way + (speed * (t - 0.1).max(0.0)).min(way)),
    };
    let poses = |t| ColliderPoses { head: None, colliders: vec![hand(t)] };
    // Beside the neck, the forearm sinks up to 2 cm into the head, which leaves no room for hair between them.
    let room = |x: Vec3, t: f32| {
        let along = hand(t).inverse().point(x).y.clamp(-0.15, 0.15);
        character.field.sample(hand(t).point(Vec3::Y * along)) - HAND
    };
    let distance = |x: Vec3, t: f32| match room(x, t) {
        room if room < 2.0 * HairOptions::default().rest.clearance => 1.0,
        _ => shape::capsule(hand(t).inverse().point(x), HAND, 0.15).w,
    };
    // In the forearm's frame: the vertex passed within half a radius of its axis.
    let through = |before: Vec3, after: Vec3, t: f32| {
        let (a, b) = (hand(t - 1.0 / 60.0).inverse().point(before), hand(t).inverse().point(after));
        (0..=8).any(|i| shape::capsule(a.lerp(b, i as f32 / 8.0), 0.5 * HAND, 0.15).w < 0.0)
    };
    let mut run = run(context, character, &[Collider::new(shape)]);
    // The forearm starts away from the hair.
    let seen = run.watch(0.1 + way / speed + 0.2, &|_| Pose::IDENTITY, &poses, &distance, &through);
    println!("a hand at {speed} m/s: {seen:?}");
    seen
}

#[test]
fn a_hand_pushes_hair_aside() {
    let Some(context) = common::context() else { return };
    let seen = sweep(context, &Character::built_in("long", 500), 3.0);
    assert!(seen.holds(), "{seen:?}");
}

/// Prints the table of docs/validation/motion.md. Speeds above 3 m/s are printed only.
#[test]
#[ignore = "proof"]
fn a_hand_of_any_speed_pushes_hair_aside() {
    let Some(context) = common::context() else { return };
    let character = Character::built_in("long", 500);
    let seen = [0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 10.0].map(|speed| (speed, sweep(context, &character, speed)));
    for (speed, seen) in &seen {
        assert!(*speed > 3.0 || seen.holds(), "{speed} m/s: {seen:?}");
    }
}

/// Returns for each of 64 straight strands the largest displacement of a vertex after one second, meters. A small
/// capsule blocks every strand but `spared`.
fn moved_by_capsules(context: &Context, spared: Option<usize>) -> Vec<f32> {
    let root = |i: usize| 0.04 * Vec3::new((i % 8) as f32, 0.0, (i / 8) as f32);
    let mut strands = Strands::default();
    for i in 0..64 {
        let line: Vec<_> = (0..12).map(|j| root(i) - Vec3::Y * 0.2 * j as f32 / 11.0).collect();
        strands.push(&line);
    }
    let options = BindOptions { guides: GuideCount::Count(64), ..Default::default() };
    let groom = bind(&strands, &options).unwrap();
    assert_eq!(groom.guides.len(), 64);
    let capsule = Collider::new(Shape::Capsule { half_length: 0.004, radius: 0.01 });
    let what = ColliderDescriptor { colliders: &[capsule; 64], ..Default::default() };
    let pose = |i: usize| {
        let away = if Some(i) == spared { 10.0 } else { 0.0 };
        Pose { translation: root(i) + Vec3::new(0.004 + away, -0.12, 0.0), ..Pose::IDENTITY }
    };
    let colliders = ColliderPoses { head: None, colliders: (0..64).map(pose).collect() };
    let mut hair = common::hair_among(context, &groom, &HairOptions::default(), &what).unwrap();
    // No self-collision, so that strands are independent.
    let physics = SimulationParams { hair_hair: HairHair::OFF, ..Default::default() };
    let mut read = |dt: f32| {
        let frame = HairFrame { dt, colliders: &colliders, simulation: &physics, ..Default::default() };
        common::simulate(&mut hair, &frame);
        common::guides(&hair)
    };
    let before = read(0.0);
    let after = (0..15).map(|_| read(4.0 / 60.0)).last().unwrap();
    let mut moved = vec![0f32; 64];
    for (at, (a, b)) in before.iter().zip(&after).enumerate() {
        // Guides are not in the order of the strands.
        let place = before[at % 64] / 0.04;
        let strand = place.x.round() as usize + 8 * place.z.round() as usize;
        moved[strand] = moved[strand].max(a.distance(*b));
    }
    moved
}

#[test]
fn all_64_capsules_collide() {
    let Some(context) = common::context() else { return };
    let least = |moved: &[f32]| moved.iter().copied().fold(f32::MAX, f32::min);
    let all = moved_by_capsules(context, None);
    println!("strands are moved by {} mm or more", 1e3 * least(&all));
    assert!(least(&all) > 0.01, "{all:?}");
    // A strand without a capsule is detected, whichever word of the collision masks holds the capsule's bit.
    for spared in [0, 31, 32, 63] {
        let moved = moved_by_capsules(context, Some(spared));
        assert!(moved[spared] < 1e-3, "{spared}: {}", moved[spared]);
        let still: Vec<_> = (0..64).filter(|i| moved[*i] < 0.01).collect();
        assert_eq!(still, [spared], "{moved:?}");
    }
}
