//! Readers on damaged files: they return soon, whatever the content. `make fuzz` runs each for a minute.

use std::time::{Duration, Instant};

use bolero::check;
use tresses_fuzz::{
    Edit, STROKES, asset, body, cooked, damaged, edited, groom, living, mesh, opened, packed, painted,
    sealed, stroked, written,
};
use tresses_groom::{
    error::Result,
    import::{ImportOptions, read_given_body},
};

/// Time limit. A file of some kilobytes that takes longer is a denial-of-service attack.
const SOON: Duration = Duration::from_secs(20);

fn survives(name: &str, file: &[u8], read: fn(&str, &[u8]) -> Result<usize>) {
    let whole = read(name, file).unwrap_or_else(|error| panic!("the file is whole: {error}"));
    assert!(whole > 0, "{name} holds nothing");
    check!().with_type::<Vec<Edit>>().for_each(|edits| {
        let start = Instant::now();
        if let Err(error) = read(name, &damaged(file, edits)) {
            assert!(!error.to_string().is_empty());
        }
        assert!(start.elapsed() < SOON, "{name} took {:?}", start.elapsed());
    });
}

#[test]
fn tfx() {
    survives("a.tfx", &written("a.tfx"), groom);
}

#[test]
fn hair() {
    survives("a.hair", &written("a.hair"), groom);
}

#[test]
fn obj_lines() {
    survives("a.obj", &written("a.obj"), groom);
}

#[test]
fn data() {
    survives("a.data", &written("a.data"), groom);
}

#[test]
fn ply() {
    survives("a.ply", &written("a.ply"), groom);
}

#[test]
fn npz() {
    survives("a.npz", include_bytes!("../files/strands.npz"), groom);
}

#[test]
fn alembic() {
    survives("a.abc", &written("a.abc"), groom);
}

#[test]
fn usd_text() {
    survives("a.usda", &written("a.usda"), groom);
}

/// Hair on joints, and the mesh that they deform.
#[test]
fn usd_skeleton() {
    survives("a.usda", &living("a.usda", true), groom);
}

#[test]
fn usd_body() {
    survives("a.usda", &living("a.usda", false), mesh);
}

#[test]
fn usd_binary() {
    survives("a.usdc", &living("a.usdc", true), groom);
}

#[test]
fn usd_binary_body() {
    survives("a.usdc", &living("a.usdc", false), mesh);
}

#[test]
fn glb() {
    survives("a.glb", &body(), mesh);
}

#[test]
fn painted_glb() {
    let read = read_given_body(&[("a.glb".into(), painted().into())], &ImportOptions::default());
    let read = read.expect("it is whole");
    assert!(read.mesh.paint.is_some() && read.lights.len() == 1, "it has its picture and its light");
    survives("a.glb", &painted(), mesh);
}

#[test]
fn glb_hair() {
    survives("a.glb", &written("a.glb"), groom);
}

#[test]
fn packed_glb_hair() {
    survives("a.glb", &packed(), groom);
}

#[test]
fn cooked_groom() {
    survives("a.tresses", &cooked(), sealed);
}

#[test]
fn edited_groom() {
    survives("a.groom", &edited(), opened);
}

#[test]
fn strokes() {
    survives("a.jsonl", STROKES.as_bytes(), stroked);
}

#[test]
fn rigged_glb() {
    let Some(file) = asset("characters/CesiumMan.glb") else {
        assert!(std::env::var_os("TRESSES_REQUIRE_ASSETS").is_none(), "the asset is not there");
        return;
    };
    survives("a.glb", &file, mesh);
}

#[test]
fn obj_mesh() {
    let file = b"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    survives("a.obj", file, mesh);
}

#[test]
fn tfx_mesh() {
    let file = b"numOfBones 1\n0 head\nnumOfVertices 4\n0 0 0 0 0 -1 0 0 0 0 0 1 0 0 0\n\
        1 0.1 0 0 1 0 0 0 0 0 0 1 0 0 0\n2 0 0.1 0 0 1 0 0 0 0 0 1 0 0 0\n3 0 0 0.1 0 0 1 0 0 0 0 1 0 0 0\n\
        numOfTriangles 4\n0 0 2 1\n1 0 1 3\n2 0 3 2\n3 1 2 3\n";
    survives("a.tfxmesh", file, mesh);
}
