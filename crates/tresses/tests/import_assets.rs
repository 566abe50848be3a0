//! Grooms and heads of other people, read whole. Needs the folder that `TRESSES_ASSETS` names.

use std::path::PathBuf;

use tresses::groom::import::{self, ImportOptions};

fn assets() -> Option<PathBuf> {
    let folder = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from).filter(|f| f.is_dir());
    if folder.is_none() {
        println!("skipped: TRESSES_ASSETS names no folder");
    }
    folder
}

/// Files, strands, vertices as their READMEs state them.
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
fn counts_are_those_of_the_readmes() {
    let Some(assets) = assets() else { return };
    for (files, strands, vertices) in GROOMS {
        let paths: Vec<PathBuf> = files.iter().map(|f| assets.join(f)).collect();
        let options = ImportOptions { unrepaired: true, ..Default::default() };
        let (groom, report) = import::read(&paths, &options).unwrap();
        assert_eq!((groom.len(), groom.positions.len()), (*strands, *vertices), "{files:?}");
        assert_eq!(report.files.len(), files.len());
    }
}

#[test]
fn tips_in_the_band_are_pinned() {
    let Some(assets) = assets() else { return };
    for (files, pinned) in [(GROOMS[3].0, 517), (GROOMS[4].0, 517), (GROOMS[1].0, 0)] {
        let paths: Vec<PathBuf> = files.iter().map(|f| assets.join(f)).collect();
        let (groom, _) = import::read(&paths, &ImportOptions::default()).unwrap();
        assert_eq!(groom.tip_pinned.iter().filter(|p| **p).count(), pinned, "{files:?}");
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
            "{file}: {} vertices, {} triangles, {} colours",
            mesh.positions.len(),
            mesh.triangles.len(),
            mesh.colors.len()
        );
        assert_eq!(mesh.triangles.len(), triangles, "{file}");
        assert_eq!(mesh.normals.len(), mesh.positions.len());
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3));
    }
}
