//! Lights of every kind, and invalid ones.

use crate::common::{Picture, after, app, camera, groom, inside, settled, wait};
use bevy::{light::GlobalAmbientLight, prelude::*};
use bevy_tresses::{Hair3d, HairGroom};

/// Frames after which all changes are visible.
const ALL: usize = 4;

/// Position of the lights, so far that their light is nearly parallel at the hair.
const PLACE: Vec3 = Vec3::new(1.2, 0.8, 4.0);

/// Adds a light that points at `target`. Returns the image with the light, and removes it again.
fn lit(app: &mut App, image: &Handle<Image>, light: impl Bundle, target: Vec3) -> Picture {
    let place = Transform::from_translation(PLACE).looking_at(target, Vec3::Y);
    let entity = app.world_mut().spawn((light, place)).id();
    let picture = after(app, ALL, image);
    app.world_mut().despawn(entity);
    picture
}

#[test]
fn lights_of_every_kind_light_hair() {
    let mut app = app("assets");
    app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..Default::default() });
    let (_, image) = camera(&mut app);
    settled(&mut app, &image);
    let hair = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    app.world_mut().spawn(Hair3d(hair));
    wait(&mut app);
    let dark = after(&mut app, ALL, &image);

    // The same irradiance from each: candela are lumens over 4 π, or over π for a small rectangle.
    let lux = 2e4;
    let lumens = 4.0 * std::f32::consts::PI * lux * PLACE.length_squared();
    let sun = DirectionalLight { illuminance: lux, ..Default::default() };
    let point = PointLight { intensity: lumens, ..Default::default() };
    let spot = SpotLight { intensity: lumens, inner_angle: 0.5, outer_angle: 0.6, ..Default::default() };
    let rect = RectLight { intensity: lumens / 4.0, width: 0.1, height: 0.1, ..Default::default() };
    let distant = lit(&mut app, &image, sun, Vec3::ZERO);
    let pixels = inside(&distant.changed(&dark));
    assert!(pixels.len() > 200, "{} pixels of hair", pixels.len());
    let expected = distant.brightness(&pixels);
    for (name, near) in [
        ("point", lit(&mut app, &image, point, Vec3::ZERO)),
        ("spot", lit(&mut app, &image, spot, Vec3::ZERO)),
        ("rectangle", lit(&mut app, &image, rect, Vec3::ZERO)),
    ] {
        let found = near.brightness(&pixels);
        println!("{name}: {found}, distant {expected}");
        assert!((found / expected - 1.0).abs() < 0.06, "{name}: {found}, not {expected}");
    }
    let away = Vec3::Z * 9.0;
    assert!(lit(&mut app, &image, rect, away).is(&dark), "a rectangle shines on one side only");
    assert!(lit(&mut app, &image, spot, away).is(&dark), "hair is outside the cone");

    // Invalid lights are left out, and do not keep hair from being drawn.
    let invalid = PointLight { intensity: -1e5, ..point };
    let entity = app.world_mut().spawn((invalid, Transform::from_xyz(0.0, 0.2, 1.0))).id();
    app.world_mut().spawn((PointLight { range: 0.0, ..point }, Transform::from_xyz(0.0, 0.2, 1.0)));
    app.world_mut().spawn((SpotLight { inner_angle: -0.2, ..spot }, Transform::from_xyz(0.0, 0.2, 1.0)));
    assert!(lit(&mut app, &image, sun, Vec3::ZERO).is(&distant), "invalid lights change the image");
    app.world_mut().get_mut::<PointLight>(entity).unwrap().intensity = 1e5;
    assert!(!after(&mut app, ALL, &image).is(&dark), "a light that has become valid is used");
}
