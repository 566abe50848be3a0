//! Tests on a file of the reference implementation (written by `apps/cli/tests/reference.py`), intact and damaged.

use std::path::Path;

use crate::{
    Strands,
    formats::{
        curves::reference_tests::check,
        parse::{parse, parse_at},
        raw::Raw,
    },
    import::{FileKind, Moment, kind},
};

const REFERENCE: &[u8] = include_bytes!("reference.abc");

fn read(bytes: &[u8], moment: Moment) -> Result<Raw, String> {
    parse_at(Path::new("a.abc"), bytes, false, moment).map_err(|error| error.to_string())
}

#[test]
fn reads_reference_file() {
    let told = ["2 strands are marked as guides (groom_guide)", "“width”"];
    check(|moment| read(REFERENCE, moment), &told);
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
