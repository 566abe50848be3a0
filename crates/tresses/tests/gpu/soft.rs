//! Light on meshes is evaluated at few shading points, and looks as if it were evaluated at many.

use crate::{
    common,
    golden::{self, SIZE, difference},
};
use tresses::{
    Body, Camera, Picture, View, ViewOptions,
    glam::Vec3,
    groom::TriMesh,
    light::{Light, Lights, Sphere},
    low_level::HairSet,
    renderer::Renderer,
};

/// Returns a floor under the golden image's hair, which shadows it. Nothing else is visible.
fn floor() -> TriMesh {
    common::rectangle(
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, z)| Vec3::new(x, -0.16, z)),
    )
}

/// With sixteen times the pixels there are sixteen times the shading points, a quarter as far apart. Averaged, both
/// give the same image. The test fails if hair casts no shadow.
#[test]
fn few_shading_points_match_many() {
    let Some(context) = common::context() else { return };
    let hair = HairSet::new(context, &golden::strands(context, 0..golden::COUNT)).expect("fits");
    let body = Body::new(context, &floor());
    let light = Light::distant(Vec3::new(0.1, 1.0, 0.2).normalize(), Vec3::splat(2.0));
    let lights = Lights { list: vec![light], ..Lights::default() };
    let picture = Picture {
        camera: Camera::look_at(Vec3::new(0.0, -0.11, 0.4), Vec3::new(0.0, -0.16, 0.06), 0.2, SIZE),
        focus: Sphere { center: Vec3::ZERO, radius: 0.25 },
        lights,
        ..golden::scene()
    };
    let options = ViewOptions { renderer: Renderer::masks(1), ..Default::default() };
    let draw = |ssaa: u32, hair: &[&HairSet]| {
        let view = View::new(context, &options, SIZE, ssaa).expect("fits");
        common::picture(context, &view, &picture, hair, &[&body])
    };
    let few = draw(1, &[&hair]);
    let (mean, high) = difference(&few, &draw(4, &[&hair]));
    println!("mean {mean:.3} of 255, 99th percentile {high}");
    assert!(mean < 0.6 && high < 10, "{mean} {high}");
    let (bare, _) = difference(&few, &draw(1, &[]));
    println!("{bare:.3} without its shadow");
    assert!(bare > 4.0, "hair shades it: {bare}");
}
