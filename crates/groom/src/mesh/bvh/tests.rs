use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::mesh::{shapes, triangle};

fn brute_force(mesh: &TriMesh, p: Vec3) -> f32 {
    let distance =
        |t: &[u32; 3]| triangle::closest_point(p, t.map(|i| mesh.positions[i as usize])).0.distance(p);
    mesh.triangles.iter().map(distance).fold(f32::INFINITY, f32::min)
}

fn exact_winding(mesh: &TriMesh, p: Vec3) -> f32 {
    let angle = |t: &[u32; 3]| triangle::solid_angle(p, t.map(|i| mesh.positions[i as usize])) as f64;
    (mesh.triangles.iter().map(angle).sum::<f64>() / (2.0 * std::f64::consts::TAU)) as f32
}

/// Deterministic points in the cube of half side `r`.
fn probes(r: f32, n: u32) -> impl Iterator<Item = Vec3> {
    // Kronecker sequence of the generalized plastic number: evenly spread without a generator.
    let step = glam::DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478);
    (1..=n).map(move |i| (((step * f64::from(i)).fract() * 2.0 - 1.0) * f64::from(r)).as_vec3())
}

#[test]
fn an_empty_mesh_has_no_nearest_point() {
    let bvh = Bvh::new(&TriMesh::default());
    assert!(bvh.is_empty() && bvh.bounds().is_none());
    assert!(bvh.closest_point(Vec3::ZERO).is_none());
    assert_eq!(bvh.winding_number(Vec3::ZERO), 0.0);
}

#[test]
fn invalid_triangles_are_skipped_and_flat_ones_kept() {
    let mut mesh = shapes::cuboid(Vec3::ONE);
    mesh.positions.push(Vec3::NAN);
    mesh.triangles.extend([[0, 1, 8], [0, 1, 99], [3, 3, 3]]);
    mesh.triangles.extend(std::iter::repeat_n([2, 2, 2], 1000));
    let bvh = Bvh::new(&mesh);
    assert_eq!(bvh.source.len(), 12 + 1 + 1000);
    assert!((bvh.closest_point(Vec3::new(0.0, 3.0, 0.0)).unwrap().distance - 2.0).abs() < 1e-6);
    assert!((bvh.winding_number(Vec3::splat(0.3)) - 1.0).abs() < 1e-3);
    assert!(bvh.closest_point(Vec3::NAN).is_none());
}

#[test]
fn the_radius_limits_the_search() {
    let bvh = Bvh::new(&shapes::sphere(1.0, 16));
    let p = Vec3::new(0.0, 1.5, 0.0);
    assert!(bvh.closest_point_within(p, 0.49).is_none());
    assert_eq!(bvh.closest_point_within(p, 0.51), bvh.closest_point(p));
}

#[test]
fn boxes_contain_triangles_and_depth_is_bounded() {
    let bvh = Bvh::new(&shapes::torus(0.3, 0.1, 40));
    let mut stack = vec![(0u32, 0usize)];
    let mut seen = 0;
    while let Some((at, depth)) = stack.pop() {
        assert!(depth < DEPTH);
        let node = bvh.nodes[at as usize];
        if node.count == 0 {
            stack.extend([(at + 1, depth + 1), (node.first, depth + 1)]);
        }
        for corner in bvh.corners[node.first as usize..][..node.count as usize].iter().flatten() {
            assert!(corner.cmpge(node.lo).all() && corner.cmple(node.hi).all());
            seen += 1;
        }
    }
    assert_eq!(seen, 3 * 2 * 80 * 40);
}

#[test]
fn winding_numbers_match_exact_sum() {
    let (mut worst, mut rough) = (0.0f32, 0.0f32);
    for mesh in [shapes::sphere(1.0, 24), shapes::torus(0.8, 0.3, 24), shapes::cuboid(Vec3::splat(0.7))] {
        let bvh = Bvh::new(&mesh);
        for p in probes(1.5, 2000) {
            let exact = exact_winding(&mesh, p);
            worst = worst.max((bvh.winding_number(p) - exact).abs());
            rough = rough.max((bvh.winding_with(p, 1.5) - exact).abs());
        }
    }
    println!("largest error of the dipoles: {worst}, roughly {rough}");
    assert!(worst < 0.04 && rough < 0.1);
}

