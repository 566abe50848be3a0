//! The groom of `apps/cli/tests/reference.py` and `reference_usd.py`, which both readers read, and a groom with all that
//! both writers write.

use crate::{Strands, formats::raw::Raw, import::Moment, strands::Mark};
use glam::{Vec2, Vec3};

/// Returns point `k` of curve `i` of the script after the transforms: scaled by 2, rotated by 90° about Y, translated.
fn point(i: usize, k: usize, frame: usize) -> Vec3 {
    let (x, k) = (i as f32 + 0.1 * (k * k * (i + 1)) as f32, k as f32);
    let p = 2.0 * Vec3::new(x, 10.0 * k, 0.5 * frame as f32 * k);
    Vec3::new(p.z, p.y, -p.x) + Vec3::new(1.0, 2.0, 3.0)
}

/// Checks what `read` finds in the file of the script. `told` are parts of its notes.
pub fn check(read: impl Fn(Moment) -> Result<Raw, String>, told: &[&str]) {
    for (moment, frame) in [(Moment::First, 0), (Moment::Frame(1), 1), (Moment::Seconds(1.03), 1)] {
        let raw = read(moment).unwrap();
        let strands = &raw.strands;
        assert_eq!((strands.len(), strands.root_uvs.len(), strands.colors.len()), (7, 0, 0));
        for i in 0..5 {
            // The ends of a uniform B-spline.
            let mean = |k: [usize; 3]| {
                let [a, b, c] = k.map(|k| point(i, k, frame));
                (a + 4.0 * b + c) / 6.0
            };
            let line = strands.strand(i);
            assert!(line.len() > 16 && line[0].distance(mean([0, 1, 2])) < 1e-3, "{}", line[0]);
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
        for said in ["2 frames from 1.000 to 1.042 s", "2 curve objects", "B-spline"].iter().chain(told) {
            assert!(notes.contains(said), "{said}: {notes}");
        }
    }
    let error = read(Moment::Frame(2)).err().unwrap();
    assert!(error.contains("frame 2 does not exist; the file has 2 frames"), "{error}");
}

/// Returns strands of different lengths with widths, colors, texture coordinates and marks.
pub fn groom() -> Strands {
    let mut strands = Strands::default();
    for i in 0..7usize {
        let root = Vec3::new(0.01 * i as f32, 1.7, 0.1 / 3.0);
        let line: Vec<_> = (0..3 + i).map(|k| root + Vec3::new(0.001, -0.01, 0.002) * k as f32).collect();
        strands.push(&line);
        strands.root_uvs.push(Vec2::new(0.1 * i as f32, 0.5));
        let weights = if i == 2 { [0.75, 0.25, 0.0] } else { [0.0; 3] };
        let closest = [10, 11, 0];
        strands.marks.push(Mark { guide: i < 2, id: 10 + i as i32, group: i as i32 % 2, closest, weights });
    }
    strands.radii = (0..strands.positions.len()).map(|i| 3e-5 + 1e-6 * i as f32).collect();
    strands.colors = strands.positions.iter().map(|p| Vec3::new(p.x, 0.5, 0.25)).collect();
    strands
}
