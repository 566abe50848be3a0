//! Round trips of meshes and hair.

use super::*;
use crate::{Look, Strands, attribute::StrandAttribute, import, mannequin, strands::Mark};
use glam::Vec3;
use std::{borrow::Cow, path::PathBuf};

fn read(bytes: &[u8]) -> import::mesh::RawMesh {
    let path = PathBuf::from("bust.glb");
    import::mesh::read_given(&[(path.clone(), Cow::Borrowed(bytes))], &path).unwrap()
}

/// A mesh read back deforms as the original.
#[test]
fn body_survives_round_trip() {
    let mesh = mannequin::mesh(60);
    let mut rig = mannequin::rig::rig(&mesh);
    rig.animations.push(wave());
    let bytes = body(&mesh, Some(&rig)).unwrap();
    let back = read(&bytes);
    let other = back.rig.unwrap();
    let names = |rig: &Rig| rig.targets.iter().map(|t| t.name.clone()).collect::<Vec<_>>();
    assert_eq!((names(&other), other.animations.len()), (names(&rig), 1));
    let mut farthest = 0f32;
    for time in [0.0, 0.3, 1.0] {
        let bent = |rig: &Rig, mesh: &TriMesh| {
            let mut mesh = mesh.clone();
            rig.deform(&rig.pose(&rig.animations[0], time), &mut mesh);
            mesh
        };
        let (here, there) = (bent(&rig, &mesh), bent(&other, &back.mesh));
        assert_eq!(here.triangles, there.triangles);
        let off = here.positions.iter().zip(&there.positions).map(|(a, b)| a.distance(*b));
        farthest = farthest.max(off.fold(0.0, f32::max));
        if time == 0.3 {
            let moved = here.positions.iter().zip(&mesh.positions).map(|(a, b)| a.distance(*b));
            assert!(moved.fold(0.0, f32::max) > 0.02, "it waves");
        }
    }
    assert!(farthest < 1e-5, "{farthest}");
    // A rig of another mesh is rejected.
    assert!(body(&mannequin::mesh(50), Some(&rig)).is_err());
}

fn wave() -> Animation {
    use crate::rig::{Channel, Curve};
    let turn = glam::Quat::from_rotation_y(0.8).to_array();
    let rest = glam::Quat::IDENTITY.to_array();
    let curve = |values: Vec<f32>| Curve { times: vec![0.0, 0.5, 1.0], values, ..Curve::default() };
    let rotation = curve([rest, turn, rest].concat());
    let weights = curve(vec![0.0, 1.0, 0.0]);
    let channels = vec![
        Channel { node: 2, property: Property::Rotation, curve: rotation },
        Channel { node: 0, property: Property::Weights(vec![1]), curve: weights },
    ];
    Animation { name: "Wave".into(), length: 1.0, channels }
}

#[test]
fn body_without_rig_survives_round_trip() {
    let mesh = mannequin::mesh(50);
    let back = read(&body(&mesh, None).unwrap());
    assert_eq!((back.mesh.positions, back.mesh.triangles), (mesh.positions, mesh.triangles));
}

fn strands() -> Strands {
    let mut strands = Strands::default();
    for i in 0..40u32 {
        let (x, n) = (i as f32, 5 + i % 3);
        let line: Vec<_> = (0..n)
            .map(|j| Vec3::new(0.01 * x, 1.5 - 0.004 * j as f32, 0.001 * (x * j as f32).sin()))
            .collect();
        strands.push(&line);
        strands.radii.extend((0..n).map(|j| 4e-5 * (1.0 - 0.1 * j as f32)));
        strands.colors.extend((0..n).map(|j| Vec3::new(0.02 * j as f32, 0.5, 1.0)));
        strands.root_uvs.push(glam::Vec2::new(0.1 * x, 0.3));
        strands.tip_pinned.push(i == 7);
        strands.marks.push(Mark {
            guide: i % 4 == 0,
            id: i as i32 - 3,
            group: (i % 2) as i32,
            closest: [i as i32 / 4 * 4 - 3; 3],
            weights: [0.5, 0.25, 0.25],
        });
    }
    strands
}

fn groom_of(bytes: &[u8]) -> import::FileBytes<'_> {
    (PathBuf::from("groom.glb"), Cow::Borrowed(bytes))
}

