//! Sample points on a body's surface. Each represents the same area.

use crate::groom::TriMesh;
use glam::Vec3;
use wgpu::util::DeviceExt;

/// Largest number of points, and the number of grid cells per edge from which it is used: about ten points per surface
/// cell.
const POINTS: usize = 8192;
const FINE: usize = 24;

/// Points on the triangles of a mesh. They refer to vertices, so that they follow deformation.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    pub(crate) buffer: wgpu::Buffer,
    /// Number of points.
    pub points: u32,
    /// 1 if triangles are counter-clockwise seen from outside, -1 if clockwise.
    pub outward: f32,
}

impl Surface {
    /// Creates points on `mesh` for a grid with `cells` per edge. A coarse cell contains more of the surface but needs
    /// no more points.
    pub(crate) fn new(device: &wgpu::Device, mesh: &TriMesh, cells: u32) -> Self {
        let mut points = points(mesh, count(cells));
        let count = points.len() as u32;
        // An empty buffer cannot be bound. A point without area has no effect.
        points.resize(points.len().max(1), [0; 4]);
        let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("surface"),
            contents: bytemuck::cast_slice(&points),
            usage: wgpu::BufferUsages::STORAGE,
        });
        Self { buffer, points: count, outward: outward(mesh) }
    }
}

/// Number of points for a grid with `cells` per edge.
pub(crate) fn points_for(cells: u32) -> u32 {
    count(cells) as u32
}

fn count(cells: u32) -> usize {
    POINTS * (cells as usize).min(FINE).pow(2) / FINE.pow(2)
}

/// Indices and corners of each triangle whose vertices all exist.
fn triangles(mesh: &TriMesh) -> impl Iterator<Item = ([u32; 3], [Vec3; 3])> {
    mesh.triangles.iter().filter_map(|triangle| {
        let [a, b, c] = triangle.map(|i| mesh.positions.get(i as usize).copied());
        Some((*triangle, [a?, b?, c?]))
    })
}

fn area([a, b, c]: [Vec3; 3]) -> f64 {
    0.5 * f64::from((b - a).cross(c - a).length())
}

/// Vertices and area (float bits, square meters) of `count` points at even distances along the cumulative area of the
/// triangles.
fn points(mesh: &TriMesh, count: usize) -> Vec<[u32; 4]> {
    let total_area: f64 = triangles(mesh).map(|(_, corners)| area(corners)).filter(|a| a.is_finite()).sum();
    if total_area <= 0.0 {
        return Vec::new();
    }
    let each = total_area / count as f64;
    let bits = (each as f32).to_bits();
    let mut points = Vec::with_capacity(count);
    let mut sum = 0.0;
    for ([a, b, c], corners) in triangles(mesh) {
        let area = area(corners);
        sum += if area.is_finite() { area } else { 0.0 };
        while points.len() < count && (points.len() as f64 + 0.5) * each < sum {
            points.push([a, b, c, bits]);
        }
    }
    points
}

/// Finds the winding from the sign of the enclosed volume, seen from the mean vertex.
fn outward(mesh: &TriMesh) -> f32 {
    let center = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len().max(1) as f32;
    let volume: f32 = triangles(mesh)
        .map(|(_, [a, b, c])| (a - center).dot((b - center).cross(c - center)))
        .filter(|v| v.is_finite())
        .sum();
    if volume < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles; one has three times the area of the other.
    fn mesh() -> TriMesh {
        TriMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 3.0, 1.0)],
            triangles: vec![[0, 1, 2], [3, 4, 1]],
            ..Default::default()
        }
    }

    #[test]
    fn points_sample_the_surface_by_area() {
        let mesh = mesh();
        let points = points(&mesh, POINTS);
        assert_eq!(points.len(), POINTS);
        let sum: f32 = points.iter().map(|point| f32::from_bits(point[3])).sum();
        let whole: f64 = triangles(&mesh).map(|(_, corners)| area(corners)).sum();
        assert!((f64::from(sum) / whole - 1.0).abs() < 1e-3);
        let first = points.iter().filter(|point| point[..3] == [0, 1, 2]).count() as f64;
        assert!((first / POINTS as f64 - 0.5 / whole).abs() < 1e-3);
        assert!(super::points(&TriMesh::default(), POINTS).is_empty());
    }

    #[test]
    fn coarse_grids_use_fewer_points() {
        assert_eq!([12, 24, 64].map(count), [POINTS / 4, POINTS, POINTS]);
        let points = points(&mesh(), count(12));
        assert_eq!(points.len(), POINTS / 4);
    }

    #[test]
    fn outward_follows_the_winding() {
        let mut mesh = TriMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Default::default()
        };
        assert_eq!(outward(&mesh), 1.0);
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        assert_eq!(outward(&mesh), -1.0);
    }
}
