//! Meshes with fewer triangles, by collapsing edges (Garland and Heckbert 1997, as meshoptimizer has it): unlike
//! vertices that are merged by where they lie, that keeps borders, folds and thin parts, and opens no holes.

use super::TriMesh;
use meshoptimizer_rs::{
    Attributes, Positions, SimplifyOptions, SimplifySettings, Workspace, simplify_with_attributes,
};

/// Fewer triangles between the vertices of a mesh.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Level {
    /// How far the surface is from the mesh's, as the sums of squares tell that chose the edges, metres.
    pub stray: f32,
    /// As [`TriMesh::triangles`].
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub triangles: Vec<[u32; 3]>,
}

/// How far the levels stray, metres: from a third of a pixel of a large portrait to one of a head across a room.
const STRAYS: [f32; 6] = [5e-5, 1e-4, 2e-4, 4e-4, 8e-4, 1.6e-3];

/// A level has at most this share of the triangles of the one before; what saves less is not worth its memory.
const FEWER: f32 = 0.8;

/// What a unit of difference between normals, and between colours, counts for, in extents of the mesh: it keeps the shading of
/// lips and eyelids for a tenth more triangles.
const NORMAL: f32 = 0.3;
const COLOR: f32 = 0.3;

impl TriMesh {
    /// Ever fewer triangles that stray ever further; none for a mesh that says nothing of its shape, with corners that do
    /// not exist or that are no numbers.
    pub fn levels(&self) -> Vec<Level> {
        let mut levels: Vec<Level> = Vec::new();
        for stray in STRAYS {
            let (before, triangles) =
                levels.last().map_or((0.0, &self.triangles), |level| (level.stray, &level.triangles));
            // Each level is made of the one before: squares add up.
            let Some(fewer) = self.collapsed(triangles, (stray * stray - before * before).sqrt()) else {
                break;
            };
            if (fewer.len() as f32) < FEWER * triangles.len() as f32 {
                levels.push(Level { stray, triangles: fewer });
            }
        }
        levels
    }

    /// `triangles` with as many edges collapsed as the surface allows that moves by `stray` metres at most.
    fn collapsed(&self, triangles: &[[u32; 3]], stray: f32) -> Option<Vec<[u32; 3]>> {
        let positions: Vec<[f32; 3]> = self.positions.iter().map(|p| p.to_array()).collect();
        let at = |values: &[glam::Vec3], i: usize| values.get(i).copied().unwrap_or_default().to_array();
        let attributes: Vec<f32> = (0..positions.len())
            .flat_map(|i| [at(&self.normals, i), at(&self.colors, i)])
            .flatten()
            .collect();
        let made = simplify_with_attributes(
            triangles.as_flattened(),
            Positions::from_packed(&positions),
            Attributes::from_interleaved(&attributes, positions.len(), 6, 6, 0).ok()?,
            &[NORMAL, NORMAL, NORMAL, COLOR, COLOR, COLOR],
            None,
            SimplifySettings {
                target_index_count: 0,
                target_error: stray,
                options: SimplifyOptions::ERROR_ABSOLUTE,
            },
            &mut Workspace::default(),
        );
        Some(made.ok()?.indices.as_chunks().0.to_vec())
    }
}
