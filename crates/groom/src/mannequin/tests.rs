use super::*;
use crate::TriMesh;
use std::collections::HashMap;

/// Counts for each edge, from the smaller to the larger index, the triangles that run along it and against it.
fn edges(mesh: &TriMesh) -> HashMap<(u32, u32), (u32, u32)> {
    let mut edges = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let entry: &mut (u32, u32) = edges.entry((*from.min(to), *from.max(to))).or_default();
            if from < to { entry.0 += 1 } else { entry.1 += 1 }
        }
    }
    edges
}

fn is_closed(mesh: &TriMesh) -> bool {
    edges(mesh).values().all(|count| *count == (1, 1))
}

fn volume(mesh: &TriMesh) -> f32 {
    mesh.triangles
        .iter()
        .map(|t| t.map(|i| mesh.positions[i as usize]))
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum()
}

/// The volume that the distance function encloses above the cut of the bust, by sampling a grid of this spacing.
fn inside(spacing: f32) -> f32 {
    let (lo, hi) = mesh(60).bounds().unwrap();
    let cells = ((hi - lo) / spacing).ceil().as_uvec3();
    let cell = |i: u32| glam::uvec3(i % cells.x, i / cells.x % cells.y, i / (cells.x * cells.y));
    let center = |i: u32| lo + (cell(i).as_vec3() + 0.5) * spacing;
    let count = (0..cells.element_product()).filter(|i| distance(center(*i)) < 0.0).count();
    count as f32 * spacing.powi(3)
}

#[test]
fn the_mesh_is_closed_and_faces_outwards() {
    for resolution in [60, 90, 130, RESOLUTION] {
        let mut mesh = mesh(resolution);
        assert!(
            mesh.triangles.len() >= if resolution < 100 { 5_000 } else { 20_000 },
            "{}",
            mesh.triangles.len()
        );
        assert!(is_closed(&mesh), "{resolution}");
        let error = volume(&mesh) / inside(0.004) - 1.0;
        assert!(error.abs() < 0.02, "{resolution}: {error}");
        mesh.triangles.pop();
        assert!(!is_closed(&mesh));
    }
}

#[test]
fn normals_are_unit_and_agree_with_the_triangles() {
    let mesh = mesh(RESOLUTION);
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
    let mut against = 0;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let normal: Vec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
        against += usize::from((b - a).cross(c - a).dot(normal) < 0.0);
    }
    assert!(against * 2000 < mesh.triangles.len(), "{against} of {}", mesh.triangles.len());
}

#[test]
fn vertices_lie_on_surface_and_field_is_a_distance() {
    let mesh = mesh(RESOLUTION);
    let off = mesh.positions.iter().filter(|p| distance(**p).abs() > 5e-5).count();
    assert!(off * 1000 < mesh.positions.len(), "{off} of {}", mesh.positions.len());
    // In creases, where two forms blend, it is shorter than a distance, never longer. Check on the surface and 3 mm
    // outside, where hair lies.
    for above in [0.0, 0.003] {
        let outside = |(p, n): (&Vec3, &Vec3)| {
            let slope = meshing::distance_and_gradient(*p + *n * above).1.length();
            !(0.62..=1.15).contains(&slope)
        };
        let bad = mesh.positions.iter().zip(&mesh.normals).filter(|v| outside(*v)).count();
        assert!(bad * 100 < mesh.positions.len(), "{bad} of {} at {above}", mesh.positions.len());
    }
}

#[test]
fn left_mirrors_right() {
    let mesh = mesh(60);
    let twin = |p: Vec3| mesh.positions.iter().map(|q| q.distance(p)).fold(1.0, f32::min);
    for p in mesh.positions.iter().step_by(29) {
        let gap = twin(Vec3::new(-p.x, p.y, p.z));
        assert!(gap < 1e-4, "{p}: {gap}");
    }
    assert!(twin(vec3(0.1, -0.3, 0.1)) > 1e-4);
    let mean: Vec3 = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len() as f32;
    assert!(mean.x.abs() < 1e-4, "{mean}");
}

#[test]
fn landmarks_lie_on_the_surface() {
    for (name, p) in [
        ("crown", CROWN),
        ("brow", BROW),
        ("eye", EYE),
        ("nose tip", NOSE_TIP),
        ("mouth", MOUTH),
        ("chin", CHIN),
        ("ear", EAR),
        ("ear top", EAR_TOP),
        ("nape", NAPE),
    ] {
        let d = distance(p);
        assert!(d.abs() < 2e-3, "{name}: {d}");
    }
    assert!(distance(SKULL_CENTER) < -0.06 && distance(NECK_JOINT) < -0.03);
}

#[test]
fn head_matches_crown_and_chin() {
    let mesh = mesh(80);
    let (_, hi) = mesh.bounds().unwrap();
    assert!((hi.y - CROWN.y).abs() < 2e-3, "{hi}");
    // Lowest point of the chin: the underside of the surface in front of the neck.
    let chin = mesh.positions.iter().filter(|p| p.z > 0.06 && p.y > -0.05).map(|p| p.y).fold(1.0, f32::min);
    assert!((chin - CHIN.y).abs() < 2e-3, "{chin}");
}

#[test]
fn distant_field_does_not_overshoot() {
    let mesh = mesh(40);
    for i in 0..400 {
        let f = |k: f32| (i as f32 * k).fract() - 0.5;
        let p = vec3(f(0.618_034), f(0.754_878), f(0.569_84));
        let nearest = mesh.positions.iter().map(|q| q.distance(p)).fold(1.0, f32::min);
        let d = distance(p).abs();
        assert!(d < nearest * 1.2 + 0.004, "{p}: {d} but {nearest}");
    }
}

#[test]
fn the_grid_follows_the_field() {
    let grid = sdf(64);
    for p in [CROWN, BROW, NAPE, CHIN] {
        assert!(grid.sample(p).abs() < 4e-3, "{p}");
    }
    assert!(grid.sample(SKULL_CENTER) < -0.06);
}

#[test]
fn scalp_points_lie_on_the_surface() {
    for i in 0..500 {
        let y = 1.0 - i as f32 / 500.0;
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        let r = (1.0 - y * y).sqrt();
        let direction = vec3(r * sin, y, r * cos);
        let Some((p, n)) = scalp_point(direction) else { panic!("no scalp along {direction}") };
        assert!(distance(p).abs() < 1e-4, "{p}");
        assert!((n.length() - 1.0).abs() < 1e-4 && n.dot(direction) > 0.5, "{n}");
        assert!((p - SKULL_CENTER).normalize().dot(direction) > 0.9999);
    }
    assert!(scalp_point(Vec3::ZERO).is_none());
    assert!(scalp_point(Vec3::splat(f32::NAN)).is_none());
    assert!(scalp_point(Vec3::NEG_Y).is_none(), "the neck is there");
    assert!(scalp_point(EAR - SKULL_CENTER).is_none(), "the ear is there");
}
