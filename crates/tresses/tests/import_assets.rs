//! Grooms and heads of other authors, read whole. Needs the folder `TRESSES_ASSETS`.

use std::path::{Path, PathBuf};

use tresses::{
    glam,
    groom::{
        import::{self, ImportOptions},
        orient::{self, Axis},
    },
};

fn assets() -> Option<PathBuf> {
    let folder = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from).filter(|f| f.is_dir());
    if folder.is_none() {
        assert!(
            std::env::var_os("TRESSES_REQUIRE_ASSETS").is_none_or(|v| v != "1"),
            "TRESSES_ASSETS names no folder"
        );
        println!("skipped: TRESSES_ASSETS names no folder");
    }
    folder
}

/// Files, number of strands and number of vertices, as their READMEs state them.
const GROOMS: &[(&[&str], usize, usize)] = &[
    (&["cyhair_straight/straight.hair"], 10_000, 160_000),
    (&["sintel/SintelHairOriginal-sintel_hair.16points.tfx"], 11_400, 182_400),
    (&["sintel_lite21/GEO-sintel_hair_emit.001-sintel_hair.tfx"], 228, 228 * 32),
    (
        &[
            "tressfx2_head/hair_free_16_guide.tfx",
            "tressfx2_head/hair_front_16_guide.tfx",
            "tressfx2_head/hair_pulled_16_guide.tfx",
            "tressfx2_head/hair_tail_16_guide.tfx",
        ],
        5_026,
        80_416,
    ),
    (
        &[
            "tressfx3_ponytail/back.tfx",
            "tressfx3_ponytail/front_top.tfx",
            "tressfx3_ponytail/side.tfx",
            "tressfx3_ponytail/tail.tfx",
        ],
        4_933,
        78_928,
    ),
    (&["tressfx4_ratboy/Ratboy_mohawk.tfx"], 2_228, 71_296),
];

#[test]
fn counts_match_the_readmes() {
    let Some(assets) = assets() else { return };
    for (i, (files, strands, vertices)) in GROOMS.iter().enumerate() {
        let options = ImportOptions { skips_repair: true, ..Default::default() };
        let (groom, report) = import::read(&paths(&assets, i), &options).unwrap();
        assert_eq!((groom.len(), groom.positions.len()), (*strands, *vertices), "{files:?}");
        assert_eq!(report.files.len(), files.len());
    }
}

#[test]
fn tips_in_the_band_are_pinned() {
    let Some(assets) = assets() else { return };
    for (groom, pinned) in [(3, 517), (4, 517), (1, 0)] {
        let (strands, _) = import::read(&paths(&assets, groom), &ImportOptions::default()).unwrap();
        assert_eq!(strands.tip_pinned.iter().filter(|p| **p).count(), pinned, "{groom}");
    }
}

#[test]
fn heads_are_read_whole() {
    let Some(assets) = assets() else { return };
    for (file, triangles) in [
        ("head_ict_facekit/generic_neutral_mesh.obj", 52_220),
        ("head_makehuman/head_crop.obj", 8_800),
        ("sintel/sintel.obj", 5_952),
        ("sintel/sintel-collider.obj", 678),
        ("sintel_lite21/sintel.obj", 5_952),
        ("tressfx2_head/head_max4.obj", 18_574),
        ("tressfx4_ratboy/Ratboy_body.tfxmesh", 25_814),
    ] {
        let mesh = import::mesh::read(&assets.join(file)).unwrap().mesh;
        println!(
            "{file}: {} vertices, {} triangles, {} colors",
            mesh.positions.len(),
            mesh.triangles.len(),
            mesh.colors.len()
        );
        assert_eq!(mesh.triangles.len(), triangles, "{file}");
        assert_eq!(mesh.normals.len(), mesh.positions.len());
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3));
    }
}

