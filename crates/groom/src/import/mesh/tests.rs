//! Valid and broken meshes.

use crate::rig::tests::glb;
use std::path::Path;

use glam::Vec3;
use proptest::prelude::*;

use super::{Files, parse};

const CUBE: &str = "o cube
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
vt 0 0
vt 1 0
f 4/1 3/2 2/1 1/2
f 5 6 7 8
f 1 2 6 5
f 3 4 8 7
f 1/1 5/2 8/1 4/2
f 2 3 7 6
";

const TFXMESH: &str = "# a comment
numOfBones 1
0 root
numOfVertices 3
0 0 0 0 0 0 1 0 0 0 0 1 0 0 0
1 1 0 0 0 0 1 0 0 0 0 1 0 0 0
2 0 1 0 0 0 1 0 0 0 0 1 0 0 0
numOfTriangles 1
0 0 1 2
";

/// Returns a GLB with one triangle under a node that scales by 2, and a red material.
#[cfg(feature = "gltf")]
fn glb() -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"scale":[2,2,2]}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.1,0.05,1]}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":44}]}"#;
    let mut bin: Vec<u8> =
        [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|v| v.to_le_bytes()).collect();
    bin.extend([0u16, 1, 2, 0].iter().flat_map(|v| v.to_le_bytes()));
    glb::pack(json.as_bytes().to_vec(), bin)
}

#[test]
fn cube_with_seams_is_one_surface() {
    let mesh = parse(Files::Disk, Path::new("cube.obj"), CUBE.as_bytes()).unwrap().mesh;
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(n.dot(p.normalize()) > 0.99, "{p} {n}");
    }
}

#[test]
fn a_tfxmesh_is_read() {
    let mesh = parse(Files::Disk, Path::new("a.tfxmesh"), TFXMESH.as_bytes()).unwrap().mesh;
    assert_eq!((mesh.positions[1], mesh.normals[0], mesh.triangles[0]), (Vec3::X, Vec3::Z, [0, 1, 2]));
}

#[cfg(feature = "gltf")]
#[test]
fn glb_shorter_than_its_header_is_rejected() {
    let mut bytes = glb();
    bytes[8..12].copy_from_slice(&11u32.to_le_bytes());
    let error = parse(Files::Disk, Path::new("a.glb"), &bytes).unwrap_err().to_string();
    assert!(error.contains("shorter than its header"), "{error}");
}

#[cfg(feature = "gltf")]
#[test]
fn glb_transform_and_color_are_read() {
    let raw = parse(Files::Disk, Path::new("a.glb"), &glb()).unwrap();
    assert_eq!(raw.declared, crate::orient::OrientationOverride::METERS);
    let mesh = raw.mesh;
    assert_eq!(mesh.positions, vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0]);
    assert_eq!(mesh.normals, vec![Vec3::Z; 3]);
    assert_eq!(mesh.colors[0], Vec3::new(0.8, 0.1, 0.05));
}

#[test]
fn errors_name_the_line() {
    let says = |name: &str, text: &str| {
        parse(Files::Disk, Path::new(name), text.as_bytes()).unwrap_err().to_string()
    };
    let broken = CUBE.replace("v 1 1 -1", "v 1 one -1");
    assert!(says("a.obj", &broken).starts_with("a.obj at line 4:"), "{}", says("a.obj", &broken));
    assert!(says("a.obj", "v 0 0 0\n").contains("no triangles"));
    assert!(says("a.tfxmesh", &TFXMESH.replace("0 0 1 2", "0 0 1 7")).contains("line 9"));
    assert!(says("a.stl", "solid").contains(".obj"));
}

fn survives(name: &str, bytes: &[u8]) -> Result<(), TestCaseError> {
    match parse(Files::Disk, Path::new(name), bytes) {
        Ok(raw) => {
            let n = raw.mesh.positions.len();
            prop_assert!(n <= bytes.len() && raw.mesh.normals.len() == n);
            prop_assert!(raw.mesh.triangles.iter().flatten().all(|i| (*i as usize) < n));
        }
        Err(error) => {
            let text = error.to_string();
            prop_assert!(!text.contains('\n') && text.len() < 500, "{}", text);
        }
    }
    Ok(())
}

