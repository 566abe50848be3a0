use super::*;
use crate::bound::Strand;
use crate::rig::{Animation, Bind, Channel, Curve, Delta, Interpolation, Joint, MorphTarget, Node, Property};
use crate::{
    BoundStrands, Guides, Influence,
    light::PunctualShape,
    mesh::{
        Paint,
        paint::{Coat, Texture},
    },
};
use glam::{UVec3, Vec3};
use std::path::PathBuf;

/// Returns a groom that uses every field.
fn sample() -> CookedGroom {
    let mut strands = Strands::default();
    for i in 0..40 {
        let (x, z) = (0.004 * (i % 8) as f32, 0.004 * (i / 8) as f32);
        strands.push(&[0.0, 0.03, 0.06].map(|y| Vec3::new(x, y, z)));
    }
    strands.radii = vec![4e-5; strands.positions.len()];
    strands.tip_pinned = (0..40).map(|i| i == 3).collect();
    let mut head = TriMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::Y],
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
        ..Default::default()
    };
    head.normals = vec![Vec3::Y; 4];
    head.paint = Some(std::sync::Arc::new(Paint {
        uvs: vec![glam::Vec2::X; 4],
        of: vec![0, Paint::NONE, 0, 0],
        coats: vec![Coat { base: Texture::even([9; 4]), relief: Texture::even([1; 4]), cutout: Some(0.5) }],
    }));
    let field = SdfGrid {
        size: UVec3::splat(2),
        origin: Vec3::ZERO,
        cell: 0.1,
        distances: (0..8).map(|i| i as f32 - 3.5).collect(),
    };
    let bind = |p: &Vec3| Bind::rigid(*p, Vec3::Y, 0);
    let turn = Channel {
        node: 0,
        property: Property::Weights(vec![0]),
        curve: Curve { interpolation: Interpolation::Step, times: vec![0.0, 1.0], values: vec![0.0, 1.0] },
    };
    let shape = Delta { vertex: 2, position: Vec3::X, normal: Vec3::ZERO };
    let rig = Rig {
        nodes: vec![Node { name: "head".into(), weights: vec![(0, 0.5)], ..Default::default() }],
        joints: vec![Joint { node: 0, inverse_bind: glam::Mat4::IDENTITY }],
        vertices: head.positions.iter().map(bind).collect(),
        targets: vec![MorphTarget { name: "smile".into(), deltas: vec![shape] }],
        animations: vec![Animation { name: "nod".into(), length: 1.0, channels: vec![turn] }],
        to_groom: glam::Mat4::IDENTITY,
    };
    let file = FileReport {
        path: PathBuf::from("folder/hair.tfx"),
        format: "TressFX 4",
        strands: 40,
        vertices: 120,
        notes: vec!["one note".into()],
    };
    let shape = PunctualShape::Spot { position: Vec3::Y, direction: Vec3::NEG_Y, inner: 0.2, outer: 0.4 };
    let light =
        PunctualLight { name: "lamp".into(), shape, color: Vec3::ONE, intensity: 8.0, range: f32::INFINITY };
    let report = ImportReport {
        files: vec![file],
        placement: orient::Placement::default(),
        head_placement: Some(orient::Placement::default()),
        rig: None,
        lights: vec![light],
        lint: lint::check(&strands, Some(&head)),
        repaired: lint::RepairReport { merged_vertices: 7, ..Default::default() },
        followers: vec![Followers { count: 2, radius: Some(0.001) }; 40],
        groups: vec![StrandGroup { id: 4, name: "fringe".into(), strands: 40, guides: 0 }],
        attributes: Attributes { widths: true, ..Default::default() },
        look: Some(Look { eumelanin: 3.0, ..Default::default() }),
    };
    let mut cooked = CookedGroom::new(strands, Some(head), Some(field), Some(rig), &report).unwrap();
    cooked.parts = vec![(0, cooked.field.clone().unwrap())];
    cooked.levels = vec![mesh::MeshLevel { stray: 1e-3, triangles: vec![[0, 1, 2]] }];
    cooked
}

