//! Against files of Pixar's USD (`apps/cli/tests/reference_usd.py` makes it), texts of our own, and broken ones.

use std::{borrow::Cow, io::Cursor, path::Path, path::PathBuf};

use glam::{Mat4, Quat, Vec2, Vec3};
use openusd::{usda, usdc, usdz};

use crate::{
    Rig, Strands, TriMesh,
    export::{self, Format},
    import::{Files, Given, Kind, Moment, Raw, Source, kind, mesh, mesh::RawMesh, parse_at, read_given},
    mannequin,
    orient::{Axis, Choice, Unit},
    rig::{Animation, Channel, Curve, Property},
    strands::Mark,
};

const REFERENCE: &[u8] = include_bytes!("reference.usdc");
const SKELETON: &[u8] = include_bytes!("reference_skel.usdc");

fn read(name: &str, bytes: &[u8], moment: Moment) -> Result<Raw, String> {
    parse_at(Path::new(name), bytes, false, moment).map_err(|error| error.to_string())
}

fn text(text: &str) -> Result<Raw, String> {
    read("a.usda", format!("#usda 1.0\n{text}").as_bytes(), Moment::First)
}

/// The same layer as `.usdc` and in a package.
fn others(text: &str) -> [(&'static str, Vec<u8>); 2] {
    let mut binary = Cursor::new(Vec::new());
    usdc::CrateWriter::write(&usda::parse(text).unwrap(), &mut binary).unwrap();
    let binary = binary.into_inner();
    let mut package = usdz::ArchiveWriter::new(Cursor::new(Vec::new()));
    package.add_layer("in/root.usdc", &binary).unwrap();
    [("a.usdc", binary), ("a.usdz", package.finish().unwrap().into_inner())]
}

/// Point `k` of curve `i` of the script, as the transforms have it: scaled by 2, turned by 90° about Y, moved.
fn point(i: usize, k: usize, frame: usize) -> Vec3 {
    let (x, k) = (i as f32 + 0.1 * (k * k * (i + 1)) as f32, k as f32);
    let p = 2.0 * Vec3::new(x, 10.0 * k, 0.5 * frame as f32 * k);
    Vec3::new(p.z, p.y, -p.x) + Vec3::new(1.0, 2.0, 3.0)
}

#[test]
fn a_file_of_the_reference_implementation() {
    for (moment, frame) in [(Moment::First, 0), (Moment::Frame(1), 1), (Moment::Seconds(1.03), 1)] {
        let raw = read("a.usdc", REFERENCE, moment).unwrap();
        let strands = &raw.strands;
        assert_eq!((strands.len(), strands.root_uvs.len(), strands.colors.len()), (7, 0, 0));
        assert_eq!(raw.declared, Choice { unit: Some(Unit(0.01)), up: Some(Axis::Y), ..Default::default() });
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
            // Half of a width of 0.01 (i + 1), twice as large.
            let radius = strands.radii[strands.range(i).start];
            assert!((radius - 0.01 * (i + 1) as f32).abs() < 1e-6, "{radius}");
            let mark = Mark { id: i as i32, group: i as i32 % 2, ..Default::default() };
            assert_eq!(strands.marks[i], mark);
        }
        for i in 0..2 {
            // Guides are straight, and 5 further on in the space of what holds both.
            let apart = strands.strand(5 + i)[1] - point(i, 1, frame);
            assert!(apart.distance(Vec3::new(10.0, 0.0, 0.0)) < 1e-3, "{apart}");
            let mark = Mark { guide: true, id: 100 + i as i32, group: i as i32, ..Default::default() };
            assert_eq!(strands.marks[5 + i], mark);
        }
        let notes = raw.notes.join("\n");
        for said in
            ["2 frames from 1.000 to 1.042 s", "2 objects", "B-spline", "guides (groom_guide)", "“widths”"]
        {
            assert!(notes.contains(said), "{said}: {notes}");
        }
    }
    let error = read("a.usdc", REFERENCE, Moment::Frame(2)).err().unwrap();
    assert!(error.contains("frame 2 is asked for, but there are 2"), "{error}");
    assert_eq!(kind(Path::new("a.usdc"), REFERENCE), Some(Kind::Groom));
}

