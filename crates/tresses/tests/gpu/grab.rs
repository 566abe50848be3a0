//! Grabbing hair: held hair follows, other hair stays, nothing stretches or jumps.

mod brush;

use crate::{common, moving::Character};

use tresses::{
    HairHairMode, HairOptions, Pose, SimulationParams,
    collide::{Collider, ColliderPoses, Shape},
    glam::Vec3,
    groom::{BindOptions, GuideCount},
    low_level::{GrabState, GrabTarget, Hair, HairFrame, Ray, readback::blocking as readback},
};

const HEAD: f32 = 0.09;
/// A ray from the front to the hair that hangs in front of the head.
const FRONT: Ray = Ray { origin: Vec3::new(0.02, -0.03, 1.0), direction: Vec3::NEG_Z };
const RADIUS: f32 = 0.015;

struct Setup {
    character: Character,
    physics: SimulationParams,
}

impl Setup {
    fn new() -> Option<Self> {
        common::context()?;
        // No self-collision, because hair that touches the held hair would be pulled along.
        let mut physics = SimulationParams::default();
        physics.hair_hair.mode = HairHairMode::Off;
        let options = BindOptions { guides: GuideCount::OneIn(2), ..Default::default() };
        Some(Self { character: Character::on_a_ball(300, 0.2, &options), physics })
    }

    /// Creates hair that has settled for half a second.
    fn hair(&self) -> Hair {
        let mut hair = self.character.hair(&HairOptions { simulation: self.physics, ..Default::default() });
        self.still(&mut hair, 31);
        hair
    }

    fn advance(&self, hair: &mut Hair, head: Pose, dt: f32) {
        common::advance(hair, &HairFrame { simulation: &self.physics, ..common::frame(head, dt) });
    }

    fn still(&self, hair: &mut Hair, frames: u32) {
        for _ in 0..frames {
            self.advance(hair, Pose::IDENTITY, 1.0 / 60.0);
        }
    }

    /// Returns the positions of the guides in vertex-major order.
    fn guides(&self, hair: &Hair) -> Vec<Vec3> {
        common::guides(hair).iter().map(|p| hair.simulation_transform().point(*p)).collect()
    }

    fn state(&self, hair: &Hair) -> GrabState {
        let buffer = hair.grabbed().state().expect("there was a grab");
        readback::buffer(common::context().unwrap(), buffer).unwrap()[0]
    }

    /// Grabs along `ray` and advances one frame, so that the hit is known. Also returns the guides before the grab.
    fn grabbed(&self, ray: &Ray) -> (Hair, Vec<Vec3>, GrabState) {
        let mut hair = self.hair();
        let before = self.guides(&hair);
        hair.grab(ray, RADIUS).unwrap();
        self.still(&mut hair, 1);
        let state = self.state(&hair);
        (hair, before, state)
    }

    /// Drags the held hair by `way` within half a second, then waits for as long.
    fn drag(&self, hair: &mut Hair, from: Vec3, way: Vec3) {
        for i in 1..=30 {
            hair.drag_to(&GrabTarget::Point(from + way * (i as f32 / 30.0))).unwrap();
            self.still(hair, 1);
        }
        self.still(hair, 30);
    }

    /// Returns the largest strain of any edge.
    fn strain(&self, guides: &[Vec3]) -> f32 {
        let groom = &self.character.groom;
        let (count, n) = (groom.guides.len(), groom.guides.vertex_count as usize);
        let mut worst = 0.0f32;
        for guide in 0..count {
            let rest = groom.guides.guide(guide);
            for j in 1..n - 1 {
                let now = guides[j * count + guide].distance(guides[(j + 1) * count + guide]);
                worst = worst.max((now / rest[j].distance(rest[j + 1]) - 1.0).abs());
            }
        }
        worst
    }

    /// Returns the largest depth of a vertex in the head, or below its rest position in the head, meters.
    fn depth(&self, guides: &[Vec3]) -> f32 {
        let rest = &self.character.groom.guides;
        let (count, n) = (rest.len(), rest.vertex_count as usize);
        let at = |i: usize| rest.positions[(i % count) * n + i / count].length().min(HEAD);
        guides.iter().enumerate().fold(0.0, |deep, (i, p)| deep.max(at(i) - p.length()))
    }
}

