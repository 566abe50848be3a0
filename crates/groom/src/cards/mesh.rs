//! Meshes of cards.

use super::{
    atlas::Rect,
    ribbon::{ROWS, Ribbon},
    volume::HairVolume,
};
use crate::SdfGrid;
use glam::{Vec2, Vec3};
use std::collections::BinaryHeap;

/// Distance from the head within which the first row moves to the skin, meters.
const ROOT: f32 = 0.01;
/// Share of the hair's volume, against the card, in a normal: locks are shaded as parts of a mass of hair.
const VOLUME: f32 = 0.7;
/// Least cosine between the normals of a vertex and of its triangles.
const FRONT: f32 = 0.2;
/// Least distance of cards from the head, meters.
const CLEAR: f32 = 0.0005;
/// Vertices and triangles of all cards of a level, card after card, row after row from the root.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardMesh {
    /// Positions, meters.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Unit vectors across the strands, orthogonal to the normals.
    pub tangents: Vec<Vec3>,
    /// Texture coordinates, from the top left.
    pub uvs: Vec<Vec2>,
    /// Light from all around that reaches the vertex, 0 to 1.
    pub light: Vec<f32>,
    /// Root of the hair at each vertex, meters.
    pub roots: Vec<Vec3>,
    /// Distance of each vertex from the root along the hair, meters.
    pub along: Vec<f32>,
    /// First vertex of each card, which is at its root; none for a helmet.
    pub starts: Vec<u32>,
    /// Vertex indices. Fronts are counterclockwise; backs are visible as well.
    pub triangles: Vec<[u32; 3]>,
}

/// Textured triangles.
pub(super) struct Surface<'a> {
    pub(super) positions: &'a [Vec3],
    pub(super) uvs: &'a [Vec2],
    pub(super) triangles: &'a [[u32; 3]],
}

/// A card before it has triangles.
pub(super) struct Plan<'a> {
    pub(super) ribbon: &'a Ribbon,
    /// Columns of vertices, 2 or 3.
    columns: usize,
    /// Rows of the ribbon that have vertices.
    rows: Vec<usize>,
}

/// A way to refine a card, by the error that it removes.
#[derive(PartialEq)]
struct Refinement {
    error: f32,
    card: usize,
    /// Rows of a stretch to divide; without, a column in the middle.
    stretch: Option<[usize; 2]>,
}

impl Eq for Refinement {}

impl PartialOrd for Refinement {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Refinement {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let order = self.error.total_cmp(&other.error);
        order.then(other.card.cmp(&self.card)).then(other.stretch.cmp(&self.stretch))
    }
}

/// Distributes at most `triangles` among cards: rows and columns where cards bend most.
pub(super) fn plan<'a>(ribbons: impl IntoIterator<Item = &'a Ribbon>, triangles: usize) -> Vec<Plan<'a>> {
    let start = |ribbon| Plan { ribbon, columns: 2, rows: vec![0, ROWS - 1] };
    let mut plans: Vec<Plan<'a>> = ribbons.into_iter().map(start).collect();
    let mut used = 2 * plans.len();
    let mut heap = BinaryHeap::new();
    for (card, plan) in plans.iter().enumerate() {
        heap.extend(stretch(plan.ribbon, card, 0, ROWS - 1));
        heap.extend(column(plan.ribbon, card));
    }
    while let Some(Refinement { card, stretch: rows, .. }) = heap.pop() {
        let plan = &mut plans[card];
        let cost = match rows {
            Some(_) => 2 * (plan.columns - 1),
            None => 2 * (plan.rows.len() - 1),
        };
        if used + cost > triangles {
            continue;
        }
        used += cost;
        match rows {
            None => plan.columns = 3,
            Some([row, next]) => {
                let midpoint = (row + next) / 2;
                let index = plan.rows.partition_point(|k| *k < midpoint);
                plan.rows.insert(index, midpoint);
                heap.extend(stretch(plan.ribbon, card, row, midpoint));
                heap.extend(stretch(plan.ribbon, card, midpoint, next));
            }
        }
    }
    plans
}

fn row_fraction(row: usize) -> f32 {
    row as f32 / (ROWS - 1) as f32
}

/// Returns the refinement of the stretch between two rows, if it can be divided and is not straight.
fn stretch(ribbon: &Ribbon, card: usize, row: usize, next: usize) -> Option<Refinement> {
    if next < row + 2 {
        return None;
    }
    let (a, b) = (ribbon.row(row_fraction(row)), ribbon.row(row_fraction(next)));
    let mut error = 0.0f32;
    for k in row + 1..next {
        let t = (k - row) as f32 / (next - row) as f32;
        let actual_row = ribbon.row(row_fraction(k));
        for across in [-1.0, 0.0, 1.0] {
            let line = a.point(across).lerp(b.point(across), t);
            error = error.max(actual_row.point(across).distance(line));
        }
    }
    let error = error * ribbon.length * row_fraction(next - row);
    (error > 1e-9).then_some(Refinement { error, card, stretch: Some([row, next]) })
}

/// Returns the refinement by a column in the middle, if the card bends across.
fn column(ribbon: &Ribbon, card: usize) -> Option<Refinement> {
    let bends: f32 = (0..ROWS).map(|k| ribbon.row(row_fraction(k)).bend[2].abs()).sum();
    // The mean distance of a parabola from a line at its mean height.
    let error = 0.26 * bends / ROWS as f32 * ribbon.length;
    (error > 1e-9).then_some(Refinement { error, card, stretch: None })
}

