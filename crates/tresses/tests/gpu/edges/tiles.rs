//! Properties of the tile rasterizer: exact area at any width, no seams, lists of any length, clipping at the near
//! plane, and outlines of bodies.

use super::{MASK_4_2X, PEEL, TILES, TILES_1, groom::Groom, mode, picture::Studio, picture::total};
use crate::{common, golden::difference};
use tresses::{
    Background, Body, Camera, Context, Picture,
    glam::{Quat, Vec2, Vec3},
    groom::bound::Strand,
    light::{Light, Sphere},
    renderer::Renderer,
};

const SIZE: [u32; 2] = [256, 224];

/// About a twentieth of a pixel: exactly 13 steps of eight bits, because otherwise all pixels along a row would round
/// in the same direction.
const WHOLE: f32 = 13.0 / 255.0;

/// Returns a scene with a camera whose pixels at the origin are 1 mm wide.
fn scene() -> Picture {
    let fov = 0.4f32;
    let distance = 0.5e-3 * SIZE[1] as f32 / (0.5 * fov).tan();
    let camera = Camera::look_at(Vec3::Z * distance, Vec3::ZERO, fov, SIZE);
    Picture { camera, focus: Sphere { center: Vec3::ZERO, radius: 0.2 }, ..common::dark() }
}

/// Returns parallel strands of `width` millimeters at an angle, `apart` millimeters from each other.
fn comb(width: f32, angle: f32, apart: f32) -> Groom {
    let count = (120.0 / apart.max(width + 4.0)).floor().max(1.0) as usize;
    let turn = Quat::from_rotation_z(angle);
    let vertices = 7;
    let points = (0..count).flat_map(|i| {
        let y = (i as f32 - 0.5 * (count - 1) as f32) * apart.max(width + 4.0) + 0.137 * i as f32;
        (0..vertices).map(move |k| turn * Vec3::new(-31.3 + 62.6 * k as f32 / 6.0, y, 0.0) * 1e-3)
    });
    Groom { vertices, points: points.collect(), root_radius: 5e-4 * width, tip_radius: 5e-4 * width }
}

/// Returns the relative error of the area of `drawn`, compared with the exact area of `meant`.
fn error(studio: &Studio<'_>, drawn: &Groom, meant: &Groom) -> f64 {
    let (hair, _strands) = studio.hair(drawn);
    let area: f64 = meant
        .points
        .chunks(meant.vertices)
        .map(|strand| {
            f64::from(strand[0].distance(*strand.last().unwrap())) * f64::from(2.0 * meant.root_radius) * 1e6
        })
        .sum();
    total(&studio.picture(&scene(), &hair)) / area - 1.0
}

#[test]
fn strands_of_any_width_cover_their_area() {
    let Some(context) = common::context() else { return };
    let studio = Studio::new(context, TILES_1, SIZE);
    for width in [WHOLE, 0.2, 0.7, 1.0, 3.0, 17.0, 80.0, 200.0] {
        for angle in [0.0f32, 0.11, 0.6, 0.785, 1.4] {
            // Strands that are wider than long leave the image when rotated.
            if width > 60.0 && angle > 0.2 {
                continue;
            }
            let groom = comb(width, angle, 5.3);
            let found = error(&studio, &groom, &groom);
            // With eight bits per pixel, coverage of a twentieth of a pixel is accurate to some thousandths.
            let most = if width < 0.1 { 0.012 } else { 0.005 };
            println!("{width} mm at {angle}: {:+.3} %", 100.0 * found);
            assert!(found.abs() < most, "{width} mm at {angle}: {found}");
        }
    }
    let groom = comb(1.0, 0.6, 5.3);
    let wide =
        Groom { root_radius: 1.01 * groom.root_radius, tip_radius: 1.01 * groom.tip_radius, ..groom.clone() };
    assert!(error(&studio, &wide, &groom).abs() > 0.005, "the comparison sees a hundredth");
}

/// Returns a wide strand along an arc, with this many vertices.
fn arc(vertices: usize, radius: f32) -> Groom {
    let points = (0..vertices).map(|k| {
        let angle = 2.6 * k as f32 / (vertices - 1) as f32;
        Vec3::new(60.0 * angle.cos(), 60.0 * angle.sin() - 25.0, 0.0) * 1e-3
    });
    Groom { vertices, points: points.collect(), root_radius: radius, tip_radius: radius }
}

