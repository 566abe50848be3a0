//! Interpolation between keys.

use super::*;

fn sample(curve: &Curve, time: f32) -> [f32; 3] {
    let mut out = [f32::NAN; 3];
    curve.sample(time, false, &mut out);
    out
}

#[test]
fn cubic_spline_matches_hermite_formula() {
    // One case per axis: from 0 to 3, 0 to 1 and 0 to 0 in 2 s, with tangents per second.
    let values = [[9.0; 3], [0.0; 3], [1.0, 0.0, -2.0], [0.5, 4.0, 0.0], [3.0, 1.0, 0.0], [9.0; 3]];
    let values = values.as_flattened().to_vec();
    let curve = Curve { interpolation: Interpolation::CubicSpline, times: vec![1.0, 3.0], values };
    for t in [0.25f64, 0.5, 0.8] {
        let formula = |start: f64, start_tangent: f64, end: f64, end_tangent: f64| {
            let (t2, t3) = (t * t, t * t * t);
            (2.0 * t3 - 3.0 * t2 + 1.0) * start
                + 2.0 * (t3 - 2.0 * t2 + t) * start_tangent
                + (3.0 * t2 - 2.0 * t3) * end
                + 2.0 * (t3 - t2) * end_tangent
        };
        let want = [formula(0.0, 1.0, 3.0, 0.5), formula(0.0, 0.0, 1.0, 4.0), formula(0.0, -2.0, 0.0, 0.0)];
        let have = sample(&curve, 1.0 + 2.0 * t as f32);
        let error = (0..3).map(|i| (want[i] - f64::from(have[i])).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "{have:?} {want:?}");
        // The check detects tangents that are not per second.
        let unscaled = want[0] - (t * t * t - 2.0 * t * t + t);
        assert!((unscaled - f64::from(have[0])).abs() > 1e-2);
    }
    // By hand: halfway between 0 and 3 with tangents 1 and 0.5.
    assert!((sample(&curve, 2.0)[0] - (1.5 + 0.25 - 0.125)).abs() < 1e-6);
    assert_eq!((sample(&curve, 0.0), sample(&curve, 9.0)), ([0.0; 3], [3.0, 1.0, 0.0]));
}

#[test]
fn step_holds_and_linear_interpolates() {
    let values = vec![0.0, 0.0, 0.0, 4.0, 8.0, 2.0];
    let mut curve = Curve { interpolation: Interpolation::Step, times: vec![1.0, 2.0], values };
    assert_eq!([0.0, 1.0, 1.999].map(|t| sample(&curve, t)), [[0.0; 3]; 3]);
    assert_eq!(sample(&curve, 2.0), [4.0, 8.0, 2.0]);
    curve.interpolation = Interpolation::Linear;
    assert_eq!(sample(&curve, 1.25), [1.0, 2.0, 0.5]);
    assert_eq!((sample(&curve, 0.5), sample(&curve, 2.5)), ([0.0; 3], [4.0, 8.0, 2.0]));
}

#[test]
fn rotations_take_the_shorter_arc() {
    let end = Quat::from_rotation_y(1.0);
    for end in [end, -end] {
        let values = [Quat::IDENTITY.to_array(), end.to_array()].concat();
        let curve = Curve { interpolation: Interpolation::Linear, times: vec![0.0, 1.0], values };
        let mut out = [0.0; 4];
        curve.sample(0.5, true, &mut out);
        let turned = Quat::from_array(out) * Vec3::X;
        assert!(turned.distance(Quat::from_rotation_y(0.5) * Vec3::X) < 1e-6, "{turned}");
    }
}

#[test]
fn missing_values_and_odd_times_are_handled() {
    let short = Curve { times: vec![0.0, 1.0], values: vec![1.0; 5], ..Default::default() };
    for curve in [Curve::default(), short] {
        assert!(sample(&curve, 0.5).iter().all(|v| v.is_nan()));
    }
    let animation = Animation { length: 2.0, ..Default::default() };
    let wrapped = [-0.5, 2.0, 4.5, f32::NAN, f32::INFINITY].map(|t| animation.wrap(t));
    assert_eq!(wrapped, [1.5, 0.0, 0.5, 0.0, 0.0]);
    assert_eq!(Animation::default().wrap(3.0), 0.0);
}
