//! Pictures of hair from all sides: opacity of strands and of cards, and how much of each strand is visible.

use super::{
    mesh::{CardMesh, Surface},
    strip::{sample_coverage, samples},
};
use crate::{Strands, TriMesh, progress::in_parallel};
use glam::{Vec2, Vec3};

/// Directions to the eyes: the faces and corners of a cube.
const EYES: [Vec3; 14] = [
    Vec3::Z,
    Vec3::NEG_Z,
    Vec3::X,
    Vec3::NEG_X,
    Vec3::Y,
    Vec3::NEG_Y,
    Vec3::new(1.0, 1.0, 1.0),
    Vec3::new(-1.0, 1.0, 1.0),
    Vec3::new(1.0, -1.0, 1.0),
    Vec3::new(-1.0, -1.0, 1.0),
    Vec3::new(1.0, 1.0, -1.0),
    Vec3::new(-1.0, 1.0, -1.0),
    Vec3::new(1.0, -1.0, -1.0),
    Vec3::new(-1.0, -1.0, -1.0),
];

/// A card in a sample of a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    /// Distance towards the eye, meters.
    depth: f32,
    pub(super) triangle: u32,
    pub(super) card: u32,
    pub(super) alpha: f32,
    /// Brightness, 0 to 1.
    pub(super) tone: f32,
}

/// Parallel projections of a sphere, and a head that hides hair behind it.
pub(super) struct Studio {
    center: Vec3,
    /// Samples per meter.
    scale: f32,
    /// Pixels along each edge, and samples along each edge of a pixel.
    size: usize,
    fine: usize,
    /// Depth of the head in each sample of each picture.
    head: Vec<Vec<f32>>,
}

/// A square of samples with a direction to the eye.
struct Eye<'a> {
    studio: &'a Studio,
    right: Vec3,
    up: Vec3,
    back: Vec3,
}

/// Opacity of each pixel, 0 to 1.
pub(super) type Opacity = Vec<f32>;

impl Studio {
    /// Frames the box `lo..hi` in images of `size` pixels of `fine` × `fine` samples.
    pub(super) fn new((lo, hi): (Vec3, Vec3), [size, fine]: [usize; 2], head: Option<&TriMesh>) -> Self {
        let radius = (0.51 * lo.distance(hi)).max(1e-6);
        let scale = (size * fine) as f32 / (2.0 * radius);
        let mut studio = Self { center: 0.5 * (lo + hi), scale, size, fine, head: Vec::new() };
        studio.head = in_parallel(&EYES, |back| studio.eye(*back).depths(head));
        studio
    }

    /// Returns the images of `strands` whose vertices have `radii`, and the number of samples in which each strand is
    /// in front.
    pub(super) fn strands(&self, strands: &Strands, radii: &[f32]) -> (Vec<Opacity>, Vec<u32>) {
        const NONE: u32 = u32::MAX;
        let views = in_parallel(&self.eyes(), |(back, behind)| {
            let eye = self.eye(*back);
            let mut depths = behind.to_vec();
            let mut nearest = vec![NONE; depths.len()];
            let mut passes = vec![1.0f32; depths.len()];
            for i in 0..strands.len() {
                let range = strands.range(i);
                for k in range.start + 1..range.end {
                    let (a, b) = (eye.project(strands.positions[k - 1]), eye.project(strands.positions[k]));
                    let half = [radii[k - 1] * self.scale, radii[k] * self.scale];
                    let depth = |t: f32| a.1 + (b.1 - a.1) * t;
                    samples([a.0, b.0], half, [eye.wide(); 2], |at, t| {
                        if depth(t) > depths[at] {
                            (depths[at], nearest[at]) = (depth(t), i as u32);
                        }
                    });
                    sample_coverage([a.0, b.0], half, [eye.wide(); 2], |at, t, coverage| {
                        if depth(t) > behind[at] {
                            passes[at] *= 1.0 - coverage;
                        }
                    });
                }
            }
            let opacity = self.reduced(|at| 1.0 - passes[at]);
            let mut counts = vec![0u32; strands.len()];
            nearest.iter().filter(|i| **i != NONE).for_each(|i| counts[*i as usize] += 1);
            (opacity, counts)
        });
        let mut counts = vec![0; strands.len()];
        let mut images = Vec::new();
        for (opacity, found) in views {
            counts.iter_mut().zip(found).for_each(|(sum, found)| *sum += found);
            images.push(opacity);
        }
        (images, counts)
    }

