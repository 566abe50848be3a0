//! Stored form of the bust: mesh and field computed in advance, 40 times faster to read than to build.
//!
//! ```text
//! signs of the lattice ─► surface nets ─► vertices (+ residual), triangles (+ turned diagonals), normals (+ residual)
//! field ─► each node from its seven neighbors (+ residual)
//! ```
//!
//! Predictable values are not stored. The signs of the lattice determine the triangles and the approximate vertices,
//! and the triangles predict the normals. The right half mirrors the left half. Numbers are rounded to [`STEP`].
//!
//! `cargo run -p tresses --example cook` rewrites the file after a change of the sculpture; a test compares it with its
//! source.

use super::{
    FIELD_RESOLUTION, RESOLUTION,
    meshing::{Lattice, grid, measure, model},
};
use crate::{
    SdfGrid, TriMesh,
    columns::{Reader, Writer},
    progress::at_once,
};
use fast_surface_nets::SurfaceNetsBuffer;
use glam::{IVec2, IVec3, Vec2, Vec3, vec3};
use std::sync::OnceLock;

/// Quantization step of positions and distances, meters: 7.6 µm.
pub(crate) const STEP: f32 = 1.0 / 131_072.0;

/// Quantization scale of the octahedral coordinates of normals: steps of about 0.06 degrees.
const FINE: f32 = 1023.0;

static FILE: &[u8] = include_bytes!("../../cooked/bust.bin");

/// The bust at [`RESOLUTION`] and its field at [`FIELD_RESOLUTION`].
#[derive(Debug)]
pub(super) struct Bust {
    pub mesh: TriMesh,
    pub field: SdfGrid,
}

const OUT_OF_DATE: &str = "the cooked bust is out of date: run the example `cook`";

/// Returns the bust, which is read once.
pub(super) fn bust() -> &'static Bust {
    static BUST: OnceLock<Bust> = OnceLock::new();
    BUST.get_or_init(|| read(FILE))
}

/// Returns the contents of the file for the current sculpture.
pub fn cook() -> Vec<u8> {
    let (mesh, lattice) = at_once(model(RESOLUTION, &()));
    write(&lattice, &mesh, &at_once(measure(FIELD_RESOLUTION, &())))
}

/// Columns of the file. Residuals of positions and normals take one per coordinate.
const RUN: usize = 0;
const POSITION: usize = 1;
const FLIPPED: usize = 4;
const NORMAL: usize = 5;
const FIELD: usize = 7;
const COLUMNS: usize = 8;

fn write(lattice: &Lattice, mesh: &TriMesh, field: &SdfGrid) -> Vec<u8> {
    let mut out = Writer::<COLUMNS>::default();
    let half: Vec<usize> = lattice.left_half().collect();
    let mut begin = 0;
    for i in 1..=half.len() {
        let inside = |k: usize| lattice.distances[half[k]] < 0.0;
        if i == half.len() || inside(i) != inside(begin) {
            out.put(RUN, (i - begin) as i32);
            begin = i;
        }
    }
    let signs = lattice.signs();
    let nets = signs.nets();
    for (i, at) in nets.surface_points.iter().enumerate() {
        if signs.is_left(*at) {
            let off = steps(mesh.positions[i] - signs.point(nets.positions[i]));
            (0..3).for_each(|a| out.put(POSITION + a, off[a]));
        }
    }
    let quads = |indices: &[u32]| indices.as_chunks::<6>().0.to_vec();
    let indices: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    let mut rough = TriMesh { positions: placed(&mesh.positions, &signs, &nets), ..Default::default() };
    for (own, mesh_quad) in quads(&nets.indices).iter().zip(quads(&indices)) {
        let is_flipped = diagonal(own) != diagonal(&mesh_quad);
        out.put(FLIPPED, is_flipped.into());
        rough.triangles.extend(split(own, is_flipped));
    }
    for (i, (at, normal)) in nets.surface_points.iter().zip(guessed(&rough)).enumerate() {
        if signs.is_left(*at) {
            let off = flat(mesh.normals[i]) - flat(normal);
            (0..2).for_each(|a| out.put(NORMAL + a, off[a]));
        }
    }
    let rounded: Vec<i32> = field.distances.iter().map(|d| (d / STEP).round() as i32).collect();
    for (i, d) in rounded.iter().enumerate() {
        out.put(FIELD, d - predict(&rounded, field, i));
    }
    out.finish()
}

