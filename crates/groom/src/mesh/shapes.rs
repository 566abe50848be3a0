//! Closed shapes with known distances, for tests of fields and trees.

use std::f32::consts::TAU;

use glam::Vec3;

use super::TriMesh;

/// Returns a mesh over an `m` by `n` lattice, `at(u, v)` with both in `0..1`, closed along the axes that `wrap`
/// selects.
fn lattice(m: u32, n: u32, wrap: [bool; 2], at: impl Fn(f32, f32) -> Vec3) -> TriMesh {
    let (columns, rows) = (m + u32::from(!wrap[0]), n + u32::from(!wrap[1]));
    let mut mesh = TriMesh::default();
    for j in 0..rows {
        for i in 0..columns {
            mesh.positions.push(at(i as f32 / m as f32, j as f32 / n as f32));
        }
    }
    for j in 0..n {
        for i in 0..m {
            let index = |i: u32, j: u32| (j % rows) * columns + i % columns;
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Returns a sphere about the origin, `n` rows of latitude, with poles of triangles without area.
pub fn sphere(radius: f32, n: u32) -> TriMesh {
    lattice(2 * n, n, [true, false], |u, v| {
        // The poles must be exact points, or the mesh is not closed.
        let ring = if v == 0.0 || v == 1.0 { 0.0 } else { (v * TAU * 0.5).sin() };
        let (s, c) = (u * TAU).sin_cos();
        radius * Vec3::new(s * ring, -(v * TAU * 0.5).cos(), c * ring)
    })
}

/// Returns a torus about the origin around y.
pub fn torus(major: f32, minor: f32, n: u32) -> TriMesh {
    lattice(2 * n, n, [true, true], |u, v| {
        let ((s, c), (sv, cv)) = ((u * TAU).sin_cos(), (v * TAU).sin_cos());
        Vec3::new(s * (major + minor * cv), minor * sv, c * (major + minor * cv))
    })
}

/// Returns a box about the origin.
pub fn cuboid(half: Vec3) -> TriMesh {
    let corner = |i: u32| {
        let sign = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
        half * Vec3::new(sign(1), sign(2), sign(4))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    TriMesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Default::default()
    }
}

/// Returns the mesh with flipped triangles.
pub fn inverted(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}
