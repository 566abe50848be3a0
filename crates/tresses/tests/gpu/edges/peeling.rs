//! Depth peeling compared with strands that are sorted and blended on the CPU.

use super::{groom::Groom, mode, picture::Studio};
use crate::common;
use tresses::{
    Background, Picture,
    glam::{DVec2, DVec3, Vec3},
    groom::hash::pcg,
    light::{HairMaterial, Sphere},
    low_level::{HairSet, readback::blocking as readback, unpack_radiance},
    renderer::Renderer,
};

const SIZE: u32 = 128;
const STRANDS: u32 = 300;
const LENGTH: f32 = 90.0;
/// Radius of a strand, pixels.
const RADIUS: f32 = 0.35;
/// Radiance of the background.
const BACKGROUND: f64 = 0.05;

/// Returns straight strands in all directions at many depths. One meter is one pixel.
fn straws() -> Groom {
    let mut points = Vec::new();
    for i in 0..STRANDS {
        let noise = |channel: u32| pcg(8 * i + channel) as f32 / u32::MAX as f32;
        let middle = Vec3::new(noise(1), noise(2), noise(3)) * SIZE as f32;
        let angle = noise(4) * std::f32::consts::TAU;
        let half = 0.5 * LENGTH * Vec3::new(angle.cos(), angle.sin(), 0.4 * noise(5) - 0.2);
        points.extend([middle - half, middle + half]);
    }
    Groom { vertices: 2, points, root_radius: RADIUS, tip_radius: RADIUS }
}

fn scene() -> Picture {
    let half = SIZE as f32 * 0.5;
    let mut camera = common::meter_is_pixel(SIZE);
    // Depth goes from 0 to 1 over the strands and as far behind them, so that millimeters are resolved.
    camera.projection.z_axis.z = 1.0 / 256.0;
    camera.projection.w_axis.z = 0.25 + 1e4 / 256.0;
    let mut scene = Picture {
        camera,
        focus: Sphere { center: Vec3::splat(half), radius: SIZE as f32 },
        background: Background::flat(Vec3::splat(BACKGROUND as f32)),
        ..Default::default()
    };
    // Below the shoulder, tone mapping changes nothing.
    scene.tone.exposure = 1.0;
    scene.tone.shoulder = 0.98;
    scene
}

/// Returns a flat material with a different lightness for each strand.
fn plain() -> HairMaterial {
    HairMaterial {
        lightness_spread: 0.9,
        opacity: 0.0,
        primary: 0.0,
        secondary: 0.0,
        transmission: 0.0,
        ..HairMaterial::blond()
    }
}

/// Uploads `groom` with that material, for peeling `layers` layers.
fn peeled<'a>(context: &'a tresses::Context, groom: &Groom, layers: u32) -> (Studio<'a>, HairSet) {
    let studio = Studio::new(context, mode("", Renderer::peeling(layers), 1), [SIZE; 2]);
    let (mut hair, _strands) = studio.hair(groom);
    hair.material = plain();
    (studio, hair)
}

/// Returns the area of a pixel inside the rectangle of a strand, by clipping the pixel at each side.
fn area(pixel: DVec2, [a, b]: [DVec2; 2], radius: f64) -> f64 {
    let along = (b - a).normalize();
    let across = DVec2::new(-along.y, along.x);
    let mut polygon: Vec<_> =
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| pixel + DVec2::new(x, y)).to_vec();
    for (normal, at) in [
        (across, across.dot(a) + radius),
        (-across, -across.dot(a) + radius),
        (along, along.dot(b)),
        (-along, -along.dot(a)),
    ] {
        let mut cut = Vec::new();
        for i in 0..polygon.len() {
            let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (d, e) = (normal.dot(p) - at, normal.dot(q) - at);
            if d <= 0.0 {
                cut.push(p);
            }
            if (d < 0.0) != (e < 0.0) && d != e {
                cut.push(p + (q - p) * (d / (d - e)));
            }
        }
        polygon = cut;
    }
    let doubled: f64 =
        (0..polygon.len()).map(|i| polygon[i].perp_dot(polygon[(i + 1) % polygon.len()])).sum();
    0.5 * doubled
}

