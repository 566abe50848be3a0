use std::path::PathBuf;

use super::*;
use crate::mesh::shapes;

fn options(resolution: u32, margin: f32) -> SdfOptions {
    SdfOptions { resolution, margin, ..Default::default() }
}

/// Returns the largest difference between a field and a closed form at the field's nodes.
fn max_error(grid: &SdfGrid, exact: impl Fn(Vec3) -> f32) -> f32 {
    let error = |(i, d): (usize, &f32)| (d - exact(grid.node(i as u32))).abs();
    grid.distances.iter().enumerate().map(error).fold(0.0, f32::max)
}

/// Counts the nodes at least `min_distance` meters from the surface whose six neighbors are all on the other side.
fn isolated(grid: &SdfGrid, min_distance: f32) -> usize {
    let (size, steps) = (grid.size, [1, grid.size.x, grid.size.x * grid.size.y]);
    let is_isolated = |i: &u32| {
        let node = [i % size.x, i / size.x % size.y, i / steps[2]];
        let own = grid.distances[*i as usize];
        own.abs() >= min_distance
            && (0..3).all(|axis| {
                node[axis] > 0
                    && node[axis] < size[axis] - 1
                    && [i - steps[axis], i + steps[axis]]
                        .iter()
                        .all(|&n| (grid.distances[n as usize] < 0.0) != (own < 0.0))
            })
    };
    (0..grid.distances.len() as u32).filter(is_isolated).count()
}

/// Returns the maximum slope between neighboring nodes: at most 1 for an exact distance field.
fn max_slope(grid: &SdfGrid) -> f32 {
    let (size, steps) = (grid.size, [1, grid.size.x, grid.size.x * grid.size.y]);
    let mut slope = 0.0f32;
    for i in 0..grid.distances.len() as u32 {
        for axis in 0..3 {
            if i / steps[axis] % size[axis] + 1 < size[axis] {
                let (d, next) = (grid.distances[i as usize], grid.distances[(i + steps[axis]) as usize]);
                slope = slope.max((d - next).abs() / grid.cell);
            }
        }
    }
    slope
}

fn torus_distance(p: Vec3) -> f32 {
    glam::Vec2::new(p.with_y(0.0).length() - 0.1, p.y).length() - 0.04
}

fn box_distance(p: Vec3) -> f32 {
    let q = p.abs() - Vec3::new(0.1, 0.05, 0.07);
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
}

#[test]
fn fields_match_closed_forms() {
    let sphere = build(&shapes::sphere(0.1, 96), &options(48, 0.03)).unwrap();
    assert_eq!(sphere.size, UVec3::splat(48));
    let off = max_error(&sphere, |p| p.length() - 0.1);
    assert!(off < 1e-4, "{off}");
    // The comparison can fail.
    assert!(max_error(&sphere, |p| p.length() - 0.101) > 5e-4);
    let torus = build(&shapes::torus(0.1, 0.04, 64), &options(64, 0.02)).unwrap();
    let off = max_error(&torus, torus_distance);
    assert!(off < 1e-4, "{off}");
    let cuboid = build(&shapes::cuboid(Vec3::new(0.1, 0.05, 0.07)), &options(50, 0.02)).unwrap();
    let off = max_error(&cuboid, box_distance);
    assert!(off < 1e-5, "{off}");
    for grid in [&sphere, &torus, &cuboid] {
        assert!(isolated(grid, 0.0) == 0 && max_slope(grid) <= 1.001);
    }
}

#[test]
fn inverted_and_duplicate_triangles_give_the_same_field() {
    let mesh = shapes::sphere(0.1, 48);
    let plain = build(&mesh, &options(32, 0.03)).unwrap();
    let inverted = build(&shapes::inverted(mesh.clone()), &options(32, 0.03)).unwrap();
    assert!(plain.distances.iter().zip(&inverted.distances).all(|(a, b)| (a - b).abs() < 1e-6));
    let doubled = build(&TriMesh::merge(&[mesh.clone(), mesh]), &options(32, 0.03)).unwrap();
    assert!(plain.distances.iter().zip(&doubled.distances).all(|(a, b)| (a - b).abs() < 1e-6));
}

/// A sphere of radius 0.1 without the part below y = -0.06.
fn bowl() -> TriMesh {
    let mut mesh = shapes::sphere(0.1, 96);
    mesh.triangles.retain(|t| t.iter().all(|&i| mesh.positions[i as usize].y > -0.06));
    mesh
}

#[test]
fn opening_gets_a_flat_lid() {
    let mesh = bowl();
    let rim = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize].y).fold(1.0, f32::min);
    let grid = build(&mesh, &options(64, 0.03)).unwrap();
    // A sphere cut by a plane: exact on the axis of the lid and in the sphere.
    for (y, expected) in
        [(rim + 0.02, -0.02), (rim + 0.01, -0.01), (rim - 0.01, 0.01), (0.0, rim), (0.09, -0.01)]
    {
        let d = grid.sample(Vec3::new(0.0, y, 0.0));
        assert!((d - expected).abs() < 0.1 * grid.cell.max(expected.abs()), "{y}: {d} {expected}");
    }
    assert!(isolated(&grid, 0.0) == 0 && max_slope(&grid) < 1.3, "{}", max_slope(&grid));
}