fn name() -> PathBuf {
    PathBuf::from("hair.tresses")
}

/// Returns the error for bytes that cannot be read.
fn refused(bytes: &[u8]) -> String {
    CookedGroom::read(&name(), bytes).unwrap_err().to_string()
}

#[test]
fn groom_survives_round_trip() {
    let cooked = sample();
    let bytes = cooked.write().unwrap();
    let back = CookedGroom::read(&name(), &bytes).unwrap();
    assert_eq!(back, cooked);
    let report = back.report(&name());
    assert_eq!(report.files[0].notes, ["made of hair.tfx (TressFX 4), one note"]);
    assert_eq!((report.repaired.merged_vertices, report.groups[0].name.as_str()), (7, "fringe"));
    // The comparison detects a small difference.
    let mut other = cooked.clone();
    other.strands.positions[5].x += 1e-6;
    assert_ne!(back, other);
}

/// Pins the layout of [`VERSION`]. If this test fails, a type has changed: increase the version.
#[test]
fn layout_matches_version() {
    let mut still = sample();
    // Replace everything that lint and binding compute, so that only a change of layout fails the test.
    still.report_text.lint =
        lint::LintReport { strands: 40, bounds: Some((Vec3::ZERO, Vec3::ONE)), ..Default::default() };
    still.groom.guides = Guides {
        vertex_count: 2,
        positions: vec![Vec3::ZERO, Vec3::Y],
        stiffness: vec![1.0],
        strands: vec![40.0],
        tip_pinned: vec![true],
        groups: vec![3],
    };
    let rest = [Vec3::X, Vec3::Z];
    let follows = Influence { guide: 0, weight: 1.0, scale: 0.5 };
    still.groom.strands = BoundStrands::new(2);
    still.groom.strands.push(Strand { seed: 9, ..Default::default() }, &rest, &[0.5, 1.0], &[follows]);
    let sum = crc32fast::hash(&postcard::to_allocvec(&still).unwrap());
    assert_eq!((VERSION, sum), (4, 3_808_408_278), "the layout of a cooked groom has changed");
}

#[test]
fn damaged_bytes_are_rejected() {
    let bytes = sample().write().unwrap();
    assert!(refused(b"").contains("not a cooked groom"));
    assert!(refused(&bytes[..20]).contains("checksum"));
    for at in (0..bytes.len()).step_by(37) {
        let mut bent = bytes.clone();
        bent[at] ^= 0x20;
        refused(&bent);
    }
    let mut older = bytes.clone();
    older[8] = 200;
    assert!(
        refused(&older).contains("version 200") && refused(&older).contains("cook it again"),
        "{}",
        refused(&older)
    );
    // Truncated and extended contents with a valid checksum.
    let sealed = |body: &[u8]| [&bytes[..12], &crc32fast::hash(body).to_le_bytes(), body].concat();
    let body = &bytes[HEADER..];
    assert!(refused(&sealed(&[b"\x050.0.9", &body[1 + TRESSES.len()..]].concat())).contains("Tresses 0.0.9"));
    assert!(CookedGroom::read(&name(), &sealed(body)).is_ok());
    for cut in (0..body.len()).step_by(53) {
        refused(&sealed(&body[..cut]));
    }
    assert!(refused(&sealed(&[body, &[0]].concat())).contains("unexpected bytes"));
}

/// Returns the head's [`Paint`] for editing.
fn paint(cooked: &mut CookedGroom) -> &mut Paint {
    std::sync::Arc::make_mut(cooked.head.as_mut().unwrap().paint.as_mut().unwrap())
}