fn groom() -> Strands {
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

#[test]
fn what_is_written_is_read_back() {
    let bare = Strands { radii: vec![], colors: vec![], root_uvs: vec![], marks: vec![], ..groom() };
    for strands in [groom(), bare] {
        let bytes = export::encode(&strands, Format::Usda, true).unwrap().bytes;
        let said = String::from_utf8(bytes.clone()).unwrap();
        for (name, bytes) in others(&said).into_iter().chain([("a.usda", bytes)]) {
            let back = read(name, &bytes, Moment::First).unwrap();
            assert_eq!(back.strands, strands, "{name}");
            assert_eq!(back.declared, Choice::METRES, "{name}");
        }
        // Another groom is told from it.
        let moved = said.replacen("1.7", "1.8", 1);
        assert_ne!(read("a.usda", moved.as_bytes(), Moment::First).unwrap().strands, strands);
    }
    let unsaid = export::encode(&groom(), Format::Usda, false).unwrap().bytes;
    assert_eq!(read("a.usda", &unsaid, Moment::First).unwrap().declared, Choice::default());
    let centimetres = export::encode_in(&groom(), Format::Usda, Unit(0.01)).unwrap().bytes;
    let back = read("a.usda", &centimetres, Moment::First).unwrap();
    assert_eq!(back.declared, Choice { unit: Some(Unit(0.01)), ..Choice::METRES });
    assert!((back.strands.positions[0].y - 170.0).abs() < 1e-4);
}

/// Curves of four or seven points each on a parabola, with more attributes.
fn curves(name: &str, more: &str, counts: &[usize]) -> String {
    let points: Vec<String> =
        counts.iter().flat_map(|n| (0..*n).map(|k| format!("({k}, {}, 0)", k * k))).collect();
    format!(
        "def BasisCurves \"{name}\" {{\n int[] curveVertexCounts = {counts:?}\n point3f[] points = [{}]\n {more}\n}}\n",
        points.join(", ")
    )
}

#[test]
fn every_basis_and_every_place_of_values() {
    let ends = |more: &str| {
        let raw = text(&curves("a", more, &[7, 4])).unwrap();
        let line = raw.strands.strand(0);
        (line[0], line[line.len() - 1], raw)
    };
    let first = |more: &str| ends(more).0.x;
    assert_eq!(first("uniform token type = \"linear\""), 0.0);
    // Bézier is what nothing said means.
    assert_eq!((ends("").0.x, ends("").1.x), (0.0, 6.0));
    assert!(ends("").2.strands.strand(0).len() > 7);
    let bspline = "uniform token basis = \"bspline\"\n";
    let catmull = "uniform token basis = \"catmullRom\"\n";
    let pinned = "uniform token wrap = \"pinned\"\n";
    assert!((first(bspline) - 1.0).abs() < 1e-6 && (first(catmull) - 1.0).abs() < 1e-6);
    assert!(first(&format!("{bspline}{pinned}")).abs() < 1e-6);
    assert!(first(&format!("{catmull}{pinned}")).abs() < 1e-6);
    // Blender means hair from root to tip.
    let blender = format!("( doc = \"Blender v4.2.0\" )\n{}", curves("a", bspline, &[7]));
    assert!(text(&blender).unwrap().strands.positions[0].x.abs() < 1e-6);
    // Widths at points, at ends of pieces, for curves, for all.
    let widths = |basis: &str, list: &str, kind: &str| {
        let more = format!("{basis} float[] widths = {list} (interpolation = \"{kind}\")");
        let (.., raw) = ends(&more);
        let strands = raw.strands;
        [0, 1].map(|i| {
            let range = strands.range(i);
            2.0 * strands.radii[range.end - 1]
        })
    };
    assert_eq!(widths("", "[1, 1, 1, 1, 1, 1, 3, 1, 1, 1, 5]", "vertex"), [3.0, 5.0]);
    assert_eq!(widths("", "[1, 1, 3, 1, 5]", "varying"), [3.0, 5.0]);
    let near = |found: [f32; 2], meant: [f32; 2]| (0..2).all(|i| (found[i] - meant[i]).abs() < 1e-5);
    assert!(near(widths(catmull, "[1, 1, 1, 1, 3, 1, 5]", "varying"), [3.0, 5.0]));
    assert_eq!(widths("", "[3, 5]", "uniform"), [3.0, 5.0]);
    assert_eq!(widths("", "[4]", "constant"), [4.0, 4.0]);
    // Indices, and what is said above for all below.
    let indexed = "color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = \"uniform\")\n\
                   int[] primvars:displayColor:indices = [1, 0]";
    let strands = ends(indexed).2.strands;
    assert_eq!((strands.colors[0], *strands.colors.last().unwrap()), (Vec3::Y, Vec3::X));
    let one = "color3f[] primvars:displayColor = [(1, 0, 0)] (interpolation = \"constant\")";
    let raw = ends(one).2;
    assert!(raw.strands.colors.is_empty() && raw.notes.join(" ").contains("displayColor"), "{:?}", raw.notes);
    let above = format!("def Xform \"x\" {{ int primvars:groom_group_id = 7\n{} }}", curves("a", "", &[4]));
    assert_eq!(text(&above).unwrap().strands.marks[0].group, 7);
    // Knots of their own.
    let nurbs = curves("a", "int[] order = [4]\n double[] knots = [0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4]", &[7]);
    let raw = text(&nurbs.replace("BasisCurves", "NurbsCurves")).unwrap();
    assert!(raw.strands.strand(0)[0].x.abs() < 1e-6 && raw.strands.positions.last().unwrap().x == 6.0);
    for (broken, said) in [
        ("uniform token basis = \"hermite\"", "not read"),
        ("uniform token type = \"cubic\"\n float[] widths = [nan]", "must be finite"),
        ("int[] primvars:groom_id = [1]\n int[] primvars:groom_id:indices = [3, 0]", "no value 3"),
    ] {
        let error = text(&curves("a", broken, &[7, 4])).err().unwrap();
        assert!(error.contains(said), "{error}");
    }
    let error = text(&curves("a", "", &[6])).err().unwrap();
    assert!(error.contains("3 n + 1"), "{error}");
}

#[test]
fn transforms_of_every_kind_move_what_is_below() {
    // Where (1, 0, 0) goes.
    let moved = |operations: &[(&str, &str)]| {
        let names: Vec<String> =
            operations.iter().map(|(kind, _)| format!("\"{}\"", kind.rsplit(' ').next().unwrap())).collect();
        let values: Vec<String> = operations
            .iter()
            .filter(|(kind, value)| !value.is_empty() && !kind.contains('!'))
            .map(|(kind, value)| format!("{kind} = {value}\n"))
            .collect();
        let line = curves("a", "uniform token type = \"linear\"", &[2]);
        let order = format!("uniform token[] xformOpOrder = [{}]", names.join(", "));
        let scene = format!(
            "def Xform \"top\" {{ double3 xformOp:translate = (0, 0, 9)\n uniform token[] xformOpOrder = [\"xformOp:translate\"]\n\
             def Xform \"x\" {{ {}{order}\n{line} }} }}",
            values.concat()
        );
        // The second point is (1, 1, 0): the first is the origin.
        let strands = text(&scene).unwrap().strands;
        (strands.positions[0] - Vec3::Z * 9.0, strands.positions[1] - strands.positions[0])
    };
    let near = |found: (Vec3, Vec3), origin: Vec3, along: Vec3| {
        assert!(found.0.distance(origin) + found.1.distance(along) < 1e-5, "{found:?} {origin} {along}");
    };
    let turn = ("float xformOp:rotateZ", "90");
    let shift = ("double3 xformOp:translate", "(1, 2, 3)");
    let size = ("float3 xformOp:scale", "(2, 3, 4)");
    near(moved(&[shift, turn, size]), Vec3::new(1.0, 2.0, 3.0), Vec3::new(-3.0, 2.0, 0.0));
    near(moved(&[size, turn, shift]), Vec3::new(-4.0, 3.0, 12.0), Vec3::new(-2.0, 3.0, 0.0));
    near(
        moved(&[("quatf xformOp:orient", "(0.70710678, 0, 0, 0.70710678)")]),
        Vec3::ZERO,
        Vec3::new(-1.0, 1.0, 0.0),
    );
    // X first, then Z: (1, 1, 0) → (1, 0, 1) → (0, 1, 1).
    near(moved(&[("float3 xformOp:rotateXYZ", "(90, 0, 90)")]), Vec3::ZERO, Vec3::new(0.0, 1.0, 1.0));
    near(moved(&[("float3 xformOp:rotateZYX", "(90, 0, 90)")]), Vec3::ZERO, Vec3::new(-1.0, 0.0, 1.0));
    let matrix = "( (0, 2, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1) )";
    near(
        moved(&[("matrix4d xformOp:transform", matrix)]),
        Vec3::new(5.0, 6.0, 7.0),
        Vec3::new(-1.0, 2.0, 0.0),
    );
    let pivot = ("double3 xformOp:translate:pivot", "(1, 0, 0)");
    let back = ("!invert!xformOp:translate:pivot", "");
    near(moved(&[pivot, turn, back]), Vec3::new(1.0, -1.0, 0.0), Vec3::new(-1.0, 1.0, 0.0));
    near(moved(&[("!resetXformStack!", ""), shift]), Vec3::new(1.0, 2.0, -6.0), Vec3::new(1.0, 1.0, 0.0));
    let error = text(&format!(
        "def Xform \"x\" {{ float xformOp:wobble = 1\n uniform token[] xformOpOrder = [\"xformOp:wobble\"]\n{} }}",
        curves("a", "", &[4])
    ));
    assert!(error.err().unwrap().contains("no operation that is known"));
}

#[test]
fn what_is_seen_is_read_and_guides_are_told() {
    let line =
        |name: &str, more: &str| curves(name, &format!("uniform token type = \"linear\"\n{more}"), &[2, 3]);
    let hidden = "token visibility = \"invisible\"";
    let raw = text(&format!("{}{}", line("a", ""), line("b", hidden))).unwrap();
    assert_eq!(raw.strands.len(), 2);
    assert!(raw.notes.join(" ").contains("1 invisible"), "{:?}", raw.notes);
    assert!(text(&line("a", hidden)).err().unwrap().contains("invisible"));
    let inside = format!("def Xform \"x\" {{ {hidden}\n{} }}\n{}", line("a", ""), line("b", ""));
    assert_eq!(text(&inside).unwrap().strands.len(), 2);
    for more in ["uniform token purpose = \"guide\"", "int primvars:groom_guide = 1"] {
        let raw = text(&format!("{}{}", line("a", ""), line("b", more))).unwrap();
        let guides: Vec<bool> = raw.strands.marks.iter().map(|mark| mark.guide).collect();
        assert_eq!(guides, [false, false, true, true], "{more}");
    }
    let proxy = "uniform token purpose = \"proxy\"";
    assert_eq!(text(&format!("{}{}", line("a", ""), line("b", proxy))).unwrap().strands.len(), 2);
    assert_eq!(text(&line("b", proxy)).unwrap().strands.len(), 2);
    // What is abstract, switched off or only an opinion is none; an instance is one.
    let asset = format!("class Xform \"kept\" {{ {} }}\n", line("a", ""));
    assert!(text(&asset).err().unwrap().contains("neither curves nor meshes"));
    let off = line("b", "").replacen("\"b\" {", "\"b\" ( active = false ) {", 1);
    assert_eq!(text(&format!("{}{off}", line("a", ""))).unwrap().strands.len(), 2);
    let twice = format!(
        "{asset}def \"x\" ( instanceable = true references = </kept> ) {{}}\n\
         def Xform \"y\" ( instanceable = true references = </kept> ) {{ double3 xformOp:translate = (0, 0, 5)\n\
         uniform token[] xformOpOrder = [\"xformOp:translate\"] }}\n"
    );
    let raw = text(&twice).unwrap();
    assert_eq!((raw.strands.len(), raw.strands.strand(2)[0].z), (4, 5.0), "{:?}", raw.notes);
}

#[test]
fn what_moves_has_its_frames() {
    let still = curves("a", "uniform token type = \"linear\"", &[2]);
    let moving = format!(
        "( timeCodesPerSecond = 10 )\ndef Xform \"x\" {{ double3 xformOp:translate.timeSamples = {{ 5: (0, 0, 0), 10: (4, 0, 0), 20: (8, 0, 0) }}\n\
         uniform token[] xformOpOrder = [\"xformOp:translate\"]\n{still} }}"
    );
    let bytes = format!("#usda 1.0\n{moving}");
    let x = |moment| read("a.usda", bytes.as_bytes(), moment).unwrap().strands.positions[0].x;
    let moments =
        [Moment::First, Moment::Frame(1), Moment::Frame(2), Moment::Seconds(0.9), Moment::Seconds(9.0)];
    assert_eq!(moments.map(x), [0.0, 4.0, 8.0, 4.0, 8.0]);
    let error = read("a.usda", format!("#usda 1.0\n{still}").as_bytes(), Moment::Frame(1)).err().unwrap();
    assert!(error.contains("nothing moves"), "{error}");
}

#[test]
fn what_is_referred_to_is_found_among_the_given() {
    let root = b"#usda 1.0\n( metersPerUnit = 0.01\n upAxis = \"Z\" )\ndef \"x\" ( references = @./in/b.usda@</x> ) {}\n";
    let inner = format!(
        "#usda 1.0\ndef Xform \"x\" {{ {} }}\n",
        curves("a", "uniform token type = \"linear\"", &[4])
    );
    let given: Vec<Given> = vec![
        (PathBuf::from("root.usda"), Cow::Borrowed(&root[..])),
        (PathBuf::from("b.usda"), Cow::Borrowed(inner.as_bytes())),
    ];
    let read = |files: &[Given]| {
        let source =
            Source { path: Path::new("root.usda"), bytes: root, files: Files::Given(files), lenient: false };
        super::read(&source, Moment::First)
    };
    let raw = read(&given).unwrap();
    assert_eq!((raw.strands.len(), raw.strands.positions[3]), (1, Vec3::new(3.0, 9.0, 0.0)));
    assert_eq!(raw.declared, Choice { unit: Some(Unit(0.01)), up: Some(Axis::Z), ..Default::default() });
    let error = read(&given[..1]).err().unwrap().to_string();
    assert!(error.contains("b.usda") && !error.contains('\n'), "{error}");
    assert!(read_given(&given[1..], &Default::default()).is_ok());
}

#[test]
fn meshes_are_heads() {
    let square = "def Mesh \"m\" { int[] faceVertexCounts = [4]\n int[] faceVertexIndices = [0, 1, 2, 3]\n\
                  point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n MORE }\n";
    let read = |more: &str, outer: &str| {
        let text = format!("#usda 1.0\n( upAxis = \"Z\" )\n{outer}{}", square.replace("MORE", more));
        let given: [Given; 1] = [(PathBuf::from("a.usda"), Cow::Owned(text.clone().into_bytes()))];
        assert_eq!(kind(Path::new("a.usda"), text.as_bytes()), Some(Kind::Mesh));
        mesh::read_given(&given, Path::new("a.usda"))
    };
    let front = read("", "").unwrap();
    assert_eq!((front.mesh.triangles.len(), front.mesh.normals[0]), (2, Vec3::Z));
    assert_eq!(front.declared, Choice { up: Some(Axis::Z), ..Default::default() });
    let back = "uniform token orientation = \"leftHanded\"";
    assert_eq!(read(back, "").unwrap().mesh.normals[0], Vec3::NEG_Z);
    let mirrored = "float3 xformOp:scale = (-1, 1, 1)\n uniform token[] xformOpOrder = [\"xformOp:scale\"]";
    let mesh = read(mirrored, "").unwrap().mesh;
    assert_eq!((mesh.positions[1], mesh.normals[0]), (Vec3::NEG_X, Vec3::Z));
    let hidden =
        read("", &square.replace("\"m\"", "\"n\"").replace("MORE", "uniform token purpose = \"proxy\""));
    assert_eq!(hidden.unwrap().mesh.triangles.len(), 2);
    let error = read("int[] faceVertexIndices = [0, 1, 2, 9]", "").err().map(|error| error.to_string());
    assert!(error.is_some());
    let broken = square.replace("2, 3]", "2, 9]").replace("MORE", "");
    let given: [Given; 1] =
        [(PathBuf::from("a.usda"), Cow::Owned(format!("#usda 1.0\n{broken}").into_bytes()))];
    let error = mesh::read_given(&given, Path::new("a.usda")).err().unwrap().to_string();
    assert!(error.contains("vertex 9 does not exist, there are 4"), "{error}");
}

#[test]
fn whatever_is_broken_is_one_sentence_or_another_groom() {
    change_every(23);
}

#[test]
#[ignore = "proof"]
fn whatever_is_broken_byte_by_byte() {
    change_every(1);
}

/// Changes every `step`th byte of files of each kind in four ways, and cuts them off there.
fn change_every(step: usize) {
    let mut strands = groom();
    // As small as a file can be that has everything.
    strands.offsets.truncate(4);
    let count = strands.offsets[3] as usize;
    strands.positions.truncate(count);
    strands.radii.truncate(count);
    strands.colors.truncate(count);
    strands.root_uvs.truncate(3);
    strands.marks.truncate(3);
    let said = export::encode(&strands, Format::Usda, true).unwrap().bytes;
    let packed = others(std::str::from_utf8(&said).unwrap());
    let files = [("a.usdc", REFERENCE), ("b.usdc", SKELETON), ("a.usda", &said), ("a.usdz", &packed[1].1)];
    for (name, sound) in files {
        let (mut refused, mut changed) = (0, 0);
        let whole = read(name, sound, Moment::First).unwrap().strands;
        let mut check = |bytes: &[u8]| match read(name, bytes, Moment::First) {
            Ok(raw) => {
                let (strands, n) = (&raw.strands, raw.strands.positions.len());
                let vertices = |count: usize| count == 0 || count == n;
                assert_eq!(strands.offsets.last().map(|end| *end as usize), Some(n));
                assert!(strands.offsets.windows(2).all(|w| w[0] < w[1]) && vertices(strands.radii.len()));
                assert!(vertices(strands.colors.len()) && n <= 16 * sound.len());
                assert!(strands.marks.is_empty() || strands.marks.len() == strands.len());
                changed += usize::from(*strands != whole);
            }
            Err(said) => {
                assert!(!said.contains('\n') && said.len() < 600, "{said}");
                assert!(!said.contains("gave up"), "{said}");
                refused += 1;
            }
        };
        // A body, where it has one.
        let bends = |bytes: &[u8]| {
            let given = [(PathBuf::from(name), Cow::Borrowed(bytes))];
            match mesh::read_given(&given, Path::new(name)) {
                Ok(raw) => {
                    let (count, rig) = (raw.mesh.positions.len(), raw.rig.unwrap_or_default());
                    assert!(
                        count <= 16 * sound.len() && matches!(rig.vertices.len(), n if n == 0 || n == count)
                    );
                    let joints = rig.vertices.iter().flat_map(|vertex| vertex.joints);
                    assert!(joints.max().is_none_or(|most| usize::from(most) < rig.joints.len()));
                    assert!(rig.joints.iter().all(|joint| (joint.node as usize) < rig.nodes.len()));
                    for animation in &rig.animations {
                        rig.deform(&rig.pose(animation, 0.5 * animation.length), &mut raw.mesh.clone());
                    }
                }
                Err(error) => {
                    let said = error.to_string();
                    assert!(!said.contains('\n') && said.len() < 600 && !said.contains("gave up"), "{said}");
                }
            }
        };
        let mut bytes = sound.to_vec();
        for i in (0..bytes.len()).step_by(step) {
            for with in [0x01, 0x80, 0xff, bytes[i]] {
                // The last of them is 0.
                bytes[i] ^= with;
                check(&bytes);
                if sound == SKELETON {
                    bends(&bytes);
                }
                bytes[i] = sound[i];
            }
        }
        (0..sound.len()).step_by(step).for_each(|end| check(&sound[..end]));
        // Both happened, often: this fails if nothing is read, or nothing looked at.
        assert!(refused > sound.len() / step / 2 && changed * step > 30, "{name}: {refused} {changed}");
    }
}

#[test]
fn what_would_take_all_stack_or_memory_is_refused() {
    let says = |said: &str| text(said).err().unwrap();
    let deep = "def \"a\" {".repeat(100_000);
    assert!(says(&deep).contains("deep"), "{}", says(&deep));
    let list = format!("def \"a\" {{ int x = {}", "[".repeat(100_000));
    assert!(says(&list).contains("deep"));
    // As deep as allowed is no trouble on the small stack of a test.
    let nested = |n: usize| format!("{}{}{}", "def \"a\" {".repeat(n), curves("b", "", &[4]), "}".repeat(n));
    assert_eq!(text(&nested(90)).unwrap().strands.len(), 1);
    // Ten times ten times … the same: the parts are few, their number is not.
    let level = |n: usize| {
        let parts: Vec<String> =
            (0..10).map(|k| format!("def \"p{k}\" ( references = </l{}> ) {{}}\n", n + 1)).collect();
        format!("class \"l{n}\" {{ {} }}\n", parts.concat())
    };
    let bomb = format!(
        "{}class Xform \"l8\" {{ {} }}\ndef \"all\" ( references = </l0> ) {{}}\n",
        (0..8).map(level).collect::<String>(),
        curves("a", "", &[7])
    );
    let error = says(&bomb);
    assert!(error.contains("more often than") || error.contains("prims"), "{error}");
    assert!(says("").contains("neither curves nor meshes"));
    let wrong = says("def BasisCurves \"a\" {\n  int[] x = [1, }\n}");
    assert!(wrong.contains("a.usda at line 3: "), "{wrong}");
}

/// Where Pixar's `UsdSkel` has the points of a prim of `reference_skel.usdc`, at rest or in a frame.
fn skinned(moment: &str, name: &str) -> Vec<Vec3> {
    let line = |line: &str| -> Option<Vec3> {
        let mut words = line.split(' ');
        let of = [words.next()?, words.next()?];
        let numbers: Vec<f32> = words.map(|word| word.parse().unwrap()).collect();
        (of == [moment, name]).then(|| Vec3::from_slice(&numbers))
    };
    include_str!("reference_skel.txt").lines().filter_map(line).collect()
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn skeletons_carry_hair_as_in_the_reference_implementation() {
    let known = [skinned("rest", "whole"), skinned("24", "whole"), skinned("25", "whole")];
    assert!(
        known[0].len() == 6 && farthest(&known[0], &known[1]) > 1.0 && farthest(&known[1], &known[2]) > 1.0
    );
    for (moment, frame) in [(Moment::First, "rest"), (Moment::Frame(0), "24"), (Moment::Frame(1), "25")] {
        let raw = read("a.usdc", SKELETON, moment).unwrap();
        let expected = [skinned(frame, "whole"), skinned(frame, "parts")].concat();
        let off = farthest(&raw.strands.positions, &expected);
        assert!(off < 1e-3, "{frame}: {off}");
        let notes = raw.notes.join("\n");
        assert!(notes.contains("curves of 2 objects go with the joints of a skeleton"), "{notes}");
    }
}

#[test]
fn skeletons_bend_meshes_as_in_the_reference_implementation() {
    let raw =
        mesh::read_given(&[(PathBuf::from("a.usdc"), Cow::Borrowed(SKELETON))], Path::new("a.usdc")).unwrap();
    let (mut body, rig) = (raw.mesh, raw.rig.expect("it bends"));
    assert!(farthest(&body.positions, &skinned("rest", "body")) < 1e-3);
    assert!(body.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
    let names: Vec<_> = rig.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!((names, rig.joints.len()), (vec!["bones", "Torso", "Neck", "Head"], 3));
    let walk = rig.animation("walk").expect("it has the animation");
    assert!((walk.length - 1.0 / 24.0).abs() < 1e-6, "{}", walk.length);
    assert_eq!(rig.target("jaw"), Some(0));
    // The last key, just before it starts again.
    for (time, frame) in [(0.0, "24"), (walk.length * 0.99999, "25")] {
        rig.deform(&rig.pose(walk, time), &mut body);
        let off = farthest(&body.positions, &skinned(frame, "body"));
        assert!(off < 5e-3, "{frame}: {off}");
    }
    assert!(farthest(&skinned("24", "body"), &skinned("25", "body")) > 1.0, "frames differ");
}

#[test]
fn broken_skeletons_are_refused() {
    let scene = |skeleton: &str, binding: &str| {
        text(&format!(
            "def SkelRoot \"a\" {{
                def Skeleton \"s\" {{ {skeleton} }}
                def BasisCurves \"hair\" (prepend apiSchemas = [\"SkelBindingAPI\"]) {{
                    uniform token type = \"linear\"
                    int[] curveVertexCounts = [2]
                    point3f[] points = [(0, 1, 0), (0, 2, 0)]
                    rel skel:skeleton = </a/s>
                    {binding}
                }}
            }}"
        ))
    };
    let two = "uniform token[] joints = [\"A\", \"A/B\"]
        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,1,0,1))]
        uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(5,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,1,0,1))]";
    let on = |joints: &str, weights: &str, size: u32| {
        format!(
            "int[] primvars:skel:jointIndices = [{joints}] (elementSize = {size} interpolation = \"constant\")
            float[] primvars:skel:jointWeights = [{weights}] (elementSize = {size} interpolation = \"constant\")"
        )
    };
    let moved = scene(two, &on("1", "1", 1)).unwrap();
    assert!(farthest(&moved.strands.positions, &[Vec3::new(5.0, 1.0, 0.0), Vec3::new(5.0, 2.0, 0.0)]) < 1e-5);
    let alone = scene(two, "").unwrap();
    assert_eq!(alone.strands.positions[0], Vec3::Y, "without joints it is where it is");
    for (skeleton, binding, why) in [
        (two.to_owned(), on("2", "1", 1), "a joint 2 of 2"),
        (two.to_owned(), on("-1", "1", 1), "a joint -1 of 2"),
        (two.to_owned(), on("0, 1, 0", "1, 0, 1", 1), "3 joints and 3 weights of 2 points"),
        (two.to_owned(), on("0", "1, 2", 1), "1 joints and 2 weights"),
        (
            two.replace("\"A\", \"A/B\"", "\"A/B\", \"A\""),
            on("0", "1", 1),
            "stands before what it hangs from",
        ),
        (two.replacen("(0,0,0,1)", "(0,0,0,0)", 1), on("0", "1", 1), "flatten"),
        (two.replace("\"A\", ", ""), on("0", "1", 1), "2 bindTransforms of 1 joints"),
        ("uniform token[] joints = [\"A\"]".into(), on("0", "1", 1), "at no place"),
    ] {
        let error = scene(&skeleton, &binding).err().unwrap_or_default();
        assert!(error.contains(why), "{why}: {error}");
    }
    // Weights of nothing leave a point where it was bound.
    let nothing = scene(two, &on("1", "0", 1)).unwrap();
    assert_eq!(nothing.strands.positions[0], Vec3::Y);
}

