use super::*;
use crate::random::Rng;
use glam::Vec3;
use proptest::prelude::*;
use std::f32::consts::TAU;

/// Curls that are the same in every lock and constant along the length.
fn regular() -> Curls {
    Curls { irregularity: 0.0, coherence: 1.0, neighbors: 1.0, ..Curls::ringlets() }
}

fn twist(curls: &Curls) -> Twist {
    Twist::new(curls, 7, 3, Vec3::new(0.01, 1.6, 0.05))
}

/// Lays a curl over a straight path of `length` meters, `steps` points per millimeter.
fn laid(curls: &Curls, length: f32, steps: usize) -> Vec<Vec3> {
    let twist = twist(curls);
    let n = (length * 1e3) as usize * steps;
    (0..=n)
        .map(|k| {
            let arc = length * k as f32 / n as f32;
            let o = twist.offset(curls, &Strand::STRICT, arc, length);
            Vec3::new(o.x, o.y, arc + o.z)
        })
        .collect()
}

/// Measures the mean distance from the path and the advance per turn, beyond the first 4 cm.
fn measured(line: &[Vec3]) -> (f32, f32) {
    let far: Vec<Vec3> = line.iter().copied().filter(|p| p.z > 0.04).collect();
    let radius = far.iter().map(|p| p.x.hypot(p.y)).sum::<f32>() / far.len() as f32;
    let angle = |p: &Vec3| p.y.atan2(p.x);
    let turned: f32 =
        far.windows(2).map(|w| (angle(&w[1]) - angle(&w[0]) + 1.5 * TAU).rem_euclid(TAU) - 0.5 * TAU).sum();
    (radius, TAU * (far[far.len() - 1].z - far[0].z) / turned.abs())
}

#[test]
fn a_curl_has_its_radius_and_wavelength() {
    for (radius, wavelength) in [(0.009, 0.034), (0.003, 0.013), (0.015, 0.06)] {
        let curls = Curls { radius, wavelength, ..regular() };
        let (r, w) = measured(&laid(&curls, 0.2, 4));
        let good = |r: f32, w: f32| (r / radius - 1.0).abs() < 1e-3 && (w / wavelength - 1.0).abs() < 2e-3;
        assert!(good(r, w), "{r} {w}");
        let (r, w) = measured(&laid(&Curls { wavelength: 1.02 * wavelength, ..curls }, 0.2, 4));
        assert!(!good(r, w), "{r} {w}");
    }
}

#[test]
fn flat_waves_stay_in_plane_and_curls_begin_at_start() {
    let curls = Curls { flatness: 1.0, start: 0.5, ..regular() };
    let line = laid(&curls, 0.2, 4);
    assert!(line.iter().filter(|p| p.z < 0.0999).all(|p| p.x == 0.0 && p.y == 0.0));
    // All offsets are in one plane, whatever its direction.
    let way = line[line.len() - 1];
    let across = Vec3::new(-way.y, way.x, 0.0).normalize();
    assert!(line.iter().all(|p| p.dot(across).abs() < 1e-6));
    let peak = line.iter().map(|p| p.x.hypot(p.y)).fold(0.0, f32::max);
    assert!((peak / curls.radius - 1.0).abs() < 0.01, "{peak}");
    let wide = laid(&Curls { tip: 2.0, ..regular() }, 0.2, 4);
    let reach = |p: Vec3| p.x.hypot(p.y) / curls.radius;
    assert!(
        (reach(wide[wide.len() - 1]) - 2.0).abs() < 1e-3 && (reach(wide[wide.len() / 2]) - 1.5).abs() < 0.01
    );
}

#[test]
fn shrinking_keeps_strand_length() {
    let length = 0.25;
    let straight = |curls: &Curls| {
        let f = twist(curls).fraction(curls, 1.0, length);
        // The part of the curl that covers the shortened path.
        let line = laid(curls, length, 8);
        let kept = &line[..=((line.len() - 1) as f32 * f) as usize];
        (f, kept.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>() / length)
    };
    for shape in [regular(), Curls { irregularity: 0.8, ..Curls::coils() }, Curls::waves()] {
        let (f, kept) = straight(&Curls { shrink: 1.0, ..shape.clone() });
        assert!((kept - 1.0).abs() < 0.01 && f < 1.0, "{kept} {f}");
        let (f, kept) = straight(&shape);
        assert!(f == 1.0 && kept > 1.02, "{kept} {f}");
    }
    let helix = (1.0 + (TAU * 9.0 / 34.0f32).powi(2)).sqrt();
    let (_, kept) = straight(&regular());
    assert!((kept / helix - 1.0).abs() < 0.05, "{kept} {helix}");
}