#[test]
fn sheets_tubes_and_cavities_are_ignored() {
    let head = shapes::sphere(0.1, 64);
    let head_only = build(&head, &options(64, 0.08)).unwrap();
    let moved = |mut mesh: TriMesh, to: Vec3| {
        mesh.transform(1.0, glam::Quat::IDENTITY, to);
        mesh
    };
    let mut sheet = shapes::cuboid(Vec3::new(0.03, 0.01, 0.03));
    sheet.triangles.truncate(2);
    let parts = [
        head.clone(),
        moved(sheet, Vec3::new(0.0, 0.0, 0.13)),
        moved(shapes::torus(0.02, 0.0004, 12), Vec3::new(0.12, 0.0, 0.0)),
        shapes::inverted(moved(shapes::sphere(0.03, 16), Vec3::new(0.02, 0.0, 0.0))),
        moved(shapes::sphere(0.03, 16), Vec3::new(-0.04, 0.0, 0.0)),
    ];
    let merged = build(&TriMesh::merge(&parts), &options(64, 0.08)).unwrap();
    for i in 0..merged.distances.len() as u32 {
        let p = merged.node(i);
        // The grids differ near the center, where neither resolves the field's sharp minimum, and beyond their borders.
        if !(0.02..0.17).contains(&p.length()) {
            continue;
        }
        assert!(
            (head_only.sample(p) - merged.sample(p)).abs() < 0.3 * head_only.cell,
            "{p} {} {}",
            head_only.sample(p),
            merged.sample(p)
        );
    }
    let hollow = SdfOptions { fills_cavities: false, ..options(64, 0.08) };
    let hollow = build(&TriMesh::merge(&parts), &hollow).unwrap();
    assert!(hollow.sample(Vec3::new(0.02, 0.0, 0.0)) > 0.02);
}

#[test]
fn invalid_meshes_and_options_are_errors() {
    let fails_with = |mesh: &TriMesh, options: &SdfOptions, word: &str| {
        let message = build(mesh, options).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    };
    let mesh = shapes::cuboid(Vec3::splat(0.1));
    fails_with(&mesh, &options(4, 0.1), "resolution");
    fails_with(&mesh, &options(64, f32::NAN), "margin");
    fails_with(&TriMesh::default(), &options(64, 0.1), "no triangles");
    let mut broken = mesh.clone();
    broken.triangles[0][0] = 77;
    fails_with(&broken, &options(64, 0.1), "triangle 0");
    let mut flat = mesh;
    flat.triangles.truncate(2);
    fails_with(&flat, &options(64, 0.1), "encloses no volume");
}

fn load(name: &str, scale: f32) -> Option<TriMesh> {
    let Some(assets) = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from) else {
        let required = std::env::var_os("TRESSES_REQUIRE_ASSETS").is_some_and(|v| v == "1");
        assert!(!required, "TRESSES_ASSETS is not set");
        println!("skipped: TRESSES_ASSETS is not set");
        return None;
    };
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj(assets.join(name), &options).expect(name);
    let meshes: Vec<TriMesh> = models
        .iter()
        .map(|m| TriMesh {
            positions: m.mesh.positions.as_chunks().0.iter().map(|p| Vec3::from_array(*p) * scale).collect(),
            triangles: m.mesh.indices.as_chunks().0.to_vec(),
            ..Default::default()
        })
        .collect();
    Some(TriMesh::merge(&meshes))
}

/// Builds the field of a head, prints its properties, and checks that no node is isolated. Returns `None` without
/// `TRESSES_ASSETS`.
fn build_head(name: &str, scale: f32, resolution: u32) -> Option<(TriMesh, SdfGrid)> {
    let mesh = load(name, scale)?;
    let start = std::time::Instant::now();
    let grid = build(&mesh, &options(resolution, 0.03)).unwrap();
    let time = start.elapsed().as_secs_f32();
    let (lo, hi) = mesh.bounds().unwrap();
    let solid = grid.distances.iter().filter(|d| **d < 0.0).count() as f32 * grid.cell.powi(3);
    println!(
        "{name}: {} triangles, {lo}..{hi}, {} at {} mm in {time:.2} s, {:.2} l, steepest {:.2}, alone {}",
        mesh.triangles.len(),
        grid.size,
        grid.cell * 1e3,
        solid * 1e3,
        max_slope(&grid),
        isolated(&grid, 0.0)
    );
    assert_eq!(isolated(&grid, grid.cell), 0);
    if let Some(folder) = std::env::var_os("TRESSES_SLICES") {
        slices(&grid, &PathBuf::from(folder).join(name.replace('/', "-") + ".png"));
    }
    Some((mesh, grid))
}

