//! Compares the GPU builder with the CPU builder and with closed forms.

use super::*;
use crate::{Context, gpu::for_tests as context, groom::mesh::shapes};
use std::{path::PathBuf, time::Instant};

/// Difference of two fields on one grid where hair can be, within four cells of the surface: the largest and the 99th
/// percentile of the differences in cells, and the fraction of all nodes that differ in sign by more than half a cell.
#[derive(Debug)]
struct FieldDifference {
    most: f32,
    p99: f32,
    signs: f32,
}

fn differs(a: &SdfGrid, b: &SdfGrid) -> FieldDifference {
    assert_eq!((a.size, a.origin), (b.size, b.origin));
    let pairs = || a.distances.iter().zip(&b.distances).map(|(a, b)| (*a, *b));
    let near = |d: f32| d.abs() < 4.0 * a.cell;
    let mut off: Vec<f32> =
        pairs().filter(|(a, b)| near(*a) || near(*b)).map(|(x, y)| (x - y).abs() / a.cell).collect();
    off.sort_by(f32::total_cmp);
    let turned = pairs().filter(|(x, y)| (*x < 0.0) != (*y < 0.0) && (x - y).abs() > 0.5 * a.cell);
    let signs = turned.count() as f32 / a.distances.len() as f32;
    FieldDifference { most: *off.last().unwrap(), p99: off[off.len() * 99 / 100], signs }
}

fn both(
    context: &Context,
    name: &str,
    mesh: &TriMesh,
    resolution: u32,
) -> (SdfGrid, SdfGrid, FieldDifference) {
    // Only the CPU builder fills cavities.
    let options = SdfOptions { resolution, fills_cavities: false, ..Default::default() };
    let builder = FieldBuilder::new(context);
    let start = Instant::now();
    let ours = pollster::block_on(builder.grid(mesh, &options)).unwrap();
    let gpu_time = start.elapsed();
    let start = Instant::now();
    let reference = sdf::build(mesh, &options).unwrap();
    let d = differs(&ours, &reference);
    println!(
        "{name}, {} triangles, {resolution}: GPU {gpu_time:.0?}, CPU {:.0?}, {d:?}",
        mesh.triangles.len(),
        start.elapsed()
    );
    (ours, reference, d)
}

#[test]
fn sphere_matches_closed_form() {
    let Some(context) = context() else { return };
    for mesh in [shapes::sphere(0.1, 48), shapes::inverted(shapes::sphere(0.1, 48))] {
        let (ours, _, d) = both(context, "sphere", &mesh, 32);
        assert!(d.most < 0.01 && d.signs == 0.0, "{d:?}");
        let exact = |i: usize| ours.node(i as u32).length() - 0.1;
        let off = |by: f32| {
            let off = ours.distances.iter().enumerate().map(|(i, d)| (d - exact(i) - by).abs());
            off.fold(0.0, f32::max)
        };
        assert!(off(0.0) < 2e-4, "{}", off(0.0));
        // The comparison detects a field that is half a millimeter off.
        assert!(off(5e-4) > 4e-4);
        let shifted =
            SdfGrid { distances: ours.distances.iter().map(|d| d + 5e-4).collect(), ..ours.clone() };
        assert!(differs(&shifted, &ours).most > 0.05);
    }
}

/// A sphere without its lowest part, like a head without a body.
fn bowl() -> TriMesh {
    let mut mesh = shapes::sphere(0.1, 48);
    let low = |v: &u32| mesh.positions[*v as usize].y < -0.06;
    mesh.triangles = mesh.triangles.iter().filter(|t| !t.iter().any(low)).copied().collect();
    mesh
}

#[test]
fn open_mesh_is_closed_by_lid() {
    let Some(context) = context() else { return };
    let (ours, _, d) = both(context, "bowl", &bowl(), 48);
    assert!(d.most < 1.5 && d.p99 < 0.5 && d.signs == 0.0, "{d:?}");
    // On the axis, the field passes zero at the height of the rim.
    let (above, below) = (ours.sample(Vec3::Y * -0.05), ours.sample(Vec3::Y * -0.07));
    assert!(above < -0.005 && below > 0.005, "{above} {below}");
    // The comparison detects a missing lid.
    let skin = |i: usize, d: f32| {
        let p = ours.node(i as u32);
        let rim = Vec3::new(p.x, 0.0, p.z).normalize_or(Vec3::X) * 0.08 - Vec3::Y * 0.06;
        let open = if p.y < -0.06 * p.length() / 0.1 { p.distance(rim) } else { (p.length() - 0.1).abs() };
        open.copysign(d)
    };
    let open = ours.distances.iter().enumerate().map(|(i, d)| skin(i, *d)).collect();
    assert!(differs(&SdfGrid { distances: open, ..ours.clone() }, &ours).most > 3.0);
}

#[test]
fn heads_match_cpu_builder() {
    let Some(context) = context() else { return };
    let mannequin = crate::groom::mannequin::mesh(64);
    let (_, _, d) = both(context, "mannequin", &mannequin, 64);
    assert!(d.p99 < 0.1 && d.signs < 1e-4, "{d:?}");
    let Some(assets) = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from).filter(|f| f.is_dir()) else {
        let required = std::env::var_os("TRESSES_REQUIRE_ASSETS").is_some_and(|v| v == "1");
        assert!(!required, "TRESSES_ASSETS names no folder");
        println!("skipped: TRESSES_ASSETS names no folder");
        return;
    };
    for (file, resolution) in [("sintel/sintel.obj", 64), ("tressfx2_head/head_max4.obj", 64)] {
        let (head, _) = crate::groom::import::read_head(&[assets.join(file)], &Default::default()).unwrap();
        let (_, _, d) = both(context, file, &head, resolution);
        assert!(d.p99 < 0.8 && d.signs < 1e-3, "{d:?}");
    }
}