/// A valid checksum does not bypass validation.
#[test]
fn inconsistent_groom_is_rejected() {
    let wrongs: [fn(&mut CookedGroom); 35] = [
        |c| c.report_text.lights[0].intensity = -1.0,
        |c| c.report_text.look.as_mut().unwrap().eumelanin = f32::NAN,
        |c| c.strands.offsets[3] = 2,
        |c| c.strands.offsets[40] = 1000,
        |c| c.strands.offsets.clear(),
        |c| c.strands.positions[0].y = f32::NAN,
        |c| c.strands.radii.truncate(1),
        |c| c.strands.tip_pinned.truncate(1),
        |c| c.report_text.followers.truncate(1),
        |c| c.groom.strands.bindings[7].guides[2] = 1 << 20,
        |c| c.groom.guides.vertex_count = u32::MAX,
        |c| c.groom.strands.rest.truncate(1),
        |c| c.groom.guides.strands.truncate(1),
        |c| c.groom.guides.stiffness[0] = f32::INFINITY,
        |c| c.head.as_mut().unwrap().triangles[0][1] = 4,
        |c| c.head.as_mut().unwrap().normals.truncate(1),
        |c| c.levels[0].triangles[0][0] = 4,
        |c| paint(c).of[1] = 1,
        |c| paint(c).uvs.truncate(1),
        |c| paint(c).coats[0].base.width = 2,
        |c| c.field.as_mut().unwrap().size = UVec3::new(u32::MAX, u32::MAX, 2),
        |c| c.field.as_mut().unwrap().cell = 0.0,
        |c| c.strands.positions[1] = c.strands.positions[0],
        |c| c.strands.radii[0] = -1.0,
        |c| c.report_text.placement.unit.0 = 0.0,
        |c| c.rig.as_mut().unwrap().nodes[0].rest.scale.x = f32::NAN,
        |c| c.rig.as_mut().unwrap().nodes[0].parent = Some(7),
        |c| {
            // A chain of nodes that is too deep.
            let nodes = &mut c.rig.as_mut().unwrap().nodes;
            nodes.extend((0..400).map(|i| Node { parent: Some(i), ..Default::default() }));
        },
        |c| c.parts[0].0 = 1,
        |c| c.parts[0].1.distances[2] = f32::NAN,
        |c| c.rig.as_mut().unwrap().vertices[0].joints[7] = 1,
        |c| c.rig.as_mut().unwrap().nodes[0].parent = Some(0),
        |c| c.rig.as_mut().unwrap().targets[0].deltas[0].vertex = 4,
        |c| c.rig.as_mut().unwrap().animations[0].channels[0].node = 1,
        |c| c.rig.as_mut().unwrap().animations[0].channels[0].curve.times[0] = 2.0,
    ];
    for (i, wrong) in wrongs.iter().enumerate() {
        let mut cooked = sample();
        wrong(&mut cooked);
        assert!(cooked.write().is_err(), "the wrong {i} is written");
        assert!(CookedGroom::read(&name(), &cooked.encode().unwrap()).is_err(), "the wrong {i} is read");
    }
}

#[test]
fn guides_are_not_bound_as_strands() {
    let mut cooked = sample();
    let mark =
        |i: usize| crate::strands::Mark { guide: i.is_multiple_of(10), id: i as i32, ..Default::default() };
    cooked.strands.marks = (0..40).map(mark).collect();
    let report = cooked.report(&name());
    let cooked = CookedGroom::new(cooked.strands, cooked.head, cooked.field, cooked.rig, &report).unwrap();
    assert_eq!((cooked.groom.strands.len(), cooked.groom.guides.len()), (36, 4));
    let back = CookedGroom::read(&name(), &cooked.write().unwrap()).unwrap();
    assert_eq!(back, cooked);
    // If all strands are guides, all are drawn.
    let mut all = cooked.clone();
    all.strands.marks.iter_mut().for_each(|mark| mark.guide = true);
    let all = CookedGroom::new(all.strands, None, None, None, &report).unwrap();
    assert_eq!(all.groom.strands.len(), 40);
    assert!(CookedGroom::read(&name(), &all.write().unwrap()).is_ok());
}
