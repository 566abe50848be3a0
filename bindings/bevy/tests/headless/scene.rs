//! Hair in Bevy's scenes: occlusion, several cameras, instances, removal.

use crate::common::{after, app, camera, groom, image, light, middle, settled, wait};
use bevy::{
    camera::{RenderTarget, ScalingMode, Viewport, visibility::RenderLayers},
    prelude::*,
};
use bevy_tresses::{Hair3d, HairGroom, NoHair};

/// Frames after which all changes are visible.
const ALL: usize = 4;

fn wear(app: &mut App, at: Vec3) -> Entity {
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    let hair = app.world_mut().spawn((Hair3d(groom), Transform::from_translation(at))).id();
    wait(app);
    hair
}

/// Adds a thin unlit plate of `color` and width `size` at depth `z`.
fn cube(app: &mut App, color: Color, z: f32, size: f32) -> Entity {
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::from_length(1.0));
    let material = StandardMaterial { base_color: color, unlit: true, ..Default::default() };
    let material = app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(material);
    let place = Transform::from_xyz(0.0, 0.0, z).with_scale(Vec3::new(size, size, 0.01));
    app.world_mut().spawn((Mesh3d(mesh), MeshMaterial3d(material), place)).id()
}

#[test]
fn hair_is_occluded_by_the_scene() {
    let mut app = app("assets");
    light(&mut app);
    let (camera, picture) = camera(&mut app);
    let wall = cube(&mut app, Color::srgb(0.2, 0.4, 0.8), -0.3, 2.0);
    let bare = settled(&mut app, &picture);
    assert!(after(&mut app, 2, &picture).is(&bare), "a scene without hair stands still");

    let hair = wear(&mut app, Vec3::ZERO);
    let dressed = after(&mut app, ALL, &picture);
    dressed.keep("dressed");
    let covered = dressed.changed(&bare);
    assert!(covered.len() > 400, "{} pixels of hair", covered.len());
    // The fan is to the right of the center, and its height is half its width.
    let [left, right] = [covered.iter().map(|p| p[0]).min(), covered.iter().map(|p| p[0]).max()];
    assert!(left.is_some_and(|x| x > 64) && right.is_some_and(|x| x < 116), "{left:?} to {right:?}");
    assert!((middle(&covered).y - 48.0).abs() < 4.0, "{}", middle(&covered));

    for msaa in [Msaa::Off, Msaa::Sample4] {
        app.world_mut().entity_mut(camera).insert(msaa);
        let free = after(&mut app, ALL, &picture);
        let hair = free.changed(&bare).len();
        assert!(hair > 400, "{msaa:?}: {hair} pixels of hair before the wall");
        // A plate in front of hair hides it.
        let front = cube(&mut app, Color::srgb(0.1, 0.7, 0.2), 0.25, 0.6);
        let hidden = after(&mut app, ALL, &picture);
        app.world_mut().entity_mut(camera).insert(NoHair);
        let alone = after(&mut app, ALL, &picture);
        assert!(hidden.is(&alone), "{msaa:?}: hair shines through");
        assert!(free.changed(&alone).len() > 400, "the comparer sees no difference");
        app.world_mut().entity_mut(camera).remove::<NoHair>();
        // A plate in the middle of the fan hides half of it.
        app.world_mut()
            .entity_mut(front)
            .insert(Transform::from_xyz(0.0, 0.0, 0.0).with_scale(Vec3::new(2.0, 2.0, 0.001)));
        let halved = after(&mut app, ALL, &picture);
        app.world_mut().entity_mut(camera).insert(NoHair);
        let half = halved.changed(&after(&mut app, ALL, &picture)).len();
        assert!(half > hair / 4 && half < hair, "{msaa:?}: {half} of {hair} pixels");
        app.world_mut().entity_mut(camera).remove::<NoHair>();
        app.world_mut().despawn(front);
    }

    app.world_mut().entity_mut(camera).insert(Msaa::Off);
    // In an orthographic projection of matching size, hair covers about the same pixels.
    let parallel = OrthographicProjection {
        scaling_mode: ScalingMode::FixedVertical { viewport_height: 0.4228 },
        ..OrthographicProjection::default_3d()
    };
    app.world_mut().entity_mut(camera).insert(Projection::from(parallel));
    let seen = after(&mut app, ALL, &picture).changed(&bare);
    let [near, share] =
        [(middle(&seen) - middle(&covered)).length(), seen.len() as f32 / covered.len() as f32];
    assert!(near < 2.0 && (share - 1.0).abs() < 0.2, "{near} pixels away, {share} times as large");
    let perspective = PerspectiveProjection { fov: 0.8, ..Default::default() };
    app.world_mut().entity_mut(camera).insert((Projection::from(perspective), RenderLayers::layer(2)));
    assert!(after(&mut app, ALL, &picture).changed(&dressed).len() > 400, "hair of another layer is seen");
    app.world_mut().entity_mut(camera).remove::<RenderLayers>();
    app.world_mut().entity_mut(hair).insert(Visibility::Hidden);
    assert!(after(&mut app, ALL, &picture).is(&bare), "hidden hair is seen");
    app.world_mut().entity_mut(hair).insert(Visibility::Visible);
    assert!(after(&mut app, ALL, &picture).changed(&bare).len() > 400);
    app.world_mut().despawn(hair);
    assert!(after(&mut app, ALL, &picture).is(&bare), "hair without an entity is seen");
    app.world_mut().despawn(wall);
    assert!(!after(&mut app, ALL, &picture).is(&bare), "the comparer sees no difference");
}

