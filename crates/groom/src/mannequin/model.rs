//! The bust's mesh and field at any resolution; the most used ones are stored.

use super::{
    FIELD_RESOLUTION, RESOLUTION,
    cooked::bust,
    meshing::{measure, model},
};
use crate::{Progress, SdfGrid, TriMesh, progress::at_once};

/// The bust's field on a regular grid: the collider. `resolution` is the number of nodes along the
/// longest axis; that of [`FIELD_RESOLUTION`] comes cooked.
pub fn sdf(resolution: u32) -> SdfGrid {
    at_once(sdf_with(resolution, &()))
}

/// The same, telling `progress`.
pub async fn sdf_with(resolution: u32, progress: &impl Progress) -> SdfGrid {
    match resolution {
        FIELD_RESOLUTION => bust().field.clone(),
        _ => measure(resolution, progress).await,
    }
}

/// The bust as triangles with smooth normals. `resolution` (clamped to 16…512) is how many of the face's
/// cells make 30 cm; elsewhere cells are up to three times wider. That of [`RESOLUTION`] comes cooked.
pub fn mesh(resolution: u32) -> TriMesh {
    at_once(mesh_with(resolution, &()))
}

/// The same, telling `progress`.
pub async fn mesh_with(resolution: u32, progress: &impl Progress) -> TriMesh {
    match resolution {
        RESOLUTION => bust().mesh.clone(),
        _ => model(resolution, progress).await.0,
    }
}
