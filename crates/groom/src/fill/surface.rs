//! Triangulated scalp surface whose corners are roots.
//!
//! Roots lie on a surface, not in a plane, and not always on a head: a ponytail has its roots on a band, fur on a whole
//! body. Each root is triangulated with its neighbors in its own tangent plane (its star is the dual of its Voronoi
//! cell). A triangle is kept if two of its corners agree on it. Where they disagree, a triangle is missing or overlaps
//! another by a sliver, which is not visible in hair.

use crate::SdfGrid;
use crate::near::PointTree;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Distance below which roots are merged, meters.
const SAME: f32 = 1e-5;

/// Number of neighbors that a root is triangulated with.
const NEIGHBORS: usize = 32;

/// Maximum circumradius of a triangle, relative to the distance to neighbors. Larger ones lie beyond the edge of the
/// hair.
const WIDEST: f32 = 2.2;

/// Half the size of the patch around a root without neighbors, meters.
const ISOLATED_RADIUS: f32 = 0.004;

/// Scalp surface reconstructed from the roots.
#[derive(Default)]
pub(super) struct Surface {
    /// Positions of roots; several strands may share one.
    pub(super) sites: Vec<Vec3>,
    /// Outward normals, one per site.
    pub(super) normals: Vec<Vec3>,
    /// Distance to the neighbors, meters, one per site.
    pub(super) spacing: Vec<f32>,
    /// Strands per square meter, one per site.
    pub(super) density: Vec<f32>,
    /// Whether the site lies at the edge of the hair, one per site.
    pub(super) rim: Vec<bool>,
    /// Triangles of site indices.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Isolated sites, which are in no triangle, and the radius of the patch around each, meters.
    pub(super) isolated: Vec<(u32, f32)>,
    /// Site of each strand.
    of: Vec<u32>,
    /// The strands of site `i` are `members[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Surface {
    /// Builds the surface through `roots`. `outward` is the direction of the hair at each root.
    pub(super) fn new(roots: &[Vec3], outward: &[Vec3], field: Option<&SdfGrid>) -> Self {
        let mut surface = Self::of_roots(roots);
        let sites = std::mem::take(&mut surface.sites);
        let near = PointTree::new(&sites);
        let mut found = Vec::new();
        let mut votes: HashMap<[u32; 3], u8> = HashMap::new();
        let mut order: Vec<[u32; 3]> = Vec::new();
        for (i, &site) in sites.iter().enumerate() {
            near.nearest(site, NEIGHBORS + 1, f32::INFINITY, &mut found);
            found.retain(|(_, j)| *j as usize != i);
            let first = &found[..found.len().min(6)];
            let spacing = first.iter().map(|(d, _)| d.sqrt()).sum::<f32>() / first.len().max(1) as f32;
            let direction = outward[surface.members[surface.starts[i] as usize] as usize];
            let normal = normal(site, &found, &sites, direction, field);
            surface.spacing.push(if first.is_empty() { 2.0 * ISOLATED_RADIUS } else { spacing });
            surface.normals.push(normal);
            for [a, b] in star(site, normal, WIDEST * spacing, &found, &sites) {
                let mut corners = [i as u32, a, b];
                corners.sort_unstable();
                let vote_count = votes.entry(corners).or_default();
                if *vote_count == 0 {
                    order.push(corners);
                }
                *vote_count += 1;
            }
        }
        order.retain(|corners| votes[corners] > 1);
        surface.triangles = order;
        surface.sites = sites;
        surface.weigh();
        surface
    }

    /// Merges coincident roots. Returns sites and their strands, without triangles.
    fn of_roots(roots: &[Vec3]) -> Self {
        // Roots in the same cell are merged. A pair across a cell border stays separate, which is harmless.
        let mut cells: HashMap<[i64; 3], u32> = HashMap::new();
        let mut sites: Vec<Vec3> = Vec::new();
        let of: Vec<u32> = roots
            .iter()
            .map(|&root| {
                let cell = root.to_array().map(|x| (f64::from(x) / f64::from(SAME)).round() as i64);
                *cells.entry(cell).or_insert_with(|| {
                    sites.push(root);
                    sites.len() as u32 - 1
                })
            })
            .collect();
        let mut members: Vec<u32> = (0..roots.len() as u32).collect();
        members.sort_by_key(|i| of[*i as usize]);
        let start = |site: u32| members.partition_point(|i| of[*i as usize] < site) as u32;
        let starts = (0..=sites.len() as u32).map(start).collect();
        Self { sites, of, starts, members, ..Self::default() }
    }