/// A lopsided curl: a tight turn, then a flat one, larger than a real one, rotated and translated.
fn drawn() -> Vec<Vec3> {
    let turn = glam::Quat::from_rotation_arc(Vec3::Z, Vec3::new(0.3, -0.8, 0.5).normalize());
    (0..=80)
        .map(|k| {
            let s = k as f32 / 80.0;
            let a = TAU * 2.0 * s;
            let flat = if s < 0.5 { 1.0 } else { 0.3 };
            turn * (Vec3::new(1.0 - a.cos(), flat * a.sin(), 4.0 * s) * 0.05) + Vec3::new(4.0, -2.0, 9.0)
        })
        .collect()
}

#[test]
fn drawn_curl_keeps_its_shape() {
    let points = drawn();
    let curve = CurlCurve::new(&points).unwrap();
    assert!((1.5..=2.5).contains(&curve.turns()), "{}", curve.turns());
    let axis = (points[80] - points[0]).normalize();
    // The radius sets its size and, through the drawn proportion, its length.
    let across = |p: Vec3| p - axis * p.dot(axis);
    let middle = {
        let even = crate::curve::resample_chords(&points, 2001);
        even[..2000].iter().map(|p| across(*p)).sum::<Vec3>() / 2000.0
    };
    let largest = points.iter().map(|p| (across(*p) - middle).length()).fold(0.0, f32::max);
    let wavelength = curve.length_for(0.01);
    assert!((wavelength / 0.01 - 0.2 / largest).abs() < 0.02, "{wavelength}");
    let curls = Curls { radius: 0.01, wavelength, curve: Some(curve.clone()), ..regular() };
    // Pairwise distances identify the shape, independent of the phase and plane of the lock.
    let scale = 0.01 / largest;
    let offset = |curls: &Curls, s: f32| {
        let o = curls.curve.as_ref().unwrap().at(s);
        Vec3::new(o.x * 0.01, o.y * 0.01, s * wavelength + o.z * 0.01)
    };
    let even = crate::curve::resample_chords(&points, 256);
    let differs = |points: &[Vec3]| {
        let mut most = 0.0f32;
        for i in (0..256).step_by(15) {
            for k in (0..256).step_by(17) {
                let ours = offset(&curls, i as f32 / 255.0 * 0.9999)
                    .distance(offset(&curls, k as f32 / 255.0 * 0.9999));
                most = most.max((ours - scale * points[i].distance(points[k])).abs());
            }
        }
        most
    };
    assert!(differs(&even) < 1e-4, "{}", differs(&even));
    let backwards: Vec<Vec3> = even.iter().rev().copied().collect();
    assert!(differs(&backwards) > 1e-3);
    // Laid along a strand, the curve repeats every wavelength without a break.
    let line = laid(&curls, 5.0 * wavelength, 8);
    let step = line.windows(2).map(|w| w[0].distance(w[1])).fold(0.0, f32::max);
    assert!(step < 1e-3, "{step}");
    let twist = twist(&curls);
    let at = |arc: f32| twist.offset(&curls, &Strand::STRICT, arc, 5.0 * wavelength);
    assert!(at(2.3 * wavelength).distance(at(3.3 * wavelength)) < 1e-4);
    assert!(at(2.3 * wavelength).distance(at(2.55 * wavelength)) > 1e-3);
    // A stretched curve appears once, whatever the wavelength.
    let mut whole = curve;
    whole.stretched = true;
    let once = Curls { curve: Some(whole), wavelength: 0.004, ..curls };
    let peaks = laid(&once, 0.2, 4);
    let crossings = peaks.windows(2).filter(|w| (w[0].x >= 0.0) != (w[1].x >= 0.0)).count();
    assert!((2..=6).contains(&crossings), "{crossings}");
}