/// Returns the exact linear radiance of every pixel, and the largest number of strands in a pixel.
fn sorted(groom: &Groom, colors: &[DVec3]) -> (Vec<DVec3>, usize) {
    let mut most = 0;
    let pixels = (0..SIZE * SIZE).map(|i| {
        let pixel = DVec2::new(f64::from(i % SIZE) + 0.5, f64::from(SIZE - 1 - i / SIZE) + 0.5);
        let mut found = Vec::new();
        for (ends, color) in groom.points.chunks(2).zip(colors.chunks(2)) {
            let [a, b] = [ends[0], ends[1]].map(|p| p.as_dvec3());
            let covered = area(pixel, [a.truncate(), b.truncate()], f64::from(RADIUS));
            if covered < 1e-6 {
                continue;
            }
            let t = (pixel - a.truncate()).dot((b - a).truncate()) / (b - a).truncate().length_squared();
            let inside = t.clamp(0.0, 1.0);
            found.push((a.z + (b.z - a.z) * t, covered, color[0] + (color[1] - color[0]) * inside));
        }
        most = most.max(found.len());
        // Back to front.
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.iter().fold(DVec3::splat(BACKGROUND), |sum, (_, covered, color)| sum + covered * (color - sum))
    });
    let pixels = pixels.collect();
    (pixels, most)
}

fn srgb(v: f64) -> f64 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the root mean square error in steps of 1/255.
fn error(picture: &[[u8; 4]], exact: &[DVec3]) -> f64 {
    let sum: f64 = picture
        .iter()
        .zip(exact)
        .flat_map(|(p, e)| {
            (0..3).map(move |c| (f64::from(p[c]) - 255.0 * srgb(e[c].clamp(0.0, 1.0))).powi(2))
        })
        .sum();
    (sum / (3 * exact.len()) as f64).sqrt()
}

fn drawn(context: &tresses::Context, groom: &Groom, layers: u32) -> Vec<[u8; 4]> {
    let (studio, hair) = peeled(context, groom, layers);
    studio.picture(&scene(), &hair)
}

#[test]
fn hair_behind_the_layers_is_weighted_by_depth() {
    let Some(context) = common::context() else { return };
    // 6 cm deep, like a head of hair. In the other groom strands are meters apart, so their order behind the layers is
    // unknown.
    let (deep, mut hair) = (straws(), straws());
    hair.points.iter_mut().for_each(|p| p.z = 0.06 * p.z / SIZE as f32 + 0.5 * SIZE as f32);
    let difference = |a: &[[u8; 4]], b: &[[u8; 4]]| {
        let square = |(a, b): (&[u8; 4], &[u8; 4])| -> f64 {
            a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum()
        };
        (a.iter().zip(b).map(square).sum::<f64>() / (3 * a.len()) as f64).sqrt()
    };
    // A pixel contains at most twelve strands.
    let exact = [&hair, &deep].map(|groom| drawn(context, groom, 16));
    for (layers, bound) in [(1, 0.5), (2, 0.6)] {
        let [known, unknown] =
            [0, 1].map(|i| difference(&drawn(context, [&hair, &deep][i], layers), &exact[i]));
        println!("{layers} layers: {known:.2} / 255 from 16 layers, in any order {unknown:.2}");
        assert!(known < bound * unknown && unknown > 0.8, "{known} {unknown}");
    }
}

#[test]
fn more_layers_approach_sorted_blending() {
    let Some(context) = common::context() else { return };
    let (groom, scene) = (straws(), scene());
    let mut errors = Vec::new();
    let mut exact = Vec::new();
    for layers in [1, 2, 4, 8, 16] {
        let (studio, hair) = peeled(context, &groom, layers);
        let picture = studio.picture(&scene, &hair);
        if exact.is_empty() {
            // Take the colors of the strands from the GPU. This test is about blending only.
            let shaded: Vec<u32> = readback::buffer(context, &studio.shaded(&hair)).expect("values");
            let colors: Vec<_> = shaded.into_iter().map(|word| unpack_radiance(word).as_dvec3()).collect();
            let brightest = colors.iter().map(|c| c.max_element()).fold(0.0, f64::max);
            assert!((0.2..0.98).contains(&brightest), "{brightest}");
            let (pixels, most) = sorted(&groom, &colors);
            println!("at most {most} strands in a pixel, the brightest {brightest:.2}");
            assert!((8..=16).contains(&most), "{most}");
            exact = pixels;
        }
        errors.push(error(&picture, &exact));
        println!("{layers:2} layers: {:.2} / 255", errors[errors.len() - 1]);
    }
    assert!(errors.windows(2).all(|pair| pair[1] < 0.8 * pair[0] || pair[1] < 0.6), "{errors:?}");
    // Rounding to 8 bits and dither alone cause 0.4.
    assert!(errors[4] < 0.8, "{errors:?}");
    // Strands in another order are detected.
    let mut turned = groom.clone();
    turned.points.iter_mut().for_each(|p| p.z = SIZE as f32 - p.z);
    let (studio, hair) = peeled(context, &turned, 16);
    assert!(error(&studio.picture(&scene, &hair), &exact) > 3.0);
}