#[test]
fn grabbed_hair_follows_and_the_rest_stays() {
    let Some(stage) = Setup::new() else { return };
    let (mut hair, before, state) = stage.grabbed(&FRONT);
    assert_eq!(state.held, 1);
    let aside = (state.hit - FRONT.origin).reject_from_normalized(FRONT.direction).length();
    assert!(aside < 1e-4 && state.hit.z > HEAD, "{:?}", state.hit);
    // Towards the roots, where there is slack.
    let way = Vec3::new(0.015, 0.03, 0.0);
    stage.drag(&mut hair, state.hit, way);
    let after = stage.guides(&hair);
    let count = stage.character.groom.guides.len();
    // Guides are farther apart than the radius, so the nearest one is held.
    let moving = || 2 * count..before.len();
    let least = moving().fold(f32::MAX, |least, i| least.min(before[i].distance(state.hit)));
    let firm = 0.59 * RADIUS.max(2.0 * least);
    let held: Vec<_> = moving().filter(|i| before[*i].distance(state.hit) < firm).collect();
    assert!(!held.is_empty() && least < 0.03, "nobody is held: {least}");
    let worst = held.iter().fold(0.0f32, |worst, i| worst.max(after[*i].distance(before[*i] + way)));
    println!("{} held, off by {:.2} mm at most", held.len(), 1e3 * worst);
    assert!(worst < 2e-3, "{worst}");
    // Guides without a vertex near the grab do not move.
    let mut control = stage.hair();
    stage.still(&mut control, 61);
    let control = stage.guides(&control);
    let mut touched = 0;
    for guide in 0..count {
        let of = |list: &[Vec3]| (0..list.len() / count).map(|j| list[j * count + guide]).collect::<Vec<_>>();
        let near = of(&before).iter().any(|p| p.distance(state.hit) < 0.06);
        let moved = common::apart(&of(&after), &of(&control));
        touched += u32::from(moved > 5e-3);
        assert!(near || moved == 0.0, "guide {guide} moved by {moved}");
    }
    assert!(touched > 0 && touched < count as u32 / 4, "{touched} of {count}");
}

#[test]
fn grab_pulls_in_wind_and_among_other_hair() {
    let Some(stage) = Setup::new() else { return };
    let mut hair = stage.hair();
    let before = stage.guides(&hair);
    let physics = SimulationParams {
        wind: tresses::Wind::new(Vec3::new(-3.0, 0.0, -4.0)),
        ..SimulationParams::default()
    };
    let frames = |hair: &mut Hair, count| {
        for _ in 0..count {
            let frame = common::frame(Pose::IDENTITY, 1.0 / 60.0);
            common::advance(hair, &HairFrame { simulation: &physics, ..frame });
        }
    };
    hair.grab(&FRONT, RADIUS).unwrap();
    frames(&mut hair, 1);
    let state = stage.state(&hair);
    let way = Vec3::new(0.01, 0.03, 0.01);
    hair.drag_to(&GrabTarget::Point(state.hit + way)).unwrap();
    frames(&mut hair, 40);
    let after = stage.guides(&hair);
    let count = stage.character.groom.guides.len();
    let nearest = (2 * count..before.len())
        .min_by(|a, b| before[*a].distance(state.hit).total_cmp(&before[*b].distance(state.hit)))
        .unwrap();
    let off = after[nearest].distance(before[nearest] + way);
    println!("in a wind of 5 m/s the nearest is off by {:.2} mm", 1e3 * off);
    // No other force brings it there.
    assert!(off < 3e-3 && off < 0.1 * way.length(), "{off}");
    let mut control = stage.hair();
    frames(&mut control, 41);
    assert!(stage.guides(&control)[nearest].distance(before[nearest] + way) > 0.02);
}

#[test]
fn grab_stops_at_full_length_and_releases() {
    let Some(stage) = Setup::new() else { return };
    let (mut hair, _, state) = stage.grabbed(&FRONT);
    // First out of reach, then through the head.
    for way in [Vec3::new(0.1, 0.1, 0.5), Vec3::new(0.0, 0.1, -0.4)] {
        stage.drag(&mut hair, state.hit, way);
        let now = stage.guides(&hair);
        let (strain, depth) = (stage.strain(&now), stage.depth(&now));
        println!("{way}: strain {:.2} %, {:.2} mm deep", 100.0 * strain, 1e3 * depth);
        assert!(strain < 0.01 && depth < 1e-3, "{strain} {depth}");
    }
    stage.drag(&mut hair, state.hit, Vec3::new(0.1, 0.1, 0.5));
    hair.release();
    assert!(!hair.grabbed().is_active());
    let mut last = stage.guides(&hair);
    let mut fastest = 0.0f32;
    let mut first = 0.0;
    for i in 0..40 {
        stage.still(&mut hair, 1);
        let now = stage.guides(&hair);
        fastest = fastest.max(60.0 * common::apart(&now, &last));
        if i == 0 {
            first = fastest;
        }
        assert!(stage.strain(&now) < 0.01);
        last = now;
    }
    println!("{first:.2} m/s after a step, at most {fastest:.2} m/s");
    // Gravity alone gives 0.16 m/s in a step, and 3.6 m/s over the distance that the hair falls.
    assert!(first < 1.0 && fastest < 4.0, "{first} {fastest}");
}

