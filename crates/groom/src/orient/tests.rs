//! Orientation of arbitrary input: the result is always a valid transform.

use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::import::ImportOptions;

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
        let alone = groom(&groom_, false, &Choice::default());
        prop_assert!(usable(&alone), "{:?}", alone);
        let corners: Vec<Vec3> = corners.into_iter().filter(|c| c.is_finite()).collect();
        let triangles: Vec<[u32; 3]> =
            (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        if triangles.is_empty() {
            return Ok(());
        }
        let normals = vec![Vec3::Y; corners.len()];
        let mesh = TriMesh { positions: corners, normals, colors: vec![], triangles };
        let raw = RawMesh { mesh, declared: false, rig: None };
        let body = head(&raw, &Choice::default());
        prop_assert!(usable(&body), "{:?}", body);
        let (own, body) = pair(&groom_, false, &raw, &ImportOptions::default());
        prop_assert!(usable(&own) && usable(&body), "{:?} {:?}", own, body);
    }
}

#[test]
fn contradicting_axes_are_refused() {
    let choice = Choice { up: Some(Axis::Y), front: Some(Axis::NegY), ..Default::default() };
    assert!(choice.check().is_err());
    assert!(Choice { front: Some(Axis::X), ..choice }.check().is_ok());
    assert!("w".parse::<Axis>().is_err() && "-z".parse::<Axis>().is_ok_and(|a| a == Axis::NegZ));
    assert!("0".parse::<Unit>().is_err() && "cm".parse::<Unit>().is_ok_and(|u| u.0 == 0.01));
}
