//! Tests of the carrier on the CPU: steps and fields against closed forms.

use super::super::Velocity;
use super::*;
use glam::Quat;

const STEP: f64 = 1.0 / 60.0;
const G: f64 = 9.81;

/// Gravity without wind.
fn still() -> Field {
    Field::of(Vec3::NEG_Y * G as f32, Vec3::ZERO)
}

/// A clock and a carrier, as in a groom.
#[derive(Default)]
struct Ride {
    clock: StepClock,
    carrier: Carrier,
}

impl Ride {
    fn frame(&mut self, space: &Space, head: &Pose, dt: f64) -> CarrierFrame {
        self.with(space, head, dt, &still())
    }

    fn with(&mut self, space: &Space, head: &Pose, dt: f64, world: &Field) -> CarrierFrame {
        if let Some(map) = self.carrier.enter(space, head, &self.clock, (dt, STEP)) {
            self.clock.enter(&map);
        }
        let ticks = self.clock.tick(dt as f32, STEP as f32, head);
        self.carrier.advance(space, (&self.clock, &ticks), (dt, STEP), Vec3::Y, world)
    }
}

fn nod(t: f64) -> Pose {
    let t = t as f32;
    Pose {
        rotation: Quat::from_rotation_y(0.5 * (7.0 * t).sin()),
        translation: Vec3::X * 0.1 * (5.0 * t).sin(),
    }
}

/// Runs frames at `fps` in a moving space and, beside each, the same frame in the world.
fn beside(
    fps: f64,
    seconds: f64,
    space: impl Fn(f64) -> Space,
    mut see: impl FnMut(f64, CarrierFrame, CarrierFrame),
) {
    let (mut there, mut here) = (Ride::default(), Ride::default());
    for i in 0..=(seconds * fps) as u32 {
        let t = f64::from(i) / fps;
        let dt = if i == 0 { 0.0 } else { 1.0 / fps };
        see(t, there.frame(&space(t), &nod(t), dt), here.frame(&Space::WORLD, &nod(t), dt));
    }
}

#[test]
fn uniform_motion_is_bit_identical_to_rest() {
    let far = DVec3::new(1e4, -37.5, 1e5 + 0.1);
    let mut wind = Vec3::ZERO;
    for way in [DVec3::ZERO, DVec3::new(100.0, 0.0, -30.0), DVec3::X * 6e4] {
        beside(
            60.0,
            0.5,
            |t| Space::at(far + way * t),
            |t, there, here| {
                assert_eq!(there.steps, here.steps);
                for (there, here) in there.fields.iter().zip(&here.fields) {
                    assert_eq!(there.gravity, here.gravity);
                    wind = there.wind;
                }
                assert!(there.shift.is_none());
                // Above the fastest wind the space takes its air along.
                if t > 0.1 {
                    let felt = if way.length() > FASTEST { Vec3::ZERO } else { -way.as_vec3() };
                    assert!((wind - felt).length() < 1e-3, "{way}: {wind}");
                }
            },
        );
    }
    // With poses in single precision, ten kilometers out, it is not.
    let folded = |t: f64| Pose { translation: nod(t).translation + far.as_vec3(), ..nod(t) };
    let (mut there, mut here) = (Ride::default(), Ride::default());
    let mut off = 0.0f32;
    for i in 0..30 {
        let t = f64::from(i) * STEP;
        let steps = [there.frame(&Space::WORLD, &folded(t), STEP), here.frame(&Space::WORLD, &nod(t), STEP)];
        let [a, b] = steps.map(|carried| carried.steps[0].end.translation);
        off = off.max((a - b - (far - far.round()).as_vec3()).length());
    }
    assert!(off > 1e-3, "{off}");
}

#[test]
fn lift_changes_gravity_at_any_frame_rate() {
    for fps in [24.0, 30.0, 60.0, 90.0, 144.0] {
        for (a, given) in [(2.0, false), (-3.0, false), (-G, false), (2.0, true), (-G, true)] {
            let lift = |t: f64| Space {
                velocity: given.then_some(Velocity { linear: DVec3::Y * a * t, angular: DVec3::ZERO }),
                ..Space::at(DVec3::new(1e4, 0.5 * a * t * t, 0.0))
            };
            let (mut sum, mut steps) = (0.0f64, 0u32);
            beside(fps, 1.0, lift, |t, there, _| {
                // A measured velocity is known after two frames, and its change after some steps, where steps end
                // between frames.
                for field in there.fields.iter().filter(|_| t > 2.5 / fps + 10.0 * STEP) {
                    let off = f64::from(field.gravity.y) + G + a;
                    assert!(off.abs() < 1e-4, "{fps} {a} {given}: {off}");
                    assert_eq!((field.gravity.x, field.gravity.z), (0.0, 0.0));
                    (sum, steps) = (sum + f64::from(field.gravity.y), steps + 1);
                }
            });
            assert!(steps > 35 && (sum / f64::from(steps) + G).abs() > 1.0);
        }
    }
}