impl CardMesh {
    pub(super) fn surface(&self) -> Surface<'_> {
        Surface { positions: &self.positions, uvs: &self.uvs, triangles: &self.triangles }
    }

    /// Returns the vertices of a card.
    pub(super) fn range(&self, card: usize) -> std::ops::Range<usize> {
        let end = self.starts.get(card + 1).map_or(self.positions.len(), |start| *start as usize);
        self.starts[card] as usize..end
    }

    /// Returns the cards in another order.
    pub(super) fn reordered(&self, order: &[u32]) -> Self {
        let mut mesh = Self::default();
        for card in order {
            let first = self.starts[*card as usize];
            let range = self.range(*card as usize);
            let start = mesh.positions.len() as u32;
            mesh.starts.push(start);
            mesh.positions.extend(&self.positions[range.clone()]);
            mesh.normals.extend(&self.normals[range.clone()]);
            mesh.tangents.extend(&self.tangents[range.clone()]);
            mesh.uvs.extend(&self.uvs[range.clone()]);
            mesh.light.extend(&self.light[range.clone()]);
            mesh.roots.extend(&self.roots[range.clone()]);
            mesh.along.extend(&self.along[range.clone()]);
            let from = self.triangles.partition_point(|t| (t[0] as usize) < range.start);
            let to = self.triangles.partition_point(|t| (t[0] as usize) < range.end);
            mesh.triangles.extend(self.triangles[from..to].iter().map(|t| t.map(|v| v - first + start)));
        }
        mesh
    }

    /// Adds a card whose picture is at `rect` in a texture of `size` texels.
    pub(super) fn push(
        &mut self,
        plan: &Plan<'_>,
        (rect, mirrored): (Rect, bool),
        size: usize,
        volume: &HairVolume<'_>,
        head: Option<&SdfGrid>,
    ) {
        let first = self.positions.len() as u32;
        self.starts.push(first);
        let columns = plan.columns;
        for k in &plan.rows {
            let row = plan.ribbon.row(row_fraction(*k));
            for c in 0..columns {
                let across = 2.0 * c as f32 / (columns - 1) as f32 - 1.0;
                // Two columns make a flat card, at the mean height of the bent one.
                let level = if columns == 2 { -row.out * (2.0 / 3.0 * row.bend[2]) } else { Vec3::ZERO };
                let mut p = row.point(across) + level;
                if let Some(head) = head {
                    // Roots are in the skin, also where the card is thick.
                    let (clearance, snap_distance) = if *k == 0 { (0.0, ROOT) } else { (CLEAR, 0.0) };
                    let far = head.sample(p);
                    if far < clearance.max(snap_distance) {
                        p += head.normal(p) * (clearance - far);
                    }
                }
                let slope = (row.bend[1] + 2.0 * across * row.bend[2]) / row.half;
                let card = (row.out - row.side * slope).normalize_or(row.out);
                let normal = (card * (1.0 - VOLUME) + volume.outward(p) * VOLUME).normalize_or(card);
                let u = if mirrored { -across } else { across };
                let at = Vec2::new(0.5 * u + 0.5, row_fraction(*k))
                    * Vec2::new(rect.width as f32, rect.height as f32);
                self.positions.push(p);
                self.normals.push(normal);
                self.tangents
                    .push(row.side.reject_from(normal).normalize_or(normal.any_orthonormal_vector()));
                self.uvs.push((at + Vec2::new(rect.x as f32, rect.y as f32)) / size as f32);
                self.light.push(volume.open(p + normal * 0.004));
                self.roots.push(self.positions[first as usize]);
                self.along.push(row_fraction(*k) * plan.ribbon.length);
            }
        }
        let (rows, columns) = (plan.rows.len() as u32, columns as u32);
        for r in 0..rows - 1 {
            for c in 0..columns - 1 {
                let at = first + r * columns + c;
                self.triangles.extend(self.halves([at, at + 1, at + columns, at + columns + 1]));
            }
        }
        self.face(self.triangles.len() - (2 * (rows - 1) * (columns - 1)) as usize);
    }

    /// Divides the part of a card between two rows along the diagonal with the smaller fold. Fronts are
    /// counterclockwise.
    fn halves(&self, [a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
        let front = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|v| self.positions[v as usize]);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let fold = |pair: [[u32; 3]; 2]| front(pair[0]).dot(front(pair[1]));
        let splits = [[[a, c, b], [b, c, d]], [[a, c, d], [a, d, b]]];
        if fold(splits[1]) > fold(splits[0]) { splits[1] } else { splits[0] }
    }

    /// Turns the normals of the triangles from `first` on to the fronts of these triangles: engines that draw both
    /// sides turn a normal around where it points to the back.
    fn face(&mut self, first: usize) {
        for _ in 0..8 {
            for triangle in &self.triangles[first..] {
                let [a, b, c] = triangle.map(|v| self.positions[v as usize]);
                let front = (b - a).cross(c - a).normalize_or_zero();
                for v in triangle.map(|v| v as usize) {
                    let normal = self.normals[v];
                    let lacking = (FRONT - normal.dot(front)).max(0.0);
                    self.normals[v] = (normal + 1.5 * lacking * front).normalize_or(normal);
                }
            }
        }
        for v in self.triangles[first..].iter().flatten().map(|v| *v as usize) {
            let normal = self.normals[v];
            let across = self.tangents[v].reject_from(normal);
            self.tangents[v] = across.normalize_or(normal.any_orthonormal_vector());
        }
    }
}
