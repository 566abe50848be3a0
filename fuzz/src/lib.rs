//! Input for fuzzing the readers: intact files, and edits that damage them.

use bolero::TypeGenerator;
use std::path::Path;
use tresses_groom::{
    BindOptions, CookedGroom, GuideCount, Look, SdfGrid, Strands, TriMesh, bind,
    cooked::HEADER,
    edit::{GroomDocument, GroomEditor, HeadFiles, StrokeScript},
    error::Result,
    export::{ExportHair, Writer},
    glam::{Mat4, Vec2, Vec3},
    import::{FileBytes, ImportOptions, read_given, read_given_body},
    orient::{LengthUnit, OrientationOverride},
    rig::{Animation, Bind, Channel, Curve, Delta, Joint, MorphTarget, Node, Property, Rig},
};

/// An edit of a file. Positions are fractions of its length, so that one list of edits fits files of any length.
#[derive(Clone, Debug, TypeGenerator)]
pub enum Edit {
    /// Truncates the file.
    Cut(u16),
    /// Replaces one byte.
    Byte(u16, u8),
    /// Replaces four bytes, at a multiple of four, by a number at which sizes overflow.
    Word(u16, Extreme),
    /// Replaces eight bytes, at a multiple of eight, by such a number.
    Long(u16, Extreme),
    /// Removes this many bytes.
    Remove(u16, u8),
    /// Repeats this many bytes.
    Repeat(u16, u8),
    /// Replaces a number in a text.
    Number(u16, Extreme),
}

/// Numbers at which readers tend to fail.
#[derive(Clone, Copy, Debug, TypeGenerator)]
pub enum Extreme {
    /// Zero.
    Zero,
    /// One.
    One,
    /// The largest unsigned number.
    Most,
    /// The largest signed number.
    Signed,
    /// The smallest signed number.
    Negative,
    /// The smallest count of four-byte items whose size overflows.
    Quarter,
    /// NaN, in single precision for 32 bits and in double precision for 64.
    Nan,
    /// Any number.
    Any(u64),
}

impl Extreme {
    fn of(self, bits: u32) -> u64 {
        let most = u64::MAX >> (64 - bits);
        most & match self {
            Self::Zero => 0,
            Self::One => 1,
            Self::Most => most,
            Self::Signed => most >> 1,
            Self::Negative => (most >> 1) + 1,
            Self::Quarter => (most >> 2) + 1,
            Self::Nan if bits == 32 => u64::from(f32::NAN.to_bits()),
            Self::Nan => f64::NAN.to_bits(),
            Self::Any(value) => value,
        }
    }

    fn text(self) -> String {
        match self {
            Self::Nan => "nan".into(),
            Self::Negative => "-1".into(),
            Self::Most => "1e39".into(),
            other => other.of(64).to_string(),
        }
    }
}

/// Returns `file` after `edits`.
pub fn damaged(file: &[u8], edits: &[Edit]) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for edit in edits {
        let length = bytes.len();
        let share = |place: u16, step: usize| length * usize::from(place) / 65536 / step * step;
        match *edit {
            Edit::Cut(at) => bytes.truncate(share(at, 1)),
            Edit::Byte(at, value) => write(&mut bytes, share(at, 1), &[value]),
            Edit::Word(at, value) => write(&mut bytes, share(at, 4), &value.of(32).to_le_bytes()[..4]),
            Edit::Long(at, value) => write(&mut bytes, share(at, 8), &value.of(64).to_le_bytes()),
            Edit::Remove(at, count) => {
                let from = share(at, 1);
                bytes.drain(from..bytes.len().min(from + usize::from(count)));
            }
            Edit::Repeat(at, count) => {
                let from = share(at, 1);
                let part = bytes[from..bytes.len().min(from + usize::from(count))].to_vec();
                bytes.splice(from..from, part);
            }
            Edit::Number(at, value) => {
                let digit = |b: &u8| b.is_ascii_digit() || b".-+eE".contains(b);
                let from = share(at, 1);
                let Some(skipped) = bytes[from..].iter().position(u8::is_ascii_digit) else { continue };
                let from = from + skipped;
                let count = bytes[from..].iter().take_while(|b| digit(b)).count();
                bytes.splice(from..from + count, value.text().into_bytes());
            }
        }
    }
    bytes
}

