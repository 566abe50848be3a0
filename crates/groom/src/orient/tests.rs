//! Orientation of arbitrary input: the result is always a valid transform.

use glam::Vec3;
use proptest::prelude::*;

use super::*;

fn points(n: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Vec3>> {
    let number = prop_oneof![
        4 => -10.0f32..10.0,
        1 => Just(0.0f32),
        1 => prop_oneof![Just(1e30f32), Just(-1e20), Just(1e-30), Just(f32::NAN), Just(f32::MAX)],
    ];
    prop::collection::vec(prop::array::uniform3(number).prop_map(Vec3::from), n)
}

fn usable(p: &Placement) -> bool {
    p.unit.0.is_finite()
        && p.unit.0 > 0.0
        && p.translation.is_finite()
        && p.axes().determinant().abs() == 1.0
        && p.axes().row(1).abs().max_element() == 1.0
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nonsense_gives_a_usable_transform(
        strands in prop::collection::vec(points(0..6), 1..20),
        corners in points(3..30),
    ) {
        let mut groom_ = Strands::default();
        strands.iter().for_each(|s| groom_.push(s));
        let alone = groom(&groom_, &KnownOrientation::default());
        prop_assert!(usable(&alone), "{:?}", alone);
        let corners: Vec<Vec3> = corners.into_iter().filter(|c| c.is_finite()).collect();
        let triangles: Vec<[u32; 3]> =
            (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        if triangles.is_empty() {
            return Ok(());
        }
        let normals = vec![Vec3::Y; corners.len()];
        let mesh = TriMesh { positions: corners, normals, triangles, ..Default::default() };
        let body = head(&mesh, &KnownOrientation::default());
        prop_assert!(usable(&body), "{:?}", body);
        let (own, body) = pair(&groom_, &KnownOrientation::default(), &mesh, &KnownOrientation::default());
        prop_assert!(usable(&own) && usable(&body), "{:?} {:?}", own, body);
    }
}

#[test]
fn contradicting_axes_are_refused() {
    let choice = OrientationOverride { up: Some(Axis::Y), front: Some(Axis::NegY), ..Default::default() };
    assert!(choice.check().is_err());
    assert!(OrientationOverride { front: Some(Axis::X), ..choice }.check().is_ok());
    assert!("w".parse::<Axis>().is_err() && "-z".parse::<Axis>().is_ok_and(|a| a == Axis::NegZ));
    assert!("0".parse::<LengthUnit>().is_err() && "cm".parse::<LengthUnit>().is_ok_and(|u| u.0 == 0.01));
}

#[test]
fn partial_declarations_leave_the_rest_to_guess() {
    let file = OrientationOverride { unit: Some(LengthUnit(0.01)), up: Some(Axis::Z), ..Default::default() };
    let both = OrientationOverride::default().or(file);
    assert_eq!((both.unit, both.up, both.front), (Some(LengthUnit(0.01)), Some(Axis::Z), None));
    // A given value overrides the file's, and discards an axis that conflicts with it.
    let given =
        OrientationOverride { front: Some(Axis::NegZ), unit: Some(LengthUnit(1.0)), ..Default::default() };
    assert_eq!(given.or(file), OrientationOverride { is_mirrored: None, up: None, ..given });
    assert_eq!(OrientationOverride::METERS.shared(file), OrientationOverride::default());
    assert_eq!(
        OrientationOverride::METERS
            .shared(OrientationOverride { is_mirrored: None, ..OrientationOverride::METERS })
            .up,
        Some(Axis::Y)
    );
    // A dome of hair, Z up. The reasons name who stated each value.
    let mut dome = Strands::default();
    for i in 0..200 {
        let (a, h) = (i as f32 * 2.4, i as f32 / 200.0);
        let out = Vec3::new(a.cos() * (1.0 - h * h).sqrt(), a.sin() * (1.0 - h * h).sqrt(), h);
        dome.push(&[out * 8.0, out * 9.0, out * 10.0 - Vec3::Z]);
    }
    let placed = groom(&dome, &KnownOrientation { declared: file, ..Default::default() });
    assert_eq!((placed.up, placed.unit), (Axis::Z, LengthUnit(0.01)));
    let reasons = placed.reasons.join("; ");
    assert!(
        reasons.contains("up z: stated by the file; face") && reasons.contains("0.01 m: stated by the file"),
        "{reasons}"
    );
    let told = groom(
        &dome,
        &KnownOrientation {
            declared: file,
            given: OrientationOverride { up: Some(Axis::X), ..Default::default() },
        },
    )
    .reasons
    .join("; ");
    assert!(told.contains("up x: given; face"), "{told}");
}

#[test]
fn fur_around_a_body_keeps_its_size() {
    let around = |unit: f32| {
        let mut fur = Strands::default();
        for i in 0..2000 {
            let (turn, z) = (2.399_963 * i as f32, 1.2 * (i as f32 / 2000.0 - 0.5));
            let radius = 0.2 * (1.0 - (z / 0.62) * (z / 0.62)).sqrt();
            let out = Vec3::new(turn.cos(), turn.sin(), 0.0);
            let root = Vec3::new(0.0, 0.5, z) + radius * out;
            fur.push(&[root * unit, (root + 0.02 * (out - Vec3::Z)) * unit]);
        }
        groom(&fur, &KnownOrientation::default())
    };
    for (unit, meters) in [(1.0, 1.0), (100.0, 0.01), (1000.0, 0.001)] {
        let placement = around(unit);
        assert_eq!(placement.unit, LengthUnit(meters), "{:?}", placement.reasons);
        assert!(placement.doubts.iter().any(|doubt| doubt.contains("set the unit")));
    }
}
