//! Bodies with fewer triangles, for devices that draw slowly: a software driver computes every corner of
//! every shadow map, and every fragment of what is hidden later.

use std::collections::HashMap;
use tresses::{glam::Vec3, groom::TriMesh};

/// `mesh` with about one vertex per cube of `cell` metres: all vertices in a cube become their mean
/// (Rossignac and Borrel, "Multi-resolution 3D approximations", 1993). Triangles whose corners meet vanish.
/// Works on any mesh, open or not, in one pass; what is thinner than a cube gets lost.
pub fn clustered(mesh: &TriMesh, cell: f32) -> TriMesh {
    let colored = mesh.colors.len() == mesh.positions.len();
    let mut cells = HashMap::new();
    let mut coarse = TriMesh::default();
    let mut counts: Vec<f32> = Vec::new();
    let mut place = Vec::with_capacity(mesh.positions.len());
    for (i, p) in mesh.positions.iter().enumerate() {
        let key = (*p / cell).floor().as_ivec3().to_array();
        let at = *cells.entry(key).or_insert_with(|| {
            coarse.positions.push(Vec3::ZERO);
            coarse.normals.push(Vec3::ZERO);
            if colored {
                coarse.colors.push(Vec3::ZERO);
            }
            counts.push(0.0);
            counts.len() - 1
        });
        coarse.positions[at] += *p;
        coarse.normals[at] += mesh.normals.get(i).copied().unwrap_or(Vec3::ZERO);
        if colored {
            coarse.colors[at] += mesh.colors[i];
        }
        counts[at] += 1.0;
        place.push(at as u32);
    }
    for (at, count) in counts.iter().enumerate() {
        coarse.positions[at] /= *count;
        coarse.normals[at] = coarse.normals[at].normalize_or(Vec3::Y);
        if colored {
            coarse.colors[at] /= *count;
        }
    }
    let moved = mesh.triangles.iter().map(|triangle| triangle.map(|v| place[v as usize]));
    coarse.triangles = moved.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    coarse.triangles.sort_unstable();
    coarse.triangles.dedup();
    coarse
}

/// `mesh` with about `triangles` triangles, or as it is if it has no more.
pub fn with_triangles(mesh: &TriMesh, triangles: usize) -> TriMesh {
    if mesh.triangles.len() <= triangles {
        return mesh.clone();
    }
    let area: f32 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    // A surface meets about 1.5 cubes per area of a cube's face, each with a vertex and so with two triangles.
    clustered(mesh, (3.0 * area / triangles.max(1) as f32).sqrt().max(1e-4))
}

/// Puts the triangles nearest to a far eye in `direction` first, so that hardly anything is shaded that
/// another triangle hides.
pub fn face(mesh: &mut TriMesh, direction: Vec3) {
    let TriMesh { positions, triangles, .. } = mesh;
    let near = |t: &[u32; 3]| t.iter().map(|v| positions[*v as usize].dot(direction)).sum::<f32>();
    triangles.sort_by(|a, b| near(b).total_cmp(&near(a)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::groom::mannequin;

    #[test]
    fn few_triangles_keep_the_form() {
        let fine = mannequin::mesh(48);
        let coarse = with_triangles(&fine, 3000);
        let count = coarse.triangles.len();
        assert!((1500..6000).contains(&count), "{count} of {}", fine.triangles.len());
        assert_eq!(coarse.positions.len(), coarse.normals.len());
        let off = coarse.positions.iter().map(|p| mannequin::distance(*p).abs()).fold(0.0, f32::max);
        assert!(off < 0.006, "{off} m off the surface");
        let facing = |mesh: &TriMesh| {
            let outwards = mesh.triangles.iter().filter(|t| {
                let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
                (b - a).cross(c - a).dot(t.iter().map(|v| mesh.normals[*v as usize]).sum()) > 0.0
            });
            outwards.count() as f32 / mesh.triangles.len() as f32
        };
        assert!(facing(&coarse) > 0.97, "{}", facing(&coarse));
        assert_eq!(with_triangles(&coarse, count), coarse);
    }

    #[test]
    fn colours_are_averaged() {
        let positions = vec![Vec3::ZERO, Vec3::splat(0.01), Vec3::X, Vec3::Y];
        let colors = vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z];
        let triangles = vec![[0, 2, 3], [1, 2, 3], [0, 1, 2]];
        let mesh = TriMesh { normals: vec![Vec3::Z; 4], positions, colors, triangles };
        let coarse = clustered(&mesh, 0.5);
        assert_eq!((coarse.positions.len(), coarse.triangles.len()), (3, 1));
        assert!((coarse.colors[0] - Vec3::new(0.5, 0.5, 0.0)).length() < 1e-6);
    }

    #[test]
    fn the_near_side_comes_first() {
        let mut mesh = mannequin::mesh(24);
        face(&mut mesh, Vec3::Z);
        let z = |t: &[u32; 3]| t.iter().map(|v| mesh.positions[*v as usize].z).sum::<f32>();
        assert!(mesh.triangles.is_sorted_by(|a, b| z(a) >= z(b)));
        face(&mut mesh, Vec3::NEG_Z);
        assert!(mesh.triangles[0].iter().all(|v| mesh.positions[*v as usize].z < 0.0));
    }
}
