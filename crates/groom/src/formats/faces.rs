//! Faces of meshes as triangles.

/// The body's colour where only some parts of a mesh have one: a neutral skin, linear.
pub(crate) const PLAIN: glam::Vec3 = glam::Vec3::new(0.45, 0.32, 0.265);

/// Faces of `counts` corners each as fans of triangles: counterclockwise as they are listed, or `turned`. `corners`
/// count `points` from 0, which begin at `base` in the mesh.
#[cfg(any(feature = "alembic", feature = "usd"))]
pub(super) fn fan(
    counts: &[i64],
    corners: &[i64],
    points: usize,
    base: u32,
    turned: bool,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    if let Some(index) = corners.iter().find(|index| !(0..points as i64).contains(index)) {
        return Err(format!("vertex {index} does not exist, there are {points}"));
    }
    let mut rest = corners;
    for count in counts {
        let split = usize::try_from(*count).ok().and_then(|count| rest.split_at_checked(count));
        let Some((face, more)) = split else {
            return Err(format!("a face of {count} corners where {} are left", rest.len()));
        };
        rest = more;
        // Below 2^28 in all.
        let corner = |k: usize| base + face[k] as u32;
        triangles.extend((2..face.len()).map(|k| match turned {
            false => [corner(0), corner(k - 1), corner(k)],
            true => [corner(0), corner(k), corner(k - 1)],
        }));
    }
    Ok(())
}
