//! Tests on files of Pixar's USD (written by `apps/cli/tests/reference_usd.py`), on generated text, and on damaged
//! files.

use std::{borrow::Cow, io::Cursor, path::Path, path::PathBuf};

use glam::Vec3;
use openusd::{usda, usdc, usdz};

use crate::{
    Strands,
    export::{CacheOptions, Writer},
    formats::{
        curves::reference_tests::{check, groom},
        parse::parse_at,
        raw::Raw,
        source::{Files, Source},
    },
    import::{FileBytes, FileKind, Moment, kind, mesh, read_given},
    orient::{Axis, LengthUnit, OrientationOverride},
};

const REFERENCE: &[u8] = include_bytes!("reference.usdc");
pub(super) const SKELETON: &[u8] = include_bytes!("reference_skel.usdc");

pub(super) fn read(name: &str, bytes: &[u8], moment: Moment) -> Result<Raw, String> {
    parse_at(Path::new(name), bytes, false, moment).map_err(|error| error.to_string())
}

/// Returns a text file of `strands` in a unit.
fn written(strands: &Strands, unit: Option<LengthUnit>) -> Vec<u8> {
    Writer::of("a.usda").unwrap().strands(strands, unit).unwrap().bytes
}

pub(super) fn text(text: &str) -> Result<Raw, String> {
    read("a.usda", format!("#usda 1.0\n{text}").as_bytes(), Moment::First)
}