#[test]
fn velocity_change_acts_in_full_at_any_frame_rate() {
    for fps in [30.0, 60.0, 144.0] {
        // Brakes from 12 m/s to 0 within a frame.
        let stop = |t: f64| Space::at(DVec3::X * 12.0 * t.min(0.5));
        let mut felt = Vec3::ZERO;
        beside(fps, 1.0, stop, |_, there, here| {
            let pulls = there.fields.iter().zip(&here.fields).map(|(a, b)| a.gravity - b.gravity);
            felt += pulls.sum::<Vec3>() * STEP as f32;
            assert_eq!(there.steps, here.steps);
        });
        assert!((felt - Vec3::X * 12.0).length() < 1e-3, "{fps}: {felt}");
    }
}

#[test]
fn space_jumps_exert_no_force() {
    // There and back, once; and to another place in each frame.
    let once = |t: f64| Space::at(DVec3::Z * if t > 0.25 { 1e3 } else { 0.0 });
    let wild = |t: f64| {
        let i = (t / STEP).round();
        Space::at(DVec3::new((i * 7.0) % 5.0, i % 2.0, (i * 3.0) % 4.0) * 1e3)
    };
    // An instant start, which is recognized one frame later.
    let start = |t: f64| Space::at(DVec3::X * 100.0 * (t - 0.25).max(0.0));
    for (space, last) in [(&once as &dyn Fn(f64) -> Space, 0.0), (&wild, f32::NAN), (&start, -100.0)] {
        let mut wind = Vec3::ZERO;
        beside(60.0, 0.5, space, |_, there, here| {
            assert_eq!(there.steps, here.steps);
            for (there, here) in there.fields.iter().zip(&here.fields) {
                assert_eq!(there.gravity, here.gravity);
                wind = there.wind;
            }
        });
        assert!(last.is_nan() || (wind.x - last).abs() < 1e-2, "{wind}");
    }
}

#[test]
fn carousel_pulls_outward_and_turns_head() {
    let (r, omega) = (3.0, 1.5);
    for given in [false, true] {
        for (at, head) in [(DVec3::ZERO, DVec3::X * r), (DVec3::X * r, DVec3::ZERO)] {
            // The head is off-center on the platform, or the space is attached to the head.
            let space = |t: f64| {
                let rotation = DQuat::from_rotation_y(omega * t);
                let place = rotation * at;
                let angular = DVec3::Y * omega;
                let velocity = given.then_some(Velocity { linear: angular.cross(place), angular });
                Space { rotation, velocity, ..Space::at(place + DVec3::splat(1e5)) }
            };
            let mut ride = Ride::default();
            let head = Pose { translation: head.as_vec3(), ..Pose::IDENTITY };
            for i in 0..120 {
                let t = f64::from(i) * STEP;
                let carried = ride.frame(&space(t), &head, STEP);
                let (step, field) = (carried.steps[0], carried.fields[0]);
                if i < 3 {
                    continue;
                }
                let out = DQuat::from_rotation_y(omega * t) * DVec3::X;
                let pull = field.gravity.as_dvec3() + DVec3::Y * G;
                assert!((pull.length() / (omega * omega * r) - 1.0).abs() < 1e-3, "{}", pull.length());
                // Lags by half a frame with a given velocity, by a whole one with a measured velocity.
                assert!(pull.normalize().dot(out) > (omega * STEP * 1.1).cos());
                let turned = step.end.rotation.angle_between(Quat::from_rotation_y((omega * t) as f32));
                assert!(turned < 1e-3, "{turned}");
                assert!(step.end.translation.length() < 1e-5, "{}", step.end.translation);
            }
        }
    }
}

