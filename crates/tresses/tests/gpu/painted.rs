//! Meshes with the textures of their materials.

use crate::common;
use tresses::{
    Body, Camera, Context, Picture, View, ViewOptions,
    glam::{Vec2, Vec3},
    groom::{
        TriMesh,
        mesh::{
            Paint,
            paint::{Coat, Texture},
        },
    },
    light::{Light, Lights},
    renderer::Renderer,
};

const SIZE: [u32; 2] = [64, 64];
/// Texel of a relief texture: a flat normal and medium roughness.
const EVEN: [u8; 4] = [128, 128, 180, 255];

/// Returns a square that fills the image, seen from +Z. Texture coordinates go from the upper left to the lower right
/// corner.
fn wall() -> TriMesh {
    common::rectangle([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0)))
}

/// Returns the paint of the [`wall`] with the texture `base`, one `relief` texel, and a `cutout` threshold.
fn paint(base: Texture, relief: [u8; 4], cutout: Option<f32>) -> Paint {
    Paint {
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
        of: vec![0; 4],
        coats: vec![Coat { base, relief: Texture::even(relief), cutout }],
    }
}

/// Returns the colors at the centers of the image's quarters: upper left, upper right, lower left, lower right.
fn quarters(context: &Context, body: &Body, light: Vec3) -> [[f32; 3]; 4] {
    let list = vec![Light::distant(light.normalize(), Vec3::splat(1.5))];
    let lights = Lights { list, ..common::dark().lights };
    let camera = Camera::look_at(3.0 * Vec3::Z, Vec3::ZERO, 0.62, SIZE);
    let picture = Picture { camera, lights, ..common::dark() };
    let options = ViewOptions { renderer: Renderer::masks(1), ..common::coarse() };
    let view = View::new(context, &options, SIZE, 1).expect("fits");
    let pixels = common::picture(context, &view, &picture, &[], &[body]);
    [(16, 16), (48, 16), (16, 48), (48, 48)].map(|(x, y)| {
        let first = 4 * (y * SIZE[0] as usize + x);
        [0, 1, 2].map(|channel| f32::from(pixels[first + channel]))
    })
}

#[test]
fn textures_have_the_right_orientation_and_cutout() {
    let Some(context) = common::context() else { return };
    let [red, green, blue, faint] =
        [[220, 20, 20, 255], [20, 220, 20, 255], [20, 20, 220, 255], [200, 200, 200, 40]];
    let base = Texture { width: 2, height: 2, rgba: [red, green, blue, faint].concat() };
    let mut body = Body::new(context, &wall());
    let plain = quarters(context, &body, Vec3::Z);
    body.paint(&paint(base.clone(), EVEN, None)).unwrap();
    let painted = quarters(context, &body, Vec3::Z);
    println!("{plain:?}\n{painted:?}");
    let dominates = |channel: usize, i: usize| {
        (0..3).all(|other| other == channel || painted[i][channel] > 2.0 * painted[i][other])
    };
    assert!(dominates(0, 0) && dominates(1, 1) && dominates(2, 2));
    assert!(painted[3][0] > 100.0 && plain.iter().all(|rgb| (rgb[0] - plain[0][0]).abs() < 3.0));
    // Cut-out texels show the background.
    body.paint(&paint(base, EVEN, Some(0.5))).unwrap();
    let cut = quarters(context, &body, Vec3::Z);
    assert_eq!(cut[..3], painted[..3]);
    assert!(cut[3][0] < 60.0, "{cut:?}");
}

#[test]
fn normals_and_roughness_affect_shading() {
    let Some(context) = common::context() else { return };
    let mut body = Body::new(context, &wall());
    body.material.wrap = 0.0;
    let mut brightness = |relief: [u8; 4], light: Vec3| {
        body.paint(&paint(Texture::even([180, 180, 180, 255]), relief, None)).unwrap();
        quarters(context, &body, light)[0][1]
    };
    // Normals that lean to the right, or up, by half as much as they point outwards.
    let [right, up] = [[185, 128, 180, 255], [128, 185, 180, 255]];
    for (relief, towards) in [(right, Vec3::X), (up, Vec3::Y)] {
        let facing = brightness(relief, Vec3::Z + towards);
        let [even, away] = [brightness(EVEN, Vec3::Z + towards), brightness(relief, Vec3::Z - towards)];
        println!("{towards}: {away} {even} {facing}");
        assert!(facing > even + 10.0 && away < even - 10.0);
    }
    // Highest roughness, lit from behind and from the side: dark, and no NaN.
    for light in [Vec3::NEG_Z, Vec3::X, Vec3::new(1.0, 0.0, -1e-3)] {
        let dark = brightness([128, 128, 255, 255], light);
        assert!(dark < 100.0, "{light}: {dark}");
    }
    // A smooth surface reflects the light back to where it comes from, where the camera is.
    let [smooth, rough] =
        [60, 250].map(|blue| brightness([128, 128, blue, 255], Vec3::Z + Vec3::new(-0.15, 0.15, 0.0)));
    println!("smooth {smooth}, rough {rough}");
    assert!(smooth > rough + 10.0);
}

#[test]
fn paint_for_another_mesh_is_an_error() {
    let Some(context) = common::context() else { return };
    let mut body = Body::new(context, &wall());
    let valid = paint(Texture::even([255; 4]), EVEN, None);
    let mut error_after = |change: fn(&mut Paint)| {
        let mut paint = valid.clone();
        change(&mut paint);
        body.paint(&paint).unwrap_err().to_string()
    };
    assert!(error_after(|paint| paint.of.truncate(3)).contains("mesh"));
    assert!(error_after(|paint| paint.of[2] = 1).contains("mesh"));
    let different_sizes = |paint: &mut Paint| {
        paint.coats.push(paint.coats[0].clone());
        paint.coats[1].base = Texture { width: 2, height: 1, rgba: vec![9; 8] };
    };
    assert!(error_after(different_sizes).contains("same size"));
}
