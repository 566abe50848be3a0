use super::*;

fn steps(motion: &Motion, dt: f64) -> impl Iterator<Item = f64> {
    let n = (motion.duration() / dt).round() as usize;
    (0..=n).map(move |i| i as f64 * dt)
}

#[test]
fn built_in_motions_loop_and_are_twice_differentiable() {
    let dt = 1e-3;
    for name in NAMES {
        let motion = Motion::named(name).unwrap();
        assert!(motion.repeats());
        let period = motion.duration();
        // A quintic with zero end slopes has its largest third derivative, 60 rise / span³, at its ends.
        let channels = FIXED + motion.shapes.len();
        let jerk = (1..motion.times.len())
            .map(|i| {
                let rise = |c: usize| (motion.values[i][c] - motion.values[i - 1][c]).abs();
                let rise = (0..channels).map(rise).fold(0.0, f64::max);
                1.1 * 60.0 * rise / (motion.times[i] - motion.times[i - 1]).powi(3)
            })
            .fold(1e-3, f64::max);
        // Include the seam of the loop.
        let value = |t: f64, c: usize| motion.at(t)[c];
        for t in steps(&motion, dt) {
            for c in 0..channels {
                assert!((value(t, c) - value(t + period, c)).abs() < 1e-9, "{name} at {t}");
                let second = |t: f64| value(t + dt, c) - 2.0 * value(t, c) + value(t - dt, c);
                let jump = (second(t + dt) - second(t)).abs() / (dt * dt);
                assert!(jump < jerk * dt, "{name} at {t}: {jump}");
            }
        }
    }
}

#[test]
fn heads_turn_at_the_stated_speed() {
    // Heads turn by 60 to 120 degrees in half a second, from hold to hold.
    for name in ["nod", "turn", "shake"] {
        let motion = Motion::named(name).unwrap();
        for i in 1..motion.times.len() {
            let angle = (0..3).map(|c| (motion.values[i][c] - motion.values[i - 1][c]).abs()).sum::<f64>();
            let in_half_a_second = angle / (motion.times[i] - motion.times[i - 1]) * 0.5;
            assert!(angle == 0.0 || (60.0..=120.0).contains(&in_half_a_second), "{name} {i}");
        }
    }
    let turn = Motion::named("turn").unwrap();
    assert!((turn.at(0.8)[0] - turn.at(1.3)[0] - 90.0).abs() < 1e-9);
    assert!(steps(&turn, 0.01).all(|t| Motion::named("still").unwrap().at(t) == [0.0; FIXED]));
}

#[test]
fn curves_pass_through_keys_without_overshoot() {
    let text = r#"{"keys": [{"time": 0}, {"time": 0.1, "rotation": [1, 0, 0]}, {"time": 1, "rotation": [90, -5, 3]},
        {"time": 1.5, "rotation": [90, -5, 3], "translation": [0.1, 0, 0]}]}"#;
    let motion = Motion::parse(text).unwrap();
    assert!(!motion.repeats());
    for (time, values) in motion.times.iter().zip(&motion.values) {
        assert_eq!(motion.at(*time), *values);
    }
    let mut last = motion.at(0.0)[0];
    for t in steps(&motion, 1e-3) {
        let yaw = motion.at(t)[0];
        assert!(yaw >= last - 1e-9 && yaw <= 90.0 + 1e-9, "{t}: {yaw} after {last}");
        last = yaw;
    }
    assert_eq!(motion.at(1e9), motion.values[3], "holds its last pose");
}

#[test]
fn head_turns_about_the_neck() {
    let neck = Vec3::new(0.0, 1.4, -0.02);
    let nose = Vec3::new(0.0, 1.55, 0.1);
    let pose = Motion::named("turn").unwrap().pose(0.3, neck);
    assert!((pose.point(neck) - neck).length() < 1e-6);
    assert!(pose.point(nose).x > 0.05, "yaw is towards +X, the head's left");
    let nod = Motion::named("nod").unwrap().pose(0.25, neck);
    assert!(nod.point(nose).y < nose.y, "positive pitch lowers the chin");
}