/// Returns the same layer as `.usdc` and in a package.
fn others(text: &str) -> [(&'static str, Vec<u8>); 2] {
    let mut binary = Cursor::new(Vec::new());
    usdc::CrateWriter::write(&usda::parse(text).unwrap(), &mut binary).unwrap();
    let binary = binary.into_inner();
    let mut package = usdz::ArchiveWriter::new(Cursor::new(Vec::new()));
    package.add_layer("in/root.usdc", &binary).unwrap();
    [("a.usdc", binary), ("a.usdz", package.finish().unwrap().into_inner())]
}

#[test]
fn custom_attributes_follow_curves() {
    let curves = |name: &str, own: &str| {
        format!(
            "def BasisCurves \"{name}\" {{ uniform token type = \"cubic\"\nuniform token basis = \"bezier\"\n
             int[] curveVertexCounts = [4, 4]\n
             point3f[] points = [(0,0,0), (0,1,0), (0,2,0), (0,3,0), (1,0,0), (1,1,0), (1,2,0), (1,3,0)]\n
             float[] primvars:length = [0, 3, 6, 9, 10, 13, 16, 19] (interpolation = \"vertex\")\n
             int[] primvars:part = [4] (interpolation = \"constant\")\n{own} }}\n"
        )
    };
    let own = "bool[] primvars:kept = [1, 0] (interpolation = \"uniform\")\n
        float[] primvars:odd = [1, 2, 3]\nfloat[] primvars:nan = [nan, 1]\nstring primvars:maker = \"me\"\n
        matrix4d[] primvars:frame = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]\n";
    let raw = text(&curves("a", own)).unwrap();
    let names: Vec<_> = raw.strands.attributes.iter().map(|it| (it.name.as_str(), it.per_vertex)).collect();
    assert_eq!(names, [("length", true), ("part", false), ("kept", false)]);
    let [length, part, kept] = &raw.strands.attributes[..] else { unreachable!() };
    assert_eq!((&kept.numbers[..], kept.is_integer), (&[1.0, 0.0][..], true));
    assert_eq!((&part.numbers[..], part.is_integer), (&[4.0, 4.0][..], true));
    // Bézier curves of evenly spaced points have even values.
    for (value, p) in length.numbers.iter().zip(&raw.strands.positions) {
        assert!((value - 3.0 * p.y - 10.0 * p.x).abs() < 1e-4, "{value} {p}");
    }
    for name in ["odd", "nan", "frame"] {
        assert!(raw.notes.iter().any(|note| note.starts_with(&format!("“{name}” is ignored"))), "{name}");
    }
    // Two objects keep what both have.
    let raw = text(&(curves("a", own) + &curves("b", ""))).unwrap();
    let names: Vec<_> = raw.strands.attributes.iter().map(|it| it.name.as_str()).collect();
    assert_eq!((raw.strands.len(), names), (4, vec!["length", "part"]));
    assert!(raw.notes.contains(&"“kept” is ignored: not all objects have it".into()), "{:?}", raw.notes);
}

#[test]
fn reads_reference_file() {
    let told = ["guides (groom_guide)", "“widths”"];
    let declared =
        OrientationOverride { unit: Some(LengthUnit(0.01)), up: Some(Axis::Y), ..Default::default() };
    let read = |moment| read("a.usdc", REFERENCE, moment).inspect(|raw| assert_eq!(raw.declared, declared));
    check(read, &told);
    assert_eq!(kind(Path::new("a.usdc"), REFERENCE), Some(FileKind::Groom));
}

#[test]
fn groom_survives_round_trip() {
    let bare = Strands { radii: vec![], colors: vec![], root_uvs: vec![], marks: vec![], ..groom() };
    for strands in [groom(), bare] {
        let bytes = written(&strands, Some(LengthUnit(1.0)));
        let said = String::from_utf8(bytes.clone()).unwrap();
        for (name, bytes) in others(&said).into_iter().chain([("a.usda", bytes)]) {
            let back = read(name, &bytes, Moment::First).unwrap();
            assert_eq!(back.strands, strands, "{name}");
            assert_eq!(back.declared, OrientationOverride::METERS, "{name}");
        }
        // The comparison detects a different groom.
        let moved = said.replacen("1.7", "1.8", 1);
        assert_ne!(read("a.usda", moved.as_bytes(), Moment::First).unwrap().strands, strands);
    }
    let unsaid = written(&groom(), None);
    assert_eq!(read("a.usda", &unsaid, Moment::First).unwrap().declared, OrientationOverride::default());
    let centimeters = written(&groom(), Some(LengthUnit(0.01)));
    let back = read("a.usda", &centimeters, Moment::First).unwrap();
    assert_eq!(
        back.declared,
        OrientationOverride { unit: Some(LengthUnit(0.01)), ..OrientationOverride::METERS }
    );
    assert!((back.strands.positions[0].y - 170.0).abs() < 1e-4);
}

/// Returns curves on a parabola, with `counts` points each and `more` attributes.
fn curves(name: &str, more: &str, counts: &[usize]) -> String {
    let points: Vec<String> =
        counts.iter().flat_map(|n| (0..*n).map(|k| format!("({k}, {}, 0)", k * k))).collect();
    format!(
        "def BasisCurves \"{name}\" {{\n int[] curveVertexCounts = {counts:?}\n point3f[] points = [{}]\n {more}\n}}\n",
        points.join(", ")
    )
}

#[test]
fn bases_and_parameter_scopes_are_read() {
    let ends = |more: &str| {
        let raw = text(&curves("a", more, &[7, 4])).unwrap();
        let line = raw.strands.strand(0);
        (line[0], line[line.len() - 1], raw)
    };
    let first = |more: &str| ends(more).0.x;
    assert_eq!(first("uniform token type = \"linear\""), 0.0);
    // Bézier is the default basis.
    assert_eq!((ends("").0.x, ends("").1.x), (0.0, 6.0));
    assert!(ends("").2.strands.strand(0).len() > 7);
    let bspline = "uniform token basis = \"bspline\"\n";
    let catmull = "uniform token basis = \"catmullRom\"\n";
    let pinned = "uniform token wrap = \"pinned\"\n";
    assert!((first(bspline) - 1.0).abs() < 1e-6 && (first(catmull) - 1.0).abs() < 1e-6);
    assert!(first(&format!("{bspline}{pinned}")).abs() < 1e-6);
    assert!(first(&format!("{catmull}{pinned}")).abs() < 1e-6);
    // Blender's hair reaches from root to tip.
    let blender = format!("( doc = \"Blender v4.2.0\" )\n{}", curves("a", bspline, &[7]));
    assert!(text(&blender).unwrap().strands.positions[0].x.abs() < 1e-6);
    // Widths per point, per segment end, per curve and constant.
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
    // Indices, and attributes of an ancestor.
    let indexed = "color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = \"uniform\")\n\
                   int[] primvars:displayColor:indices = [1, 0]";
    let strands = ends(indexed).2.strands;
    assert_eq!((strands.colors[0], *strands.colors.last().unwrap()), (Vec3::Y, Vec3::X));
    let one = "color3f[] primvars:displayColor = [(1, 0, 0)] (interpolation = \"constant\")";
    let raw = ends(one).2;
    assert!(raw.strands.colors.is_empty() && raw.notes.join(" ").contains("displayColor"), "{:?}", raw.notes);
    let above = format!("def Xform \"x\" {{ int primvars:groom_group_id = 7\n{} }}", curves("a", "", &[4]));
    assert_eq!(text(&above).unwrap().strands.marks[0].group, 7);
    // NURBS with their own knots.
    let nurbs = curves("a", "int[] order = [4]\n double[] knots = [0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4]", &[7]);
    let raw = text(&nurbs.replace("BasisCurves", "NurbsCurves")).unwrap();
    assert!(raw.strands.strand(0)[0].x.abs() < 1e-6 && raw.strands.positions.last().unwrap().x == 6.0);
    for (broken, said) in [
        ("uniform token basis = \"hermite\"", "not supported"),
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
fn every_transform_operation_applies_to_children() {
    // Returns the transformed origin and the transformed vector (1, 1, 0).
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
        // The line goes from the origin to (1, 1, 0).
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
    assert!(error.err().unwrap().contains("is unknown"));
}

#[test]
fn hidden_curves_are_skipped_and_guides_marked() {
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
    // Classes and inactive prims are skipped, instances are read.
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
fn animated_transforms_have_frames() {
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
    assert!(error.contains("not animated"), "{error}");
}

#[test]
fn references_resolve_among_given_files() {
    let root = b"#usda 1.0\n( metersPerUnit = 0.01\n upAxis = \"Z\" )\ndef \"x\" ( references = @./in/b.usda@</x> ) {}\n";
    let inner = format!(
        "#usda 1.0\ndef Xform \"x\" {{ {} }}\n",
        curves("a", "uniform token type = \"linear\"", &[4])
    );
    let given: Vec<FileBytes> = vec![
        (PathBuf::from("root.usda"), Cow::Borrowed(&root[..])),
        (PathBuf::from("b.usda"), Cow::Borrowed(inner.as_bytes())),
    ];
    let read = |files: &[FileBytes]| {
        let source =
            Source { path: Path::new("root.usda"), bytes: root, files: Files::Given(files), lenient: false };
        super::read(&source, Moment::First)
    };
    let raw = read(&given).unwrap();
    assert_eq!((raw.strands.len(), raw.strands.positions[3]), (1, Vec3::new(3.0, 9.0, 0.0)));
    assert_eq!(
        raw.declared,
        OrientationOverride { unit: Some(LengthUnit(0.01)), up: Some(Axis::Z), ..Default::default() }
    );
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
        let given: [FileBytes; 1] = [(PathBuf::from("a.usda"), Cow::Owned(text.clone().into_bytes()))];
        assert_eq!(kind(Path::new("a.usda"), text.as_bytes()), Some(FileKind::Mesh));
        mesh::read_given(&given, Path::new("a.usda"))
    };
    let front = read("", "").unwrap();
    assert_eq!((front.mesh.triangles.len(), front.mesh.normals[0]), (2, Vec3::Z));
    assert_eq!(front.declared, OrientationOverride { up: Some(Axis::Z), ..Default::default() });
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
    let given: [FileBytes; 1] =
        [(PathBuf::from("a.usda"), Cow::Owned(format!("#usda 1.0\n{broken}").into_bytes()))];
    let error = mesh::read_given(&given, Path::new("a.usda")).err().unwrap().to_string();
    assert!(error.contains("vertex 9 does not exist; there are 4"), "{error}");
}

#[test]
fn damaged_files_give_errors_or_valid_grooms() {
    change_every(23);
}

#[test]
#[ignore = "proof"]
fn damage_at_every_byte_gives_errors_or_valid_grooms() {
    change_every(1);
}

/// Changes every `step`th byte of files of each kind in four ways, and truncates the files there.
fn change_every(step: usize) {
    let mut strands = groom();
    // The smallest groom with every attribute.
    strands.offsets.truncate(4);
    let count = strands.offsets[3] as usize;
    strands.positions.truncate(count);
    strands.radii.truncate(count);
    strands.colors.truncate(count);
    strands.root_uvs.truncate(3);
    strands.marks.truncate(3);
    let said = written(&strands, Some(LengthUnit(1.0)));
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
                assert!(!said.contains("reader failed"), "{said}");
                refused += 1;
            }
        };
        // The mesh, if the file has one.
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
                    assert!(
                        !said.contains('\n') && said.len() < 600 && !said.contains("reader failed"),
                        "{said}"
                    );
                }
            }
        };
        let mut bytes = sound.to_vec();
        for i in (0..bytes.len()).step_by(step) {
            for with in [0x01, 0x80, 0xff, bytes[i]] {
                // The last mask sets the byte to 0.
                bytes[i] ^= with;
                check(&bytes);
                if sound == SKELETON {
                    bends(&bytes);
                }
                bytes[i] = sound[i];
            }
        }
        (0..sound.len()).step_by(step).for_each(|end| check(&sound[..end]));
        // Both outcomes must be frequent: the test fails if every file is rejected or if most bytes have no effect.
        assert!(refused > sound.len() / step / 2 && changed * step > 30, "{name}: {refused} {changed}");
    }
}

