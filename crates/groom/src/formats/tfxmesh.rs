//! TressFX's text collision mesh: vertices with normals and bone weights, then triangles.

use glam::Vec3;

use super::{raw::RawMesh, source::Source};
use crate::{
    TriMesh,
    error::{At, Result},
};

/// Reads the whole file and ignores bones.
pub(super) fn read(source: &Source) -> Result<RawMesh> {
    let mut mesh = TriMesh::default();
    let (mut bones, mut vertices, mut triangles) = (0u64, 0u64, 0u64);
    let mut last = 1;
    for entry in source.lines() {
        let (line, text) = entry?;
        let mut words = text.split_ascii_whitespace();
        let Some(first) = words.next().filter(|w| !w.starts_with('#')) else { continue };
        last = line;
        match first {
            "numOfBones" => bones = source.count(line, words.next(), "numOfBones")?,
            "numOfVertices" => vertices = source.count(line, words.next(), "numOfVertices")?,
            "numOfTriangles" => triangles = source.count(line, words.next(), "numOfTriangles")?,
            _ if bones > 0 => bones -= 1,
            _ if vertices > 0 => {
                mesh.positions.push(source.vec3(line, &mut words, "a vertex's")?);
                let normal = source.vec3(line, &mut words, "a normal's")?;
                mesh.normals.push(normal.normalize_or(Vec3::Y));
                vertices -= 1;
            }
            _ if triangles > 0 => {
                let mut corner = || -> Result<u32> {
                    let i = source.count(line, words.next(), "a triangle's vertex")?;
                    if i >= mesh.positions.len() as u64 {
                        let problem =
                            format!("vertex {i} does not exist; there are {}", mesh.positions.len());
                        return Err(source.problem(At::Line(line), problem));
                    }
                    Ok(i as u32)
                };
                let corners = [corner()?, corner()?, corner()?];
                mesh.triangles.push(corners);
                triangles -= 1;
            }
            _ => return Err(source.problem(At::Line(line), "the line belongs to no section")),
        }
    }
    // The counts of a broken file may overflow.
    match bones.saturating_add(vertices).saturating_add(triangles) {
        0 => Ok(RawMesh { mesh, ..RawMesh::default() }),
        missing => {
            Err(source.problem(At::Line(last), format!("the file ends here, {missing} entries too early")))
        }
    }
}