    /// Returns the strands rooted at `site`.
    pub(super) fn strands(&self, site: u32) -> &[u32] {
        let i = site as usize;
        &self.members[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// Returns the site of strand `i`.
    pub(super) fn site(&self, i: u32) -> usize {
        self.of[i as usize] as usize
    }

    /// Returns the corners of a triangle.
    pub(super) fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|site| self.sites[site as usize])
    }

    /// Computes the strand density around each site, the rim and the isolated sites.
    fn weigh(&mut self) {
        let n = self.sites.len();
        // Each corner owns a third of its triangles. Area beyond the edge of the hair belongs to no site.
        let (mut area, mut angle) = (vec![0.0f32; n], vec![0.0f32; n]);
        for &t in &self.triangles {
            let p = self.corners(t);
            let third = area_of(p) / 3.0;
            for k in 0..3 {
                let (u, v) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                area[t[k] as usize] += third;
                angle[t[k] as usize] += u.angle_between(v);
            }
        }
        self.rim = angle.iter().map(|angle| *angle < 0.9 * std::f32::consts::TAU).collect();
        let own = |i: usize| {
            let around = (angle[i] / std::f32::consts::TAU).clamp(0.1, 1.0);
            (self.strands(i as u32).len() as f32 * around, area[i])
        };
        let mut sums: Vec<(f32, f32)> = (0..n).map(own).collect();
        // Average over the neighbors as well, because single root positions are random.
        for t in &self.triangles {
            for k in 0..3 {
                let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
                let (x, y) = (own(a), own(b));
                sums[a] = (sums[a].0 + y.0, sums[a].1 + y.1);
                sums[b] = (sums[b].0 + x.0, sums[b].1 + x.1);
            }
        }
        self.density = sums.iter().map(|(strands, area)| strands / area.max(1e-12)).collect();
        for i in (0..n).filter(|i| angle[*i] == 0.0) {
            let radius = (0.5 * self.spacing[i]).clamp(1e-4, ISOLATED_RADIUS);
            self.density[i] = self.strands(i as u32).len() as f32 / (std::f32::consts::PI * radius * radius);
            self.isolated.push((i as u32, radius));
        }
        // Limit the range of densities, so that no site dominates.
        let mut sorted = self.density.clone();
        sorted.sort_by(f32::total_cmp);
        let median = sorted[sorted.len() / 2];
        for density in &mut self.density {
            *density = density.clamp(median / 16.0, median * 16.0);
        }
    }
}