/// Groom (index into [`GROOMS`]), its head, and the expected unit, up axis, front axis and mirroring.
const ON_THEIR_HEADS: &[(usize, &str, f32, Axis, Axis, bool)] = &[
    (1, "sintel/sintel.obj", 1.0, Axis::Y, Axis::Z, false),
    (2, "sintel_lite21/sintel.obj", 0.01, Axis::Y, Axis::Z, false),
    (3, "tressfx2_head/head_max4.obj", 0.00295, Axis::Y, Axis::Z, false),
    (4, "tressfx2_head/head_max4.obj", 0.00295, Axis::Y, Axis::NegZ, true),
    (5, "tressfx4_ratboy/Ratboy_body.tfxmesh", 1.0, Axis::Y, Axis::Z, false),
];

fn paths(assets: &Path, groom: usize) -> Vec<PathBuf> {
    GROOMS[groom].0.iter().map(|f| assets.join(f)).collect()
}

#[test]
fn grooms_are_placed_upright_on_their_own_heads() {
    let Some(assets) = assets() else { return };
    for (groom, head, unit, up, front, mirrored) in ON_THEIR_HEADS {
        let files = paths(&assets, *groom);
        let (strands, mesh, report) =
            import::read_with_head(&files, &[assets.join(head)], &ImportOptions::default()).unwrap();
        let p = &report.placement;
        assert_eq!((p.up, p.front, p.mirrored), (*up, *front, *mirrored), "{head}: {p:?}");
        assert!((p.unit.0 / unit - 1.0).abs() < 0.03, "{head}: {p:?}");
        let distance = report.lint.root_distance.unwrap();
        assert!(distance.median < 0.003 && distance.p95 < 0.02, "{head}: {distance:?}");
        // Roots are on top of the mesh, and hair is behind the face.
        let (lo, hi) = mesh.bounds().unwrap();
        let highest = strands.iter().map(|s| s[0].y).fold(f32::MIN, f32::max);
        assert!((hi.y - highest).abs() < 0.02, "{head}: {highest} under {hi}");
        let mean = strands.iter().map(|s| s[0]).sum::<glam::Vec3>() / strands.len() as f32;
        assert!(mean.z < 0.5 * (lo.z + hi.z), "{head}: {mean} in {lo} {hi}");
        println!("{head}: {:?}", p.reasons);
    }
}

#[test]
fn grooms_are_oriented_without_a_head() {
    let Some(assets) = assets() else { return };
    // The reference image of straight.hair maps (x, y, z) to (−x, z, y), with a unit of about 4.2 mm.
    for (groom, unit, up, front) in [
        (0, 0.0042, Axis::Z, Axis::Y),
        (1, 1.0, Axis::Y, Axis::Z),
        (2, 0.01, Axis::Y, Axis::Z),
        (3, 0.003, Axis::Y, Axis::Z),
        (4, 0.003, Axis::Y, Axis::NegZ),
        (5, 1.0, Axis::Y, Axis::Z),
    ] {
        let (_, report) = import::read(&paths(&assets, groom), &ImportOptions::default()).unwrap();
        let p = &report.placement;
        assert_eq!((p.up, p.front), (up, front), "{p:?}");
        assert!((p.unit.0 / unit - 1.0).abs() < 0.15, "{p:?}");
    }
}

#[test]
fn groom_for_another_head_is_fitted() {
    let Some(assets) = assets() else { return };
    for (groom, head) in [
        (0, "head_ict_facekit/generic_neutral_mesh.obj"),
        (0, "head_makehuman/head_crop.obj"),
        (1, "head_ict_facekit/generic_neutral_mesh.obj"),
        (2, "sintel/sintel.obj"),
        (3, "head_ict_facekit/generic_neutral_mesh.obj"),
    ] {
        let head = [assets.join(head)];
        let (_, _, report) =
            import::read_with_head(&paths(&assets, groom), &head, &ImportOptions::default()).unwrap();
        let distance = report.lint.root_distance.unwrap();
        assert!(distance.median < 0.005, "{groom} on {head:?}: {distance:?}");
        assert!(report.placement.doubts.iter().any(|d| d.contains("another head")));
    }
}