    /// Returns the images of `surface`, whose opacity is `alpha`.
    pub(super) fn cards(&self, surface: &Surface<'_>, alpha: &Pyramid) -> Vec<Opacity> {
        in_parallel(&self.eyes(), |(back, depths)| {
            let eye = self.eye(*back);
            let mut passes = vec![1.0f32; depths.len()];
            for triangle in surface.triangles {
                let corners = triangle.map(|v| surface.positions[v as usize]);
                let [u, v, w] = triangle.map(|v| surface.uvs[v as usize]);
                let texels = alpha.area([u, v, w]);
                eye.fill(corners, |at, [a, b, c], depth, area| {
                    if depth > depths[at] {
                        let level = 0.5 * (texels / area.max(1e-6)).max(1.0).log2();
                        passes[at] *= 1.0 - alpha.at(a * u + b * v + c * w, level);
                    }
                });
            }
            self.reduced(|at| 1.0 - passes[at])
        })
    }

    /// Calls `visit` for each sample with cards, with its layers sorted from the front. Returns a result for each
    /// picture. `alpha` is the opacity of texels, `tones` their brightness.
    pub(super) fn layered<R: Default + Send>(
        &self,
        mesh: &CardMesh,
        alpha: &Pyramid,
        tones: &[f32],
        visit: impl Fn(&mut R, &[Layer]) + Sync,
    ) -> Vec<R> {
        in_parallel(&self.eyes(), |(back, depths)| {
            let eye = self.eye(*back);
            let mut samples: Vec<Vec<Layer>> = vec![Vec::new(); depths.len()];
            for (number, triangle) in (0..).zip(&mesh.triangles) {
                let card = mesh.starts.partition_point(|start| *start <= triangle[0]) as u32 - 1;
                let corners = triangle.map(|v| mesh.positions[v as usize]);
                let [u, v, w] = triangle.map(|v| mesh.uvs[v as usize]);
                let light = triangle.map(|v| mesh.light[v as usize]);
                let texels = alpha.area([u, v, w]);
                eye.fill(corners, |at, [a, b, c], depth, area| {
                    if depth > depths[at] {
                        let level = 0.5 * (texels / area.max(1e-6)).max(1.0).log2();
                        let uv = a * u + b * v + c * w;
                        let lit = a * light[0] + b * light[1] + c * light[2];
                        let tone = lit * tones[alpha.nearest(uv)];
                        let alpha = alpha.at(uv, level);
                        samples[at].push(Layer { depth, triangle: number, card, alpha, tone });
                    }
                });
            }
            let mut found = R::default();
            for layers in samples.iter_mut().filter(|layers| !layers.is_empty()) {
                layers.sort_by(|a, b| b.depth.total_cmp(&a.depth));
                visit(&mut found, layers);
            }
            found
        })
    }

    /// Directions to the eyes, and the head's depths.
    fn eyes(&self) -> Vec<(Vec3, &[f32])> {
        EYES.into_iter().zip(self.head.iter().map(Vec::as_slice)).collect()
    }