#[test]
fn invalid_curl_curves_are_rejected() {
    let line = |n: usize| (0..n).map(|k| Vec3::X * k as f32).collect::<Vec<_>>();
    let ring: Vec<Vec3> = (0..=32)
        .map(|k| Vec3::new((TAU * k as f32 / 32.0).cos(), (TAU * k as f32 / 32.0).sin(), 0.0))
        .collect();
    let holes = vec![Vec3::ZERO, Vec3::NAN, Vec3::X];
    for bad in [vec![], line(1), line(2), line(9), ring, holes, vec![Vec3::X; 5]] {
        assert!(CurlCurve::new(&bad).is_err(), "{bad:?}");
    }
    let folder = std::env::temp_dir().join(format!("tresses-curl-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("curl.obj");
    let mut text: String = drawn().iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    let words = |from: usize| (from..from + 80).map(|i| i.to_string()).collect::<Vec<_>>().join(" ");
    text += &format!("l {}\n", words(1));
    std::fs::write(&path, &text).unwrap();
    assert!(CurlCurve::read(&path).is_ok());
    std::fs::write(&path, text + &format!("l {}\n", words(2))).unwrap();
    let error = CurlCurve::read(&path).unwrap_err().to_string();
    assert!(error.contains("2 curves"), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn curls_finer_than_vertex_spacing_are_rejected() {
    let coils = Curls::coils();
    assert!(coils.fits(0.1, 64).is_ok());
    let error = coils.fits(0.3, 64).unwrap_err().to_string();
    assert!(error.contains("13 mm") && error.contains("30 cm") && error.contains("15 mm"), "{error}");
    assert!(Curls { wavelength: 0.015, ..coils.clone() }.fits(0.3, 64).is_ok());
    // Shrinking shortens the path.
    assert!(Curls { shrink: 1.0, ..coils.clone() }.fits(0.3, 64).is_ok());
    assert!(Curls::default().fits(9.0, 2).is_ok());
    assert_eq!(Curls { wavelength: 0.01, ..coils }.vertices_per_turn(0.1, 61), 6.0);
}

#[test]
fn out_of_range_curls_are_rejected() {
    let base = Curls::ringlets();
    for bad in [
        Curls { radius: -0.001, ..base.clone() },
        Curls { radius: f32::NAN, ..base.clone() },
        Curls { wavelength: 0.0, ..base.clone() },
        Curls { start: 1.5, ..base.clone() },
        Curls { shrink: f32::INFINITY, ..base.clone() },
        Curls { tip: 9.0, ..base.clone() },
    ] {
        assert!(bad.check().is_err(), "{bad:?}");
    }
    assert!(Curls::NAMES.iter().all(|name| Curls::named(name).unwrap().check().is_ok()));
}

prop_compose! {
    fn any_curls()(
        radius in 0.0..0.2f32, wavelength in 1e-3..1.0f32, shares in prop::array::uniform6(0.0..=1.0f32),
        tip in 0.0..3.0f32, drawn_one in any::<bool>(), stretched in any::<bool>(),
    ) -> Curls {
        let [flatness, start, irregularity, coherence, neighbors, shrink] = shares;
        let curve = drawn_one.then(|| {
            let mut curve = CurlCurve::new(&drawn()).unwrap();
            curve.stretched = stretched;
            curve
        });
        Curls { radius, wavelength, flatness, start, tip, irregularity, coherence, neighbors, shrink, curve }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn offsets_are_finite_bounded_and_continuous(
        curls in any_curls(), lock in any::<u32>(), length in 1e-3..1.0f32,
    ) {
        prop_assert!(curls.check().is_ok());
        let twist = Twist::new(&curls, 5, lock, Vec3::new(0.03, 1.6, -0.04));
        let strand = Strand::new(&curls, false, &mut Rng::new(1, lock));
        let most = curls.radius * 1.5 * 1.5 * 1.6 * curls.tip.max(1.0);
        // Along the axis, a drawn curve may go back by more than the radius.
        let most_along = 3.0 * most + curls.wavelength.max(length) * 2.0;
        let offset = |arc: f32| twist.offset(&curls, &strand, arc, length);
        prop_assert!(offset(0.0).length() == 0.0);
        // A small fraction of the shortest wavelength that can occur.
        let step = 2e-4 * curls.wavelength.min(length);
        for k in 0..=64 {
            let arc = length * k as f32 / 64.0;
            let o = offset(arc);
            prop_assert!(o.is_finite() && o.truncate().length() <= most + 1e-6 && o.z.abs() <= most_along, "{o}");
            let next = offset(arc + step);
            prop_assert!(o.distance(next) < 0.05 * (most + most_along) + 1e-5, "{o} {next}");
        }
        let f = twist.fraction(&curls, 1.0, length);
        prop_assert!((0.0..=1.0).contains(&f), "{f}");
    }
}