/// A body of `rig` and hair on its first vertices, written and read back.
fn written_body(body: &TriMesh, rig: &Rig, strands: &Strands, packed: bool) -> (RawMesh, Vec<u8>) {
    let hair = [export::usda::HairOf { name: "hair", strands }];
    let mut bytes = export::usda::character(Some((body, Some(rig))), &hair).unwrap();
    let mut name = "a.usda";
    if packed {
        (bytes, name) = (export::usda::packed(&bytes).unwrap(), "a.usdc");
    }
    let given = [(PathBuf::from(name), Cow::Borrowed(&bytes[..]))];
    (mesh::read_given(&given, Path::new(name)).unwrap(), bytes)
}

#[test]
fn bodies_with_hair_are_written_and_bend_as_they_did() {
    let bust = mannequin::mesh(40);
    let mut built_in = mannequin::rig::rig(&bust);
    let turn = |angle: f32| Quat::from_rotation_y(angle).to_array();
    let curve = |values: Vec<f32>| Curve { times: vec![0.0, 0.5, 1.0], values, ..Default::default() };
    let turns = curve([0.0, 0.7, -0.3].map(turn).concat());
    let shape = built_in.target("Jaw").unwrap() as u32;
    built_in.animations.push(Animation {
        name: "Look around".into(),
        length: 1.0,
        channels: vec![
            Channel { node: 2, property: Property::Rotation, curve: turns },
            Channel { node: 0, property: Property::Weights(vec![shape]), curve: curve(vec![0.0, 1.0, 0.5]) },
        ],
    });
    // And one whose rest is not where it was bound, in centimetres.
    let given = [(PathBuf::from("a.usdc"), Cow::Borrowed(SKELETON))];
    let raw = mesh::read_given(&given, Path::new("a.usdc")).unwrap();
    let (mut other, mut rig) = (raw.mesh, raw.rig.unwrap());
    rig.to_groom =
        Mat4::from_scale_rotation_translation(Vec3::splat(0.01), Quat::from_rotation_y(0.4), Vec3::X);
    rig.deform(&rig.rest_pose(), &mut other);
    // And one that rests with its jaw half open.
    let mut open = built_in.clone();
    open.nodes[0].weights = vec![(shape, 0.5)];
    let mut opened = bust.clone();
    open.deform(&open.rest_pose(), &mut opened);
    assert!(farthest(&opened.positions, &bust.positions) > 1e-3);
    let all =
        [(&bust, &built_in, false), (&bust, &built_in, true), (&other, &rig, false), (&opened, &open, false)];
    for (body, rig, packed) in all {
        // A strand on every seventh vertex, or so many that there are some.
        let mut strands = Strands::default();
        let step = (body.positions.len() / 40).max(1);
        for (p, n) in body.positions.iter().zip(&body.normals).step_by(step) {
            strands.push(&[*p, *p + 0.01 * *n, *p + 0.03 * *n]);
        }
        strands.radii = vec![4e-5; strands.positions.len()];
        let (raw, bytes) = written_body(body, rig, &strands, packed);
        let (mut found, back) = (raw.mesh, raw.rig.expect("it bends"));
        assert_eq!(found.triangles, body.triangles);
        assert!(farthest(&found.positions, &body.positions) < 1e-5);
        let names = |rig: &Rig| rig.targets.iter().map(|target| target.name.clone()).collect::<Vec<_>>();
        assert_eq!((names(&back), back.animations.len()), (names(rig), 1));
        let (animation, own) = (&rig.animations[0], &back.animations[0]);
        let mut expected = body.clone();
        let mut most = 0.0f32;
        for part in [0.0, 0.25, 0.6, 0.99] {
            rig.deform(&rig.pose(animation, part * animation.length), &mut expected);
            back.deform(&back.pose(own, part * own.length), &mut found);
            let off = farthest(&found.positions, &expected.positions);
            assert!(off < 2e-3, "{part}: {off}");
            most = most.max(farthest(&expected.positions, &body.positions));
        }
        assert!(most > 0.01, "it moves by {most}");
        let name = if packed { "a.usdc" } else { "a.usda" };
        let raw = read(name, &bytes, Moment::First).unwrap();
        assert!(farthest(&raw.strands.positions, &strands.positions) < 1e-5);
        let thick = raw.strands.radii.iter().map(|radius| (radius / 4e-5 - 1.0).abs()).fold(0.0, f32::max);
        assert!(thick < 1e-3, "{thick}");
        // Roots go with the skin.
        let frames = (own.length * 24.0).round() as u32;
        let (late, middle) = (frames.div_ceil(2), frames.div_ceil(2) as f32 / frames as f32);
        let late = read(name, &bytes, Moment::Frame(late)).unwrap().strands;
        // Shapes do not move hair.
        let mut still = rig.pose(animation, own.length * middle.min(1.0 - 1e-6));
        still.weights = rig.rest_pose().weights;
        rig.deform(&still, &mut expected);
        let roots: Vec<Vec3> = late.iter().map(|line| line[0]).collect();
        let skin: Vec<Vec3> = expected.positions.iter().step_by(step).copied().collect();
        let off = farthest(&roots, &skin);
        assert!(off < 3e-3, "roots are {off} from their skin");
    }
    // A joint that is scaled to nothing, in names that no path may have, twice.
    let mut gone = built_in.clone();
    let scales = [Vec3::ONE, Vec3::ZERO, Vec3::ONE].map(|s| s.to_array()).concat();
    let vanish = Channel { node: 1, property: Property::Scale, curve: curve(scales) };
    gone.animations[0].channels.push(vanish);
    gone.animations.push(gone.animations[0].clone());
    gone.targets.push(gone.targets[0].clone());
    let text = export::usda::character(Some((&bust, Some(&gone))), &[]).unwrap();
    let said = String::from_utf8_lossy(&text);
    assert!(!said.contains("NaN") && said.contains("\"Breath 2\"") && said.contains("Look_around_2"));
    let given = [(PathBuf::from("a.usda"), Cow::Borrowed(&text[..]))];
    let back = mesh::read_given(&given, Path::new("a.usda")).unwrap().rig.unwrap();
    assert_eq!((back.animations.len(), back.targets.len()), (2, 4));
    let (mut found, mut expected) = (bust.clone(), bust.clone());
    back.deform(&back.pose(&back.animations[0], 0.5), &mut found);
    gone.deform(&gone.pose(&gone.animations[0], 0.5), &mut expected);
    assert!(farthest(&found.positions, &expected.positions) < 2e-3);
    gone.animations[0].length = 1e7;
    let error = export::usda::character(Some((&bust, Some(&gone))), &[]).unwrap_err().to_string();
    assert!(error.contains("100000 frames"), "{error}");
    let empty = [export::usda::HairOf { name: "hair", strands: &Strands::default() }];
    assert!(export::usda::character(None, &empty).is_err());
    assert!(export::usda::character(Some((&other, Some(&built_in))), &[]).is_err(), "another's rig");
    // Without a rig nothing is bound.
    let plain = export::usda::character(Some((&bust, None)), &[]).unwrap();
    let given = [(PathBuf::from("a.usda"), Cow::Borrowed(&plain[..]))];
    let raw = mesh::read_given(&given, Path::new("a.usda")).unwrap();
    assert!(raw.rig.is_none() && farthest(&raw.mesh.positions, &bust.positions) == 0.0);
}

