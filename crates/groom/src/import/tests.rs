//! Broken files, and round trips through every format.

use std::path::Path;

use glam::{Vec2, Vec3};
use proptest::prelude::*;

use super::*;
use crate::formats::parse::parse;
use crate::{
    Followers, Strands,
    attribute::StrandAttribute,
    export::Writer,
    formats::{ContentKind, FORMATS},
    orient::LengthUnit,
};

/// Generates grooms of up to 11 strands with equal or different numbers of vertices.
fn grooms() -> impl Strategy<Value = Strands> {
    let strand = |n| prop::collection::vec(prop::array::uniform3(-2.0f32..2.0), n);
    let strands = prop_oneof![
        prop::collection::vec(strand(2..9), 1..12),
        (2usize..9).prop_flat_map(move |n| prop::collection::vec(strand(n..n + 1), 1..12)),
    ];
    (strands, any::<[bool; 5]>()).prop_map(|(list, [radii, colors, uvs, pins, custom])| {
        let mut out = Strands::default();
        for s in &list {
            out.push(&s.iter().map(|p| Vec3::from(*p)).collect::<Vec<_>>());
        }
        let n = out.positions.len();
        if radii {
            out.radii = (0..n).map(|i| 3e-5 + 1e-7 * i as f32).collect();
        }
        if colors {
            out.colors = out.positions.iter().map(|p| p.abs() * 0.3 + 0.01).collect();
        }
        if uvs {
            out.root_uvs = (0..list.len()).map(|i| Vec2::new(0.5, i as f32 + 1.0)).collect();
        }
        if pins {
            out.tip_pinned = (0..list.len()).map(|i| i % 2 == 0).collect();
        }
        if custom {
            let row = |name: &str, per_vertex, is_integer, width: u32| {
                let count = if per_vertex { n } else { list.len() };
                let number = |i: usize| if is_integer { i as f32 - 3.0 } else { 0.3 * i as f32 };
                let numbers = (0..count * width as usize).map(number).collect();
                StrandAttribute { name: name.into(), per_vertex, is_integer, width, numbers }
            };
            out.attributes =
                vec![row("age", false, true, 1), row("curl", true, false, 1), row("tint", true, false, 3)];
            out.attributes.push(row("uv2", false, false, 2));
        }
        out
    })
}

/// Encodes a groom. `None` omits the unit.
fn encoded(strands: &Strands, name: &str, unit: Option<LengthUnit>) -> Vec<u8> {
    Writer::of(name).unwrap().strands(strands, unit).unwrap().bytes
}

/// Returns files of one groom in every readable format.
fn files(groom: &Strands) -> Vec<(&'static str, Vec<u8>)> {
    let encoded = |name| (name, encoded(groom, name, None));
    vec![
        encoded("a.hair"),
        encoded("a.tfx"),
        encoded("a.obj"),
        encoded("a.data"),
        encoded("a.ply"),
        ("b.ply", ply_text(groom).into_bytes()),
        ("b.tfx", tfx3(groom)),
        ("c.tfx", tfx2(groom).into_bytes()),
    ]
}

/// Returns a PLY file as other programs write it: text, unused faces and colors, several number types, unordered edges.
fn ply_text(groom: &Strands) -> String {
    let (vertices, strands) = (groom.positions.len(), groom.len());
    let edges = vertices - strands;
    let mut text = format!(
        "ply\r\nformat ascii 1.0\nelement vertex {vertices}\nproperty uchar red\nproperty double z\nproperty float x\nproperty float y\nelement face 1\nproperty list uchar int vertex_indices\nelement edge {edges}\nproperty int vertex2\nproperty uint vertex1\nend_header\n"
    );
    groom.positions.iter().for_each(|p| text += &format!("255 {} {} {}\n", p.z, p.x, p.y));
    text += "3 0 1 0\n";
    for i in (0..strands).rev() {
        let range = groom.range(i);
        (range.start + 1..range.end).for_each(|v| text += &format!("{v} {}\n", v - 1));
    }
    text
}

