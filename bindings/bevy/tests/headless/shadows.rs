//! Shadows between hair and Bevy's meshes, for every kind of light.

use crate::common::{after, app, app_that_casts, camera, groom, settled, wait};
use bevy::{light::GlobalAmbientLight, prelude::*};
use bevy_tresses::{Hair3d, HairGroom};

/// Frames after which all changes are visible.
const ALL: usize = 4;

/// Adds a light of a kind, with shadow maps, at the same place for all kinds.
fn lamp(app: &mut App, kind: usize) -> Entity {
    let place = Transform::from_xyz(0.0, 1.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y);
    let world = app.world_mut();
    match kind {
        0 => world.spawn((
            DirectionalLight { shadow_maps_enabled: true, illuminance: 9000.0, ..Default::default() },
            place,
        )),
        1 => world
            .spawn((SpotLight { shadow_maps_enabled: true, intensity: 2.4e5, ..Default::default() }, place)),
        _ => world
            .spawn((PointLight { shadow_maps_enabled: true, intensity: 2.4e5, ..Default::default() }, place)),
    }
    .id()
}

fn block(app: &mut App, place: Transform) -> Entity {
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::from_length(1.0));
    let material = StandardMaterial {
        base_color: Color::WHITE,
        perceptual_roughness: 1.0,
        reflectance: 0.0,
        ..Default::default()
    };
    let material = app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(material);
    app.world_mut().spawn((Mesh3d(mesh), MeshMaterial3d(material), place)).id()
}

#[test]
fn meshes_cast_shadows_on_hair() {
    let mut app = app("assets");
    app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..Default::default() });
    let (_, picture) = camera(&mut app);
    let bare = settled(&mut app, &picture);
    let hair = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    app.world_mut().spawn(Hair3d(hair));
    wait(&mut app);
    // Hair comes to rest, so that only light changes.
    after(&mut app, 12, &picture);
    for (kind, name) in ["directional", "spot", "point"].into_iter().enumerate() {
        let light = lamp(&mut app, kind);
        let lit = after(&mut app, ALL, &picture);
        let seen = lit.changed(&bare);
        assert!(seen.len() > 300, "{name}: {} pixels of hair", seen.len());
        // A plate halfway to the light, outside the camera's view.
        let half = Transform::from_xyz(0.0, 0.5, 0.5).looking_at(Vec3::ZERO, Vec3::Y);
        let plate = block(&mut app, half.with_scale(Vec3::new(0.6, 0.6, 0.01)));
        let shaded = after(&mut app, ALL, &picture);
        shaded.keep(&format!("shaded-{name}"));
        let [before, behind] = [&lit, &shaded].map(|picture| picture.brightness(&seen));
        println!("{name}: hair of {before}, behind a block {behind}");
        assert!(behind < 0.1 * before, "{name}");
        app.world_mut().despawn(plate);
        // A block beside the light's path changes nothing.
        let aside = block(&mut app, Transform::from_xyz(2.0, 0.5, 0.5).with_scale(Vec3::splat(0.4)));
        assert!(after(&mut app, ALL, &picture).is(&lit), "{name}: a block beside the way of the light");
        app.world_mut().despawn(aside);
        app.world_mut().despawn(light);
    }
}

#[test]
fn hair_casts_shadows_on_meshes() {
    let [with, without] = [1.0, 0.0].map(|casts| {
        let mut app = app_that_casts("assets", casts);
        app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..Default::default() });
        lamp(&mut app, 0);
        let (_, picture) = camera(&mut app);
        block(&mut app, Transform::from_xyz(0.0, 0.0, -0.3).with_scale(Vec3::new(2.0, 2.0, 0.01)));
        let bare = settled(&mut app, &picture);
        let hair = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
        app.world_mut().spawn(Hair3d(hair));
        wait(&mut app);
        let dressed = after(&mut app, ALL, &picture);
        dressed.keep(&format!("casts-{casts}"));
        (bare, dressed)
    });
    assert!(with.0.is(&without.0), "a scene without hair is as it was");
    // Light comes from above and the front, so the shadow on the wall is below the hair.
    let shadow = with.1.changed(&without.1);
    let [lit, dark] = [&without.1, &with.1].map(|picture| picture.brightness(&shadow));
    println!("{} pixels of {lit} in the shadow of hair, there {dark}", shadow.len());
    assert!(shadow.len() > 200 && dark < 0.5 * lit);
    assert!(shadow.iter().all(|[_, y]| *y > 48), "it lies where the light goes");
    let hair = without.1.changed(&without.0);
    let kept = hair.iter().filter(|at| !shadow.contains(at)).count();
    assert!(kept > hair.len() / 2, "hair itself is as bright: {kept} of {}", hair.len());
}
