//! Drawn strands cover their area, and their light is finite and bounded.

use crate::common;

use common::{context, meter_is_pixel, picture, segments};
use tresses::{
    Camera, Context, Picture, View, ViewOptions,
    glam::Vec3,
    light::{HairMaterial, LightShape, Sphere},
    low_level::{HairSet, readback::blocking as readback, unpack_radiance},
    renderer::{ClassicOptions, Renderer, ShadingModel, ShadingRate, ShadowMethod},
};

/// Creates a view of `size`² pixels with this many samples and, along each axis, `ssaa` texels per pixel.
fn view(context: &Context, size: u32, samples: u32, ssaa: u32) -> View {
    let options = ViewOptions { renderer: Renderer::masks(samples), ..common::coarse() };
    View::new(context, &options, [size, size], ssaa).expect("fits")
}

fn render(context: &Context, view: &View, scene: &Picture, hair: &HairSet) -> Vec<u8> {
    picture(context, view, scene, &[hair], &[])
}

const SIZE: u32 = 512;
const CELL: u32 = 16;
const LENGTH: f32 = 9.0;

/// Draws strands of `LENGTH` pixels in all directions, one per cell of a grid so that none hides another. Returns the
/// expected and the drawn coverage, pixels.
fn coverage(context: &Context, width: f32, samples: u32, ssaa: u32) -> (f64, f64) {
    // One meter is one pixel.
    let cells = SIZE / CELL;
    let strands: Vec<_> = (0..cells * cells)
        .map(|i| {
            let noise = |k: u32| {
                (i.wrapping_mul(2_654_435_761).wrapping_add(k * 40_503) >> 8 & 0xffff) as f32 / 65_536.0
            };
            let center = Vec3::new((i % cells) as f32 + 0.5, (i / cells) as f32 + 0.5, 0.0) * CELL as f32
                + Vec3::new(noise(1) - 0.5, noise(2) - 0.5, 0.0);
            let angle = noise(3) * std::f32::consts::TAU;
            let half = Vec3::new(angle.cos(), angle.sin(), 0.0) * 0.5 * LENGTH;
            [center - half, center + half]
        })
        .collect();
    let view = view(context, SIZE, samples, ssaa);
    let strands_count = strands.len();
    let hair = segments(context, &strands, 0.5 * width);
    let half = SIZE as f32 * 0.5;
    let scene = Picture {
        camera: meter_is_pixel(SIZE),
        focus: Sphere { center: Vec3::new(half, half, 0.0), radius: SIZE as f32 },
        ..common::dark()
    };
    let picture = render(context, &view, &scene, &hair);
    let drawn: f64 = picture.chunks(4).map(|pixel| f64::from(pixel[3]) / 255.0).sum();
    (f64::from(width * LENGTH) * strands_count as f64, drawn)
}

#[test]
fn strips_cover_their_area() {
    let Some(context) = context() else { return };
    // (width in pixels, tolerance). Below a pixel each strand rounds to whole samples by its own hash, so that the sum
    // over 1024 strands has a statistical error.
    for (samples, ssaa) in [(4, 1), (1, 1), (4, 2)] {
        for (width, tolerance) in
            [(0.1, 0.2), (0.3, 0.09), (0.7, 0.06), (1.0, 0.03), (2.5, 0.02), (5.0, 0.02)]
        {
            // A single sample is smoothed along strands, and their ends blur into their surroundings.
            let tolerance = tolerance + if samples * ssaa == 1 { 0.02 } else { 0.0 };
            let (expected, drawn) = coverage(context, width, samples, ssaa);
            let error = drawn / expected - 1.0;
            println!(
                "{samples} samples, ssaa {ssaa}, {width} px: {drawn:.0} of {expected:.0} ({:+.1} %)",
                error * 100.0
            );
            assert!(error.abs() < tolerance, "{samples} samples, {width} px wide: {drawn} of {expected}");
        }
    }
}