    fn eye(&self, back: Vec3) -> Eye<'_> {
        let back = back.normalize();
        let reference_axis = if back.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
        let right = reference_axis.cross(back).normalize();
        Eye { studio: self, right, up: back.cross(right), back }
    }

    /// Averages the samples of each pixel.
    fn reduced(&self, of: impl Fn(usize) -> f32) -> Opacity {
        let wide = self.size * self.fine;
        let pixel = |i: usize| {
            let (x, y) = (i % self.size * self.fine, i / self.size * self.fine);
            let all = (0..self.fine * self.fine).map(|k| of((y + k / self.fine) * wide + x + k % self.fine));
            all.sum::<f32>() / (self.fine * self.fine) as f32
        };
        (0..self.size * self.size).map(pixel).collect()
    }
}

/// A position in samples, and towards the eye in meters.
type ProjectedPoint = (Vec2, f32);

impl Eye<'_> {
    fn wide(&self) -> usize {
        self.studio.size * self.studio.fine
    }

    fn project(&self, p: Vec3) -> ProjectedPoint {
        let from = p - self.studio.center;
        let flat = Vec2::new(from.dot(self.right), -from.dot(self.up)) * self.studio.scale;
        (flat + 0.5 * self.wide() as f32, from.dot(self.back))
    }

    /// Returns the depth of `head` in each sample.
    fn depths(&self, head: Option<&TriMesh>) -> Vec<f32> {
        let mut depths = vec![f32::NEG_INFINITY; self.wide() * self.wide()];
        let Some(head) = head else { return depths };
        for triangle in &head.triangles {
            let corners = triangle.map(|v| head.positions[v as usize]);
            self.fill(corners, |at, _, depth, _| depths[at] = depths[at].max(depth));
        }
        depths
    }

    /// Calls `visit` for each sample of a triangle: its index, barycentric coordinates, depth, and the triangle's area
    /// in samples.
    fn fill(&self, corners: [Vec3; 3], mut visit: impl FnMut(usize, [f32; 3], f32, f32)) {
        let [a, b, c] = corners.map(|p| self.project(p));
        let twice = (b.0 - a.0).perp_dot(c.0 - a.0);
        if twice.abs() < 1e-9 {
            return;
        }
        let wide = self.wide();
        let (lo, hi) = (a.0.min(b.0).min(c.0), a.0.max(b.0).max(c.0));
        let range = |lo: f32, hi: f32| {
            (lo - 0.5).ceil().max(0.0) as usize..((hi + 0.5).floor().max(0.0) as usize).min(wide)
        };
        for y in range(lo.y, hi.y) {
            for x in range(lo.x, hi.x) {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let u = (b.0 - p).perp_dot(c.0 - p) / twice;
                let v = (c.0 - p).perp_dot(a.0 - p) / twice;
                let w = 1.0 - u - v;
                if u >= 0.0 && v >= 0.0 && w > 0.0 {
                    visit(y * wide + x, [u, v, w], u * a.1 + v * b.1 + w * c.1, 0.5 * twice.abs());
                }
            }
        }
    }
}

/// A square image with its mips, values 0 to 1.
pub(super) struct Pyramid {
    /// Edge and values of each level.
    levels: Vec<(usize, Vec<f32>)>,
}