/// Writes the three middle slices: blue inside, red outside, one line per centimeter.
fn slices(grid: &SdfGrid, path: &std::path::Path) {
    let n = grid.size.max_element() * 4;
    let mut pixels = vec![0u8; (3 * n * n * 3) as usize];
    let extent = grid.cell * grid.size.max_element() as f32;
    let center = grid.origin + grid.size.as_vec3() * 0.5 * grid.cell;
    for (view, (right, up)) in
        [(Vec3::X, Vec3::Y), (Vec3::Z, Vec3::Y), (Vec3::X, Vec3::Z)].into_iter().enumerate()
    {
        for y in 0..n {
            for x in 0..n {
                let (u, v) = (x as f32 / n as f32 - 0.5, 0.5 - y as f32 / n as f32);
                let d = grid.sample(center + (right * u + up * v) * extent);
                let line = (d.abs() * 100.0).fract() < 0.1;
                let shade = if line { 60 } else { 200 };
                let color = if d.abs() < 0.0008 {
                    [255; 3]
                } else if d < 0.0 {
                    [30, 80, shade]
                } else {
                    [shade, 90, 50]
                };
                let at = ((y * 3 * n + view as u32 * n + x) * 3) as usize;
                pixels[at..at + 3].copy_from_slice(&color);
            }
        }
    }
    let file = std::fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), 3 * n, n);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
}

#[test]
fn real_heads_are_solid() {
    // Two points inside and two outside: brow and neck, in front of the nose and over the shoulder.
    for (name, scale, resolution, inside, outside) in [
        (
            "sintel/sintel.obj",
            1.0,
            64,
            [[0.0, 1.57, 0.0], [0.0, 1.3, 0.0]],
            [[0.0, 1.52, 0.14], [0.12, 1.45, 0.0]],
        ),
        (
            "tressfx2_head/head_max4.obj",
            0.0027,
            96,
            [[0.0, 0.25, 0.0], [0.0, 0.0, -0.02]],
            [[0.0, 0.2, 0.14], [0.15, 0.2, 0.0]],
        ),
        (
            "head_ict_facekit/generic_neutral_mesh.obj",
            0.01,
            96,
            [[0.0, 0.08, 0.0], [0.0, -0.1, 0.0]],
            [[0.0, 0.0, 0.15], [0.11, -0.08, 0.0]],
        ),
    ] {
        let Some((_, grid)) = build_head(name, scale, resolution) else { return };
        for (points, sign) in [(inside, -1.0), (outside, 1.0)] {
            for p in points {
                let d = grid.sample(Vec3::from(p));
                assert!(d * sign > 0.01, "{name} {p:?}: {d}");
            }
        }
        assert!(max_slope(&grid) < 1.5);
    }
}

/// Returns the differences between our field and the reference of another tool within 3 cm of the surface, meters: the
/// median and the 99th percentile.
fn differences(reference: &SdfGrid, step: Vec3, ours: &SdfGrid) -> (f32, f32) {
    let mut errors: Vec<f32> = (0..reference.distances.len() as u32)
        .filter(|&i| reference.distances[i as usize].abs() < 0.03)
        .map(|i| {
            let cell = UVec3::new(i % 64, i / 64 % 64, i / 4096).as_vec3() + 0.5;
            (reference.distances[i as usize] - ours.sample(reference.origin + cell * step)).abs()
        })
        .collect();
    errors.sort_by(f32::total_cmp);
    (errors[errors.len() / 2], errors[errors.len() * 99 / 100])
}

#[test]
fn collider_field_matches_reference_tool() {
    let Some((_, ours)) = build_head("sintel/sintel-collider.obj", 1.0, 64) else { return };
    let path = PathBuf::from(std::env::var_os("TRESSES_ASSETS").unwrap()).join("sintel/sintel-sdf.bin");
    let bytes = std::fs::read(path).unwrap();
    let (head, distances) = bytes.split_at(32);
    assert_eq!(head[..4], 64u32.to_le_bytes());
    let floats =
        |bytes: &[u8]| bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect::<Vec<_>>();
    let bounds = floats(&head[8..]);
    let (lo, hi) = (Vec3::from_slice(&bounds), Vec3::from_slice(&bounds[3..]));
    let reference = SdfGrid { size: UVec3::splat(64), origin: lo, cell: 0.0, distances: floats(distances) };
    // The reference's nodes are the centers of 64 cells per axis.
    let step = (hi - lo) / 64.0;
    let (median, tail) = differences(&reference, step, &ours);
    println!("against the reference: median {} mm, 99 % {} mm", median * 1e3, tail * 1e3);
    assert!(median < 1e-4 && tail < 1e-3);
    // The comparison can fail: for a shift, and for another order of the axes.
    let shifted = SdfGrid { origin: ours.origin + Vec3::X * 0.005, ..ours.clone() };
    assert!(differences(&reference, step, &shifted).0 > 1e-3);
    let transposed_index = |i: usize| (i % 64) * 64 + (i / 64 % 64) + i / 4096 * 4096;
    let transposed = (0..64 * 64 * 64).map(|i| reference.distances[transposed_index(i)]).collect();
    assert!(differences(&SdfGrid { distances: transposed, ..reference }, step, &ours).0 > 1e-3);
}
