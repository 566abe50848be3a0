//! Helmets: opaque shells around hair, for heads of few pixels.

use super::{
    accuracy::soft_iou,
    atlas::{Extent, Rect},
    lines::{Lines, PATH_POINTS},
    mesh::{CardMesh, Surface},
    picture::{Opacity, Pyramid, Studio},
    tile::{Texel, Tile},
    volume::HairVolume,
};
use crate::{SdfGrid, TriMesh, progress::in_parallel};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Number of densities that are tried for the surface.
const TRIES: i32 = 16;
/// Area of parts of the surface that are left out, as a fraction of the largest part.
const SMALL: f32 = 0.05;
/// Opacity from which hair is solid.
const SOLID: f32 = 0.9;
/// Texels between the edge of the picture and the vertices.
const INSET: f32 = 2.0;
/// Most repetitions of a lock in the picture.
const REPEATS: usize = 8;
/// Size of the picture, meters: it is drawn at the density of the cards.
pub(super) const EXTENT: Extent = [0.06, 0.03];

/// Returns the fraction of the area of hair in which it is almost opaque. A shell suits hair for which this is large.
pub(super) fn solid(pictures: &[Opacity]) -> f32 {
    let all = pictures.iter().flatten();
    let (solid, any) = all.fold((0.0f32, 0.0f32), |(solid, any), opacity| {
        (solid + f32::from(u8::from(*opacity >= SOLID)) * opacity, any + opacity)
    });
    if any > 0.0 { solid / any } else { 0.0 }
}

/// Returns the shell of at most about `triangles` triangles whose pictures in `studio` are most like `target`.
pub(super) fn shell(
    lines: &Lines<'_>,
    head: Option<&SdfGrid>,
    (studio, target): (&Studio, &[Opacity]),
    triangles: usize,
) -> Option<TriMesh> {
    let volume = HairVolume::new(lines.strands, &lines.radii, head, 0.0);
    let opaque = Pyramid::new(1, vec![1.0]);
    let tries: Vec<i32> = (0..TRIES).collect();
    let shells = in_parallel(&tries, |k| {
        let level = 0.5 * volume.densest() * 0.7f32.powi(*k);
        let shell = outside(volume.surface(level), head, volume.cell(), triangles)?;
        let uvs = vec![Vec2::splat(0.5); shell.positions.len()];
        let surface = Surface { positions: &shell.positions, uvs: &uvs, triangles: &shell.triangles };
        Some((soft_iou(target, &studio.cards(&surface, &opaque)), shell))
    });
    let best = shells.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, shell)| shell)
}

/// Keeps the large parts of `surface` that are not hidden by the head, with at most about `max_triangles` triangles.
fn outside(mut surface: TriMesh, head: Option<&SdfGrid>, cell: f32, max_triangles: usize) -> Option<TriMesh> {
    if let Some(head) = head {
        let p = surface.positions.clone();
        surface.triangles.retain(|triangle| {
            let [a, b, c] = triangle.map(|v| p[v as usize]);
            let center = (a + b + c) / 3.0;
            let far = head.sample(center);
            // The side of the shell that lies on the head cannot be seen.
            let hidden = far < cell && (b - a).cross(c - a).dot(head.normal(center)) < 0.0;
            !(far < 0.0 || hidden)
        });
    }
    let parts = surface.parts();
    let min_area = SMALL * parts.first()?.area;
    let kept = parts.iter().filter(|part| part.area >= min_area).flat_map(|part| &part.triangles);
    surface.triangles = kept.map(|i| surface.triangles[*i as usize]).collect();
    surface.triangles = surface.simplified(max_triangles)?;
    // Drop vertices without triangles.
    let mut new = vec![u32::MAX; surface.positions.len()];
    let mut positions = Vec::new();
    for v in surface.triangles.iter_mut().flatten() {
        let index = &mut new[*v as usize];
        if *index == u32::MAX {
            *index = positions.len() as u32;
            positions.push(surface.positions[*v as usize]);
        }
        *v = *index;
    }
    surface.positions = positions;
    surface.compute_normals();
    (!surface.triangles.is_empty()).then_some(surface)
}