fn files() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.obj", CUBE.as_bytes().to_vec()),
        ("a.tfxmesh", TFXMESH.as_bytes().to_vec()),
        #[cfg(feature = "gltf")]
        ("a.glb", glb()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn broken_meshes_do_no_harm(
        share in 0.0f64..1.0,
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        for (name, whole) in files() {
            survives(name, &whole[..(whole.len() as f64 * share) as usize])?;
            let mut flipped = whole;
            for (at, value) in &flips {
                let at = at.index(flipped.len());
                flipped[at] = *value;
            }
            survives(name, &flipped)?;
        }
    }

    #[test]
    fn changed_digits_do_no_harm(at in any::<prop::sample::Index>(), digit in b'0'..=b'9', more in 0usize..12) {
        for (name, mut bytes) in files() {
            let digits: Vec<usize> = (20..bytes.len()).filter(|i| bytes[*i].is_ascii_digit()).collect();
            let at = digits[at.index(digits.len())];
            bytes[at] = digit;
            // Overwrite the spaces that follow with digits: numbers grow, but the file does not.
            for i in (at + 1..(at + more).min(bytes.len())).take_while(|i| *i < digits[digits.len() - 1]) {
                if bytes[i] == b' ' {
                    bytes[i] = digit;
                }
            }
            survives(name, &bytes)?;
        }
    }
}

#[test]
fn given_files_resolve_their_companions() {
    use crate::import::{FileBytes, FileKind, kind, read_given, read_given_head};
    let given =
        |name: &str, text: &str| -> FileBytes<'static> { (name.into(), text.as_bytes().to_vec().into()) };
    let mesh = format!("mtllib head.mtl\nusemtl skin\n{CUBE}");
    let material = given("head.mtl", "newmtl skin\nKd 0.1 0.2 0.3\n");
    // A cube of the size of a head, so that the guess of the unit has no doubts.
    let head = given("head.obj", &mesh);
    let groom = given("hair.obj", "v 0 1 0\nv 0 1.1 0\nv 0 1.2 0\nl 1 2 3\n");
    let sorts = [&head, &material, &groom].map(|(name, bytes)| kind(name, bytes));
    assert_eq!(sorts, [Some(FileKind::Mesh), Some(FileKind::Resource), Some(FileKind::Groom)]);
    let files = [groom.clone(), material, head.clone()];
    let (strands, mesh, report) = read_given(&files, &Default::default()).unwrap();
    assert_eq!((strands.len(), report.files.len()), (1, 1));
    assert_eq!(mesh.unwrap().colors[0], Vec3::new(0.1, 0.2, 0.3));
    // Without its materials a mesh has no colors, as on disk; without its buffers it cannot be read.
    assert!(read_given_head(&[head], &Default::default()).unwrap().0.colors.is_empty());
    #[cfg(feature = "gltf")]
    {
        let gltf = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"a%20b.bin","byteLength":36}]}"#;
        let error = read_given_head(&[given("head.gltf", gltf)], &Default::default()).unwrap_err();
        assert_eq!(error.to_string(), "head.gltf: the file needs a b.bin; provide both together");
    }
    let error = read_given(&[groom, given("notes.txt", "")], &Default::default()).unwrap_err();
    assert!(error.to_string().starts_with("notes.txt: a groom is"), "{error}");
}

#[test]
fn data_uri_buffers_are_read() {
    use base64::{Engine, engine::general_purpose::STANDARD};
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    let file = |uri: &str| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 36, "uri": "{uri}"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}]}}"#
        )
    };
    let read = |uri: &str| {
        let (path, text) = (std::path::PathBuf::from("a.gltf"), file(uri));
        super::read_given(&[(path.clone(), text.as_bytes().into())], &path)
    };
    let whole = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes));
    assert_eq!(read(&whole).unwrap().mesh.positions, corners.map(glam::Vec3::from));
    for (uri, said) in [
        ("data:;base64,AAA", "a buffer is missing (Invalid"),
        ("data:text/plain,abc", "neither a file name nor base64 data"),
        ("https://example.org/a.bin", "neither a file name nor base64 data"),
        ("data:;base64,AAAA", "has 3 bytes, but should have 36"),
    ] {
        let error = read(uri).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("a.gltf"), "{error}");
    }
}

/// Returns a GLB with a triangle whose material has an image: red and half transparent on the left, white on the right.
#[cfg(feature = "textures")]
fn painted(picture: &[u8], more: &str) -> Vec<u8> {
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
"images":[{{"bufferView":3,"mimeType":"image/png"}}],"textures":[{{"source":0}}],
"materials":[{{"alphaMode":"MASK","alphaCutoff":0.25,
"pbrMetallicRoughness":{{"baseColorFactor":[1,0.5,1,1],"roughnessFactor":0.5,"baseColorTexture":{{"index":0{more}}}}}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":2}},"indices":1,"material":0}},
{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}},
{{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}}],
"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}},
{{"buffer":0,"byteOffset":44,"byteLength":24}},{{"buffer":0,"byteOffset":68,"byteLength":{}}}],
"buffers":[{{"byteLength":{}}}]}}"#,
        picture.len(),
        68 + picture.len()
    );
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let mut bin = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    bin.extend([0u16, 1, 2, 0].iter().flat_map(|v| v.to_le_bytes()));
    bin.extend(floats(&[0.25, 0.5, 0.75, 0.5, -0.75, 7.5]));
    bin.extend(picture);
    glb::pack(json.into_bytes(), bin)
}

