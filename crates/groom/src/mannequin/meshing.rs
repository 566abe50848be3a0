//! Conversion of the distance field to triangles and to a grid.

use super::{distance, forms};
use crate::{Progress, SdfGrid, TriMesh};
use fast_surface_nets::{SurfaceNetsBuffer, ndshape::RuntimeShape, ndshape::Shape, surface_nets};
use glam::{Vec3, vec3};

/// Bounding box of the bust with a margin, meters.
const LO: Vec3 = vec3(-0.235, -0.260, -0.155);
const HI: Vec3 = vec3(0.235, 0.240, 0.140);

/// Returns the grid of the field without distances.
pub(super) fn grid(resolution: u32) -> SdfGrid {
    SdfGrid::over(LO, HI, resolution)
}

/// Samples the distance field of the sculpture.
pub(super) async fn measure(resolution: u32, progress: &impl Progress) -> SdfGrid {
    let mut grid = grid(resolution);
    let (row, rows) = (grid.size.x, grid.size.y * grid.size.z);
    for i in 0..rows {
        if i % 16 == 0 {
            progress.step("computing the distance field", i as f32 / rows as f32).await;
        }
        let nodes: Vec<f32> = (i * row..(i + 1) * row).map(|i| distance(grid.node(i))).collect();
        grid.distances.extend(nodes);
    }
    grid
}

/// Returns the nodes of one axis: `cell` apart within 4 cm of `fine`, three times as far beyond 12 cm.
fn nodes(lo: f32, hi: f32, fine: f32, cell: f32) -> Vec<f32> {
    let away = |length: f32| {
        let mut t = 0.0;
        std::iter::from_fn(move || {
            t += cell * (1.0 + 2.0 * forms::step(0.04, 0.12, t));
            Some(t)
        })
        .take_while(move |t| *t < length)
        .chain([length])
    };
    let mut below: Vec<f32> = away(fine - lo).map(|t| fine - t).collect();
    below.reverse();
    below.into_iter().chain([fine]).chain(away(hi - fine).map(|t| fine + t)).collect()
}

/// Nodes along x, y and z and the distances at them. Cells are smallest in the face.
pub(super) struct Lattice {
    axes: [Vec<f32>; 3],
    shape: RuntimeShape<u32, 3>,
    pub distances: Vec<f32>,
}

/// Name of the task for progress reports.
const TASK: &str = "building the head";

/// Cells along the edge of a block, the unit that is skipped far from the surface.
const BLOCK: usize = 6;

impl Lattice {
    async fn new(resolution: u32, progress: &impl Progress) -> Self {
        let mut lattice = Self::empty(resolution);
        lattice.fill(progress).await;
        lattice.close_pinholes();
        lattice
    }

    /// Returns a lattice without distances.
    pub fn empty(resolution: u32) -> Self {
        let cell = 0.30 / resolution.clamp(16, 512) as f32;
        // Lips and lids run horizontally, so rows are closer than columns.
        let axes = [
            nodes(LO.x, HI.x, 0.0, 1.15 * cell),
            nodes(LO.y, HI.y, 0.075, 0.7 * cell),
            nodes(LO.z, HI.z, 0.045, cell),
        ];
        let shape = RuntimeShape::<u32, 3>::new([0, 1, 2].map(|a| axes[a].len() as u32));
        let distances = vec![0.0; axes.iter().map(Vec::len).product()];
        Self { axes, shape, distances }
    }

    /// Returns the indices of the nodes of the left half and of the middle.
    pub fn left_half(&self) -> impl Iterator<Item = usize> + use<> {
        let across = self.axes[0].len();
        (0..self.distances.len()).filter(move |i| i % across <= across / 2)
    }

    /// Sets the distance at a node and at its mirror image.
    pub fn set(&mut self, i: usize, distance: f32) {
        let across = self.axes[0].len();
        let x = i % across;
        self.distances[i] = distance;
        self.distances[i - x + across - 1 - x] = distance;
    }

    /// Returns the lattice with only the signs of the distances.
    pub fn signs(&self) -> Self {
        let distances = self.distances.iter().map(|d| if *d < 0.0 { -1.0 } else { 1.0 }).collect();
        Self { axes: self.axes.clone(), shape: self.shape.clone(), distances }
    }

    /// Returns the surface: one vertex per cell that it passes through, in fractional node coordinates.
    pub fn nets(&self) -> SurfaceNetsBuffer {
        let mut nets = SurfaceNetsBuffer::default();
        let last = self.shape.as_array().map(|n| n - 1);
        surface_nets(&self.distances, &self.shape, [0; 3], last, &mut nets);
        nets
    }

    /// Returns whether a cell is in the left half.
    pub fn is_left(&self, cell: [u32; 3]) -> bool {
        (cell[0] as usize) < self.axes[0].len() / 2
    }