fn tfx3(groom: &Strands) -> Vec<u8> {
    let n = groom.strand(0).len();
    let strands: Vec<&[Vec3]> = groom.iter().filter(|s| s.len() == n).collect();
    let mut bytes = vec![0; 296];
    let pins = u32::from(!groom.tip_pinned.is_empty());
    let words = [(0, 3f32.to_bits()), (4, strands.len() as u32), (8, n as u32), (16, pins), (144, 296)];
    for (at, value) in words {
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
    }
    for p in strands.iter().copied().flatten() {
        bytes.extend(p.to_array().iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}

fn tfx2(groom: &Strands) -> String {
    let pins = usize::from(!groom.tip_pinned.is_empty());
    let mut text = format!(
        "version 2.0\r\nscale 1.0\nrotation 0 0 0\nbothEndsImmovable {pins}\nnumStrands {}\nis sorted 1\n",
        groom.len()
    );
    for (i, s) in groom.iter().enumerate() {
        text += &format!("strand {i} numVerts {} texcoord 0.5 {}\n", s.len(), i + 1);
        s.iter().for_each(|p| text += &format!("{} {} {}\n", p.x, p.y, p.z));
        text += "\n";
    }
    text
}

/// Reads a broken file. It must not panic, and an error must be one line that names the file.
fn survives(name: &str, bytes: &[u8]) -> Result<(), TestCaseError> {
    for lenient in [false, true] {
        match parse(Path::new(name), bytes, lenient) {
            Ok(raw) => {
                let s = &raw.strands;
                prop_assert!(!s.is_empty() && s.offsets.windows(2).all(|w| w[0] <= w[1]));
                prop_assert_eq!(*s.offsets.last().unwrap() as usize, s.positions.len());
                // Memory is bounded by the file's size, although an OBJ may refer to a vertex repeatedly.
                prop_assert!(s.positions.len() <= bytes.len());
                prop_assert!(lenient || s.positions.iter().all(|p| p.is_finite()));
            }
            Err(error) => {
                let text = error.to_string();
                prop_assert!(text.starts_with(name) && !text.contains('\n') && text.len() < 300, "{}", text);
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn written_grooms_read_back_bit_identical(groom in grooms()) {
        for (format, writer) in FORMATS.iter().flat_map(|it| it.writers.iter().map(move |writer| (it, writer))) {
            let keeps = |content| writer.holds(content) && format.reads.contains(&content);
            let name = &format!("a.{}", writer.extension);
            // A .glb rounds positions. Some formats have no reader because their feature is off.
            if writer.extension == "glb" || format.read.is_none() {
                continue;
            }
            let raw = parse(Path::new(name), &encoded(&groom, name, Some(LengthUnit(1.0))), false).unwrap();
            let declared = if keeps(ContentKind::Units) { orient::OrientationOverride::METERS } else { orient::OrientationOverride::default() };
            prop_assert_eq!(raw.declared, declared);
            let mut back = raw.strands;
            let mut expected = groom.clone();
            if !keeps(ContentKind::Widths) {
                expected.radii.clear();
            }
            if !keeps(ContentKind::Colors) {
                expected.colors.clear();
            }
            if !keeps(ContentKind::RootUvs) {
                expected.root_uvs.clear();
            }
            if !keeps(ContentKind::Attributes) {
                expected.attributes.clear();
            }
            if !keeps(ContentKind::PinnedTips) || expected.tip_pinned.iter().all(|p| !p) {
                expected.tip_pinned.clear();
            }
            if writer.extension == "tfx" {
                // Shorter strands were extended by copies of their tip, which the repair merges.
                lint::repair(&mut back);
                lint::repair(&mut expected);
            }
            prop_assert_eq!(&back, &expected, "{}", name);
        }
    }

    #[test]
    fn read_only_formats_preserve_values(groom in grooms()) {
        let text = parse(Path::new("c.tfx"), tfx2(&groom).as_bytes(), false).unwrap().strands;
        prop_assert_eq!(&text.positions, &groom.positions);
        prop_assert_eq!(&text.offsets, &groom.offsets);
        prop_assert_eq!(text.tip_pinned.len(), if groom.tip_pinned.is_empty() { 0 } else { groom.len() });
        prop_assert_eq!(text.root_uvs[0], Vec2::new(0.5, 1.0));
        let lines = parse(Path::new("b.ply"), ply_text(&groom).as_bytes(), false).unwrap().strands;
        prop_assert_eq!(&lines.positions, &groom.positions);
        prop_assert_eq!(&lines.offsets, &groom.offsets);
        let mut three = tfx3(&groom);
        // The bytes of 3.1 begin with letters.
        for version in [3.0f32, 3.1] {
            three[..4].copy_from_slice(&version.to_le_bytes());
            let read = parse(Path::new("b.tfx"), &three, false).unwrap().strands;
            prop_assert_eq!(read.strand(0), groom.strand(0));
        }
    }

    #[test]
    fn truncated_files_are_errors(groom in grooms(), share in 0.0f64..1.0) {
        for (name, bytes) in files(&groom) {
            let cut = &bytes[..(bytes.len() as f64 * share) as usize];
            survives(name, cut)?;
            // Truncated text may end in a shorter but valid number.
            let binary = ["a.hair", "a.ply"].contains(&name) || bytes[0] < 32;
            prop_assert!(!binary || parse(Path::new(name), cut, false).is_err(), "{} {}", name, cut.len());
        }
    }

    #[test]
    fn flipped_bytes_do_no_harm(groom in grooms(), flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12)) {
        for (name, mut bytes) in files(&groom) {
            for (at, value) in &flips {
                let at = at.index(bytes.len());
                bytes[at] = *value;
            }
            survives(name, &bytes)?;
        }
    }

    #[test]
    fn inflated_headers_do_no_harm(groom in grooms(), at in 0usize..48, value in any::<u32>()) {
        for (name, mut bytes) in files(&groom).into_iter().filter(|f| f.0 == "a.hair" || f.1[0] < 32) {
            let at = if at >= 40 { 144 + 4 * (at - 40) } else { 4 * at };
            for value in [value, u32::MAX, 0, bytes.len() as u32, 0x7fff_ffff] {
                if at + 4 <= bytes.len() {
                    bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
                }
                survives(name, &bytes)?;
            }
        }
    }

    #[test]
    fn noise_does_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        for name in ["a.hair", "a.tfx", "a.obj", "a.data", "a.ply", "a.xyz"] {
            survives(name, &bytes)?;
        }
    }

    #[test]
    fn repaired_grooms_are_valid(mut groom in grooms(), nan in any::<prop::sample::Index>()) {
        let at = nan.index(groom.positions.len());
        groom.positions[at].y = f32::NAN;
        let before = groom.positions.len();
        lint::repair(&mut groom);
        for i in 0..groom.len() {
            prop_assert!(groom.strand(i).len() >= 2 && groom.length(i) > 0.0);
            prop_assert!(groom.strand(i).windows(2).all(|w| w[0].distance(w[1]) >= lint::MIN_SEGMENT));
        }
        prop_assert!(groom.positions.iter().all(|p| p.is_finite()) && groom.positions.len() < before);
        let once = groom.clone();
        lint::repair(&mut groom);
        prop_assert_eq!(once, groom);
    }
}

/// Returns a `.ply` of points without edges, strand after strand.
fn ply_points(strands: &[Vec<Vec3>], color: impl Fn(usize) -> Option<[u8; 3]>) -> Vec<u8> {
    let count = strands.iter().map(Vec::len).sum::<usize>();
    let colors = color(0).map_or("", |_| "property uchar red\nproperty uchar green\nproperty uchar blue\n");
    let mut text = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\n{colors}end_header\n"
    )
    .into_bytes();
    for (i, strand) in strands.iter().enumerate() {
        for p in strand {
            text.extend(p.to_array().into_iter().flat_map(f32::to_le_bytes));
            text.extend(color(i).into_iter().flatten());
        }
    }
    text
}

#[test]
fn points_without_edges_are_cut_into_strands() {
    let strand = |i: usize| {
        let root = Vec3::new(0.013 * (i % 7) as f32, 0.1, 0.017 * (i / 7) as f32);
        (0..100).map(|k| root - Vec3::Y * (1.5e-3 * k as f32)).collect::<Vec<_>>()
    };
    let strands: Vec<Vec<Vec3>> = (0..40).map(strand).collect();
    let of = |i: usize| Some([(i * 37 % 251) as u8, (i * 91 % 255) as u8, 7]);
    // By distances, and by colors where roots and tips are near each other.
    let joined: Vec<Vec<Vec3>> =
        (0..40).map(|i| (0..100).map(|k| Vec3::X * (1e-3 * (100 * i + k) as f32)).collect()).collect();
    for (strands, bytes) in [
        (&strands, ply_points(&strands, |_| None)),
        (&strands, ply_points(&strands, of)),
        (&joined, ply_points(&joined, of)),
    ] {
        let read = parse(Path::new("pc.ply"), &bytes, false).unwrap();
        assert_eq!(read.strands.len(), 40);
        assert!(read.strands.iter().zip(strands).all(|(read, given)| read == given));
        assert!(read.notes.iter().any(|note| note.contains("strands of 100")), "{:?}", read.notes);
    }
    let says = |bytes: &[u8]| parse(Path::new("pc.ply"), bytes, false).err().unwrap().to_string();
    assert!(says(&ply_points(&joined, |_| None)).contains("which strands they form"));
    assert!(says(&ply_points(&joined, |_| Some([1, 2, 3]))).contains("which strands they form"));
    assert!(says(&ply_points(&strands[..1], |_| None)).contains("without edges"));
}

#[test]
fn nan_errors_state_their_position() {
    let mut groom = Strands::default();
    groom.push(&[Vec3::ZERO, Vec3::new(0.0, f32::NAN, 0.0)]);
    for (name, place) in [
        ("a.hair", "at byte 144"),
        ("a.tfx", "at byte 180"),
        ("a.obj", "at line 3"),
        ("a.data", "at byte 24"),
        ("a.ply", "at byte 206"),
    ] {
        let bytes = encoded(&groom, name, None);
        let error = parse(Path::new(name), &bytes, false).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(error.contains(place) && error.contains("NaN"), "{error}");
        assert!(parse(Path::new(name), &bytes, true).is_ok());
    }
}

#[test]
fn hair_file_defaults_are_read() {
    let mut groom = Strands::default();
    groom.push(&[Vec3::ZERO, Vec3::X]);
    let mut bytes = encoded(&groom, "a.hair", None);
    bytes[20..24].copy_from_slice(&0.1f32.to_le_bytes());
    bytes[28..32].copy_from_slice(&0.5f32.to_le_bytes());
    let strands = parse(Path::new("a.hair"), &bytes, false).unwrap().strands;
    assert_eq!(strands.radii, vec![0.05; 2]);
    assert_eq!(strands.colors, vec![Vec3::new(0.5, 0.0, 0.0); 2]);
    // Thickness, transparency and colors, in this order.
    bytes[12..16].copy_from_slice(&(2u32 | 4 | 8 | 16).to_le_bytes());
    bytes.extend([1.0f32, 2.0, 0.9, 0.8, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6].iter().flat_map(|v| v.to_le_bytes()));
    let strands = parse(Path::new("a.hair"), &bytes, false).unwrap().strands;
    assert_eq!(strands.radii, vec![0.5, 1.0]);
    assert_eq!(strands.colors[1], Vec3::new(0.4, 0.5, 0.6));
}

#[test]
fn wrong_file_types_are_reported() {
    let says = |name: &str, bytes: &[u8]| parse(Path::new(name), bytes, false).err().unwrap().to_string();
    assert!(says("a.hair", b"HAIL").contains("HAIR"));
    assert!(says("a.tfx", &[0; 400]).contains("version"));
    assert!(says("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").contains("head"));
    assert!(says("a.obj", b"v 0 0 0\nl 1 2\n").contains("line 2"));
    assert!(says("a.tfx", b"").contains("empty"));
    assert!(says("a.data", &[0xff; 8]).contains("is negative"));
    assert!(says("a.data", &[9, 0, 0, 0, 1, 0, 0, 0]).contains("ends here"));
    let header = |lines: &str| format!("ply\nformat ascii 1.0\n{lines}end_header\n0 0 0\n");
    let vertex = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    assert!(says("a.ply", b"plot\n").contains("does not start with"));
    assert!(says("a.ply", header(vertex).as_bytes()).contains("points without edges"));
    assert!(says("a.ply", header(&vertex[..34]).as_bytes()).contains("no y"));
    let edges = format!("{vertex}element edge 1\nproperty int vertex1\nproperty int vertex2\n");
    assert!(says("a.ply", (header(&edges) + "0 1\n").as_bytes()).contains("at line 12"));
    assert!(says("a.ply", header("element edge 9\n").as_bytes()).contains("no properties"));
    #[cfg(feature = "gltf")]
    {
        let body = Writer::of("a.glb").unwrap().mesh(&crate::mannequin::mesh(20), None).unwrap();
        assert!(says("a.glb", &body).contains("head"));
        assert!(says("a.glb", b"glTF").contains("not a valid glTF file"));
    }
    assert!(says("a.tfxmesh", b"0").contains("a mesh, not a groom"));
    let said = says("a.fbx", b"0");
    assert!(said.starts_with("a.fbx: a groom is a .tfx, .hair") && !said.contains(".tfxmesh"), "{said}");
    #[cfg(not(feature = "usd"))]
    assert!(says("a.usd", b"0").contains("the feature `usd`"));
}

#[test]
fn writers_report_lost_attributes() {
    let mut groom = Strands::default();
    groom.push(&[Vec3::ZERO, Vec3::X]);
    (groom.radii, groom.colors, groom.tip_pinned) = (vec![1e-5; 2], vec![Vec3::ONE; 2], vec![true]);
    let notes = |name: &str| {
        Writer::of(name).unwrap().strands(&groom, Some(LengthUnit(1.0))).unwrap().notes.join("; ")
    };
    let lost = |what: &str| format!("{what} are not written: the format cannot store them");
    assert_eq!(notes("a.hair"), lost("pinned tips"));
    assert_eq!(notes("a.tfx"), lost("widths"));
    let all = ["unit and axes", "widths", "colors", "pinned tips"];
    assert_eq!(notes("a.data"), all.map(lost).join("; "));
    let error =
        |unit| Writer::of("a.hair").unwrap().strands(&groom, Some(LengthUnit(unit))).unwrap_err().to_string();
    assert!(
        error(0.01).contains("only .") && error(0.01).contains("a unit other than meters"),
        "{}",
        error(0.01)
    );
    assert!(Writer::of("a.hair").unwrap().mesh(&TriMesh::default(), None).is_err());
    assert!(
        Writer::of("a.tfx").unwrap().character(None, &[]).unwrap_err().to_string().contains("a character")
    );
    assert!(Writer::of("a.tresses").unwrap_err().to_string().contains("tresses convert"));
    assert!(Writer::of("a.dae").unwrap_err().to_string().contains("a groom can be written as .tfx, .hair"));
}

/// Returns a text `.tfx` file with these header lines.
fn asking(lines: &str) -> Vec<u8> {
    let mut groom = Strands::default();
    groom.push(&[Vec3::ZERO, Vec3::Y * 0.1, Vec3::Y * 0.2]);
    groom.push(&[Vec3::X * 0.01, Vec3::X * 0.01 + Vec3::Y * 0.1]);
    tfx2(&groom).replace("scale 1.0\n", lines).into_bytes()
}

#[test]
fn followers_are_read() {
    let four = asking("scale 2.0\nnumFollowHairsPerGuideHair 4\nmaxRadiusAroundGuideHair 0.5\n");
    let raw = parse(Path::new("a.tfx"), &four, false).unwrap();
    assert_eq!(raw.followers, vec![Followers { count: 4, radius: Some(1.0) }; 2]);
    assert!(raw.notes.iter().any(|note| note.contains("4 child strands")));
    // The binary version states only the count.
    let mut groom = Strands::default();
    groom.push(&[Vec3::ZERO, Vec3::Y]);
    let mut bytes = tfx3(&groom);
    assert!(parse(Path::new("a.tfx"), &bytes, false).unwrap().followers.is_empty());
    bytes[12] = 6;
    let raw = parse(Path::new("a.tfx"), &bytes, false).unwrap();
    assert_eq!(raw.followers, vec![Followers { count: 6, radius: None }]);
    // Radii are in meters. Each remaining strand has an entry; files without child strands have none.
    let dropped = String::from_utf8(four.clone())
        .unwrap()
        .replace("0 0.2 0\n", "0 0 0\n")
        .replace("0 0.1 0\n", "0 0 0\n");
    let files = [("a.tfx", four), ("b.tfx", dropped.into_bytes()), ("c.tfx", asking(""))];
    let files: Vec<FileBytes> = files.map(|(name, bytes)| (name.into(), bytes.into())).into();
    let orient = orient::OrientationOverride { unit: Some(orient::LengthUnit(0.01)), ..Default::default() };
    let (strands, _, report) = read_given(&files, &ImportOptions { orient, ..Default::default() }).unwrap();
    assert_eq!((strands.len(), report.followers.len()), (5, 5));
    assert_eq!(report.followers[2], Followers { count: 4, radius: Some(0.01) });
    assert_eq!(report.followers[4], Followers::default());
    assert_eq!(report.with_followers(), 5 + 3 * 4);
}

#[test]
fn invalid_followers_are_reported() {
    for (lines, says) in [
        ("numFollowHairsPerGuideHair many\n", "should be a count, but is “many”"),
        ("numFollowHairsPerGuideHair -1\n", "should be a count, but is “-1”"),
        ("numFollowHairsPerGuideHair\n", "numFollowHairsPerGuideHair is missing"),
        ("maxRadiusAroundGuideHair nan\n", "should be a finite number, but is “nan”"),
        ("maxRadiusAroundGuideHair -2\n", "is -2, but must not be negative"),
    ] {
        let error = parse(Path::new("a.tfx"), &asking(lines), false).err().unwrap().to_string();
        assert!(error.contains(says) && error.contains("line 2") && !error.contains('\n'), "{error}");
    }
    // Any count is stored, saturated to 32 bits. Filling reports that there is no room for so many strands.
    let many = parse(Path::new("a.tfx"), &asking("numFollowHairsPerGuideHair 99999999999\n"), false).unwrap();
    assert_eq!(many.followers[0].count, u32::MAX);
    let nowhere = asking("numFollowHairsPerGuideHair 3\nmaxRadiusAroundGuideHair 0\n");
    assert_eq!(parse(Path::new("a.tfx"), &nowhere, false).unwrap().followers[1].radius, None);
    let lenient = parse(Path::new("a.tfx"), &asking("maxRadiusAroundGuideHair inf\n"), true).unwrap();
    assert!(lenient.followers.is_empty());
}
