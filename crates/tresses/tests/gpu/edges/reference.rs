//! Coverage of a real groom compared with a path-traced image.

use super::{
    ALPHA_4_2X, Mode,
    groom::Groom,
    modes,
    picture::{Studio, total},
};
use crate::common;
use std::{fs::File, io::BufReader, path::Path};
use tresses::{Camera, Picture, glam::Vec3, groom::import, light::Sphere};

/// Sizes of the images, pixels. The reference has 960×600 pixels, so they correspond to 1.5, 3 and 6 times its camera
/// distance. Strands are 0.4, 0.2 and 0.1 pixels wide at the root.
const SIZES: [[u32; 2]; 3] = [[640, 400], [320, 200], [160, 100]];

/// Vertices per drawn strand.
const VERTICES: usize = 32;

/// Returns the groom at `path` with the curves of the path-traced image: uniform cubic B-splines with a mirrored point
/// beyond each end, with radius 0.17 mm at the root and 0.07 mm at the tip.
fn sintel(path: &Path) -> Groom {
    let (strands, _) = import::read(&[path], &Default::default()).expect("a groom");
    let mut points = Vec::new();
    for strand in strands.iter() {
        let point_count = strand.len();
        let control = |i: isize| match i {
            -1 => 2.0 * strand[0] - strand[1],
            i if i as usize == point_count => 2.0 * strand[point_count - 1] - strand[point_count - 2],
            i => strand[i as usize],
        };
        for k in 0..VERTICES {
            let parameter = k as f32 / (VERTICES - 1) as f32 * (point_count - 1) as f32;
            let i = (parameter as isize).min(point_count as isize - 2);
            let u = parameter - i as f32;
            // Basis functions of the cubic B-spline at fraction `u` of segment `i`, times 6.
            let weights = [
                (1.0 - u).powi(3),
                3.0 * u.powi(3) - 6.0 * u * u + 4.0,
                -3.0 * u.powi(3) + 3.0 * u * u + 3.0 * u + 1.0,
                u.powi(3),
            ];
            let point = (0..4).map(|j| control(i - 1 + j) * weights[j as usize]).sum::<Vec3>() / 6.0;
            points.push(point);
        }
    }
    Groom { vertices: VERTICES, points, root_radius: 1.7e-4, tip_radius: 0.7e-4 }
}

/// Returns the total coverage in the reference image, pixels.
fn reference_coverage(path: &Path) -> f64 {
    let file = File::open(path).expect("the reference");
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().expect("a PNG");
    let mut texels = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut texels).expect("a PNG");
    assert_eq!((info.width, info.height, info.color_type), (960, 600, png::ColorType::Grayscale));
    texels.iter().map(|v| f64::from(*v) / 255.0).sum()
}

#[test]
fn real_groom_coverage_matches_the_path_tracer() {
    check_coverage(&SIZES[2..], |mode| [super::MASK_4_2X, super::TILES, super::ALPHA_4].contains(&mode));
}

/// Prints the table of docs/validation/coverage.md.
#[test]
#[ignore = "proof"]
fn real_groom_coverage_matches_the_path_tracer_in_any_mode() {
    check_coverage(&SIZES, |mode| mode != ALPHA_4_2X);
}

/// Compares the coverage of images of these sizes with the path-traced one, in the modes that `includes` selects.
/// Asserts that all are within 1 %, and that alpha to coverage is not.
fn check_coverage(sizes: &[[u32; 2]], includes: impl Fn(Mode) -> bool) {
    let Some(picture) = common::asset("../reference/sintel_coverage.png") else { return };
    let Some(file) = common::asset(common::SINTEL) else { return };
    let Some(context) = common::context() else { return };
    let reference_pixels = reference_coverage(&picture);
    let groom = sintel(&file);
    let eye = Vec3::new(0.299_269_2, 1.586_853_9, 0.518_349_5);
    for mode in modes(context.tier().max_samples).filter(|mode| includes(*mode)) {
        let mut studio = Studio::new(context, mode, SIZES[0]);
        let (hair, _strands) = studio.hair(&groom);
        let errors = sizes.iter().map(|&size| {
            studio.resize(size);
            let target = Vec3::new(0.0, 1.545, 0.0);
            let scene = Picture {
                camera: Camera::look_at(eye, target, 30f32.to_radians(), size),
                focus: Sphere { center: target, radius: 0.2 },
                ..common::dark()
            };
            let scale = f64::from(size[0]) / 960.0;
            total(&studio.picture(&scene, &hair)) / (reference_pixels * scale * scale) - 1.0
        });
        let errors: Vec<_> = errors.collect();
        println!("{:36} {:+.2?} %", mode.name, errors.iter().map(|e| 100.0 * e).collect::<Vec<_>>());
        let is_accurate = errors.iter().all(|error| error.abs() < 0.01);
        // Alpha to coverage turns equal alpha into the same samples, so overlapping strands lose coverage. The test
        // must detect that.
        assert_eq!(is_accurate, !mode.is_alpha(), "{}: {errors:?}", mode.name);
    }
}