#[test]
fn wide_curved_strand_has_no_seams() {
    let Some(context) = common::context() else { return };
    let studio = Studio::new(context, TILES_1, SIZE);
    let inside = |groom: &Groom| {
        let (hair, _strands) = studio.hair(groom);
        let picture = studio.picture(&scene(), &hair);
        // Samples along the center line of the strand and 8 pixels to either side of it.
        let alphas = (3..257).map(|k| {
            let angle = 2.6 * k as f32 / 260.0;
            let at = Vec2::new(60.0 * angle.cos(), 25.0 - 60.0 * angle.sin())
                + 0.5 * Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
            let off = |d: f32| at + d * Vec2::new(angle.cos(), -angle.sin());
            [-8.0, 0.0, 8.0]
                .map(off)
                .map(|p| picture[p.y as usize * SIZE[0] as usize + p.x as usize][3])
                .into_iter()
                .min()
                .unwrap()
        });
        alphas.min().unwrap()
    };
    for vertices in [12, 24, 64] {
        assert_eq!(inside(&arc(vertices, 0.012)), 255, "{vertices} vertices");
    }
    // A thinner strand does not reach the samples at the sides, which the test detects.
    assert!(inside(&arc(12, 0.006)) < 255);
}

/// Returns strands across the whole image, each in a hundred tiles, which overlap in a known order.
fn lattice(count: usize) -> Groom {
    let vertices = 2;
    let points = (0..count).flat_map(|i| {
        let s = i as f32 / count as f32;
        let turn = Quat::from_rotation_z(2.399_963 * i as f32);
        [-1.0, 1.0].map(|x| turn * Vec3::new(0.12 * x, 0.08 * (s * 77.7).fract() - 0.04, 0.05 * s))
    });
    Groom { vertices, points: points.collect(), root_radius: 2e-4, tip_radius: 2e-4 }
}

#[test]
fn overflowing_tile_lists_are_drawn_in_rounds() {
    let Some(context) = common::context() else { return };
    let wait = |studio: &Studio<'_>| studio.is_complete();
    let shown = |groom: &Groom, redrawn: bool| {
        let studio = Studio::new(context, TILES_1, SIZE);
        let (hair, _strands) = studio.hair(groom);
        let picture = studio.picture(&scene(), &hair).as_flattened().to_vec();
        let complete = wait(&studio);
        let again = studio.picture(&scene(), &hair).as_flattened().to_vec();
        assert!(!redrawn || wait(&studio), "lists have grown");
        (picture, complete, again)
    };
    // 4,000 strands need about 160,000 entries, twice the capacity. 30,000 strands need more than four times the
    // capacity.
    let (rounds, complete, one) = shown(&lattice(4000), true);
    assert!(complete);
    assert_eq!(difference(&rounds, &one).0, 0.0, "in rounds or in one go, the picture is the same");
    let (torn, complete, whole) = shown(&lattice(30_000), true);
    assert!(!complete && difference(&torn, &whole).0 > 1.0, "what does not fit is seen to be missing");
}

#[test]
fn strands_are_clipped_at_the_near_plane() {
    let Some(context) = common::context() else { return };
    // The camera is inside the hair, so that some strands begin behind it.
    let view = Picture {
        camera: Camera::look_at(Vec3::new(0.01, 0.05, 0.082), Vec3::new(0.1, 0.03, 0.0), 0.9, SIZE),
        focus: Sphere { center: Vec3::ZERO, radius: 0.2 },
        background: Background::transparent(),
        ..common::dark()
    };
    let groom = Groom::on_a_ball(2000, 4e-4);
    let shown = |m, groom: &Groom| {
        let studio = Studio::new(context, m, SIZE);
        let (hair, _strands) = studio.hair(groom);
        studio.picture(&view, &hair)
    };
    // Hair without light is black, so compare alpha.
    let difference = |a: &[[u8; 4]], b: &[[u8; 4]]| {
        let sum: u32 = a.iter().zip(b).map(|(a, b)| u32::from(a[3].abs_diff(b[3]))).sum();
        f64::from(sum) / a.len() as f64
    };
    let exact = shown(mode("16 layers", Renderer::peeling(16), 1), &groom);
    let mean = difference(&shown(TILES_1, &groom), &exact);
    let less = Groom { points: groom.points[..16 * 1400].to_vec(), ..groom.clone() };
    let other = difference(&shown(TILES_1, &less), &exact);
    println!("{mean:.3} of 255, {other:.3} with some strands fewer");
    assert!(mean < 1.0 && other > 3.0 * mean, "{mean} {other}");
}