fn read(bytes: &[u8]) -> Bust {
    let mut columns = Reader::<COLUMNS>::new(bytes);
    let mut next = |column| columns.get(column).expect(OUT_OF_DATE);
    let mut signs = Lattice::empty(RESOLUTION);
    let (mut inside, mut left) = (true, 0);
    for i in signs.left_half() {
        if left == 0 {
            left = next(RUN);
            inside = !inside;
        }
        left -= 1;
        signs.set(i, if inside { -1.0 } else { 1.0 });
    }
    let nets = signs.nets();
    let mut mesh = TriMesh::default();
    for (i, at) in nets.surface_points.iter().enumerate() {
        let p = match signs.is_left(*at) {
            true => {
                let off = IVec3::from_array([0, 1, 2].map(|a| next(POSITION + a)));
                signs.point(nets.positions[i]) + off.as_vec3() * STEP
            }
            false => mirrored(mesh.positions[signs.twin(&nets, *at)]),
        };
        mesh.positions.push(p);
    }
    for quad in nets.indices.as_chunks::<6>().0 {
        mesh.triangles.extend(split(quad, next(FLIPPED) == 1));
    }
    for (at, normal) in nets.surface_points.iter().zip(guessed(&mesh)) {
        let normal = match signs.is_left(*at) {
            true => {
                let off = IVec2::from_array([0, 1].map(|a| next(NORMAL + a)));
                round(flat(normal) + off)
            }
            false => mirrored(mesh.normals[signs.twin(&nets, *at)]),
        };
        mesh.normals.push(normal);
    }
    let mut field = grid(FIELD_RESOLUTION);
    let mut rounded = Vec::with_capacity(field.size.element_product() as usize);
    for i in 0..rounded.capacity() {
        let d = predict(&rounded, &field, i) + next(FIELD);
        rounded.push(d);
    }
    assert!(columns.is_done(), "{OUT_OF_DATE}");
    field.distances = rounded.iter().map(|d| *d as f32 * STEP).collect();
    Bust { mesh, field }
}

fn steps(v: Vec3) -> IVec3 {
    (v / STEP).round().as_ivec3()
}

fn mirrored(v: Vec3) -> Vec3 {
    v * vec3(-1.0, 1.0, 1.0)
}

/// Returns `positions` as the reader reconstructs them.
fn placed(positions: &[Vec3], signs: &Lattice, nets: &SurfaceNetsBuffer) -> Vec<Vec3> {
    let mut all: Vec<Vec3> = Vec::with_capacity(positions.len());
    for (i, at) in nets.surface_points.iter().enumerate() {
        all.push(match signs.is_left(*at) {
            true => {
                let base = signs.point(nets.positions[i]);
                base + steps(positions[i] - base).as_vec3() * STEP
            }
            false => mirrored(all[signs.twin(nets, *at)]),
        });
    }
    all
}

/// Returns the two corners that the triangles of a quad share.
fn diagonal(quad: &[u32; 6]) -> [u32; 2] {
    let other = if quad[1] == quad[5] { quad[1] } else { quad[2] };
    [quad[0].min(other), quad[0].max(other)]
}

/// Returns the triangles of a quad, along its other diagonal if `is_flipped`.
fn split(quad: &[u32; 6], is_flipped: bool) -> [[u32; 3]; 2] {
    let [a, b, c, d, e, f] = *quad;
    match is_flipped {
        false => [[a, b, c], [d, e, f]],
        true if b == f => [[c, e, b], [c, a, e]],
        true => [[b, c, f], [b, f, a]],
    }
}

/// Returns area-weighted normals, not normalized. Uses only operations that give the same result on every machine.
fn guessed(mesh: &TriMesh) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        t.iter().for_each(|i| normals[*i as usize] += (b - a).cross(c - a));
    }
    normals
}

