//! Smooth normals for meshes that have none.

use std::collections::HashMap;

use glam::Vec3;

/// Unit normals, one per vertex: the average of the adjoining triangles, each weighted by its angle
/// there, so that the result does not depend on how a surface is cut into triangles. Vertices at the
/// same place share theirs, whatever the seams.
pub fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut places: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    let place: Vec<u32> = positions
        .iter()
        .map(|p| {
            let next = places.len() as u32;
            // Adding zero turns −0 into 0.
            *places.entry((*p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
        })
        .collect();
    let mut sums = vec![Vec3::ZERO; places.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        for (corner, (here, next, last)) in triangle.iter().zip([(a, b, c), (b, c, a), (c, a, b)]) {
            let angle = (next - here).angle_between(last - here);
            if angle.is_finite() {
                sums[place[*corner as usize] as usize] += normal * angle;
            }
        }
    }
    place.iter().map(|p| sums[*p as usize].normalize_or(Vec3::Y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_of_a_cube_points_along_its_diagonal() {
        // Three faces at the origin's corner, one of them cut in two: area or count would tilt it.
        let p = |x, y, z| Vec3::new(x, y, z);
        let positions =
            vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.), p(0., 1., 1.), p(0., 0., 0.)];
        let triangles = [[0, 1, 3], [5, 2, 1], [0, 3, 4], [0, 4, 2]];
        let normals = smooth_normals(&positions, &triangles);
        let expected = p(-1., -1., -1.).normalize();
        assert!((normals[0].abs() - expected.abs()).length() < 1e-6, "{}", normals[0]);
        assert_eq!(normals[0], normals[5], "the same place, the same normal");
    }
}