/// Hair around a vertex.
#[derive(Clone, Copy, Default)]
struct Nearby {
    weight: f32,
    root: Vec3,
    direction: Vec3,
    /// Fraction of the length, 0 root, 1 tip.
    along: f32,
    /// Distance from the root, meters.
    distance: f32,
}

/// Returns the mean of the strands around `p`: those farther away than `radius` count little.
fn nearby(lines: &Lines<'_>, p: Vec3, radius: f32) -> Nearby {
    let mut sum = Nearby::default();
    for i in 0..lines.strands.len() as u32 {
        let path = lines.path_points(i);
        for k in 0..PATH_POINTS {
            let near = radius * radius / (path[k].distance_squared(p) + 0.1 * radius * radius);
            let weight = near.powi(4) * lines.weights[i as usize];
            sum.weight += weight;
            sum.root += weight * path[0];
            sum.direction +=
                weight * (path[(k + 1).min(PATH_POINTS - 1)] - path[k.saturating_sub(1)]).normalize_or_zero();
            let along = k as f32 / (PATH_POINTS - 1) as f32;
            sum.along += weight * along;
            sum.distance += weight * along * lines.length(i);
        }
    }
    let scale = 1.0 / sum.weight.max(f32::MIN_POSITIVE);
    Nearby {
        weight: sum.weight,
        root: sum.root * scale,
        direction: sum.direction * scale,
        along: sum.along * scale,
        distance: sum.distance * scale,
    }
}

/// Returns a shell with texture coordinates in `rect` of a texture of `size` texels: from the front to the back, the
/// same on the left and the right, and from root to tip.
pub(super) fn textured(
    shell: &TriMesh,
    lines: &Lines<'_>,
    volume: &HairVolume<'_>,
    (rect, size): (Rect, usize),
) -> CardMesh {
    let mut mesh = CardMesh { triangles: shell.triangles.clone(), ..Default::default() };
    let (lo, hi) = shell.bounds().unwrap_or_default();
    let axis = 0.5 * (lo + hi);
    let found = in_parallel(&shell.positions, |p| nearby(lines, *p, 2.0 * volume.cell()));
    for ((p, normal), nearby) in shell.positions.iter().zip(&shell.normals).zip(found) {
        let from = *p - axis;
        let around = from.x.abs().atan2(from.z) / PI;
        let inner = |texels: usize, at: f32| INSET + at.clamp(0.0, 1.0) * (texels as f32 - 2.0 * INSET);
        let corner = Vec2::new(rect.x as f32, rect.y as f32);
        let at = Vec2::new(inner(rect.width, around), inner(rect.height, nearby.along));
        mesh.positions.push(*p);
        mesh.normals.push(*normal);
        mesh.tangents.push(normal.cross(nearby.direction).normalize_or(normal.any_orthonormal_vector()));
        mesh.uvs.push((corner + at) / size as f32);
        mesh.light.push(volume.open(*p + normal * 0.004));
        mesh.roots.push(nearby.root);
        mesh.along.push(nearby.distance);
    }
    mesh
}

/// Returns the opaque picture of `width` × `height` texels that repeats a lock of a width of `lock` meters.
pub(super) fn tile(width: usize, height: usize, draw: impl FnOnce([usize; 2]) -> Tile) -> Tile {
    let repeats = (width / 32).clamp(1, REPEATS);
    let mut lock = draw([width.div_ceil(repeats), height]);
    lock.spread();
    let texel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let (repeat, at) = (x / lock.width, x % lock.width);
        let mirrored = repeat % 2 == 1;
        let texel = &lock.texels[y * lock.width + if mirrored { lock.width - 1 - at } else { at }];
        let mut tangent = texel.tangent;
        if mirrored {
            tangent.x = -tangent.x;
        }
        Texel { coverage: 1.0, tangent, ..*texel }
    };
    Tile { width, height, texels: (0..width * height).map(texel).collect() }
}