/// Returns all pairs of an up and a front axis, and the rotation to them.
fn rotations() -> impl Iterator<Item = (Axis, Axis, glam::Mat3)> {
    let pairs = Axis::ALL.into_iter().flat_map(|up| Axis::ALL.map(|front| (up, front)));
    let upright = pairs.filter(|(up, front)| front.vector().dot(up.vector()) == 0.0);
    upright.map(|(up, front)| {
        let placement = orient::Placement { up, front, ..Default::default() };
        (up, front, placement.axes().transpose())
    })
}

#[test]
fn rotated_and_scaled_groom_and_head_are_restored() {
    let Some(assets) = assets() else { return };
    let options = ImportOptions { skips_repair: true, ..Default::default() };
    let (strands, mesh, _) =
        import::read_with_head(&paths(&assets, 2), &[assets.join("sintel_lite21/sintel.obj")], &options)
            .unwrap();
    for (up, front, turn) in rotations() {
        let (mut groom, mut head) = (strands.clone(), mesh.clone());
        groom.positions.iter_mut().for_each(|p| *p = turn * *p * 100.0);
        head.positions.iter_mut().for_each(|p| *p = turn * *p * 100.0);
        let unknown = orient::KnownOrientation::default();
        let (own, of_head) = orient::pair(&groom, &unknown, &head, &unknown);
        assert_eq!((own.up, own.front, own.mirrored), (up, front, false), "{own:?}");
        assert_eq!((of_head.up, of_head.front, of_head.unit), (up, front, orient::LengthUnit(0.01)));
    }
}

#[test]
fn given_axes_and_units_are_used() {
    let Some(assets) = assets() else { return };
    let mut options = ImportOptions::default();
    options.orient.up = Some(Axis::Z);
    options.orient.front = Some(Axis::NegY);
    options.orient.unit = Some("cm".parse().unwrap());
    let (_, report) = import::read(&paths(&assets, 0), &options).unwrap();
    let p = report.placement;
    assert_eq!((p.up, p.front, p.unit.0), (Axis::Z, Axis::NegY, 0.01));
    // The unit given for the groom also applies to the head if both share one.
    let mut options = ImportOptions::default();
    options.orient.unit = Some("0.0037".parse().unwrap());
    let head = [assets.join("tressfx2_head/head_max4.obj")];
    let (_, _, report) = import::read_with_head(&paths(&assets, 4), &head, &options).unwrap();
    assert_eq!(report.placement.unit.0, 0.0037);
    assert_eq!(report.head_placement.unwrap().unit.0, 0.0037);
}

#[test]
fn heads_are_oriented_without_a_groom() {
    let Some(assets) = assets() else { return };
    for (file, unit) in [
        ("head_ict_facekit/generic_neutral_mesh.obj", 0.01),
        ("head_makehuman/head_crop.obj", 0.1),
        ("head_makehuman/base.obj", 0.1),
        ("sintel/sintel.obj", 1.0),
        ("sintel_lite21/sintel.obj", 0.01),
        ("tressfx2_head/head_max4.obj", 0.0028),
        ("tressfx4_ratboy/Ratboy_body.tfxmesh", 1.0),
    ] {
        let (_, p) = import::read_head(&[assets.join(file)], &ImportOptions::default()).unwrap();
        assert_eq!((p.up, p.front), (Axis::Y, Axis::Z), "{file}: {p:?}");
        assert!((p.unit.0 / unit - 1.0).abs() < 0.1, "{file}: {p:?}");
    }
}

#[test]
fn rotated_human_heads_are_restored() {
    let Some(assets) = assets() else { return };
    for file in ["head_ict_facekit/generic_neutral_mesh.obj", "head_makehuman/base.obj", "sintel/sintel.obj"]
    {
        let whole = import::mesh::read(&assets.join(file)).unwrap().mesh;
        for (up, front, turn) in rotations() {
            let mut head = whole.clone();
            head.positions.iter_mut().for_each(|p| *p = turn * *p);
            let found = orient::head(&head, &orient::KnownOrientation::default());
            assert_eq!((found.up, found.front), (up, front), "{file}: {found:?}");
        }
    }
}