fn write(bytes: &mut [u8], at: usize, value: &[u8]) {
    for (byte, value) in bytes.iter_mut().skip(at).zip(value) {
        *byte = *value;
    }
}

/// Returns a few strands with widths, colors and texture coordinates.
pub fn strands() -> Strands {
    let mut strands = Strands::default();
    for strand in 0..6 {
        let root = Vec3::new(strand as f32 * 0.01, 1.7, 0.05);
        let line: Vec<_> =
            (0..5).map(|i| root - Vec3::Y * (0.02 * i as f32) + Vec3::Z * (0.001 * (i * i) as f32)).collect();
        strands.push(&line);
    }
    let vertices = strands.positions.len();
    strands.radii = vec![4e-5; vertices];
    strands.colors = vec![Vec3::new(0.4, 0.2, 0.1); vertices];
    strands.root_uvs = (0..strands.len()).map(|i| Vec2::new(0.1 * i as f32, 0.5)).collect();
    strands
}

fn writer(name: &str) -> &'static Writer {
    Writer::of(name).expect("a format that is written")
}

/// Strokes of every tool on [`strands`].
pub const STROKES: &str = r#"{"version":1}
{"tool":"comb","set":{"radius":0.03},"samples":[[0,0.02,1.68,0.5,0,0,-1,1],[0.1,0.04,1.66,0.5,0,0,-1,0.5]]}
{"tool":"grab","path":[[0.02,1.65,0.05],[0.05,1.66,0.08]]}
{"tool":"smooth","path":[[0.02,1.65,0.05],[0.05,1.66,0.08]]}
{"tool":"puff","set":{"falloff":"flat"},"path":[[0.02,1.7,0.05],[0.05,1.7,0.05]]}
{"tool":"pinch","set":{"reach":"ball"},"path":[[0.02,1.65,0.05],[0.05,1.66,0.08]]}
{"tool":"length","path":[[0.02,1.65,0.05],[0.05,1.66,0.08]]}
{"tool":"cut","path":[[0.02,1.63,0.05],[0.05,1.63,0.05]]}
{"tool":"line","path":[[-0.1,1.66,0.05],[0.2,1.65,0.05]]}
{"do":"pose","guides":[[1,[[0.01,1.7,0.05],[0.02,1.69,0.05],[0.03,1.68,0.05],[0.04,1.67,0.05],[0.05,1.66,0.05]]]]}
{"do":"undo"}
"#;

/// Returns an edited groom of [`strands`].
fn document() -> GroomDocument {
    let options = BindOptions {
        guides: GuideCount::All,
        guide_vertex_count: Some(5),
        strand_vertex_count: Some(5),
        ..BindOptions::default()
    };
    let groom = bind(&strands(), &options).expect("it is valid");
    let files = vec![("head.obj".into(), b"v 0 0 0"[..].into())];
    let head = HeadFiles::Files { files, orientation: OrientationOverride::METERS };
    GroomDocument::new(groom, head, 0.0).expect("it is valid")
}

/// Returns an edited groom as a file.
pub fn edited() -> Vec<u8> {
    document().write()
}

/// Reads an edited groom after its checksums have been corrected, so that damage reaches the contents.
pub fn opened(name: &str, bytes: &[u8]) -> Result<usize> {
    let mut bytes = bytes.to_vec();
    let mut at = 12;
    while let Some(header) = bytes.get(at..at + 16) {
        let length = u64::from_le_bytes(header[4..12].try_into().expect("eight bytes"));
        let Some(end) = usize::try_from(length).ok().and_then(|length| length.checked_add(at + 16)) else {
            break;
        };
        let Some(contents) = bytes.get(at + 16..end) else { break };
        let sum = crc32fast::hash(contents).to_le_bytes();
        bytes[at + 12..at + 16].copy_from_slice(&sum);
        at = end;
    }
    let document = GroomDocument::read(Path::new(name), &bytes)?;
    Ok(document.groom().strands.len())
}

/// Reads strokes and applies them.
pub fn stroked(name: &str, bytes: &[u8]) -> Result<usize> {
    let text = String::from_utf8_lossy(bytes);
    let script = StrokeScript::read(&text, Path::new(name))?;
    let mut editor = GroomEditor::new(document(), None);
    script.apply(&mut editor)?;
    let groom = editor.document().groom();
    assert!(groom.guides.positions.iter().all(|p| p.is_finite()), "strokes make no infinite hair");
    Ok(groom.strands.len())
}