/// Radiance is linear in the lights: half the light gives exactly half the radiance. NaN and infinity do not halve:
/// packed radiance stores them as black or as its maximum.
#[test]
fn light_is_finite_and_linear() {
    let Some(context) = context() else { return };
    let mut view = view(context, 16, 1, 1);
    // All directions of a sphere, far enough apart that no strand shades another.
    let strands: Vec<_> = (0..600)
        .map(|i| {
            let z = 1.0 - (i as f32 + 0.5) / 300.0;
            let angle = i as f32 * 2.399_963;
            let r = (1.0 - z * z).max(0.0).sqrt();
            let direction = Vec3::new(r * angle.cos(), r * angle.sin(), z);
            let at = direction * 0.2;
            [at, at + direction.any_orthonormal_vector() * 0.001 + direction * 0.002]
        })
        .collect();
    let mut hair = segments(context, &strands, 4e-5);
    let models = [ShadingModel::KajiyaKay, ShadingModel::Fiber];
    for (name, model) in HairMaterial::NAMES.iter().flat_map(|name| models.map(|model| (name, model))) {
        hair.material = HairMaterial::named(name).expect("a preset");
        let renderer = Renderer::masks(1).with_shading(model);
        view.set_options(&ViewOptions { renderer, ..*view.options() }).expect("fits");
        for eye in [Vec3::Z, Vec3::X, Vec3::NEG_Z, Vec3::Y * 0.99 + Vec3::Z * 0.1, Vec3::new(-0.5, 0.6, 0.4)]
        {
            let mut scene = Picture {
                camera: Camera::look_at(eye, Vec3::ZERO, 0.6, [16, 16]),
                focus: Sphere { center: Vec3::ZERO, radius: 0.3 },
                ..Default::default()
            };
            // Includes strands that are collinear with light and eye.
            scene.lights.list[0].shape = LightShape::Distant { direction: eye.normalize() };
            let shaded = |scene: &Picture| -> Vec<u32> {
                render(context, &view, scene, &hair);
                readback::buffer(context, &view.shaded(&hair).unwrap()).expect("values")
            };
            let whole = shaded(&scene);
            let lights = &mut scene.lights;
            lights.list.iter_mut().for_each(|light| light.intensity *= 0.5);
            let sky = &mut lights.sky;
            [&mut sky.zenith, &mut sky.horizon, &mut sky.ground].into_iter().for_each(|part| *part *= 0.5);
            for (whole, half) in whole.into_iter().zip(shaded(&scene)) {
                let (whole, half) = (unpack_radiance(whole), unpack_radiance(half));
                assert!(whole.min_element() > 0.0, "{name}, {model:?}: {whole}");
                assert_eq!(whole, 2.0 * half, "{name}, {model:?}");
            }
        }
    }
}

/// Hair in front of other hair: less light arrives behind it, and both shading rates agree.
#[test]
fn hair_shadows_hair() {
    let Some(context) = context() else { return };
    let classic = |rate, shadows| {
        let classic = ClassicOptions { rate, shadows, ..ClassicOptions::default() };
        ViewOptions { renderer: Renderer::Classic(classic), ..Default::default() }
    };
    let options = classic(ShadingRate::PerPixel, ShadowMethod::Opaque);
    let mut view = View::new(context, &options, [64, 64], 1).expect("fits");
    // Two curtains without gaps. The second is 1 cm behind the first as seen from the key light, and shorter, so that
    // no light reaches it past the ends of the first.
    let curtain = |z: f32, tall: f32| {
        (0..800).map(move |i| {
            let x = i as f32 * 1.25e-4 - 0.05;
            [Vec3::new(x, tall, z), Vec3::new(x, -tall, z)]
        })
    };
    let strands: Vec<_> = curtain(0.0, 0.06).chain(curtain(-0.01, 0.05)).collect();
    let mut hair = segments(context, &strands, 1e-4);
    let mut scene = Picture {
        camera: Camera::look_at(Vec3::new(0.0, 0.0, 0.5), Vec3::ZERO, 0.15, [64, 64]),
        focus: Sphere { center: Vec3::ZERO, radius: 0.1 },
        ..Default::default()
    };
    scene.lights.list[0].shape = LightShape::Distant { direction: Vec3::Z };
    // With two vertices per strand, terms that are nonlinear along a strand cannot agree.
    hair.material.root_darkness = 1.0;
    hair.material.shift_noise = 0.0;
    scene.shadows.has_ambient = false;
    // Fibers that each method counts in front of the second curtain. The first one is 1.6 fibers deep.
    let behind = scene.shadows.density * (0.01 - scene.shadows.bias);
    for (method, expected, tolerance) in [
        (ShadowMethod::Opaque, 20.0, 0.6),
        (ShadowMethod::Absorption, behind, 0.2),
        (ShadowMethod::DeepOpacity, 1.6, 0.15),
    ] {
        view.set_options(&classic(ShadingRate::PerPixel, method)).expect("fits");
        render(context, &view, &scene, &hair);
        let shaded: Vec<u8> = readback::buffer(context, &view.shaded(&hair).unwrap()).expect("values");
        let mean = |strands: std::ops::Range<usize>| {
            let count = strands.len() as f32;
            // The byte of the key light, in the first of two vertices of eight bytes each.
            strands.map(|i| (f32::from(shaded[i * 16]) / 255.0).powi(2) * 64.0).sum::<f32>() / count
        };
        // Skip the edges of the curtains, which light passes.
        let (front, back) = (mean(100..700), mean(900..1500));
        println!("{method:?}: {front} fibers before the first, {back} before the second");
        // Deep opacity maps count a part of the fibers in the same layer, in front of the point or behind it.
        assert!(front < if method == ShadowMethod::DeepOpacity { 0.8 } else { 0.01 }, "{method:?}: {front}");
        assert!((back - expected).abs() < tolerance, "{method:?}: {back}, not {expected}");
    }
    let pixels = render(context, &view, &scene, &hair);

    view.set_options(&classic(ShadingRate::PerVertex, ShadowMethod::DeepOpacity)).expect("fits");
    let vertices = render(context, &view, &scene, &hair);
    let level = |picture: &[u8]| picture.iter().map(|v| f64::from(*v)).sum::<f64>() / picture.len() as f64;
    let (a, b) = (level(&pixels), level(&vertices));
    assert!((a - b).abs() < 4.0, "per pixel {a}, per vertex {b}");
}