/// Draws strands at one place of the image in one depth bin, the nearest last. Of `count` strands, the nearer half is
/// red, the other half green. `shown` selects strands by their relative depth, and `turned` reverses the depth.
fn crowd(context: &Context, count: usize, shown: impl Fn(f32) -> bool, turned: bool) -> Vec<u8> {
    let depths = (0..count).rev().map(|i| (i ^ 5) as f32 / count as f32).filter(|s| shown(*s));
    let depths: Vec<f32> = depths.collect();
    // A strand far behind occupies the last bin, so that the others share the first.
    let at = |s: f32| [-20.0, if turned { s - 1.0 } else { -s } * 0.4];
    let points = depths.iter().map(|s| at(*s)).chain([[-10.0, -40.0]]);
    let points = points.flat_map(|[x, z]| [-1.0, 1.0].map(|y| Vec3::new(x + 0.1 * y, 30.0 * y, z) * 1e-3));
    let groom = Groom { vertices: 2, points: points.collect(), root_radius: 2e-3, tip_radius: 2e-3 };
    let studio = Studio::new(context, TILES_1, SIZE);
    let (hair, buffers) = studio.hair(&groom);
    let colors = depths.iter().map(|s| if *s < 0.5 { 0xff } else { 0xff00 }).chain([0xff]);
    let infos: Vec<_> =
        colors.map(|color| Strand { radius: 2e-3, seed: 1, root_color: color, tip_color: color }).collect();
    context.queue().write_buffer(&buffers.strands, 0, bytemuck::cast_slice(&infos));
    let mut view = scene();
    view.lights.list.push(Light::distant(Vec3::Z, Vec3::splat(9.0)));
    studio.picture(&view, &hair).as_flattened().to_vec()
}

#[test]
fn crowded_depth_bins_are_sorted() {
    let Some(context) = common::context() else { return };
    // The counts cover both ways of sorting: counting, and sorting by a workgroup. The nearer half hides the other one.
    for count in [30, 400, 1000, 6001] {
        let front = crowd(context, count, |s| s < 0.5, false);
        let all = difference(&crowd(context, count, |_| true, false), &front).0;
        let turned = difference(&crowd(context, count, |_| true, true), &front).0;
        println!("{count}: {all:.4} of 255 off the nearer half, {turned:.3} when the farther half is nearer");
        assert!(all < 0.06 && turned > 5.0 * all, "{count}: {all} {turned}");
    }
}

/// A frame follows tile lists as far as the previous frame needed, and farther where that is not enough. The image must
/// be the same whatever came before.
#[test]
fn image_does_not_depend_on_the_previous_frame() {
    let Some(context) = common::context() else { return };
    let light = Light::distant(Vec3::Z, Vec3::splat(9.0));
    let from = |eye: Vec3| {
        let camera = Camera::look_at(eye, Vec3::ZERO, 0.4, SIZE);
        let mut scene = Picture { camera, ..scene() };
        scene.lights.list.push(light);
        scene
    };
    let [front, aside, near, far] =
        [Vec3::Z * 0.5, Vec3::new(0.3, 0.1, 0.4), Vec3::Z * 0.22, Vec3::Z * 3.0].map(from);
    let wide = Groom::on_a_ball(4000, 4e-4);
    // Needs five times as many strands to become opaque.
    let thin = Groom { root_radius: 8e-5, tip_radius: 8e-5, ..wide.clone() };
    let pictures = [
        (&wide, &front),
        (&wide, &front),
        (&thin, &front),
        (&wide, &aside),
        (&thin, &near),
        (&wide, &far),
        (&thin, &front),
        (&wide, &near),
    ];
    for mode in [TILES_1, TILES] {
        let studio = Studio::new(context, mode, SIZE);
        let hair = [&wide, &thin].map(|groom| studio.hair(groom));
        let ball = Body::new(context, &crate::golden::ball());
        let mut before = Vec::new();
        for (i, (groom, scene)) in pictures.into_iter().enumerate() {
            let own = usize::from(std::ptr::eq(groom, &thin));
            let shown = studio.picture_with_bodies(scene, &hair[own].0, &[&ball]).as_flattened().to_vec();
            let alone = Studio::new(context, mode, SIZE);
            let (own, _strands) = alone.hair(groom);
            let alone = alone.picture_with_bodies(scene, &own, &[&ball]).as_flattened().to_vec();
            assert!(shown == alone, "{i}");
            assert!(i < 2 || shown != before, "{i}: there is something to see");
            before = shown;
        }
    }
}

