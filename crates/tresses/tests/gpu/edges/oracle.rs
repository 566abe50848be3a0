//! Brute-force coverage on the CPU: tests every strand's strip against a grid of points in each pixel. Shares no code
//! with the shaders.

use super::groom::Groom;
use tresses::{
    Camera,
    glam::{DMat4, DVec2, DVec3, Vec3},
};

/// Points along each axis of a pixel.
const GRID: usize = 16;

/// Returns the area that `groom` covers as seen by `view`, pixels.
pub fn covered(groom: &Groom, view: &Camera) -> f64 {
    let [width, height] = view.size.map(|v| v as usize * GRID);
    let mut hit = vec![false; width * height];
    let matrix = view.projection.as_dmat4() * view.view.as_dmat4();
    let size = DVec2::new(width as f64, height as f64);
    let eye = view.eye().as_dvec3();
    for first in (0..groom.points.len()).step_by(groom.vertices) {
        let sides: Vec<_> = (first..first + groom.vertices)
            .map(|i| {
                let p = groom.points[i].as_dvec3();
                let across = groom.tangent(i).as_dvec3().cross(eye - p).normalize();
                let side = across * f64::from(groom.radius(i));
                [project(matrix, size, p - side), project(matrix, size, p + side)]
            })
            .collect();
        for pair in sides.windows(2) {
            let ([a, b], [c, d]) = (pair[0], pair[1]);
            fill(&mut hit, [width, height], [a, b, c]);
            fill(&mut hit, [width, height], [c, b, d]);
        }
    }
    hit.iter().filter(|hit| **hit).count() as f64 / (GRID * GRID) as f64
}

fn project(matrix: DMat4, size: DVec2, p: DVec3) -> DVec2 {
    let clip = matrix * p.extend(1.0);
    DVec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * size
}

/// Marks the cells whose center is in a triangle, row by row.
fn fill(hit: &mut [bool], [width, height]: [usize; 2], corners: [DVec2; 3]) {
    let low = corners.iter().map(|c| c.y).fold(f64::MAX, f64::min);
    let high = corners.iter().map(|c| c.y).fold(f64::MIN, f64::max);
    let first = (low - 0.5).ceil().max(0.0) as usize;
    for row in first..height {
        let y = row as f64 + 0.5;
        if y > high {
            break;
        }
        let (mut left, mut right) = (f64::MAX, f64::MIN);
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if (a.y <= y) != (b.y <= y) {
                let x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
                left = left.min(x);
                right = right.max(x);
            }
        }
        let begin = (left - 0.5).ceil().max(0.0) as usize;
        let end = ((right - 0.5).ceil().max(0.0) as usize).min(width);
        if begin < end {
            hit[row * width + begin..row * width + end].fill(true);
        }
    }
}

#[test]
fn single_strand_covers_its_area() {
    let groom = Groom {
        vertices: 2,
        points: vec![Vec3::new(-0.1, 0.03, 0.0), Vec3::new(0.1, -0.05, 0.0)],
        root_radius: 0.004,
        tip_radius: 0.004,
    };
    let view = Camera::look_at(Vec3::Z, Vec3::ZERO, 0.4, [120, 100]);
    let pixel = f64::from(view.pixel());
    let exact = 0.008 * f64::from(groom.points[0].distance(groom.points[1])) / (pixel * pixel);
    let found = covered(&groom, &view);
    assert!((found / exact - 1.0).abs() < 2e-3, "{found}, not {exact}");
}