impl Pyramid {
    /// Creates the mips of an image of `size` × `size` values; `size` is a power of two.
    pub(super) fn new(size: usize, values: Vec<f32>) -> Self {
        let mut levels = vec![(size, values)];
        while let Some((size, values)) = levels.last().filter(|(size, _)| *size > 1) {
            let half = size / 2;
            let at = |x: usize, y: usize| values[y * size + x];
            let mean = |i: usize| {
                let (x, y) = (i % half * 2, i / half * 2);
                0.25 * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1))
            };
            let next = (0..half * half).map(mean).collect();
            levels.push((half, next));
        }
        Self { levels }
    }

    /// Returns the area of a triangle of texture coordinates, texels.
    fn area(&self, [a, b, c]: [Vec2; 3]) -> f32 {
        0.5 * (b - a).perp_dot(c - a).abs() * (self.levels[0].0 * self.levels[0].0) as f32
    }

    /// Returns the index of the texel at a texture coordinate.
    fn nearest(&self, uv: Vec2) -> usize {
        let size = self.levels[0].0;
        let [x, y] = (uv * size as f32).to_array().map(|at| (at.max(0.0) as usize).min(size - 1));
        y * size + x
    }

    /// Returns the value at a texture coordinate and a fractional level.
    fn at(&self, uv: Vec2, level: f32) -> f32 {
        let level = level.min((self.levels.len() - 1) as f32);
        let low = level as usize;
        let value = self.bilinear(uv, low);
        let part = level - low as f32;
        if part < 1e-3 { value } else { value + part * (self.bilinear(uv, low + 1) - value) }
    }

    fn bilinear(&self, uv: Vec2, level: usize) -> f32 {
        let (size, values) = &self.levels[level.min(self.levels.len() - 1)];
        let last = *size as f32 - 1.0;
        let at = (uv * *size as f32 - 0.5).clamp(Vec2::ZERO, Vec2::splat(last));
        let base = at.floor().min(Vec2::splat((last - 1.0).max(0.0)));
        let part = at - base;
        let (x, y) = (base.x as usize, base.y as usize);
        let (right, below) = ((x + 1).min(size - 1), (y + 1).min(size - 1));
        let row = |y: usize| values[y * size + x] * (1.0 - part.x) + values[y * size + right] * part.x;
        row(y) * (1.0 - part.y) + row(below) * part.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strands_and_an_opaque_card_cover_their_area() {
        // A fifth of a square of 10 cm, and all of it.
        let mut strands = Strands::default();
        for i in 0..20 {
            let x = 5e-3 * (i as f32 + 0.5) - 0.05;
            strands.push(&[Vec3::new(x, 0.05, 0.0), Vec3::new(x, -0.05, 0.0)]);
        }
        let radii = vec![0.5e-3; 40];
        let bounds = (Vec3::new(-0.05, -0.05, 0.0), Vec3::new(0.05, 0.05, 0.0));
        let studio = Studio::new(bounds, [64, 4], None);
        let area = |opacity: &Opacity| {
            let pixel = studio.fine as f32 / studio.scale;
            opacity.iter().sum::<f32>() * pixel * pixel
        };
        let (images, seen) = studio.strands(&strands, &radii);
        assert!((area(&images[0]) - 0.002).abs() < 4e-5, "{}", area(&images[0]));
        assert!(seen.iter().all(|count| *count > 0));
        let positions =
            [(-0.05, 0.05), (0.05, 0.05), (0.05, -0.05), (-0.05, -0.05)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let surface = Surface { positions: &positions, uvs: &uvs, triangles: &[[0, 1, 2], [0, 2, 3]] };
        let alpha = |value: f32| Pyramid::new(32, vec![value; 32 * 32]);
        let card = studio.cards(&surface, &alpha(1.0));
        assert!((area(&card[0]) - 0.01).abs() < 2e-4, "{}", area(&card[0]));
        assert!((area(&studio.cards(&surface, &alpha(0.3))[0]) - 0.003).abs() < 1e-4);
        // A head in front hides the card from the front, but not from behind.
        let head = TriMesh {
            positions: positions.map(|p| 2.0 * p + 0.1 * Vec3::Z).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Default::default()
        };
        let studio = Studio::new(bounds, [64, 4], Some(&head));
        let hidden = studio.cards(&surface, &alpha(1.0));
        assert!(area(&hidden[0]) == 0.0 && (area(&hidden[1]) - 0.01).abs() < 2e-4);
    }

    #[test]
    fn mips_keep_the_mean() {
        let values: Vec<f32> = (0..64 * 64).map(|i| f32::from(u8::from(i % 3 == 0))).collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let pyramid = Pyramid::new(64, values);
        assert!((pyramid.at(Vec2::splat(0.3), 6.0) - mean).abs() < 1e-5);
        assert!((pyramid.at(Vec2::splat(0.5), 4.5) - mean).abs() < 0.02);
    }
}