/// A frame records the rounds that it may need, by the last count that has arrived. The image must be the same as with
/// all rounds.
#[test]
fn image_does_not_depend_on_the_recorded_rounds() {
    let Some(context) = common::context() else { return };
    let groom = Groom { root_radius: 1e-4, tip_radius: 1e-4, ..Groom::on_a_ball(3000, 1e-4) };
    let mut seen = Vec::new();
    // Distances of the camera: at rest, slowly and quickly closer, into the hair, and out again.
    let slow = (0..6).map(|i| 0.9 * 0.98f32.powi(i));
    let quick = (0..8).map(|i| 0.8 * 0.8f32.powi(i));
    let path: Vec<_> = [0.9; 4].into_iter().chain(slow).chain(quick).chain([0.15, 0.15, 0.9, 0.9]).collect();
    let studio = Studio::new(context, TILES_1, SIZE);
    let (hair, _strands) = studio.hair(&groom);
    for distance in path {
        let camera = Camera::look_at(Vec3::Z * distance, Vec3::ZERO, 0.4, SIZE);
        let scene = Picture { camera, ..scene() };
        let (shown, dispatches) = studio.picture_and_dispatch_count(&scene, &hair);
        seen.push(dispatches / 7);
        let alone = Studio::new(context, TILES_1, SIZE);
        let (hair, _strands) = alone.hair(&groom);
        assert_eq!(
            alone.picture_and_dispatch_count(&scene, &hair).1,
            4 * 7,
            "nothing is known of a first picture"
        );
        while !alone.is_complete() {
            alone.picture(&scene, &hair);
        }
        assert!(shown == alone.picture(&scene, &hair), "{distance}");
    }
    println!("rounds: {seen:?}");
    assert!(seen.contains(&1) && seen.iter().filter(|rounds| **rounds == 4).count() > 3, "{seen:?}");
}

/// Hair behind and in front of a body's edge is weighted by the body's samples.
#[test]
fn body_outlines_in_front_of_hair_are_smooth() {
    let Some(context) = common::context() else { return };
    let cube = Body::new(context, &common::cube(0.07));
    let groom = Groom::on_a_ball(3000, 3e-4);
    let view = Picture { background: Background::default(), ..super::coverage::scene(0.6, SIZE) };
    let view =
        Picture { camera: Camera::look_at(Vec3::new(0.2, 0.12, 0.55), Vec3::Y * 0.05, 0.35, SIZE), ..view };
    let shown = |m| {
        let studio = Studio::new(context, m, SIZE);
        let (hair, _strands) = studio.hair(&groom);
        studio.picture_with_bodies(&view, &hair, &[&cube]).as_flattened().to_vec()
    };
    let exact = shown(mode("64 samples", Renderer::masks(4), 4));
    let [many, one, peeled, masks] =
        [TILES, TILES_1, PEEL, MASK_4_2X].map(|m| difference(&shown(m), &exact).0);
    println!(
        "off by {many:.3} of 255 with four samples, {one:.3} with one; peeled {peeled:.3}, masks {masks:.3}"
    );
    assert!(many < 0.96 * one && many < 0.96 * peeled, "{many} {one} {peeled}");
}
