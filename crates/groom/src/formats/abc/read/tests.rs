//! Tests on a file of the reference implementation (written by `apps/cli/tests/reference.py`), intact and damaged.

use std::path::Path;

use glam::Vec3;

use crate::{
    Strands,
    formats::parse::{parse, parse_at},
    formats::raw::Raw,
    import::{FileKind, Moment, kind},
    strands::Mark,
};

const REFERENCE: &[u8] = include_bytes!("reference.abc");

fn read(bytes: &[u8], moment: Moment) -> Result<Raw, String> {
    parse_at(Path::new("a.abc"), bytes, false, moment).map_err(|error| error.to_string())
}

/// Returns point `k` of curve `i` of the script after the transforms: scaled by 2, rotated by 90° about Y, translated.
fn point(i: usize, k: usize, frame: usize) -> Vec3 {
    let (x, k) = (i as f32 + 0.1 * (k * k * (i + 1)) as f32, k as f32);
    let p = 2.0 * Vec3::new(x, 10.0 * k, 0.5 * frame as f32 * k);
    Vec3::new(p.z, p.y, -p.x) + Vec3::new(1.0, 2.0, 3.0)
}

#[test]
fn reads_reference_file() {
    for (moment, frame) in [(Moment::First, 0), (Moment::Frame(1), 1), (Moment::Seconds(1.03), 1)] {
        let raw = read(REFERENCE, moment).unwrap();
        let strands = &raw.strands;
        assert_eq!((strands.len(), strands.root_uvs.len(), strands.colors.len()), (7, 0, 0));
        for i in 0..5 {
            // The ends of a uniform B-spline.
            let mean = |k: [usize; 3]| {
                let [a, b, c] = k.map(|k| point(i, k, frame));
                (a + 4.0 * b + c) / 6.0
            };
            let line = strands.strand(i);
            assert!(
                line.len() > 16 && line[0].distance(mean([0, 1, 2])) < 1e-3,
                "{} {}",
                line[0],
                mean([0, 1, 2])
            );
            assert!(line[line.len() - 1].distance(mean([3, 4, 5])) < 1e-3);
            assert!(frame == 0 || line[0].distance(point(i, 1, 0)) > 0.1, "frames differ");
            // Half of a width of 0.01 (i + 1), scaled by 2.
            let radius = strands.radii[strands.range(i).start];
            assert!((radius - 0.01 * (i + 1) as f32).abs() < 1e-6, "{radius}");
            let mark = Mark { id: i as i32, group: i as i32 % 2, ..Default::default() };
            assert_eq!(strands.marks[i], mark);
        }
        for i in 0..2 {
            // Guides are straight, and translated by 5 in the space of their common parent.
            let apart = strands.strand(5 + i)[1] - point(i, 1, frame);
            assert!(apart.distance(Vec3::new(10.0, 0.0, 0.0)) < 1e-3, "{apart}");
            let mark = Mark { guide: true, id: 100 + i as i32, group: i as i32, ..Default::default() };
            assert_eq!(strands.marks[5 + i], mark);
        }
        let notes = raw.notes.join("\n");
        for said in [
            "2 frames from 1.000 to 1.042 s",
            "2 curve objects",
            "B-spline",
            "2 strands are marked as guides (groom_guide)",
            "“width”",
        ] {
            assert!(notes.contains(said), "{said}: {notes}");
        }
    }
    assert!(
        read(REFERENCE, Moment::Frame(2))
            .err()
            .unwrap()
            .contains("frame 2 does not exist; the file has 2 frames")
    );
    assert_eq!(kind(Path::new("a.abc"), REFERENCE), Some(FileKind::Groom));
}

#[test]
fn damaged_files_give_errors_or_valid_grooms() {
    let sound = |strands: &Strands| {
        let n = strands.positions.len();
        let vertices = |count: usize| count == 0 || count == n;
        assert_eq!(strands.offsets.last().map(|end| *end as usize), Some(n));
        assert!(strands.offsets.windows(2).all(|w| w[0] < w[1]) && vertices(strands.radii.len()));
        assert!(vertices(strands.colors.len()) && n <= 16 * REFERENCE.len());
        assert!(strands.marks.is_empty() || strands.marks.len() == strands.len());
    };
    let (mut refused, mut changed, mut placed) = (0, 0, 0);
    let whole = read(REFERENCE, Moment::First).unwrap().strands;
    let mut check = |bytes: &[u8]| match read(bytes, Moment::First) {
        Ok(raw) => {
            sound(&raw.strands);
            changed += usize::from(raw.strands != whole);
        }
        Err(said) => {
            assert!(!said.contains('\n') && said.len() < 400, "{said}");
            refused += 1;
            placed += usize::from(said.contains("at byte"));
        }
    };
    let mut bytes = REFERENCE.to_vec();
    for i in 0..bytes.len() {
        for with in [0x01, 0x80, 0xff, bytes[i]] {
            // The last mask sets the byte to 0.
            bytes[i] ^= with;
            check(&bytes);
            bytes[i] = REFERENCE[i];
        }
    }
    (0..REFERENCE.len()).for_each(|end| check(&REFERENCE[..end]));
    // Both outcomes must be frequent: the test fails if every file is rejected or if most bytes have no effect.
    assert!(
        refused > REFERENCE.len() && changed > 500 && placed > REFERENCE.len() / 2,
        "{refused} {changed} {placed}"
    );
}

#[test]
fn wrong_file_types_are_reported() {
    let says = |bytes: &[u8]| read(bytes, Moment::First).err().unwrap();
    assert!(says(b"\x89HDF\r\n\x1a\n").contains("HDF5"));
    assert!(says(b"solid").contains("does not start with “Ogawa”"));
    let mut open = REFERENCE.to_vec();
    open[5] = 0;
    assert!(says(&open).contains("did not finish"));
    let hair = parse(Path::new("a.hair"), b"HAIR", false).err();
    assert!(hair.is_some());
    let frame = parse_at(Path::new("a.obj"), b"v 0 0 0\nv 1 0 0\nl 1 2\n", false, Moment::Frame(1));
    assert!(frame.err().unwrap().to_string().contains("no frames"));
}
