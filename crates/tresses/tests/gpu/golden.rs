//! Small images of hair on a ball, compared with golden images. `TRESSES_WRITE_GOLDEN=1` writes new golden images: look
//! at them before you commit them.

use crate::common;

use std::path::Path;
use tresses::{
    Body, Camera, Context, Picture, View, ViewOptions,
    glam::Vec3,
    groom::{TriMesh, bound::Strand},
    light::{FiberMaterial, HairMaterial, Sphere},
    low_level::{HairSet, StrandBuffers, StrandVertex, Tier, pack_tangent},
    renderer::{Renderer, ShadingModel},
};

pub const SIZE: [u32; 2] = [120, 96];
const VERTICES: u32 = 12;

/// Number of strands on the ball.
pub const COUNT: u32 = 3000;

/// Creates wavy strands that leave the upper half of a ball of radius 8 cm and fall. `numbers` selects some of the
/// [`COUNT`] strands.
pub fn strands(context: &Context, numbers: impl IntoIterator<Item = u32>) -> StrandBuffers {
    let count = COUNT as i32;
    let mut vertices = Vec::new();
    let mut infos = Vec::new();
    for i in numbers.into_iter().map(|i| i as i32) {
        let z = 1.0 - (i as f32 + 0.5) / count as f32 * 0.9;
        let around = i as f32 * 2.399_963;
        let r = (1.0 - z * z).sqrt();
        let normal = Vec3::new(r * around.cos(), z, r * around.sin());
        let side = normal.cross(Vec3::Y).normalize_or(Vec3::X);
        let point = |k: u32| {
            let s = k as f32 / (VERTICES - 1) as f32;
            let out = normal * (0.08 + 0.03 * s * (1.0 - 0.6 * s)) + Vec3::Y * (-0.09 * s * s);
            out + side * 0.006 * (9.0 * s + 0.02 * (i % 40) as f32).sin() * s
        };
        for k in 0..VERTICES {
            let tangent = (point(k + 1) - point(k)).normalize();
            let radius = 1.0 - 0.6 * k as f32 / (VERTICES - 1) as f32;
            vertices.push(StrandVertex { position: point(k), tangent: pack_tangent(tangent, radius) });
        }
        infos.push(Strand {
            radius: 5e-4,
            seed: (i as u32).wrapping_mul(0x9e37_79b9),
            root_color: 0,
            tip_color: 0,
        });
    }
    common::upload(context, VERTICES as usize, &vertices, &infos)
}

pub fn ball() -> TriMesh {
    let (rows, columns) = (24u32, 48u32);
    let mut mesh = TriMesh::default();
    for row in 0..=rows {
        for column in 0..columns {
            let (theta, phi) = (
                row as f32 / rows as f32 * std::f32::consts::PI,
                column as f32 / columns as f32 * std::f32::consts::TAU,
            );
            let normal = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            mesh.positions.push(normal * 0.08);
            mesh.normals.push(normal);
            if row < rows {
                let at = |r: u32, c: u32| (row + r) * columns + (column + c) % columns;
                mesh.triangles.push([at(0, 0), at(0, 1), at(1, 0)]);
                mesh.triangles.push([at(0, 1), at(1, 1), at(1, 0)]);
            }
        }
    }
    mesh
}

pub fn picture(context: &Context, model: ShadingModel, hair_material: HairMaterial) -> Vec<u8> {
    let renderer = Renderer::masks(4).with_shading(model);
    let options = ViewOptions { shadow_resolution: 256, renderer, ..Default::default() };
    let view = View::new(context, &options, SIZE, 1).expect("fits");
    let mut hair = HairSet::new(context, &strands(context, 0..COUNT)).expect("fits");
    hair.material = hair_material;
    let body = Body::new(context, &ball());
    common::picture(context, &view, &scene(), &[&hair], &[&body])
}

/// Returns the scene, with a camera in front of the ball.
pub fn scene() -> Picture {
    Picture {
        camera: Camera::look_at(Vec3::new(0.2, 0.12, 0.5), Vec3::new(0.0, -0.01, 0.0), 0.38, SIZE),
        focus: Sphere { center: Vec3::ZERO, radius: 0.15 },
        ..Default::default()
    }
}