#[test]
fn winding_number_of_sphere_inverse_and_hole() {
    let sphere = shapes::sphere(1.0, 32);
    let [outward, inward] = [sphere.clone(), shapes::inverted(sphere.clone())].map(|m| Bvh::new(&m));
    for p in probes(1.4, 1000).filter(|p| (p.length() - 1.0).abs() > 0.02) {
        let inside = if p.length() < 1.0 { 1.0 } else { 0.0 };
        assert!((outward.winding_number(p) - inside).abs() < 0.04, "{p}");
        assert!((inward.winding_number(p) + inside).abs() < 0.04, "{p}");
    }
    // Cut off below y = -0.5: the flat disc there closes the hole.
    let mut cut = sphere;
    cut.triangles.retain(|t| t.iter().all(|&i| cut.positions[i as usize].y > -0.501));
    let rim = cut.triangles.iter().flatten().map(|&i| cut.positions[i as usize].y).fold(1.0, f32::min);
    let bvh = Bvh::new(&cut);
    for (below, inside) in [(-0.1, true), (-0.05, true), (0.05, false), (0.1, false)] {
        for x in [0.0, 0.3, 0.6] {
            let w = bvh.winding_number(Vec3::new(x, rim - below, 0.2));
            assert_eq!(w > 0.5, inside, "{below} {x} {w}");
        }
    }
    assert!((bvh.winding_number(Vec3::new(0.1, rim, 0.2)) - 0.5).abs() < 0.04);
}

#[test]
fn flipped_and_duplicate_triangles_keep_solid_inside() {
    let mut mesh = shapes::sphere(1.0, 24);
    for i in (0..mesh.triangles.len()).step_by(97) {
        mesh.triangles[i].swap(0, 1);
    }
    let doubled: Vec<_> = mesh.triangles[400..600].to_vec();
    mesh.triangles.extend(doubled);
    let bvh = Bvh::new(&mesh);
    for p in probes(1.6, 1000).filter(|p| p.length() < 0.85) {
        assert!(bvh.winding_number(p) > 0.5, "{p}");
    }
    assert!(probes(1.6, 1000).filter(|p| p.length() > 1.3).all(|p| bvh.winding_number(p) < 0.5));
}

fn soup() -> impl Strategy<Value = TriMesh> {
    let point = prop::array::uniform3(-1.0f32..1.0).prop_map(Vec3::from_array);
    (prop::collection::vec(point, 3..60)).prop_flat_map(|positions| {
        let n = positions.len() as u32;
        let triangles = prop::collection::vec(prop::array::uniform3(0..n), 1..120);
        triangles.prop_map(move |triangles| TriMesh {
            positions: positions.clone(),
            triangles,
            ..Default::default()
        })
    })
}

proptest! {
    #[test]
    fn closest_point_matches_brute_force(mesh in soup(), p in prop::array::uniform3(-2.0f32..2.0)) {
        let p = Vec3::from_array(p);
        let bvh = Bvh::new(&mesh);
        let found = bvh.closest_point(p).unwrap();
        let expected = brute_force(&mesh, p);
        prop_assert!((found.distance - expected).abs() <= 1e-6, "{} {}", found.distance, expected);
        let [a, b, c] = mesh.triangles[found.triangle as usize].map(|i| mesh.positions[i as usize]);
        let w = found.barycentric;
        prop_assert!((a * w.x + b * w.y + c * w.z).distance(found.point) < 1e-5);
        prop_assert!(w.min_element() >= 0.0 && (w.element_sum() - 1.0).abs() < 1e-5);
        prop_assert!((found.point.distance(p) - found.distance).abs() < 1e-6);
        let hinted = bvh.nearest(p, f32::INFINITY, Some(bvh.source.len() as u32 / 2), 0.0).unwrap().1;
        prop_assert!((hinted.distance - expected).abs() <= 1e-6);
    }
}

#[test]
fn missing_triangle_changes_closest_point() {
    let mesh = shapes::sphere(1.0, 16);
    let whole = Bvh::new(&mesh);
    let wrong = probes(1.5, 100).filter(|p| {
        let nearest = whole.closest_point(*p).unwrap();
        let mut less = mesh.clone();
        less.triangles.swap_remove(nearest.triangle as usize);
        (Bvh::new(&less).closest_point(*p).unwrap().distance - brute_force(&mesh, *p)).abs() > 1e-6
    });
    assert!(wrong.count() > 50);
}
