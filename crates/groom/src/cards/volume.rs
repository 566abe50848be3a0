//! The blurred density of hair, whose gradient is the direction out of the hair.

use crate::{SdfGrid, Strands, TriMesh};
use fast_surface_nets::{SurfaceNetsBuffer, ndshape::RuntimeShape, surface_nets};
use glam::{UVec3, Vec3};

/// Cells along the longest edge, at most.
const CELLS: f32 = 48.0;
/// Standard deviation of the blur that gives the directions out of the hair, meters.
pub(super) const BLUR: f32 = 0.02;
/// Distance from the head within which its normal replaces the gradient of the density, meters.
const NEAR: f32 = 0.03;

/// Area of hair (width times length) per volume, 1/m, at the nodes of a grid.
pub(super) struct HairVolume<'a> {
    size: UVec3,
    origin: Vec3,
    cell: f32,
    density: Vec<f32>,
    head: Option<&'a SdfGrid>,
}

impl<'a> HairVolume<'a> {
    /// Splats strands whose vertices have `radii`, and blurs with the standard deviation `blur` (meters; at least 1.4
    /// cells).
    pub(super) fn new(strands: &Strands, radii: &[f32], head: Option<&'a SdfGrid>, blur: f32) -> Self {
        let (lo, hi) = strands.bounds().unwrap_or_default();
        let cell = ((hi - lo).max_element() / CELLS).max(1e-4);
        let margin = 3.0 * blur.max(1.5 * cell);
        let size = ((hi - lo + 2.0 * margin) / cell).ceil().as_uvec3() + 2;
        let mut volume = Self { size, origin: lo - margin, cell, density: Vec::new(), head };
        let mut density = vec![0.0f64; size.element_product() as usize];
        for i in 0..strands.len() {
            for k in strands.range(i).skip(1) {
                let (a, b) = (strands.positions[k - 1], strands.positions[k]);
                let long = a.distance(b);
                let steps = (long / cell).ceil().max(1.0);
                let area = f64::from((radii[k - 1] + radii[k]) * long / steps);
                for step in 0..steps as u32 {
                    let at = volume.corner(a.lerp(b, (step as f32 + 0.5) / steps));
                    at.weights()
                        .for_each(|(node, weight)| density[volume.index(node)] += area * f64::from(weight));
                }
            }
        }
        let cell = f64::from(cell);
        volume.density = density.into_iter().map(|area| (area / (cell * cell * cell)) as f32).collect();
        volume.blur(blur);
        volume
    }

    fn index(&self, node: UVec3) -> usize {
        ((node.z * self.size.y + node.y) * self.size.x + node.x) as usize
    }

    fn corner(&self, p: Vec3) -> Corner {
        let last = (self.size - 2).as_vec3();
        let local = ((p - self.origin) / self.cell).clamp(Vec3::ZERO, last + 0.999);
        let base = local.floor().min(last);
        Corner { base: base.as_uvec3(), part: local - base }
    }

    /// Blurs by three boxes per axis, which have the standard deviation `blur` together.
    fn blur(&mut self, blur: f32) {
        // The variance of a box of 2 r + 1 cells is (r² + r) / 3.
        let variance = (blur / self.cell).powi(2);
        let radius = (((1.0 + 4.0 * variance).sqrt() - 1.0) * 0.5).round().max(1.0) as usize;
        let size = self.size.to_array().map(|n| n as usize);
        let strides = [1, size[0], size[0] * size[1]];
        for axis in 0..3 {
            let (count, stride) = (size[axis], strides[axis]);
            let mut line = vec![0.0f32; count];
            for start in 0..self.density.len() {
                if start / stride % count != 0 {
                    continue;
                }
                for _ in 0..3 {
                    (0..count).for_each(|k| line[k] = self.density[start + k * stride]);
                    let get =
                        |k: isize| usize::try_from(k).ok().and_then(|k| line.get(k)).copied().unwrap_or(0.0);
                    let mut sum: f32 = (0..=radius as isize).map(get).sum();
                    for k in 0..count as isize {
                        self.density[start + k as usize * stride] = sum / (2 * radius + 1) as f32;
                        sum += get(k + 1 + radius as isize) - get(k - radius as isize);
                    }
                }
            }
        }
    }