    /// Returns the vertex in the mirror image of this cell.
    pub fn twin(&self, nets: &SurfaceNetsBuffer, [x, y, z]: [u32; 3]) -> usize {
        let across = self.axes[0].len() as u32;
        nets.stride_to_index[self.shape.linearize([across - 2 - x, y, z]) as usize] as usize
    }

    fn at(&self, i: [usize; 3]) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|a| self.axes[a][i[a]]))
    }

    /// Computes the distances at all nodes. A block that is farther from the surface than its own corners gets one
    /// value, because only its sign is used. The right half mirrors the left half.
    async fn fill(&mut self, progress: &impl Progress) {
        let size = [0, 1, 2].map(|a| self.axes[a].len());
        let half = [size[0] / 2 + 1, size[1], size[2]];
        let index = |x: usize, y: usize, z: usize| x + size[0] * (y + size[1] * z);
        for bz in (0..half[2]).step_by(BLOCK) {
            for by in (0..half[1]).step_by(BLOCK) {
                progress.step(TASK, 0.5 * bz as f32 / half[2] as f32).await;
                for bx in (0..half[0]).step_by(BLOCK) {
                    let from = [bx, by, bz];
                    let to = [0, 1, 2].map(|a| (from[a] + BLOCK).min(half[a]) - 1);
                    let (lo, hi) = (self.at(from), self.at(to));
                    let center_distance = distance(0.5 * (lo + hi));
                    let far = center_distance.abs()
                        > 0.75 * (hi - lo).length() + 2.0 * (hi - lo).max_element() / BLOCK as f32;
                    for z in bz..=to[2] {
                        for y in by..=to[1] {
                            for x in bx..=to[0] {
                                let d = if far { center_distance } else { distance(self.at([x, y, z])) };
                                self.distances[index(x, y, z)] = d;
                                self.distances[index(size[0] - 1 - x, y, z)] = d;
                            }
                        }
                    }
                }
            }
        }
    }

    /// Fills gaps that are thinner than a cell. If the corners of a cell's face alternate between inside and outside,
    /// four quads would share one edge.
    fn close_pinholes(&mut self) {
        let size = [0, 1, 2].map(|a| self.axes[a].len());
        let stride = [1, size[0], size[0] * size[1]];
        for _ in 0..8 {
            let mut closed = true;
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                for i in 0..self.distances.len() - stride[a] - stride[b] {
                    let corners = [i, i + stride[a], i + stride[a] + stride[b], i + stride[b]];
                    let inside = corners.map(|c| self.distances[c] < 0.0);
                    if inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1] {
                        corners.iter().for_each(|c| self.distances[*c] = self.distances[*c].min(-1e-5));
                        closed = false;
                    }
                }
            }
            if closed {
                return;
            }
        }
    }

    /// Returns the point at the fractional node coordinates `q`.
    pub fn point(&self, q: [f32; 3]) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|a| {
            let i = (q[a] as usize).min(self.axes[a].len() - 2);
            let (lo, hi) = (self.axes[a][i], self.axes[a][i + 1]);
            lo + (hi - lo) * (q[a] - i as f32)
        }))
    }
}

/// Returns distance and gradient at `p` from the corners of a small tetrahedron about it.
pub(super) fn distance_and_gradient(p: Vec3) -> (f32, Vec3) {
    const H: f32 = 2e-4;
    const CORNERS: [Vec3; 4] =
        [vec3(1.0, -1.0, -1.0), vec3(-1.0, -1.0, 1.0), vec3(-1.0, 1.0, -1.0), vec3(1.0, 1.0, 1.0)];
    let mut sum = (0.0, Vec3::ZERO);
    for corner in CORNERS {
        let d = distance(p + corner * H);
        sum = (sum.0 + d, sum.1 + corner * d);
    }
    (0.25 * sum.0, sum.1 / (4.0 * H))
}

/// Meshes the sculpture. Returns the bust and its lattice.
pub(super) async fn model(resolution: u32, progress: &impl Progress) -> (TriMesh, Lattice) {
    let lattice = Lattice::new(resolution, progress).await;
    let nets = lattice.nets();
    let mut mesh = TriMesh::default();
    for (i, q) in nets.positions.iter().enumerate() {
        if i % 1024 == 0 {
            progress.step(TASK, 0.5 + 0.5 * i as f32 / nets.positions.len() as f32).await;
        }
        // Both halves are computed on the left, so that they are bit-identical mirror images.
        let q = lattice.point(*q);
        let mirror = vec3(if q.x < 0.0 { -1.0 } else { 1.0 }, 1.0, 1.0);
        let mut p = q * mirror;
        let mut normal = Vec3::Y;
        // Naive surface nets leave a vertex slightly off the surface: two Newton steps project it.
        for _ in 0..2 {
            let (d, g) = distance_and_gradient(p);
            p -= g * (d / g.length_squared().max(0.25));
            normal = g.normalize_or(normal);
        }
        mesh.positions.push(p * mirror);
        mesh.normals.push(normal * mirror);
    }
    mesh.triangles = nets.indices.as_chunks().0.to_vec();
    (mesh, lattice)
}