#[test]
fn changing_coordinates_moves_nothing() {
    // The world's origin moves near the head every few frames, like a floating origin or grid cells; later with other
    // axes as well.
    let (mut there, mut here) = (Ride::default(), Ride::default());
    let start = DVec3::new(2e4, 0.0, -7e3);
    let turned = DQuat::from_rotation_y(0.7);
    for i in 0..60 {
        let t = f64::from(i) * STEP;
        let cell = DVec3::X * 16.0 * f64::from(i / 7 % 2);
        let space =
            Space { rotation: if i > 40 { turned } else { DQuat::IDENTITY }, ..Space::at(start + cell) };
        let walk = Pose { translation: nod(t).translation + Vec3::X * 0.05 * i as f32, ..nod(t) };
        let head = space.pose_from(&Space::at(start), &walk);
        let (a, b) = (there.frame(&space, &head, STEP), here.frame(&Space::at(start), &walk, STEP));
        assert_eq!((a.steps.len(), a.steps[0].mode), (1, b.steps[0].mode));
        let (p, q) = (a.steps[0].end, b.steps[0].end);
        assert!(p.translation.distance(q.translation) < 2e-6, "{i}: {p:?} {q:?}");
        assert!(p.rotation.angle_between(q.rotation) < 2e-3);
        assert!((a.fields[0].gravity - b.fields[0].gravity).length() < 1e-6);
        assert_eq!(a.shift, b.shift);
    }
    // A head that jumps in both spaces is teleported.
    let far = Pose { translation: Vec3::Z * 40.0, ..Pose::IDENTITY };
    let space = Space::at(start + DVec3::Y * 500.0);
    assert_eq!(there.frame(&space, &far, STEP).steps[0].mode, Mode::Rigid);
}

#[test]
fn origin_follows_hair_in_whole_meters() {
    let mut ride = Ride::default();
    let (mut way, mut before) = (Vec3::ZERO, None::<Pose>);
    for i in 0..600 {
        let head = Pose { translation: Vec3::new(0.03, 0.0, -0.02) * i as f32, ..nod(f64::from(i) * STEP) };
        let carried = ride.frame(&Space::WORLD, &head, STEP);
        if let Some(shift) = carried.shift {
            assert_eq!((shift.offset, shift.velocity), (shift.offset.round(), Vec3::ZERO));
            way -= shift.offset;
            before = before.map(|pose| Pose { translation: pose.translation + shift.offset, ..pose });
        }
        let step = carried.steps[0];
        assert!(step.end.translation.abs().max_element() < FAR + 0.2);
        assert!((step.end.translation + way).distance(head.translation) < 2e-6);
        assert!(before.is_none_or(|before| before == step.begin));
        before = Some(step.end);
        assert_eq!(carried.fields[0].gravity, still().gravity);
    }
    assert!(way.length() > 15.0);
    // Hair that is reset far away starts there.
    let far = Pose { translation: Vec3::new(70.0, 0.0, 3.25), ..Pose::IDENTITY };
    let step = Ride::default().frame(&Space::WORLD, &far, STEP).steps[0];
    assert_eq!((step.mode, step.end.translation), (Mode::Reset, Vec3::Z * 0.25));
    // Teleported hair is carried there: from the old origin to the new one.
    let step = ride.frame(&Space::WORLD, &far, STEP).steps[0];
    assert_eq!(step.mode, Mode::Rigid);
    assert_eq!(step.begin, before.unwrap());
    assert!(step.end.translation.length() < 1.0);
}

#[test]
fn air_belongs_to_world_or_cabin() {
    let wind = Vec3::new(4.0, 0.0, 1.0);
    let world = Field { wind, ..still() };
    let rotation = DQuat::from_rotation_y(0.4);
    let ride = |carries_air: bool| {
        let mut ride = Ride::default();
        let mut field = None;
        for i in 0..40 {
            let t = f64::from(i) * STEP;
            let turned = DQuat::from_rotation_y(0.5 * t) * rotation;
            let space = Space {
                rotation: turned,
                moves_air: carries_air,
                ..Space::at(DVec3::new(30.0 * t, 0.0, 1e4))
            };
            let carried = ride.with(&space, &Pose::IDENTITY, STEP, &world);
            field = carried.fields.first().copied().map(|field| (field, turned));
        }
        field.unwrap()
    };
    // The carrier's axes are the space's initial axes.
    let (field, turned) = ride(false);
    let felt = rotation.inverse() * (wind.as_dvec3() - DVec3::X * 30.0);
    assert!((field.wind.as_dvec3() - felt).length() < 1e-3, "{}", field.wind);
    assert!((field.own.as_dvec3() - rotation.inverse() * wind.as_dvec3()).length() < 1e-5);
    assert_eq!(field.spin, Vec3::ZERO);
    assert!((rotation * field.at - DVec3::new(30.0 * 39.0 * STEP, 0.0, 1e4)).length() < 1e-6);
    let (field, turned_too) = ride(true);
    assert_eq!(turned, turned_too);
    let felt = rotation.inverse() * turned * wind.as_dvec3();
    assert!((field.wind.as_dvec3() - felt).length() < 1e-4, "{}", field.wind);
    assert!((field.spin - Vec3::Y * 0.5).length() < 1e-4, "{}", field.spin);
    assert_eq!(field.kick, Vec3::ZERO);
}
