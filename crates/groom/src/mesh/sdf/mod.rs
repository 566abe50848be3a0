//! The signed distance field of any mesh, as artists make them: open at the neck, with eyes, teeth, lashes
//! and clothes as separate and partly overlapping pieces.
//!
//! What is solid is decided by the winding number (see [`Bvh::winding_number`]), which is 1 inside a closed
//! outward mesh, 0 outside, and passes 0.5 on the lid that closes a hole. Distances are then those to the
//! *solid's* boundary, not to every triangle:
//!
//! - An opening, such as the neck's, is closed by the surface where the winding number is 0.5: a flat lid
//!   for a flat rim. The field passes zero there like everywhere else.
//! - A sheet in the air (a strip of lashes, a flat collar) has air on both sides and is no obstacle. A
//!   sheet that encloses more than half of the directions seen from within, a cap or a jacket, is the solid
//!   under it, closed by a lid.
//! - Triangles inside the solid (overlapping parts, sockets) do not matter, nor do cavities that no air
//!   reaches: inside a head the distance is that to the skin.
//! - Solids that the grid cannot resolve, thinner than about a cell, are left out.
//! - A mesh that is inside out as a whole is flipped first.
//!
//! Flood filling from outside, the usual way to find signs, leaks through the first hole; the parity of ray
//! crosses makes speckles behind every one.

mod lids;
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

/// How to make a distance field of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct SdfOptions {
    /// Nodes along the longest axis, 8 to 512.
    pub resolution: u32,
    /// How far the grid reaches beyond the mesh, metres.
    pub margin: f32,
    /// Closed pieces whose mean thickness (twice the volume by the surface) is less, metres, are left
    /// out: tubes of lashes, brows, threads.
    pub thinnest: f32,
    /// Whether air that does not reach the border of the grid (closed mouths, nostrils behind sealed
    /// lips) becomes solid. A gap as wide as the grid shows keeps a cavity open.
    pub fill_cavities: bool,
}

impl Default for SdfOptions {
    fn default() -> Self {
        Self { resolution: 96, margin: 0.03, thinnest: 0.001, fill_cavities: true }
    }
}

/// The field of `mesh`, in its space. Fails if the mesh is broken (see [`TriMesh::validate`]), an option
/// is out of range, or the mesh encloses nothing that the grid could show.
pub fn build(mesh: &TriMesh, options: &SdfOptions) -> Result<SdfGrid> {
    at_once(build_with(mesh, options, &()))
}

/// The same, telling `progress`.
///
/// # Errors
/// As [`build`].
pub async fn build_with(mesh: &TriMesh, options: &SdfOptions, progress: &impl Progress) -> Result<SdfGrid> {
    progress.step(TASK, 0.0).await;
    let (mesh, mut grid, inverted) = prepare(mesh, options)?;
    let bvh = Bvh::new(&mesh);
    let field = Winding { bvh: &bvh, sign: if inverted { -1.0 } else { 1.0 } };
    let solid = signs::solid(&grid, &field, options.fill_cavities, progress).await;
    if !solid.contains(&true) {
        return Err(Error::Unusable(NOTHING.into()));
    }
    let skin = Bvh::new(&skin::boundary(&mesh, &grid, &field, &solid, progress).await);
    let mut distances = unsigned(&grid, &skin, progress).await;
    progress.step(TASK, 0.95).await;
    lids::close(&grid, &field, &solid, &mut distances);
    grid.distances = distances.iter().zip(&solid).map(|(d, s)| if *s { -d } else { *d }).collect();
    Ok(grid)
}

/// What takes long; the shares of its parts are those of a head.
const TASK: &str = "measuring the head";

/// What is wrong with a mesh whose field is nowhere negative.
pub const NOTHING: &str = "the mesh encloses nothing that its distance field could show: it is flat or too thin, or its triangles face both ways";

/// What of `mesh` is to be measured, the grid for it without distances, and whether it is inside out: where
/// another builder, as the one on the GPU, begins.
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
        return Err(Error::Unusable("the mesh has no triangles to make a distance field of".into()));
    };
    let grid = frame(lo - options.margin, hi + options.margin, options.resolution);
    Ok((mesh, grid, inverted))
}

fn check(options: &SdfOptions) -> Result<()> {
    let bad = |name, value: String, range| Err(Error::Parameter { name, value, range });
    if !(8..=512).contains(&options.resolution) {
        return bad("the distance field's resolution", options.resolution.to_string(), "8 to 512");
    }
    for (name, value) in
        [("the distance field's margin", options.margin), ("the thinnest piece", options.thinnest)]
    {
        if !(0.0..=f32::MAX).contains(&value) {
            return bad(name, value.to_string(), "0 or more and finite");
        }
    }
    Ok(())
}

/// The mesh without the pieces too thin to matter, and whether what is left is inside out.
fn body(mesh: &TriMesh, thinnest: f32) -> (TriMesh, bool) {
    let mut kept = TriMesh { positions: mesh.positions.clone(), ..Default::default() };
    for (i, part) in mesh.parts().iter().enumerate() {
        // The largest piece is the body, however thin.
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

/// A grid without distances over at least `lo..hi`.
fn frame(lo: Vec3, hi: Vec3, resolution: u32) -> SdfGrid {
    let cell = ((hi - lo).max_element() / (resolution - 1) as f32).max(f32::MIN_POSITIVE);
    // A little less before rounding up: the longest axis must not gain a node by rounding errors.
    let size = ((hi - lo) / cell - 1e-3).ceil().as_uvec3() + UVec3::ONE;
    SdfGrid { size: size.max(UVec3::splat(2)), origin: lo, cell, distances: Vec::new() }
}

/// The winding number of a mesh, turned if the mesh is inside out.
struct Winding<'a> {
    bvh: &'a Bvh,
    sign: f32,
}

/// How near to a node, in its radii, the first estimate stops looking into it, and how far off that
/// estimate may be (see the tests of the tree).
const ROUGH: f32 = 1.5;
const ROUGH_ERROR: f32 = 0.1;

impl Winding<'_> {
    /// The winding number at `p`, within [`ROUGH_ERROR`], and more precise where it decides.
    fn at(&self, p: Vec3) -> f32 {
        let rough = self.sign * self.bvh.winding_with(p, ROUGH);
        let clear = (rough - 0.5).abs() > 1.5 * ROUGH_ERROR;
        if clear { rough } else { self.precise(p) }
    }

    fn precise(&self, p: Vec3) -> f32 {
        self.sign * self.bvh.winding_number(p)
    }
}

/// The distance from every node to `skin`, infinite without triangles. Each search starts from the triangle its neighbour
/// found, which is nearly always within a few of the right one, but for the first of a layer: layers are measured by as
/// many threads as there are, and are the same to the bit by any number of them.
async fn unsigned(grid: &SdfGrid, skin: &Bvh, progress: &impl Progress) -> Vec<f32> {
    let [nx, ny, nz] = grid.size.to_array();
    let mut distances = vec![f32::INFINITY; (nx * ny * nz) as usize];
    let mut layers: Vec<(u32, &mut [f32])> = (0..).zip(distances.chunks_mut((nx * ny) as usize)).collect();
    let threads = threads();
    // Some layers at a time, so that a listener gets its turn.
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

/// The distances of the nodes of layer `z`.
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
