//! Hair between two colliders: a finger that presses it onto a plane, rubs and lifts; two fingers that close on it.

use super::{
    lab::{Experiment, Lab, bare, straight},
    table::{Row, at_most, judge},
};
use tresses::{
    Pose, RestShape, SimulationParams,
    collide::{Collider, ColliderDescriptor, FieldId, FieldSource, Shape},
    glam::Vec3,
    groom::SdfGrid,
};

/// Radius of a finger, meters.
const FINGER: f32 = 8e-3;
/// Clearance of hair from colliders, meters.
const CLEARANCE: f32 = 1.5e-3;

/// Motion of a finger: time (s) and position (meters).
type Keys = [(f32, Vec3)];

fn along(keys: &Keys, t: f32) -> Vec3 {
    let Some(w) = keys.windows(2).find(|w| t < w[1].0) else { return keys[keys.len() - 1].1 };
    let s = ((t - w[0].0) / (w[1].0 - w[0].0)).clamp(0.0, 1.0);
    w[0].1.lerp(w[1].1, s)
}

/// Moves the last colliders along `keys`. Returns the largest depth of a vertex below y = 0, meters, and how many times
/// a vertex has `passed` the fingers.
fn play(
    e: &mut Experiment,
    seconds: f32,
    keys: &[&Keys],
    passed: impl Fn(Vec3, &[Vec3]) -> bool,
) -> (f32, usize) {
    let (mut deepest, mut through) = (f32::MIN, 0);
    for i in 1..=(seconds / e.params.step).round() as usize {
        let at: Vec<_> = keys.iter().map(|keys| along(keys, i as f32 * e.params.step)).collect();
        let moved = e.obstacles.colliders.iter_mut().rev().zip(at.iter().rev());
        moved.for_each(|(pose, at)| pose.translation = *at);
        e.run_still(1);
        for x in &e.positions()[0][2..] {
            deepest = deepest.max(-x.y);
            through += usize::from(passed(*x, &at));
        }
    }
    (deepest, through)
}

/// Creates a hair that lies on a plane along z, and a finger along x above it.
fn on_a_plane(lab: &'static Lab) -> Experiment {
    let plane = SdfGrid::from_fn(Vec3::splat(-0.3), Vec3::splat(0.3), 31, |p| p.y);
    let strand: Vec<_> = straight(16, 0.2, Vec3::Z).into_iter().map(|p| p + Vec3::Y * CLEARANCE).collect();
    let (finger, pose) = Shape::capsule(Vec3::X * -0.05, Vec3::X * 0.05, FINGER);
    let colliders = [Collider::new(Shape::Field(FieldId(0))), Collider::new(finger)];
    let what = ColliderDescriptor {
        fields: &[FieldSource::Grid(&plane)],
        colliders: &colliders,
        ..Default::default()
    };
    let params = SimulationParams { friction: 0.4, drag: 1.0, ..bare(8e-9) };
    let above = Pose { translation: Vec3::new(0.0, 0.06, 0.1), ..pose };
    let shape = RestShape::SagFree;
    let mut e = Experiment::new(lab, &[strand], &[], params, shape, None)
        .with_colliders(&what, vec![Pose::IDENTITY, above]);
    e.run_still(20);
    e
}

fn pressed(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let mut rows = Vec::new();
    for (speed, gap) in [(0.5f32, 1e-3f32), (2.0, 1e-3), (0.5, -4e-3), (2.0, -4e-3)] {
        let mut e = on_a_plane(lab);
        let low = FINGER + gap - if fault { 4e-3 } else { 0.0 };
        let down = 0.05 / speed;
        let at = |y: f32, z: f32| Vec3::new(0.0, y, z);
        let keys = [
            (0.0, at(low + 0.05, 0.1)),
            (down, at(low, 0.1)),
            (down + 0.2, at(low, 0.1)),
            (down + 0.4, at(low, 0.15)),
            (down + 0.8, at(low, 0.05)),
            (down + 1.0, at(low, 0.05)),
            (down + 1.0 + down, at(low + 0.05, 0.05)),
        ];
        // Hair above the center of the finger has passed through it.
        let passed = |x: Vec3, at: &[Vec3]| (x.z - at[0].z).abs() < FINGER && x.y > at[0].y;
        let (deepest, through) = play(&mut e, down + 1.0 + down, &[&keys], passed);
        let expected = (0.5 * -gap).max(0.0);
        let case = if gap > 0.0 { "1 mm above it" } else { "4 mm into it" };
        let case = format!("finger presses hair onto a plane, {speed} m/s, to {case}, rubs, lifts");
        rows.push(at_most(format!("{case}: deeper than half way"), "mm", 0.5, (deepest - expected) * 1e3));
        assert!(fault || through == 0, "{case}: {through} through the finger");
    }
    rows
}

/// Two fingers close on hanging hair until they overlap by 4 mm, carry it 3 cm sideways, and open.
fn between_fingers(lab: &'static Lab, fault: bool) -> Vec<Row> {
    let (finger, pose) = Shape::capsule(Vec3::Z * -0.05, Vec3::Z * 0.05, FINGER);
    let what = ColliderDescriptor { colliders: &[Collider::new(finger); 2], ..Default::default() };
    let mut rows = Vec::new();
    for speed in [0.5f32, 2.0] {
        let strand = straight(16, 0.2, Vec3::NEG_Y);
        let params = SimulationParams { friction: 0.4, drag: 1.0, ..bare(8e-9) };
        let mut e = Experiment::new(lab, &[strand], &[], params, RestShape::SagFree, None)
            .with_colliders(&what, vec![pose; 2]);
        let closed = FINGER - 2e-3 - if fault { 3.0 * FINGER } else { 0.0 };
        let time = 0.05 / speed;
        let keys = [-1.0f32, 1.0].map(|side| {
            let at = |open: f32, aside: f32| Vec3::new(side * (closed + open) + aside, -0.1, 0.0);
            let (shut, far) = (at(0.0, 0.0), at(0.0, 0.03));
            [
                (0.0, at(0.05, 0.0)),
                (time, shut),
                (time + 0.2, shut),
                (time + 0.3, far),
                (time + 0.4, far),
                (2.0 * time + 0.4, at(0.05, 0.03)),
            ]
        });
        for (pose, keys) in e.obstacles.colliders.iter_mut().zip(&keys) {
            pose.translation = keys[0].1;
        }
        let passed = |x: Vec3, at: &[Vec3]| (x.y + 0.1).abs() < FINGER && (x.x < at[0].x || x.x > at[1].x);
        let (_, through) = play(&mut e, 2.0 * time + 0.4, &[&keys[0], &keys[1]], passed);
        let case = format!(
            "fingers close on hair at {speed} m/s each, carry it, open: times that a vertex is beyond one"
        );
        rows.push(at_most(case, "", 0.5, through as f32));
    }
    rows
}

#[test]
fn hair_between_fingers_does_not_pass_through_them() {
    judge("fingers", between_fingers);
}

#[test]
fn hair_under_a_finger_does_not_pass_through_it() {
    judge("squeeze", pressed);
}