/// Returns the strands as a file.
///
/// # Panics
/// If the writer fails, which is a bug.
pub fn written(name: &str) -> Vec<u8> {
    writer(name).strands(&strands(), Some(LengthUnit(1.0))).expect("strands are written").bytes
}

/// Returns the strands and a mesh of four vertices as one compressed file.
///
/// # Panics
/// As [`written`].
pub fn packed() -> Vec<u8> {
    let (mesh, strands) = (tetrahedron(), strands());
    let look = Look::default();
    let hair = [ExportHair { name: "hair", strands: &strands, packed: true, look: Some(&look) }];
    writer("a.glb").character(Some((&mesh, None)), &hair).expect("a character is written")
}

/// Returns a mesh of four vertices as a file.
///
/// # Panics
/// As [`written`].
pub fn body() -> Vec<u8> {
    writer("a.glb").mesh(&tetrahedron(), None).expect("a body is written")
}

/// A PNG of two texels.
const PNG: [u8; 74] = [
    137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 2, 0, 0, 0, 1, 8, 6, 0, 0, 0, 244,
    34, 127, 138, 0, 0, 0, 17, 73, 68, 65, 84, 120, 156, 99, 248, 207, 192, 208, 240, 255, 255, 255, 255, 0,
    20, 119, 5, 124, 33, 57, 115, 50, 0, 0, 0, 0, 73, 69, 78, 68, 174, 66, 96, 130,
];

/// Returns a triangle as a file. Its material has a color texture and a normal texture, and its node a light.
pub fn painted() -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"extensions":{"KHR_lights_punctual":{"light":0}}}],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":40,"color":[1,0.5,0.25],"range":3,
"spot":{"innerConeAngle":0.2,"outerConeAngle":0.4}}]}},
"images":[{"bufferView":3,"mimeType":"image/png"}],"textures":[{"source":0}],
"materials":[{"alphaMode":"MASK","alphaCutoff":0.25,"normalTexture":{"index":0,"scale":0.5},
"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,1,1],"roughnessFactor":0.5,"baseColorTexture":{"index":0,
"extensions":{"KHR_texture_transform":{"offset":[0.5,0],"scale":[2,1],"rotation":0.3}}}}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6},
{"buffer":0,"byteOffset":44,"byteLength":24},{"buffer":0,"byteOffset":68,"byteLength":74}],
"buffers":[{"byteLength":144}]}"#;
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let mut bin = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    bin.extend([0u16, 1, 2, 0].iter().flat_map(|v| v.to_le_bytes()));
    bin.extend(floats(&[0.25, 0.5, 0.75, 0.5, -0.75, 7.5]));
    bin.extend(PNG);
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut out = b"glTF".to_vec();
    let total = 12 + 8 + json.len() + 8 + bin.len();
    out.extend([2, total as u32, json.len() as u32, 0x4E4F_534A].iter().flat_map(|v: &u32| v.to_le_bytes()));
    out.extend(&json);
    out.extend([bin.len() as u32, 0x004E_4942].iter().flat_map(|v: &u32| v.to_le_bytes()));
    out.extend(&bin);
    out
}

fn tetrahedron() -> TriMesh {
    let positions = vec![Vec3::ZERO, Vec3::X * 0.1, Vec3::Y * 0.1, Vec3::Z * 0.1];
    let normals = vec![Vec3::NEG_ONE.normalize(), Vec3::X, Vec3::Y, Vec3::Z];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    TriMesh { positions, normals, triangles, ..Default::default() }
}

/// Returns a mesh on a skeleton with a blend shape and an animation, and hair if `hair`, as USD. The extension of
/// `name` selects text or binary.
///
/// # Panics
/// As [`written`].
pub fn living(name: &str, hair: bool) -> Vec<u8> {
    let (mesh, strands) = (tetrahedron(), strands());
    let hair =
        &[ExportHair { name: "hair", strands: &strands, packed: false, look: None }][..usize::from(hair)];
    writer(name).character(Some((&mesh, Some(&rig(&mesh)))), hair).expect("a character is written")
}