    /// Returns the surface where the density is `level`, with vertices in meters.
    pub(super) fn surface(&self, level: f32) -> TriMesh {
        let shape = RuntimeShape::<u32, 3>::new(self.size.to_array());
        let values: Vec<f32> = self.density.iter().map(|density| level - density).collect();
        let mut net = SurfaceNetsBuffer::default();
        surface_nets(&values, &shape, [0; 3], (self.size - 1).to_array(), &mut net);
        TriMesh {
            positions: net.positions.iter().map(|p| self.origin + self.cell * Vec3::from(*p)).collect(),
            triangles: net.indices.as_chunks().0.to_vec(),
            ..Default::default()
        }
    }

    /// Largest density.
    pub(super) fn densest(&self) -> f32 {
        self.density.iter().copied().fold(0.0, f32::max)
    }

    /// Edge of a cell, meters.
    pub(super) fn cell(&self) -> f32 {
        self.cell
    }

    /// Returns the density at `p`.
    pub(super) fn density(&self, p: Vec3) -> f32 {
        self.corner(p).weights().map(|(node, weight)| weight * self.density[self.index(node)]).sum()
    }

    /// Returns the direction in which hair becomes sparser fastest, or zero where it does not.
    pub(super) fn thinning(&self, p: Vec3) -> Vec3 {
        let d = |axis: Vec3| self.density(p + axis * self.cell) - self.density(p - axis * self.cell);
        -Vec3::new(d(Vec3::X), d(Vec3::Y), d(Vec3::Z)).normalize_or_zero()
    }

    /// Returns the direction out of the hair at `p`: away from the head close to it, otherwise where hair thins out.
    pub(super) fn outward(&self, p: Vec3) -> Vec3 {
        match self.head {
            Some(head) if head.sample(p) < NEAR => head.normal(p),
            _ => self.thinning(p),
        }
    }

    /// Returns the fraction of light from all around that reaches `p` through hair and past the head.
    pub(super) fn open(&self, p: Vec3) -> f32 {
        const STEPS: u32 = 12;
        let step = 0.12 / STEPS as f32;
        let directions = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|a| [a, -a]);
        let corners =
            (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0);
        let all: Vec<_> = directions.chain(corners.map(Vec3::normalize)).collect();
        let reached = all.iter().map(|d| {
            let mut depth = 0.0;
            for k in 0..STEPS {
                let at = p + *d * (step * (k as f32 + 0.5));
                if self.head.is_some_and(|head| head.sample(at) < -0.003) {
                    return 0.0;
                }
                depth += self.density(at) * step;
            }
            // A ray meets a fiber of random direction under a mean sine of π / 4.
            (-0.25 * std::f32::consts::PI * depth).exp()
        });
        reached.sum::<f32>() / all.len() as f32
    }
}

/// The eight nodes around a point.
struct Corner {
    base: UVec3,
    part: Vec3,
}

impl Corner {
    fn weights(&self) -> impl Iterator<Item = (UVec3, f32)> + use<> {
        let (base, part) = (self.base, self.part);
        (0..8).map(move |i| {
            let side = UVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let near = |axis: usize| if side[axis] == 1 { part[axis] } else { 1.0 - part[axis] };
            (base + side, near(0) * near(1) * near(2))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_has_the_area_and_falls_outwards() {
        let mut strands = Strands::default();
        for i in 0..900 {
            let at = Vec3::new((i % 30) as f32 - 14.5, 0.0, (i / 30) as f32 - 14.5) * 0.003;
            strands.push(&[at, at + Vec3::new(0.0, 0.1, 0.0)]);
        }
        let radii = vec![1e-4; strands.positions.len()];
        let volume = HairVolume::new(&strands, &radii, None, BLUR);
        let sum = volume.density.iter().sum::<f32>() * volume.cell.powi(3);
        assert!((sum / (900.0 * 0.1 * 2e-4) - 1.0).abs() < 0.01, "{sum}");
        let side = Vec3::new(0.05, 0.05, 0.0);
        assert!(volume.outward(side).dot(Vec3::X) > 0.95, "{}", volume.outward(side));
        let (inside, outside) =
            (volume.open(Vec3::new(0.0, 0.05, 0.0)), volume.open(Vec3::new(0.15, 0.05, 0.0)));
        assert!(inside < outside && outside > 0.8, "{inside} {outside}");
    }
}