/// Returns the mean and the 99th percentile of the differences of all channels, in steps of 1/255.
pub fn difference(a: &[u8], b: &[u8]) -> (f64, u8) {
    assert_eq!(a.len(), b.len());
    let mut steps: Vec<u8> = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).collect();
    steps.sort_unstable();
    (steps.iter().map(|v| f64::from(*v)).sum::<f64>() / steps.len() as f64, steps[steps.len() * 99 / 100])
}

/// Maximum mean difference of the same image on two drivers, in steps of 1/255. Drivers may place samples and round as
/// they like.
pub const DRIVER_DIFFERENCE: f64 = 0.75;

/// Whether `a` matches the stored image `b`, which Mesa's software driver has drawn.
fn agree(context: &Context, a: &[u8], b: &[u8]) -> bool {
    let (mean, high) = difference(a, b);
    println!("mean difference {mean:.2}, 99th percentile {high}");
    match context.tier().software {
        true => mean < 0.25 && high < 5,
        false => mean < DRIVER_DIFFERENCE,
    }
}

#[test]
fn hair_on_a_ball_matches_the_golden_images() {
    let Some(context) = common::context() else { return };
    let brown = HairMaterial::brown();
    let lighter = HairMaterial { diffuse: 1.3 * brown.diffuse, ..brown };
    let flat = HairMaterial { opacity: 0.0, ..brown };
    compare(context, ("ball.png", ShadingModel::KajiyaKay), brown, &[lighter, flat]);

    let fiber = |fiber: FiberMaterial| HairMaterial { fiber, ..brown };
    let lighter = fiber(FiberMaterial { root_absorption: 0.7 * brown.fiber.root_absorption, ..brown.fiber });
    let mut smooth = brown.fiber;
    smooth.shape.longitudinal = 0.2;
    let alone = fiber(FiberMaterial { density_forward: 0.0, density_back: 0.0, ..brown.fiber });
    compare(context, ("ball-fiber.png", ShadingModel::Fiber), brown, &[lighter, fiber(smooth), alone]);
}

/// Lists of tiles are stored in squares of texels on GPUs.
#[test]
fn tiles_of_both_tiers_draw_the_same_image() {
    let Some(context) = common::context() else { return };
    for samples in [1, 4] {
        let [own, other] = [true, false].map(|software| {
            let context = &context.clone().with_tier(Tier { software, ..context.tier() });
            let options = ViewOptions { renderer: Renderer::tiles(samples), ..common::coarse() };
            let view = View::new(context, &options, SIZE, 1).expect("fits");
            let hair = HairSet::new(context, &strands(context, 0..COUNT)).expect("fits");
            let body = Body::new(context, &ball());
            // The second frame orders only the fronts of the lists.
            [(); 2].map(|()| common::picture(context, &view, &scene(), &[&hair], &[&body]))
        });
        assert!(own == other, "{samples} samples");
        assert!(own[0] == own[1] && own[0].iter().any(|value| *value != own[0][0]), "{samples} samples");
    }
}

/// Compares `material` with the image `name`, and checks that the other materials look different.
fn compare(
    context: &Context,
    (name, model): (&str, ShadingModel),
    material: HairMaterial,
    others: &[HairMaterial],
) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    let now = picture(context, model, material);
    if std::env::var_os("TRESSES_WRITE_GOLDEN").is_some() {
        let file = std::fs::File::create(&path).expect("a writable tree");
        let mut encoder = png::Encoder::new(file, SIZE[0], SIZE[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.write_header().and_then(|mut writer| writer.write_image_data(&now)).expect("a PNG");
    }
    let file = std::fs::File::open(&path).expect("the golden picture");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
    let mut golden = vec![0; reader.output_buffer_size().expect("a small picture")];
    reader.next_frame(&mut golden).expect("a PNG");
    assert!(agree(context, &now, &golden), "{name} has changed");

    // Slightly different hair colors and missing terms are detected.
    for other in others {
        assert!(!agree(context, &picture(context, model, *other), &golden), "{other:?}");
    }
    // Rendering is deterministic.
    assert_eq!(difference(&now, &picture(context, model, material)), (0.0, 0));
}