/// Returns a file from the optional assets, if it exists.
pub fn asset(path: &str) -> Option<Vec<u8>> {
    std::fs::read(std::path::Path::new(&std::env::var_os("TRESSES_ASSETS")?).join(path)).ok()
}

/// Reads a groom like a user who opens the file. Any result is fine, as long as the reader returns.
pub fn groom(name: &str, bytes: &[u8]) -> Result<usize> {
    let files: [FileBytes<'_>; 1] = [(name.into(), bytes.into())];
    read_given(&files, &ImportOptions::default()).map(|(strands, ..)| strands.len())
}

/// Reads a mesh in the same way.
pub fn mesh(name: &str, bytes: &[u8]) -> Result<usize> {
    let files: [FileBytes<'_>; 1] = [(name.into(), bytes.into())];
    read_given_body(&files, &ImportOptions::default()).map(|body| body.mesh.positions.len())
}

/// Returns a rig with a joint, a blend shape, and an animation of both.
fn rig(mesh: &TriMesh) -> Rig {
    let bind = |(p, n): (&Vec3, &Vec3)| Bind::rigid(*p, *n, 0);
    let curve = |values| Curve { times: vec![0.0, 1.0], values, ..Default::default() };
    let turn = Channel { node: 1, property: Property::Rotation, curve: curve(vec![0.5; 8]) };
    let smile = Channel { node: 1, property: Property::Weights(vec![0]), curve: curve(vec![0.0, 1.0]) };
    Rig {
        nodes: vec![Node::default(), Node { parent: Some(0), weights: vec![(0, 0.5)], ..Default::default() }],
        joints: vec![Joint { node: 1, inverse_bind: Mat4::IDENTITY }],
        vertices: mesh.positions.iter().zip(&mesh.normals).map(bind).collect(),
        targets: vec![MorphTarget {
            name: "smile".into(),
            deltas: vec![Delta { vertex: 2, position: Vec3::X, normal: Vec3::ZERO }],
        }],
        animations: vec![Animation { name: "nod".into(), length: 1.0, channels: vec![turn, smile] }],
        to_groom: Mat4::IDENTITY,
    }
}

/// Returns a cooked groom on a head with a joint and a blend shape.
///
/// # Panics
/// If the written groom cannot be read.
pub fn cooked() -> Vec<u8> {
    let options = ImportOptions::default();
    let given: [FileBytes<'_>; 1] = [("a.tfx".into(), written("a.tfx").into())];
    let (strands, _, report) = read_given(&given, &options).expect("strands");
    let mesh = tetrahedron();
    let field = SdfGrid::from_fn(Vec3::splat(-0.1), Vec3::splat(0.1), 3, |p| p.length() - 0.05);
    let rig = rig(&mesh);
    let mut cooked =
        CookedGroom::new(strands, Some(mesh), Some(field.clone()), Some(rig), &report).expect("a groom");
    cooked.parts = vec![(0, field)];
    cooked.write().expect("bytes")
}

/// Reads a cooked groom with an intact header and a matching checksum, because otherwise the checksum would reject all
/// damage. Then uses the groom as an application does.
///
/// # Errors
/// Errors of the reader.
pub fn sealed(name: &str, bytes: &[u8]) -> Result<usize> {
    let whole = cooked();
    let body = bytes.get(HEADER..).unwrap_or_default();
    let file = [&whole[..HEADER - 4], &crc32fast::hash(body).to_le_bytes(), body].concat();
    let cooked = CookedGroom::read(name.as_ref(), &file)?;
    (0..cooked.strands.len()).for_each(|i| drop(cooked.strands.length(i).to_string()));
    assert!(cooked.groom.bounds().is_some());
    let fields = cooked.field.iter().chain(cooked.parts.iter().map(|(_, part)| part));
    assert!(fields.map(|field| field.node_normals().count()).all(|nodes| nodes >= 8));
    if let (Some(rig), Some(mut head)) = (&cooked.rig, cooked.head) {
        for motion in rig.animations.iter().map(|motion| Some((motion, 0.3))).chain([None]) {
            rig.deform(&rig.pose_with(motion, &[]), &mut head);
        }
    }
    Ok(cooked.strands.len())
}