#[test]
fn hair_and_body_survive_round_trip() {
    let (mesh, mut strands) = (mannequin::mesh(60), strands());
    let row = |name: &str, per_vertex, is_integer, width: u32, count: usize| StrandAttribute {
        name: name.into(),
        per_vertex,
        is_integer,
        width,
        numbers: (0..count * width as usize).map(|i| i as f32 - 7.0).collect(),
    };
    strands.attributes = vec![
        row("age, years", false, true, 1, strands.len()),
        row("curl", true, false, 2, strands.positions.len()),
    ];
    let rig = mannequin::rig::rig(&mesh);
    let look = Look { eumelanin: 0.3, roughness: [0.2, 0.4], ..Default::default() };
    let mut sizes = Vec::new();
    for packed in [false, true] {
        let hair = [ExportHair { name: "hair", strands: &strands, packed, look: Some(&look) }];
        let bytes = character(Some((&mesh, Some(&rig))), &hair).unwrap();
        let given = [groom_of(&bytes)];
        assert_eq!(import::kind(&given[0].0, &bytes), Some(import::FileKind::Groom));
        let (back, head, report) = import::read_given(&given, &Default::default()).unwrap();
        let head = head.expect("it holds a body");
        assert_eq!(
            (head.triangles.len(), report.rig.unwrap().targets.len()),
            (mesh.triangles.len(), rig.targets.len())
        );
        assert_eq!((report.placement.unit.0, report.look), (1.0, Some(look)));
        assert_eq!(
            (&back.offsets, &back.tip_pinned, &back.marks),
            (&strands.offsets, &strands.tip_pinned, &strands.marks)
        );
        assert_eq!((&back.root_uvs, &back.attributes), (&strands.root_uvs, &strands.attributes));
        // Within half a step of 16 bits.
        let far = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(far(&back.positions, &strands.positions) < 0.39 / 65535.0, "positions");
        assert!(far(&back.colors, &strands.colors) < 2e-5, "colors");
        let radii = back.radii.iter().zip(&strands.radii).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(radii < 1e-9, "{radii}");
        sizes.push(bytes.len());
    }
    assert!(sizes[1] < sizes[0], "{sizes:?}");
}

#[test]
fn fine_hair_is_stored_as_floats() {
    let mut strands = Strands::default();
    // A hair of 1 m beside fuzz with segments of 0.5 mm.
    strands.push(&[Vec3::ZERO, Vec3::Y]);
    for i in 0..200 {
        let root = Vec3::new(0.001 * i as f32, 0.0, 0.2);
        strands.push(&[root, root + Vec3::Y * 5e-4, root + Vec3::Y * 1e-3]);
    }
    let bytes =
        character(None, &[ExportHair { name: "", strands: &strands, packed: true, look: None }]).unwrap();
    let (back, head, _) = import::read_given(&[groom_of(&bytes)], &Default::default()).unwrap();
    assert!(head.is_none());
    assert_eq!(back, strands);
    let black = Look { eumelanin: f32::NAN, ..Default::default() };
    let wrong = ExportHair { name: "", strands: &strands, packed: false, look: Some(&black) };
    assert!(character(None, &[wrong]).unwrap_err().to_string().contains("eumelanin"));
    assert!(
        character(None, &[ExportHair { name: "", strands: &Strands::default(), packed: false, look: None }])
            .is_err()
    );
}

#[test]
fn damaged_hair_is_reported() {
    let strands = strands();
    let whole =
        character(None, &[ExportHair { name: "hair", strands: &strands, packed: true, look: None }]).unwrap();
    let error = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let mut bytes = whole.clone();
        let at = whole.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
        bytes[at..at + from.len()].copy_from_slice(to.as_bytes());
        import::read_given(&[groom_of(&bytes)], &Default::default()).expect_err(to).to_string()
    };
    for (from, to, said) in [
        ("\"count\":40,\"flags\"", "\"count\":41,\"flags\"", "has 40 items, but should have 41"),
        ("\"vertices\":", "\"vertexes\":", "it has no vertices"),
        ("ATTRIBUTES", "ATTRIBUTEZ", "cannot be decompressed"),
        ("\"vertexCounts\":0", "\"vertexCounts\":9", "accessor 9"),
        ("EXT_tresses_hair\":{", "EXT_tresses_fuzz\":{", "not a groom"),
    ] {
        let text = error(from, to);
        assert!(text.contains(said) && text.contains("groom.glb"), "{text}");
    }
}
