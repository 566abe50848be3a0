//! Mesh and field of the bust at any resolution; the most used resolutions are stored.

use super::{
    FIELD_RESOLUTION, RESOLUTION,
    cooked::bust,
    meshing::{measure, model},
};
use crate::{Progress, SdfGrid, TriMesh, progress::at_once};

/// Returns the field of the bust on a regular grid: the collider. `resolution` is the number of nodes along the longest
/// axis. The field at [`FIELD_RESOLUTION`] is precomputed.
pub fn sdf(resolution: u32) -> SdfGrid {
    at_once(sdf_with(resolution, &()))
}

/// [`sdf`] that reports to `progress`.
pub async fn sdf_with(resolution: u32, progress: &impl Progress) -> SdfGrid {
    match resolution {
        FIELD_RESOLUTION => bust().field.clone(),
        _ => measure(resolution, progress).await,
    }
}

/// Returns the bust as triangles with smooth normals. `resolution` (clamped to 16…512) is the number of the face's
/// cells per 30 cm; other cells are up to three times wider. The mesh at [`RESOLUTION`] is precomputed.
pub fn mesh(resolution: u32) -> TriMesh {
    at_once(mesh_with(resolution, &()))
}

/// [`mesh`] that reports to `progress`.
pub async fn mesh_with(resolution: u32, progress: &impl Progress) -> TriMesh {
    match resolution {
        RESOLUTION => bust().mesh.clone(),
        _ => model(resolution, progress).await.0,
    }
}