#[test]
fn what_no_joint_holds_goes_with_its_skeleton_and_motions_that_make_no_sense_are_left_out() {
    let one = "((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))";
    let scene = format!(
        "#usda 1.0
        def SkelRoot \"a\" {{
            def Skeleton \"s\" {{
                uniform token[] joints = [\"A\"]
                uniform matrix4d[] bindTransforms = [{one}]
                uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,3,0,1))]
                double3 xformOp:translate = (7, 0, 0)
                uniform token[] xformOpOrder = [\"xformOp:translate\"]
                rel skel:animationSource = </a/turn>
            }}
            def SkelAnimation \"turn\" {{
                uniform token[] joints = [\"A\"]
                quatf[] rotations.timeSamples = {{ 0: [(1,0,0,0)], 24: [(0,1,0,0)] }}
            }}
            def SkelAnimation \"held\" {{
                uniform token[] joints = [\"A\"]
                float3[] translations = [(0, 5, 0)]
                quatf[] rotations = [(1, 0, 0, 0)]
            }}
            def Mesh \"m\" (prepend apiSchemas = [\"SkelBindingAPI\"]) {{
                int[] faceVertexCounts = [3]
                int[] faceVertexIndices = [0, 1, 2]
                point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
                rel skel:skeleton = </a/s>
                int[] primvars:skel:jointIndices = [0, 0, 0] (elementSize = 1 interpolation = \"vertex\")
                float[] primvars:skel:jointWeights = [1, 1, 0] (elementSize = 1 interpolation = \"vertex\")
            }}
        }}"
    );
    let given = [(PathBuf::from("a.usda"), Cow::Borrowed(scene.as_bytes()))];
    let raw = mesh::read_given(&given, Path::new("a.usda")).unwrap();
    let places = [Vec3::new(7.0, 3.0, 0.0), Vec3::new(8.0, 3.0, 0.0), Vec3::new(7.0, 1.0, 0.0)];
    assert!(farthest(&raw.mesh.positions, &places) < 1e-5, "{:?}", raw.mesh.positions);
    let rig = raw.rig.unwrap();
    let names: Vec<_> = rig.animations.iter().map(|animation| animation.name.as_str()).collect();
    assert_eq!((names, rig.animations[0].length), (vec!["held"], 0.0));
    let mut held = raw.mesh.clone();
    rig.deform(&rig.pose(&rig.animations[0], 0.0), &mut held);
    assert!(held.positions[0].distance(Vec3::new(7.0, 5.0, 0.0)) < 1e-5, "{}", held.positions[0]);
    let notes = raw.notes.join("\n");
    assert!(notes.contains("an animation is left out") && notes.contains("/a/turn"), "{notes}");
}

