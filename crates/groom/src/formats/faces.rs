//! Triangulation of mesh faces.

/// Vertex color where only some parts of a mesh have colors: a neutral skin tone, linear.
pub(crate) const PLAIN: glam::Vec3 = glam::Vec3::new(0.45, 0.32, 0.265);

/// Triangulates faces of `counts` corners each as fans, with the winding of `corners` or, if `reverse_winding`, the
/// opposite one. `corners` are indices of `points` points, the first of which is vertex `base` of the mesh.
#[cfg(any(feature = "alembic", feature = "usd"))]
pub(super) fn fan(
    counts: &[i64],
    corners: &[i64],
    points: usize,
    base: u32,
    reverse_winding: bool,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    if let Some(index) = corners.iter().find(|index| !(0..points as i64).contains(index)) {
        return Err(format!("vertex {index} does not exist; there are {points}"));
    }
    let mut rest = corners;
    for count in counts {
        let split = usize::try_from(*count).ok().and_then(|count| rest.split_at_checked(count));
        let Some((face, more)) = split else {
            return Err(format!("a face has {count} corners, but only {} are left", rest.len()));
        };
        rest = more;
        // Indices are below 2^28.
        let corner = |k: usize| base + face[k] as u32;
        triangles.extend((2..face.len()).map(|k| match reverse_winding {
            false => [corner(0), corner(k - 1), corner(k)],
            true => [corner(0), corner(k), corner(k - 1)],
        }));
    }
    Ok(())
}