#[test]
fn each_camera_sees_hair_from_its_position() {
    let mut app = app("assets");
    light(&mut app);
    let (_, front) = camera(&mut app);
    // Two viewports of one image, one from the front and one from behind, where left and right are swapped.
    let split = image(&mut app, [256, 96]);
    let mut part = |x: u32, z: f32, order: isize| {
        let viewport = Viewport {
            physical_position: UVec2::new(x, 0),
            physical_size: UVec2::new(128, 96),
            ..Default::default()
        };
        app.world_mut().spawn((
            Camera3d::default(),
            Camera { viewport: Some(viewport), order, ..Default::default() },
            Transform::from_xyz(0.0, 0.0, z).looking_at(Vec3::ZERO, Vec3::Y),
            Projection::from(PerspectiveProjection { fov: 0.8, ..Default::default() }),
            RenderTarget::from(split.clone()),
        ));
    };
    part(0, 0.5, 1);
    part(128, -0.5, 2);
    let [bare, bare_split] = [(&front), (&split)].map(|image| settled(&mut app, image));
    wear(&mut app, Vec3::ZERO);
    let seen = after(&mut app, ALL, &front).changed(&bare);
    let both = after(&mut app, 0, &split);
    both.keep("split");
    let both = both.changed(&bare_split);
    let (left, right): (Vec<_>, Vec<_>) = both.iter().partition(|[x, _]| *x < 128);
    assert!(
        seen.len() > 400 && left.len() > 400 && right.len() > 400,
        "{} {} {}",
        seen.len(),
        left.len(),
        right.len()
    );
    // The left viewport shows the first camera's image, except for antialiased edges.
    assert!((middle(&seen) - middle(&left)).length() < 1.0, "{} {}", middle(&seen), middle(&left));
    let mirrored = Vec2::new(256.0 + 127.0 - 128.0 - middle(&left).x, middle(&left).y);
    assert!((middle(&right) - mirrored).length() < 2.0, "{} {mirrored}", middle(&right));
}

#[test]
fn heads_share_a_groom_at_different_places() {
    let mut app = app("assets");
    light(&mut app);
    let (_, picture) = camera(&mut app);
    let bare = settled(&mut app, &picture);
    // Far enough apart for separate lighting zones.
    let first = wear(&mut app, Vec3::NEG_X * 0.25);
    let groom = app.world().get::<Hair3d>(first).cloned().expect("it wears hair");
    let alone = after(&mut app, ALL, &picture);
    let seen = alone.changed(&bare);
    let turn = Quat::from_rotation_y(std::f32::consts::PI);
    let second = app.world_mut().spawn((groom, Transform::from_xyz(0.25, 0.0, 0.0).with_rotation(turn))).id();
    wait(&mut app);
    let pair = after(&mut app, ALL, &picture);
    pair.keep("pair");
    let (left, right): (Vec<_>, Vec<_>) = pair.changed(&bare).into_iter().partition(|[x, _]| *x < 64);
    let mirrored = Vec2::new(127.0 - middle(&seen).x, middle(&seen).y);
    assert!(seen.len() > 400 && (middle(&left) - middle(&seen)).length() < 0.5, "{}", middle(&left));
    assert!((middle(&right) - mirrored).length() < 1.0, "{} {mirrored}", middle(&right));
    // The first is lit as if it were alone. The second is seen from behind.
    let [both, one] = [pair.brightness(&left), alone.brightness(&seen)];
    assert!((both / one - 1.0).abs() < 0.05, "{both} {one}");
    app.world_mut().despawn(first);
    let left = after(&mut app, ALL, &picture).changed(&bare);
    assert!(!left.is_empty() && (middle(&left) - mirrored).length() < 1.0, "{} {mirrored}", middle(&left));
    app.world_mut().despawn(second);
    assert!(after(&mut app, ALL, &picture).is(&bare));
}