#[test]
fn caches_are_written_frame_by_frame() {
    let strands = groom();
    let options = export::usda::CacheOptions { unit: Unit(0.01), rate: 12.0, frames: 3 };
    let mut cache = export::usda::Cache::new(Vec::new(), &strands, options).unwrap();
    let at = |frame: usize| -> Vec<Vec3> {
        strands.positions.iter().map(|p| *p + Vec3::Y * 0.5 * frame as f32).collect()
    };
    (0..3).for_each(|frame| cache.frame(&at(frame)).unwrap());
    assert!(cache.frame(&[Vec3::ZERO]).is_err());
    let bytes = cache.finish().unwrap();
    for frame in 0..3 {
        let raw = read("a.usda", &bytes, Moment::Frame(frame)).unwrap();
        assert_eq!(raw.declared, Choice { unit: Some(Unit(0.01)), ..Choice::METRES });
        let metres: Vec<Vec3> = raw.strands.positions.iter().map(|p| *p * 0.01).collect();
        assert!(farthest(&metres, &at(frame as usize)) < 1e-5);
        assert_eq!(
            (raw.strands.marks.len(), raw.strands.colors.len()),
            (strands.len(), strands.positions.len())
        );
        assert!(raw.notes.join("\n").contains("3 frames from 0.000 to 0.167 s"), "{:?}", raw.notes);
    }
    assert!(read("a.usda", &bytes, Moment::Frame(3)).is_err());
}
