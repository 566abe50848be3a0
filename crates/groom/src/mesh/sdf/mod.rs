//! Signed distance fields of meshes as artists make them: open at the neck, with eyes, teeth, lashes and clothes as
//! separate and partly overlapping pieces.
//!
//! The winding number decides what is solid (see [`Bvh::winding_number`]). It is 1 inside a closed outward mesh, 0
//! outside, and passes 0.5 on the lid that closes a hole. Distances are measured to the boundary of the *solid*, not to
//! every triangle:
//!
//! - An opening, such as the neck, is closed by the surface where the winding number is 0.5: a flat lid for a flat rim.
//!   The field crosses zero there like everywhere else.
//! - A sheet in the air (a strip of lashes, a flat collar) has air on both sides and is no obstacle. A sheet that
//!   encloses more than half of the directions seen from within, such as a cap or a jacket, is a solid closed by a lid.
//! - Triangles inside the solid (overlapping parts, sockets) are ignored, and so are cavities that no air reaches:
//!   inside a head, distances are measured to the skin.
//! - Solids that the grid cannot resolve, thinner than about a cell, are dropped.
//! - A mesh that is inside out as a whole is flipped first.
//!
//! Flood filling from outside, the usual way to find signs, leaks through the first hole. The parity of ray crossings
//! makes speckles behind every hole.

mod caps;
mod signs;
mod skin;
#[cfg(test)]
mod tests;

use glam::{UVec3, Vec3};

use super::{Bvh, TriMesh};
use crate::SdfGrid;
use crate::{
    Error, Progress, Result,
    progress::{at_once, threads},
};

/// Options for the distance field of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct SdfOptions {
    /// Nodes along the longest axis, 8 to 512.
    pub resolution: u32,
    /// Margin of the grid around the mesh, meters.
    pub margin: f32,
    /// Minimum mean thickness of closed pieces (twice the volume divided by the surface), meters. Thinner ones, such as
    /// tubes of lashes, brows and threads, are dropped.
    pub thinnest: f32,
    /// Whether air that does not reach the border of the grid (closed mouths, nostrils behind sealed lips) becomes
    /// solid. A gap that the grid resolves keeps a cavity open.
    pub fills_cavities: bool,
}

impl Default for SdfOptions {
    fn default() -> Self {
        Self { resolution: 96, margin: 0.03, thinnest: 0.001, fills_cavities: true }
    }
}

/// Builds the distance field of `mesh`, in its space.
///
/// # Errors
/// [`Error::Unusable`] for an invalid mesh (see [`TriMesh::validate`]) or one that encloses nothing that the grid
/// resolves; [`Error::Parameter`] for an option out of range.
pub fn build(mesh: &TriMesh, options: &SdfOptions) -> Result<SdfGrid> {
    at_once(build_with(mesh, options, &()))
}

/// [`build`] that reports to `progress`.
///
/// # Errors
/// As [`build`].
pub async fn build_with(mesh: &TriMesh, options: &SdfOptions, progress: &impl Progress) -> Result<SdfGrid> {
    progress.step(TASK, 0.0).await;
    let (mesh, mut grid, inverted) = prepare(mesh, options)?;
    let bvh = Bvh::new(&mesh);
    let field = Winding { bvh: &bvh, sign: if inverted { -1.0 } else { 1.0 } };
    let solid = signs::solid(&grid, &field, options.fills_cavities, progress).await;
    if !solid.contains(&true) {
        return Err(Error::Unusable(NOTHING.into()));
    }
    let skin = Bvh::new(&skin::boundary(&mesh, &grid, &field, &solid, progress).await);
    let mut distances = unsigned(&grid, &skin, progress).await;
    progress.step(TASK, 0.95).await;
    caps::close(&grid, &field, &solid, &mut distances);
    grid.distances = distances.iter().zip(&solid).map(|(d, s)| if *s { -d } else { *d }).collect();
    Ok(grid)
}

/// Name of the task for progress reports. The fractions suit a typical head.
const TASK: &str = "computing the distance field";

/// Error for a mesh whose field is nowhere negative.
pub const NOTHING: &str = "the mesh encloses no volume that the distance field can resolve: it is flat or too thin, or its triangles face both ways";

/// Returns the pieces of `mesh` to measure, the grid for them without distances, and whether the mesh is inside out.
/// Other builders, such as the one on the GPU, start from here.
///
/// # Errors
/// As [`build`].
pub fn prepare(mesh: &TriMesh, options: &SdfOptions) -> Result<(TriMesh, SdfGrid, bool)> {
    mesh.validate()?;
    check(options)?;
    let (mesh, inverted) = body(mesh, options.thinnest);
    let corners = mesh.triangles.iter().flatten().map(|v| mesh.positions[*v as usize]);
    let bounds = corners.fold(None, |bounds, p| {
        let (lo, hi) = bounds.unwrap_or((p, p));
        Some((p.min(lo), p.max(hi)))
    });
    let Some((lo, hi)) = bounds else {
        return Err(Error::Unusable("the mesh has no triangles, so it has no distance field".into()));
    };
    let grid = frame(lo - options.margin, hi + options.margin, options.resolution);
    Ok((mesh, grid, inverted))
}