#[test]
fn grab_without_a_hit_changes_nothing() {
    let Some(stage) = Setup::new() else { return };
    let mut control = stage.hair();
    stage.still(&mut control, 10);
    let control = stage.guides(&control);
    let beside = Ray { origin: Vec3::new(0.5, 0.0, 1.0), direction: Vec3::NEG_Z };
    let away = Ray { direction: Vec3::Z, ..FRONT };
    // From below, through the head, towards the hair on its top.
    let hidden = Ray { origin: Vec3::NEG_Y, direction: Vec3::Y };
    for ray in [beside, away, hidden] {
        let (mut hair, _, state) = stage.grabbed(&ray);
        assert_eq!(state.held, 0, "{ray:?}");
        hair.drag_to(&GrabTarget::Point(Vec3::splat(0.3))).unwrap();
        stage.still(&mut hair, 9);
        assert!(stage.guides(&hair) == control, "{ray:?}");
    }
    // From above, that hair is not hidden.
    let (_, _, state) = stage.grabbed(&Ray { origin: Vec3::new(0.01, 1.0, 0.01), direction: Vec3::NEG_Y });
    assert!(state.held == 1 && state.hit.y > HEAD - 5e-3, "{state:?}");
    let mut hair = stage.hair();
    assert!(hair.grab(&Ray { direction: Vec3::ZERO, ..FRONT }, RADIUS).is_err());
    assert!(hair.grab(&FRONT, 0.0).is_err());
    assert!(hair.drag_to(&GrabTarget::Point(Vec3::NAN)).is_err());
}

#[test]
fn grab_is_deterministic_at_any_frame_rate() {
    let Some(stage) = Setup::new() else { return };
    // The hand moves at a constant speed, and frames end with a step.
    let pulled = |fps: f32, speed: f32| {
        let mut hair = stage.hair();
        hair.grab(&FRONT, RADIUS).unwrap();
        let at = |t: f32| Ray { origin: FRONT.origin + Vec3::new(0.3, 0.4, 0.0) * t * speed, ..FRONT };
        for i in 1..=(0.5 * fps).round() as u32 {
            hair.drag_to(&GrabTarget::Ray(at(i as f32 / fps))).unwrap();
            stage.advance(&mut hair, Pose::IDENTITY, 1.0 / fps);
        }
        stage.guides(&hair)
    };
    let reference = pulled(60.0, 1.0);
    assert!(pulled(60.0, 1.0) == reference, "not the same twice");
    for fps in [30.0, 144.0] {
        let off = common::apart(&pulled(fps, 1.0), &reference);
        println!("{fps} and 60 frames per second part by {:.3} mm", 1e3 * off);
        assert!(off < 1e-3, "{fps}: {off}");
    }
    assert!(common::apart(&pulled(60.0, 1.05), &reference) > 2e-3, "a faster hand is not seen");
}

#[test]
fn jumps_and_resets_release_the_grab() {
    let Some(stage) = Setup::new() else { return };
    for jumps in [true, false] {
        let (mut hair, _, state) = stage.grabbed(&FRONT);
        stage.drag(&mut hair, state.hit, Vec3::new(0.02, 0.0, 0.04));
        let far = Pose { translation: Vec3::X * 3.0, ..Pose::IDENTITY };
        let head = if jumps { far } else { Pose::IDENTITY };
        if !jumps {
            hair.reset();
        }
        stage.advance(&mut hair, head, 1.0 / 60.0);
        assert!(!hair.grabbed().is_active());
        let now = stage.guides(&hair);
        assert!(now.iter().all(|p| p.distance(head.translation) < 0.4));
    }
}

#[test]
fn added_ball_pushes_hair_until_it_is_removed() {
    let Some(stage) = Setup::new() else { return };
    let mut hair = stage.hair();
    let free = stage.guides(&hair);
    let ball = 0.03;
    hair.set_colliders(&[Collider::new(Shape::sphere(ball))]).unwrap();
    // From the front into the hair beside the head, and out at the back.
    let at = |t: f32| Pose { translation: Vec3::new(0.14, -0.05, 0.25 - 0.25 * t), ..Pose::IDENTITY };
    let (mut pushed, mut inside) = (0.0f32, 0.0f32);
    for i in 0..=60 {
        let place = at(i as f32 / 30.0);
        let colliders = ColliderPoses { head: None, colliders: vec![place] };
        let simulation = &stage.physics;
        let frame = HairFrame { dt: 1.0 / 60.0, colliders: &colliders, simulation, ..Default::default() };
        common::advance(&mut hair, &frame);
        let now = stage.guides(&hair);
        pushed = pushed.max(common::apart(&now, &free));
        let deepest = now.iter().fold(0.0f32, |deep, p| deep.max(ball - p.distance(place.translation)));
        inside = inside.max(deepest);
    }
    println!("a ball of {ball} m pushes by {pushed:.3} m and is entered by {:.2} mm", 1e3 * inside);
    assert!(pushed > 0.02 && inside < 2e-3, "{pushed} {inside}");
    hair.set_colliders(&[]).unwrap();
    stage.still(&mut hair, 120);
    let left = common::apart(&stage.guides(&hair), &free);
    assert!(left < 0.5 * pushed, "hair comes back: {left} of {pushed}");
    // The number of poses must be the number of colliders.
    let poses = ColliderPoses { head: None, colliders: vec![Pose::IDENTITY] };
    let frame = HairFrame { colliders: &poses, ..Default::default() };
    assert!(common::try_submit(|recorder| recorder.advance(&mut hair, &frame)).is_err());
}