#[cfg(feature = "textures")]
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let texel = |x, _| image::Rgba(if x == 0 { [255, 0, 0, 128] } else { [255; 4] });
    image::RgbaImage::from_fn(2, 1, texel).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[cfg(feature = "textures")]
#[test]
fn material_images_are_read() {
    use crate::mesh::Paint;
    let raw = parse(Files::Disk, Path::new("a.glb"), &painted(&png(), "")).unwrap();
    let paint = raw.mesh.paint.as_ref().unwrap();
    raw.mesh.validate().unwrap();
    assert_eq!(paint.of, [0, 0, 0, Paint::NONE, Paint::NONE, Paint::NONE]);
    let coat = &paint.coats[0];
    // A factor of 0.5 in linear green is 188 of 255 in sRGB.
    assert_eq!(coat.base.rgba, [255, 0, 0, 128, 255, 188, 255, 255]);
    assert_eq!((coat.cutout, &coat.relief.rgba[..]), (Some(0.25), &[127, 127, 127, 255][..]));
    // Vertex colors are sampled from the image, which repeats.
    let near = |i: usize, rgb: [f32; 3]| raw.mesh.colors[i].abs_diff_eq(Vec3::from(rgb), 0.01);
    assert!(near(0, [1.0, 0.0, 0.0]) && near(1, [1.0, 0.5, 1.0]) && near(2, [1.0, 0.0, 0.0]));
    assert!(raw.notes.is_empty());

    let turned = r#","extensions":{"KHR_texture_transform":{"offset":[0.5,0],"scale":[2,1]}}"#;
    let raw = parse(Files::Disk, Path::new("a.glb"), &painted(&png(), turned)).unwrap();
    assert_eq!(raw.mesh.paint.unwrap().uvs[1], glam::Vec2::new(2.0, 0.5));
}

/// A mesh whose image cannot be read is usable without it, and has a note.
#[cfg(feature = "textures")]
#[test]
fn unreadable_images_are_reported() {
    let told = |bytes: Vec<u8>, why: &str| {
        let raw = parse(Files::Disk, Path::new("a.glb"), &bytes).unwrap();
        assert!(raw.mesh.paint.is_none() && raw.mesh.triangles.len() == 2);
        assert!(raw.notes.len() == 1 && raw.notes[0].contains(why), "{why}: {:?}", raw.notes);
    };
    told(painted(b"not a picture", ""), "format");
    told(painted(&png()[..40], ""), "image 0");
    // Fields that the `gltf` crate would unwrap.
    let edited = |from: &str, to: &str| glb::edited(&painted(&png(), ""), from, to);
    told(
        edited(r#"{"bufferView":3,"mimeType":"image/png"}"#, "{}"),
        "neither in the file nor in a file of its own",
    );
    told(edited(r#""bufferView":3,"mimeType":"image/png""#, r#""uri":"nowhere.png""#), "nowhere.png");
    told(edited(r#""TEXCOORD_0":2"#, r#""TEXCOORD_0":0"#), "wrong data type");
    let far = r#","extensions":{"KHR_texture_transform":{"scale":[1e38,1e38],"offset":[3e38,3e38]}}"#;
    told(painted(&png(), far), "not finite");
    // Without a MIME type, the first bytes decide the image format.
    let raw = parse(Files::Disk, Path::new("a.glb"), &edited(r#","mimeType":"image/png""#, "")).unwrap();
    assert!(raw.mesh.paint.is_some() && raw.notes.is_empty());
}

/// Small files may contain large images.
#[cfg(feature = "textures")]
#[test]
fn large_images_are_reduced() {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let large = image::GrayImage::new(4096, 4096);
    large.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    let raw = parse(Files::Disk, Path::new("a.glb"), &painted(&bytes.into_inner(), "")).unwrap();
    assert!(raw.notes.is_empty(), "{:?}", raw.notes);
    let base = &raw.mesh.paint.unwrap().coats[0].base;
    assert_eq!([base.width, base.height], [2048; 2]);
}