fn check(options: &SdfOptions) -> Result<()> {
    let bad = |name, value: String, range| Err(Error::Parameter { name, value, range });
    if !(8..=512).contains(&options.resolution) {
        return bad("the distance field's resolution", options.resolution.to_string(), "8 to 512");
    }
    for (name, value) in [
        ("the distance field's margin", options.margin),
        ("the minimum thickness of a piece", options.thinnest),
    ] {
        if !(0.0..=f32::MAX).contains(&value) {
            return bad(name, value.to_string(), "0 or more and finite");
        }
    }
    Ok(())
}

/// Returns the mesh without the pieces that are too thin, and whether the rest is inside out.
fn body(mesh: &TriMesh, thinnest: f32) -> (TriMesh, bool) {
    let mut kept = TriMesh { positions: mesh.positions.clone(), ..Default::default() };
    for (i, part) in mesh.parts().iter().enumerate() {
        // Keep the largest piece, which is the body, however thin.
        if i == 0 || !part.closed || part.thickness() >= thinnest {
            kept.triangles.extend(part.triangles.iter().map(|&t| mesh.triangles[t as usize]));
        }
    }
    let (lo, hi) = mesh.bounds().unwrap_or_default();
    let center = 0.5 * (lo + hi).as_dvec3();
    let volume = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3() - center);
        a.dot(b.cross(c))
    };
    let inverted = kept.triangles.iter().map(volume).sum::<f64>() < 0.0;
    (kept, inverted)
}

/// Returns a grid without distances over at least `lo..hi`.
fn frame(lo: Vec3, hi: Vec3, resolution: u32) -> SdfGrid {
    let cell = ((hi - lo).max_element() / (resolution - 1) as f32).max(f32::MIN_POSITIVE);
    // Subtract a little before rounding up: rounding errors must not add a node to the longest axis.
    let size = ((hi - lo) / cell - 1e-3).ceil().as_uvec3() + UVec3::ONE;
    SdfGrid { size: size.max(UVec3::splat(2)), origin: lo, cell, distances: Vec::new() }
}

/// Winding number of a mesh, negated if the mesh is inside out.
struct Winding<'a> {
    bvh: &'a Bvh,
    sign: f32,
}

/// Distance, in radii of a node, beyond which the first estimate approximates the node, and the maximum error of that
/// estimate (see the tests of the tree).
const ROUGH: f32 = 1.5;
const ROUGH_ERROR: f32 = 0.1;

impl Winding<'_> {
    /// Returns the winding number at `p` within [`ROUGH_ERROR`], and more precisely near 0.5.
    fn at(&self, p: Vec3) -> f32 {
        let rough = self.sign * self.bvh.winding_with(p, ROUGH);
        let clear = (rough - 0.5).abs() > 1.5 * ROUGH_ERROR;
        if clear { rough } else { self.precise(p) }
    }

    fn precise(&self, p: Vec3) -> f32 {
        self.sign * self.bvh.winding_number(p)
    }
}

/// Returns the distance from every node to `skin`, infinite without triangles. Each search starts from the triangle of
/// the neighboring node, which is nearly always within a few of the right one, except for the first node of a layer.
/// Layers are measured in parallel; the result is bit-identical for any number of threads.
async fn unsigned(grid: &SdfGrid, skin: &Bvh, progress: &impl Progress) -> Vec<f32> {
    let [nx, ny, nz] = grid.size.to_array();
    let mut distances = vec![f32::INFINITY; (nx * ny * nz) as usize];
    let mut layers: Vec<(u32, &mut [f32])> = (0..).zip(distances.chunks_mut((nx * ny) as usize)).collect();
    let threads = threads();
    // Measure some layers at a time, so that a listener gets its turn.
    for batch in layers.chunks_mut(4 * threads) {
        progress.step(TASK, 0.6 + 0.3 * batch[0].0 as f32 / nz as f32).await;
        if threads == 1 {
            batch.iter_mut().for_each(|(z, layer)| measure(grid, skin, *z, layer));
            continue;
        }
        std::thread::scope(|scope| {
            for part in batch.chunks_mut(batch.len().div_ceil(threads)) {
                scope.spawn(|| part.iter_mut().for_each(|(z, layer)| measure(grid, skin, *z, layer)));
            }
        });
    }
    distances
}

/// Measures the distances of the nodes of layer `z`.
fn measure(grid: &SdfGrid, skin: &Bvh, z: u32, layer: &mut [f32]) {
    let [nx, ny, _] = grid.size.to_array();
    let mut row_hint = None;
    for (y, row) in (0..).zip(layer.chunks_mut(nx as usize)) {
        let mut hint = row_hint;
        for (x, distance) in (0..).zip(row) {
            let found = skin.nearest(grid.node(nx * (ny * z + y) + x), f32::INFINITY, hint, 0.0);
            hint = found.map(|(slot, _)| slot);
            if x == 0 {
                row_hint = hint;
            }
            if let Some((_, closest)) = found {
                *distance = closest.distance;
            }
        }
    }
}