#[test]
fn invalid_keyframes_fail_with_a_reason() {
    for (text, clause) in [
        ("", "EOF"),
        (r#"{"keys": []}"#, "no keys"),
        (r#"{"keys": [{"time": 1}]}"#, "must be at 0"),
        (r#"{"keys": [{"time": 0}, {"time": 0}]}"#, "not later"),
        (r#"{"keys": [{"time": 0, "rotation": [1e99, 0, 0]}]}"#, "larger than 1e6"),
        (r#"{"keys": [{"time": 0, "spin": 3}]}"#, "spin"),
        (r#"{"loop": true, "keys": [{"time": 0}, {"time": 1, "rotation": [9, 0, 0]}]}"#, "looping"),
    ] {
        let error = format!("{:#}", Motion::parse(text).unwrap_err());
        assert!(error.contains(clause) && !error.contains('\n'), "{text}: {error}");
    }
    assert!(Motion::open("waltz").unwrap_err().to_string().contains("still, nod, turn, shake, walk, dance"));
}

#[test]
fn torso_leans_about_the_waist() {
    let neck = Vec3::new(0.0, 1.4, 0.0);
    let text =
        r#"{"keys": [{"time": 0, "rotation": [90, 0, 0], "lean": [0, 0, 30], "translation": [0, 0.1, 0]}]}"#;
    let gesture = Motion::parse(text).unwrap().gesture(0.0, neck);
    assert!(gesture.head.point(neck).distance(neck) < 1e-6, "the head turns about the neck");
    let waist = neck - Vec3::Y * WAIST;
    assert!(gesture.body.point(waist).distance(waist + Vec3::Y * 0.1) < 1e-6, "the torso about the waist");
    // Positive roll is to the right; yaw turns the head about the neck of the leaned torso.
    let at = gesture.rigid().point(neck) - Vec3::Y * 0.1;
    assert!((at - waist).length() - WAIST < 1e-6 && at.x < -0.2, "{at}");
    assert_eq!(gesture.rigid(), Motion::parse(text).unwrap().pose(0.0, neck));
}

#[test]
fn blend_shapes_are_keyed_and_blended() {
    let text = r#"{"keys": [{"time": 0, "shapes": {"Jaw": 1}}, {"time": 1, "shapes": {"Brows": 0.5}}]}"#;
    let motion = Motion::parse(text).unwrap();
    assert_eq!(motion.shapes().collect::<Vec<_>>(), ["Brows", "Jaw"]);
    let gesture = |time| motion.gesture(time, Vec3::ZERO);
    assert_eq!((gesture(0.0).shape("Jaw"), gesture(1.0).shape("Jaw")), (1.0, 0.0));
    assert_eq!((gesture(0.0).shape("Brows"), gesture(1.0).shape("Brows")), (0.0, 0.5));
    let (calm, open) = (Gesture::default(), gesture(0.0));
    assert_eq!(calm.lerp(&open, 0.25).shape("Jaw"), 0.25);
    assert_eq!(open.lerp(&calm, 0.25).shape("Jaw"), 0.75);
    // Dancers breathe, and at rest no shape is active.
    for name in ["walk", "dance"] {
        let motion = Motion::named(name).unwrap();
        assert!(motion.shapes().any(|shape| shape == "Breath"), "{name}");
        let most = steps(&motion, 0.05).map(|t| motion.gesture(t, Vec3::ZERO).shape("Breath"));
        assert!(most.fold(0.0, f32::max) > 0.9, "{name}");
    }
    let rest = Motion::named("dance").unwrap().gesture(0.0, Vec3::Y);
    assert_eq!((rest.rigid(), rest.shape("Breath")), (Pose::IDENTITY, 0.0));
}