/// Returns the octahedral coordinates of a direction, in quantization steps.
fn flat(v: Vec3) -> IVec2 {
    let n = v / (v.x.abs() + v.y.abs() + v.z.abs()).max(1e-20);
    let p = match n.z >= 0.0 {
        true => n.truncate(),
        false => Vec2::new((1.0 - n.y.abs()) * 1f32.copysign(n.x), (1.0 - n.x.abs()) * 1f32.copysign(n.y)),
    };
    (p * FINE).round().as_ivec2()
}

/// Returns the direction for coordinates from [`flat`].
fn round(steps: IVec2) -> Vec3 {
    let p = steps.as_vec2() / FINE;
    let mut n = p.extend(1.0 - p.x.abs() - p.y.abs());
    let fold = (-n.z).max(0.0);
    n.x -= fold.copysign(n.x);
    n.y -= fold.copysign(n.y);
    n.normalize()
}

/// Predicts node `i` of a field from the nodes before it; exact for linear fields.
fn predict(before: &[i32], field: &SdfGrid, i: usize) -> i32 {
    let (nx, ny) = (field.size.x as usize, field.size.y as usize);
    let at = [i % nx, i / nx % ny, i / (nx * ny)];
    let stride = [1, nx, nx * ny];
    let mut sum = 0;
    for corner in 1..8 {
        let axes = (0..3).filter(|a| corner >> a & 1 == 1);
        if axes.clone().all(|a| at[a] > 0) {
            let back: usize = axes.clone().map(|a| stride[a]).sum();
            let sign = if axes.count() % 2 == 1 { 1 } else { -1 };
            sum += sign * before[i - back];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the largest differences of positions, normals and distances, and the number of different triangles.
    fn off(a: &Bust, b: &Bust) -> (f32, f32, f32, usize) {
        assert_eq!(a.mesh.positions.len(), b.mesh.positions.len());
        assert_eq!(a.mesh.triangles.len(), b.mesh.triangles.len());
        assert_eq!(
            (a.field.size, a.field.origin, a.field.cell),
            (b.field.size, b.field.origin, b.field.cell)
        );
        let most = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        let sorted = |bust: &Bust| -> Vec<[u32; 3]> {
            let mut all: Vec<[u32; 3]> = bust.mesh.triangles.clone();
            for t in &mut all {
                let first = (0..3).min_by_key(|k| t[*k]).unwrap_or(0);
                t.rotate_left(first);
            }
            all.sort_unstable();
            all
        };
        let (mine, its) = (sorted(a), sorted(b));
        let others = mine.iter().filter(|t| its.binary_search(t).is_err()).count();
        let distances = a.field.distances.iter().zip(&b.field.distances).map(|(a, b)| (a - b).abs());
        (
            most(&a.mesh.positions, &b.mesh.positions),
            most(&a.mesh.normals, &b.mesh.normals),
            distances.fold(0.0, f32::max),
            others,
        )
    }

    #[test]
    fn cooked_bust_matches_its_source() {
        let (mesh, _) = at_once(model(RESOLUTION, &()));
        let mut live = Bust { mesh, field: at_once(measure(FIELD_RESOLUTION, &())) };
        let (place, normal, distance, others) = off(bust(), &live);
        println!("{} bytes: off by {place} m, {normal}, {distance} m, {others} triangles", FILE.len());
        // Tolerances for rounding, and for the last bits of sines and roots on other machines.
        let same = |(place, normal, distance, others): (f32, f32, f32, usize)| {
            place < STEP && normal < 3e-3 && distance < STEP && others < 20
        };
        assert!(same((place, normal, distance, others)), "run the example `cook`");
        live.mesh.positions[7].x += 2.0 * STEP;
        assert!(!same(off(bust(), &live)));
        live.mesh.positions[7].x -= 2.0 * STEP;
        live.field.distances[7] += 2.0 * STEP;
        assert!(!same(off(bust(), &live)));
    }

    #[test]
    fn halves_mirror_each_other() {
        let mesh = &bust().mesh;
        let left: Vec<_> = mesh.positions.iter().filter(|p| p.x < 0.0).collect();
        assert_eq!(2 * left.len(), mesh.positions.len());
    }
}
