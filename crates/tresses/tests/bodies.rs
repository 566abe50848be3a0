//! Simplified meshes have no holes that the full mesh does not have, seen from any side. Needs no GPU.

use std::{collections::HashMap, path::PathBuf};
use tresses::{
    glam::{Mat3, Vec3},
    groom::{
        TriMesh,
        import::{self, ImportOptions},
        mannequin,
    },
};

/// Width and height of the depth images, pixels.
const SIDE: usize = 192;

/// Returns the directions to the six faces and the eight corners of a cube.
fn directions() -> impl Iterator<Item = Vec3> {
    let all = (0..27).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) - 1.0);
    all.filter(|v| matches!(v.length_squared() as u32, 1 | 3)).map(Vec3::normalize)
}

/// Renders depth along `towards` in parallel projection: meters from a plane in front of the mesh, infinite where there
/// is no mesh. Also returns the size of a pixel, meters.
fn depths(mesh: &TriMesh, triangles: &[[u32; 3]], towards: Vec3) -> (Vec<f32>, f32) {
    let (lo, hi) = mesh.bounds().unwrap();
    let (x, y) = towards.any_orthonormal_pair();
    let turn = Mat3::from_cols(x, y, towards).transpose();
    let (middle, pixel) = (0.5 * (lo + hi), lo.distance(hi) / (SIDE - 4) as f32);
    let place = |v: u32| turn * (mesh.positions[v as usize] - middle) / pixel + 0.5 * SIDE as f32;
    let mut seen = vec![f32::INFINITY; SIDE * SIDE];
    for [a, b, c] in triangles.iter().map(|t| t.map(place)) {
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        let least = a.min(b).min(c).floor().max(Vec3::ZERO);
        let most = a.max(b).max(c).ceil().min(Vec3::splat(SIDE as f32 - 1.0));
        for py in least.y as usize..=most.y as usize {
            for px in least.x as usize..=most.x as usize {
                let p = Vec3::new(px as f32 + 0.5, py as f32 + 0.5, 0.0);
                let share = |u: Vec3, v: Vec3| (u - p).truncate().perp_dot((v - p).truncate()) / area;
                let (wa, wb, wc) = (share(b, c), share(c, a), share(a, b));
                if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 {
                    let at = &mut seen[py * SIDE + px];
                    *at = at.min((wa * a.z + wb * b.z + wc * c.z) * pixel);
                }
            }
        }
    }
    (seen, pixel)
}

/// Returns the share of the mesh's pixels at which the depth of `triangles` is wrong. The depth must lie in the range
/// of the full mesh over the pixel and its neighbors, plus or minus a pixel and `stray` meters. Through a hole, it is
/// farther or infinite.
fn holes(mesh: &TriMesh, triangles: &[[u32; 3]], stray: f32) -> f32 {
    let (mut wrong, mut all) = (0, 0);
    for towards in directions() {
        let (whole, pixel) = depths(mesh, &mesh.triangles, towards);
        let (fewer, _) = depths(mesh, triangles, towards);
        for y in 1..SIDE - 1 {
            for x in 1..SIDE - 1 {
                let beside = (0..9).map(|k| whole[(y + k / 3 - 1) * SIDE + x + k % 3 - 1]);
                let (near, far) = beside.fold((f32::INFINITY, 0_f32), |(lo, hi), z| (z.min(lo), hi.max(z)));
                if far.is_infinite() && whole[y * SIDE + x].is_infinite() {
                    continue;
                }
                let room = stray + pixel;
                let found = fewer[y * SIDE + x];
                all += 1;
                wrong += u32::from(found < near - room || found > far + room);
            }
        }
    }
    wrong as f32 / all.max(1) as f32
}

/// Simplifies by vertex clustering, which tears holes: all vertices in a cube of edge `cell` meters become the first
/// one.
fn clustered(mesh: &TriMesh, cell: f32) -> Vec<[u32; 3]> {
    let mut first = HashMap::new();
    let cube = |p: &Vec3| (*p / cell).floor().as_ivec3();
    let place: Vec<u32> =
        (0..).zip(&mesh.positions).map(|(i, p)| *first.entry(cube(p)).or_insert(i)).collect();
    let moved = mesh.triangles.iter().map(|t| t.map(|v| place[v as usize]));
    moved.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// Allowed share of wrong pixels. Edges of thin parts sometimes move by more than a pixel.
const MOST: f32 = 0.0005;

fn check(name: &str, mesh: &TriMesh) {
    let levels = mesh.levels();
    let mut before = mesh.triangles.len();
    for level in &levels {
        let (count, share) = (level.triangles.len(), holes(mesh, &level.triangles, level.stray));
        println!("{name}: {:.2} mm, {count} of {}, {share:.5}", 1e3 * level.stray, mesh.triangles.len());
        assert!(count < before && share < MOST, "{name}: {share} is wrong at {} m", level.stray);
        before = count;
    }
}

#[test]
fn simplified_built_in_head_has_no_holes() {
    let mesh = mannequin::mesh(96);
    check("mannequin", &mesh);
    let levels = mesh.levels();
    assert!(levels.len() > 3 && levels[1].triangles.len() * 2 < mesh.triangles.len());
    // Missing triangles are detected.
    let level = levels.last().unwrap();
    let torn: Vec<_> = (0..).zip(&level.triangles).filter(|(i, _)| i % 50 != 0).map(|(_, t)| *t).collect();
    let share = holes(&mesh, &torn, level.stray);
    assert!(share > 5.0 * MOST, "{share}");
}

#[test]
fn simplified_imported_heads_have_no_holes() {
    let Some(assets) = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from).filter(|f| f.is_dir()) else {
        assert!(std::env::var_os("TRESSES_REQUIRE_ASSETS").is_none(), "TRESSES_ASSETS names no folder");
        return println!("skipped: TRESSES_ASSETS names no folder");
    };
    let mut torn = 0;
    for files in [
        &["head_ict_facekit/generic_neutral_mesh.obj"][..],
        &["head_makehuman/head_crop.obj"],
        &["head_makehuman/base.obj"],
        &["sintel/sintel.obj", "sintel/sintel-eyes.obj", "sintel/sintel-eyelashes.obj"],
        &["sintel/sintel-collider.obj"],
        &["sintel_lite21/sintel.obj", "sintel_lite21/sintel_eyeballs.obj"],
        &["tressfx2_head/head_max4.obj"],
        &["tressfx4_ratboy/Ratboy_body.tfxmesh"],
        &["characters/CesiumMan.glb"],
        &["characters/RobotExpressive.glb"],
    ] {
        let paths: Vec<PathBuf> = files.iter().map(|file| assets.join(file)).collect();
        let (mesh, _) = import::read_head(&paths, &ImportOptions::default()).unwrap();
        check(files[0], &mesh);
        let Some(level) = mesh.levels().pop() else { continue };
        // Vertex clustering at 12 mm, the former method for bodies, tears holes.
        let share = holes(&mesh, &clustered(&mesh, 0.012), level.stray);
        println!("{}: clustered {share:.5}", files[0]);
        torn += u32::from(share > MOST);
    }
    assert!(torn > 3, "holes are found in {torn} meshes that have some");
}