/// Returns the area of a triangle, m².
pub(super) fn area_of([a, b, c]: [Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

/// Returns the outward normal at a root: of the head's distance field near the head, else of the plane through its
/// neighbors.
fn normal(site: Vec3, found: &[(f32, u32)], sites: &[Vec3], outward: Vec3, field: Option<&SdfGrid>) -> Vec3 {
    if let Some(field) = field.filter(|field| field.sample(site).abs() < 0.02) {
        return field.normal(site);
    }
    // Fit a plane through the nearest neighbors, solved for the axis whose equation is best determined.
    let (mut diagonal, mut mixed) = (Vec3::ZERO, Vec3::ZERO);
    for (_, j) in &found[..found.len().min(12)] {
        let d = sites[*j as usize] - site;
        diagonal += d * d;
        mixed += Vec3::new(d.y * d.z, d.x * d.z, d.x * d.y);
    }
    let Vec3 { x: xx, y: yy, z: zz } = diagonal;
    let Vec3 { x: yz, y: xz, z: xy } = mixed;
    let minors = Vec3::new(yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy);
    let plane = match minors.max_position() {
        0 => Vec3::new(minors.x, xz * yz - xy * zz, xy * yz - xz * yy),
        1 => Vec3::new(xz * yz - xy * zz, minors.y, xy * xz - yz * xx),
        _ => Vec3::new(xy * yz - xz * yy, xy * xz - yz * xx, minors.z),
    };
    let flat = minors.max_element() > 1e-6 * diagonal.element_sum().powi(2);
    let plane = if flat { plane.normalize_or(outward) } else { outward };
    let plane = plane.normalize_or(Vec3::Y);
    if plane.dot(outward) < 0.0 { -plane } else { plane }
}

/// Returns the two other corners of each triangle around `site`, in its tangent plane, with a circumradius of at most
/// `widest`.
fn star(site: Vec3, normal: Vec3, widest: f32, found: &[(f32, u32)], sites: &[Vec3]) -> Vec<[u32; 2]> {
    const NOBODY: u32 = u32::MAX;
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let corner = |x: f32, y: f32| (Vec2::new(x, y) * widest, NOBODY);
    // The Voronoi cell: corners in order, each with the neighbor across the side that begins there.
    let mut cell = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mut cut: Vec<(Vec2, u32)> = Vec::new();
    for &(squared, j) in found {
        let away = sites[j as usize] - site;
        let mut flat = Vec2::new(away.dot(u), away.dot(v));
        // Skip neighbors on another sheet of the surface, for example behind an ear.
        if flat.length_squared() < 0.25 * squared {
            continue;
        }
        // Four corners of a square have one circumcircle. A small offset per neighbor breaks the tie, the same way for
        // all of them.
        flat *= 1.0 + 1e-4 * (crate::hash::pcg(j) >> 8) as f32 / 16_777_216.0;
        let half = 0.5 * flat.length_squared();
        let side = |p: Vec2| p.dot(flat) - half;
        if cell.iter().all(|(p, _)| side(*p) <= 0.0) {
            continue;
        }
        cut.clear();
        for k in 0..cell.len() {
            let ((p, across), (q, _)) = (cell[k], cell[(k + 1) % cell.len()]);
            let (a, b) = (side(p), side(q));
            if a <= 0.0 {
                cut.push((p, across));
                if b > 0.0 {
                    cut.push((p.lerp(q, a / (a - b)), j));
                }
            } else if b <= 0.0 {
                cut.push((p.lerp(q, a / (a - b)), across));
            }
        }
        std::mem::swap(&mut cell, &mut cut);
    }
    let n = cell.len();
    let pairs = (0..n).map(|k| [cell[k].1, cell[(k + 1) % n].1]);
    pairs.filter(|[a, b]| *a != NOBODY && *b != NOBODY && a != b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalp::spread_direction;

    #[test]
    fn triangles_cover_a_scalp_once() {
        // Directions spread over the part of a sphere that holds a scalp.
        let roots: Vec<Vec3> = (0..900).map(|i| 0.09 * spread_direction(i, Vec2::new(0.1, 0.4))).collect();
        let outward: Vec<Vec3> = roots.iter().map(|p| p.normalize()).collect();
        let surface = Surface::new(&roots, &outward, None);
        assert!(surface.isolated.is_empty());
        let normals = surface.normals.iter().zip(&outward).map(|(a, b)| a.dot(*b)).fold(1.0, f32::min);
        assert!(normals > 0.97, "{normals}");
        // The cap up to 2.4 radians, minus the area beyond its outermost roots.
        let area: f32 = surface.triangles.iter().map(|t| area_of(surface.corners(*t))).sum();
        let cap = std::f32::consts::TAU * 0.09f32.powi(2) * (1.0 - 2.4f32.cos());
        assert!((0.93..1.01).contains(&(area / cap)), "{}", area / cap);
        // Each inner edge belongs to two triangles.
        let mut sides: HashMap<[u32; 2], u32> = HashMap::new();
        for t in &surface.triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let good = sides.values().filter(|n| **n <= 2).count() as f32 / sides.len() as f32;
        assert!(good > 0.995, "{good}");
        let mean = surface.density.iter().sum::<f32>() / 900.0;
        assert!((mean * cap / 900.0 - 1.0).abs() < 0.1, "{}", mean * cap / 900.0);
    }

    #[test]
    fn collinear_and_coincident_roots_are_handled() {
        let line: Vec<Vec3> = (0..9).map(|i| Vec3::X * i as f32 * 0.01).collect();
        let up = vec![Vec3::Y; 9];
        let surface = Surface::new(&line, &up, None);
        assert_eq!((surface.triangles.len(), surface.isolated.len()), (0, 9));
        let surface = Surface::new(&[Vec3::X; 5], &up[..5], None);
        assert_eq!((surface.sites.len(), surface.strands(0)), (1, &[0, 1, 2, 3, 4][..]));
        // A square grid, where four roots share a circumcircle, is covered without holes.
        let grid: Vec<Vec3> =
            (0..100).map(|i| Vec3::new((i % 10) as f32, 0.0, (i / 10) as f32) * 0.01).collect();
        let surface = Surface::new(&grid, &[Vec3::Y; 100], None);
        let area: f32 = surface.triangles.iter().map(|t| area_of(surface.corners(*t))).sum();
        assert!((area / 0.0081 - 1.0).abs() < 0.02, "{area}");
    }
}
