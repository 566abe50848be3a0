use super::*;
use crate::{BindOptions, GuideCount, bind, mannequin};

fn made(grow: impl Fn(&mut Strands)) -> Strands {
    let mut strands = Strands::default();
    grow(&mut strands);
    strands
}

fn all() -> Vec<(&'static str, Strands)> {
    let mesh = mannequin::mesh(96);
    let mut all = vec![("brows", made(brows)), ("lashes", made(lashes))];
    let kinds = [Beard::Stubble, Beard::Short, Beard::Full];
    all.extend(kinds.map(|kind| ("beard", made(|into| beard(into, kind, &mesh)))));
    all
}

#[test]
fn facial_hair_starts_below_skin_and_stays_outside() {
    for (what, strands) in all() {
        assert!(strands.len() > 300, "{what}: {}", strands.len());
        for strand in strands.iter() {
            let root = skin(strand[0] * 1000.0);
            assert!((-0.6..0.05).contains(&root), "{what}: a root {root} mm from the skin");
            for p in &strand[1..] {
                let gap = skin(*p * 1000.0);
                assert!(gap > -0.4, "{what}: {gap} mm inside at {p}");
            }
        }
    }
}

#[test]
fn facial_hair_grows_in_its_region() {
    let beyond = |strands: &Strands, is: &dyn Fn(Vec3) -> bool| {
        strands.iter().filter(|strand| !is(strand[0] * 1000.0)).count()
    };
    let brow = |p: Vec3| (9.0..56.0).contains(&p.x.abs()) && (122.0..140.0).contains(&p.y) && p.z > 50.0;
    assert_eq!(beyond(&made(brows), &brow), 0);
    let lash = |p: Vec3| (14.0..50.0).contains(&p.x.abs()) && (102.0..112.0).contains(&p.y);
    assert_eq!(beyond(&made(lashes), &lash), 0);
    let mesh = mannequin::mesh(96);
    let full = made(|into| beard(into, Beard::Full, &mesh));
    let lips = |p: Vec3| p.z < 60.0 || p.x.abs() > 20.0 || (p.y - 43.5).abs() > 5.0;
    assert_eq!(beyond(&full, &lips), 0, "lips are bare");
    assert_eq!(beyond(&full, &|p| p.y < 114.0 && p.z > -16.0), 0);
    // Both sides have about the same number of hairs, but do not mirror each other.
    for (what, strands) in all() {
        let left: Vec<_> = strands.iter().filter(|strand| strand[0].x > 0.0).collect();
        let right = strands.len() - left.len();
        let ratio = left.len() as f32 / right as f32;
        assert!((0.9..1.1).contains(&ratio), "{what}: {ratio}");
        let mirrored = |p: Vec3| vec3(-p.x, p.y, p.z);
        let same =
            left.iter().filter(|a| strands.iter().any(|b| mirrored(a[0]).distance(b[0]) < 1e-6)).count();
        assert_eq!(same, 0, "{what}");
    }
}

#[test]
fn facial_hair_binds_and_is_deterministic() {
    assert_eq!(made(brows), made(brows));
    for (what, strands) in all() {
        let options = BindOptions { guides: GuideCount::OneIn(20), ..Default::default() };
        let groom = bind(&strands, &options).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert_eq!(groom.strands.len(), strands.len());
    }
    assert!(made(|into| beard(into, Beard::None, &mannequin::mesh(64))).is_empty());
}
