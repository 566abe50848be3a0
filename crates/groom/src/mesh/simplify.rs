//! Levels of detail by edge collapse (Garland and Heckbert 1997, as implemented by meshoptimizer). Unlike merging
//! vertices by position, it keeps borders, folds and thin parts, and opens no holes.

use super::TriMesh;
use meshoptimizer_rs::{
    Attributes, Positions, SimplifyOptions, SimplifySettings, Workspace, simplify_with_attributes,
};

/// A level of detail: fewer triangles over the vertices of a mesh.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshLevel {
    /// Deviation from the mesh's surface, meters, as estimated by the quadric error of the collapsed edges.
    pub stray: f32,
    /// Triangles as in [`TriMesh::triangles`].
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub triangles: Vec<[u32; 3]>,
}

/// Deviations of the levels, meters: from a third of a pixel of a large portrait to one pixel of a head across a room.
const STRAYS: [f32; 6] = [5e-5, 1e-4, 2e-4, 4e-4, 8e-4, 1.6e-3];

/// Maximum triangles of a level as a fraction of the previous level; a level that saves less is not worth its memory.
const FEWER: f32 = 0.8;

/// Weight of a unit of difference between normals, and between colors, in extents of the mesh. These weights keep the
/// shading of lips and eyelids for a tenth more triangles.
const NORMAL: f32 = 0.3;
const COLOR: f32 = 0.3;

impl TriMesh {
    /// Returns levels of ever fewer triangles and ever larger deviation. Returns none for a mesh with corners that do
    /// not exist or positions that are not numbers.
    pub fn levels(&self) -> Vec<MeshLevel> {
        let mut levels: Vec<MeshLevel> = Vec::new();
        for stray in STRAYS {
            let (before, triangles) =
                levels.last().map_or((0.0, &self.triangles), |level| (level.stray, &level.triangles));
            // Each level is simplified from the previous one, so squared deviations add up.
            let Some(fewer) = self.collapsed(triangles, 0, (stray * stray - before * before).sqrt()) else {
                break;
            };
            if (fewer.len() as f32) < FEWER * triangles.len() as f32 {
                levels.push(MeshLevel { stray, triangles: fewer });
            }
        }
        levels
    }

    /// Keeps at most about `count` triangles, those that change the surface least. Returns none for an invalid mesh.
    #[cfg(feature = "cards")]
    pub(crate) fn simplified(&self, count: usize) -> Option<Vec<[u32; 3]>> {
        let (lo, hi) = self.bounds()?;
        self.collapsed(&self.triangles, count, hi.distance(lo))
    }

    /// Collapses edges of `triangles` until `count` are left, or until the surface would move by more than `stray`
    /// meters.
    fn collapsed(&self, triangles: &[[u32; 3]], count: usize, stray: f32) -> Option<Vec<[u32; 3]>> {
        let positions: Vec<[f32; 3]> = self.positions.iter().map(|p| p.to_array()).collect();
        let at = |values: &[glam::Vec3], i: usize| values.get(i).copied().unwrap_or_default().to_array();
        let attributes: Vec<f32> = (0..positions.len())
            .flat_map(|i| [at(&self.normals, i), at(&self.colors, i)])
            .flatten()
            .collect();
        let simplified = simplify_with_attributes(
            triangles.as_flattened(),
            Positions::from_packed(&positions),
            Attributes::from_interleaved(&attributes, positions.len(), 6, 6, 0).ok()?,
            &[NORMAL, NORMAL, NORMAL, COLOR, COLOR, COLOR],
            None,
            SimplifySettings {
                target_index_count: 3 * count,
                target_error: stray,
                options: SimplifyOptions::ERROR_ABSOLUTE,
            },
            &mut Workspace::default(),
        );
        Some(simplified.ok()?.indices.as_chunks().0.to_vec())
    }
}
