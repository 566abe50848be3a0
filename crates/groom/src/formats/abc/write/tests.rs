use glam::Vec3;
use std::io::Cursor;
use std::path::Path;

use super::{writer::CacheWriter as _, *};
use crate::{
    formats::{curves::reference_tests::groom, parse::parse_at},
    import::Moment,
    orient::OrientationOverride,
};

#[test]
fn groom_survives_round_trip() {
    let strands = groom();
    let bytes = encode(&strands, Some(LengthUnit(1.0))).unwrap().bytes;
    let back = parse_at(Path::new("a.abc"), &bytes, false, Moment::First).unwrap();
    assert_eq!(back.strands, strands);
    assert_eq!(back.declared, OrientationOverride::METERS);
    // A different groom gives a different file.
    let mut other = strands;
    other.positions[3].x += 1e-3;
    assert_ne!(encode(&other, Some(LengthUnit(1.0))).unwrap().bytes, bytes);
}

#[test]
fn cache_frames_survive_round_trip() {
    let strands = groom();
    let options = Options { unit: LengthUnit(0.01), oriented: true, rate: 30.0, start: 1.0 };
    let moved = |frame: u32| -> Vec<Vec3> {
        strands.positions.iter().map(|p| *p + Vec3::X * 0.5 * (frame.min(2)) as f32).collect()
    };
    let mut cache = Cache::new(Cursor::new(Vec::new()), &strands, options).unwrap();
    for frame in 0..4 {
        cache.frame(&moved(frame)).unwrap();
    }
    assert!(cache.frame(&strands.positions[1..]).is_err());
    let bytes = cache.end().unwrap().into_inner();
    let read = |moment| parse_at(Path::new("a.abc"), &bytes, false, moment);
    for (moment, frame) in [
        (Moment::First, 0),
        (Moment::Frame(1), 1),
        (Moment::Frame(3), 2),
        (Moment::Seconds(0.0), 0),
        (Moment::Seconds(1.04), 1),
        (Moment::Seconds(9.0), 2),
    ] {
        let raw = read(moment).unwrap();
        let expected: Vec<Vec3> = moved(frame).iter().map(|p| *p / 0.01).collect();
        assert_eq!(raw.strands.positions, expected, "{moment:?}");
        assert_eq!(raw.declared.unit, Some(LengthUnit(0.01)));
        assert!(
            raw.notes.iter().any(|note| note.contains("4 frames from 1.000 to 1.100 s")),
            "{:?}",
            raw.notes
        );
    }
    let error = read(Moment::Frame(4)).err().unwrap().to_string();
    assert!(error.contains("frame 4 does not exist; the file has 4 frames"), "{error}");
}