#[test]
fn excessive_nesting_and_instancing_are_rejected() {
    let says = |said: &str| text(said).err().unwrap();
    let deep = "def \"a\" {".repeat(100_000);
    assert!(says(&deep).contains("deep"), "{}", says(&deep));
    let list = format!("def \"a\" {{ int x = {}", "[".repeat(100_000));
    assert!(says(&list).contains("deep"));
    // The maximum depth fits in the small stack of a test thread.
    let nested = |n: usize| format!("{}{}{}", "def \"a\" {".repeat(n), curves("b", "", &[4]), "}".repeat(n));
    assert_eq!(text(&nested(90)).unwrap().strands.len(), 1);
    // Eight levels of ten references each expand to 10⁸ prims.
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
    assert!(error.contains("too often") || error.contains("prims"), "{error}");
    assert!(says("").contains("neither curves nor meshes"));
    let wrong = says("def BasisCurves \"a\" {\n  int[] x = [1, }\n}");
    assert!(wrong.contains("a.usda at line 3: "), "{wrong}");
}

/// Returns the largest distance between corresponding points.
pub(super) fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn cache_frames_survive_round_trip() {
    let strands = groom();
    let options = CacheOptions { unit: LengthUnit(0.01), rate: 12.0, frames: 3 };
    let mut bytes = Cursor::new(Vec::new());
    let mut cache = Writer::of("a.usda").unwrap().cache(Box::new(&mut bytes), &strands, options).unwrap();
    let at = |frame: usize| -> Vec<Vec3> {
        strands.positions.iter().map(|p| *p + Vec3::Y * 0.5 * frame as f32).collect()
    };
    (0..3).for_each(|frame| cache.frame(&at(frame)).unwrap());
    assert!(cache.frame(&[Vec3::ZERO]).is_err());
    cache.finish().unwrap();
    let bytes = bytes.into_inner();
    for frame in 0..3 {
        let raw = read("a.usda", &bytes, Moment::Frame(frame)).unwrap();
        assert_eq!(
            raw.declared,
            OrientationOverride { unit: Some(LengthUnit(0.01)), ..OrientationOverride::METERS }
        );
        let meters: Vec<Vec3> = raw.strands.positions.iter().map(|p| *p * 0.01).collect();
        assert!(farthest(&meters, &at(frame as usize)) < 1e-5);
        assert_eq!(
            (raw.strands.marks.len(), raw.strands.colors.len()),
            (strands.len(), strands.positions.len())
        );
        assert!(raw.notes.join("\n").contains("3 frames from 0.000 to 0.167 s"), "{:?}", raw.notes);
    }
    assert!(read("a.usda", &bytes, Moment::Frame(3)).is_err());
}
