//! Hair on skinned meshes of Bevy: with joints, with morph targets, in other units.

use crate::common::{HEAD, Picture, after, app, camera, fan, light, middle, settled, wait};
use bevy::{
    mesh::{
        VertexAttributeValues,
        morph::{MeshMorphWeights, MorphAttributes},
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_tresses::{Hair3d, HairGroom, HairReady, HairSkin, groom::TriMesh, tri_mesh};

/// Frames after which all changes are visible.
const ALL: usize = 4;
/// Size of a pixel at the hair, meters.
const PIXEL: f32 = 0.0044;

/// Returns the fan's ball as a mesh with two joints at its center, scaled by `size`. `share` is the weight of the
/// second joint at a position.
fn ball(size: f32, share: impl Fn(Vec3) -> f32) -> Mesh {
    let mut mesh = Sphere::new(HEAD).mesh().uv(24, 16);
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION) else {
        panic!("a ball has places")
    };
    let weights: Vec<[f32; 4]> =
        places.iter().map(|p| [1.0 - share(Vec3::from(*p)), share(Vec3::from(*p)), 0.0, 0.0]).collect();
    places.iter_mut().flatten().for_each(|x| *x *= size);
    let joints = VertexAttributeValues::Uint16x4(vec![[0, 1, 0, 0]; weights.len()]);
    mesh.with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
}

fn groom() -> HairGroom {
    HairGroom::from_strands(&fan(1500), &Default::default()).expect("strands are sound")
}

/// Returns the fan on its ball, rigid.
fn rigid() -> HairGroom {
    let head: TriMesh = tri_mesh(&ball(1.0, |_| 0.0)).expect("a ball has triangles");
    groom().with_head(head).expect("a ball is closed")
}

fn wear(app: &mut App, groom: HairGroom) -> Hair3d {
    Hair3d(app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom))
}

/// A ball on two joints at its center; the second joint is a child of the first.
struct Body {
    joints: [Entity; 2],
    mesh: Entity,
}

/// Adds a body whose vertices are scaled by `size` and whose root by its inverse.
fn body(app: &mut App, size: f32, share: impl Fn(Vec3) -> f32) -> Body {
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(ball(size, share));
    // The joints are not at the mesh's origin; the bind poses compensate.
    let off = Transform::from_xyz(0.0, 0.02 * size, 0.01 * size);
    let binds = vec![off.to_matrix().inverse(); 2];
    let binds = app
        .world_mut()
        .resource_mut::<Assets<SkinnedMeshInverseBindposes>>()
        .add(SkinnedMeshInverseBindposes::from(binds));
    let world = app.world_mut();
    let root = world.spawn((Transform::from_scale(Vec3::splat(1.0 / size)), Visibility::default())).id();
    let first = world.spawn((off, Visibility::default(), ChildOf(root))).id();
    let second = world.spawn((Transform::default(), Visibility::default(), ChildOf(first))).id();
    let joints = [first, second];
    let skin = SkinnedMesh { inverse_bindposes: binds, joints: joints.to_vec() };
    let mesh = world.spawn((Mesh3d(mesh), skin, Transform::default(), ChildOf(root))).id();
    Body { joints, mesh }
}

/// Turns an entity by 0.02 rad per frame about a point, for 30 frames.
fn turn(app: &mut App, entity: Entity, base: Transform, about: Vec3) {
    for i in 1..=30 {
        let rotation = Quat::from_rotation_z(0.02 * i as f32);
        let place = about + rotation * (base.translation - about);
        app.world_mut().entity_mut(entity).insert(Transform { rotation, translation: place, ..base });
        app.update();
    }
}

/// Returns the shift of the mean position of hair between two images, meters.
fn moved(a: &Picture, b: &Picture, bare: &Picture) -> Vec2 {
    (middle(&a.changed(bare)) - middle(&b.changed(bare))) * PIXEL
}

#[test]
fn hair_follows_its_joint() {
    // A ball carried by the second joint moves hair like a rigid head that turns about the same point.
    let mut app_a = app("assets");
    light(&mut app_a);
    let (_, picture) = camera(&mut app_a);
    let bare = settled(&mut app_a, &picture);
    let hair = wear(&mut app_a, rigid());
    let hair = app_a.world_mut().spawn(hair).id();
    wait(&mut app_a);
    let rest = after(&mut app_a, ALL, &picture);
    turn(&mut app_a, hair, Transform::default(), Vec3::new(0.0, 0.02, 0.01));
    let expected = after(&mut app_a, 0, &picture);
    expected.keep("rigid");
    assert!(moved(&expected, &rest, &bare).length() > 0.05, "it turns far");
    drop(app_a);

    for (name, size, child) in [("skin", 1.0, false), ("child", 1.0, true), ("centimeters", 100.0, true)] {
        let mut app = app("assets");
        light(&mut app);
        let (_, picture) = camera(&mut app);
        let Body { joints: [_, second], mesh } = body(&mut app, size, |_| 1.0);
        app.world_mut().entity_mut(mesh).insert(Visibility::Hidden);
        let bare = settled(&mut app, &picture);
        let hair = wear(&mut app, groom());
        let hair = app.world_mut().spawn((hair, HairSkin::new(mesh))).id();
        if child {
            // Place the groom's origin at the center of the ball.
            let place = Transform::from_xyz(0.0, -0.02 * size, -0.01 * size);
            app.world_mut().entity_mut(hair).insert((place, ChildOf(second)));
        }
        wait(&mut app);
        let at_rest = after(&mut app, ALL, &picture);
        let off = moved(&at_rest, &rest, &bare);
        assert!(off.length() < 0.3 * PIXEL, "{name}: {off} m off at rest");
        turn(&mut app, second, Transform::default(), Vec3::ZERO);
        let turned = after(&mut app, 0, &picture);
        turned.keep(name);
        let off = moved(&turned, &expected, &bare);
        assert!(off.length() < 0.5 * PIXEL, "{name}: {off} m off");
        let [own, all] = [turned.changed(&bare).len(), expected.changed(&bare).len()];
        assert!(own.abs_diff(all) < all / 20, "{name}: {own} pixels of hair, not {all}");
    }
}

#[test]
fn roots_follow_stretching_skin_and_morph_targets() {
    let mut app = app("assets");
    light(&mut app);
    let (_, picture) = camera(&mut app);
    // The second joint carries the upper half.
    let share = |p: Vec3| if p.y > 0.0 { (p.y / 0.02).min(1.0) } else { 0.0 };
    let Body { joints: [_, second], mesh } = body(&mut app, 1.0, share);
    app.world_mut().entity_mut(mesh).insert(Visibility::Hidden);
    let bare = settled(&mut app, &picture);
    let hair = wear(&mut app, groom());
    app.world_mut().spawn((hair, HairSkin::new(mesh)));
    wait(&mut app);
    let rest = after(&mut app, ALL, &picture);
    app.world_mut().entity_mut(second).insert(Transform::from_xyz(0.0, 0.06, 0.0));
    let stretched = after(&mut app, 40, &picture);
    stretched.keep("stretched");
    let edge = |of: &Picture, top: bool| {
        let rows: Vec<u32> = of.changed(&bare).iter().map(|p| p[1]).collect();
        *if top { rows.iter().min() } else { rows.iter().max() }.expect("there is hair") as f32 * PIXEL
    };
    let (up, down) =
        (edge(&rest, true) - edge(&stretched, true), edge(&stretched, false) - edge(&rest, false));
    assert!((0.04..0.08).contains(&up), "the upper hair rises by {up} m");
    assert!(down.abs() < 0.02, "the lower stays: {down} m");
    app.world_mut().entity_mut(second).insert(Transform::default());

    // A morph target that moves the right side by 3 cm.
    let asset = app.world().get::<Mesh3d>(mesh).expect("it has a mesh").0.clone();
    let mut swollen = ball(1.0, share);
    let push =
        |p: &[f32; 3]| MorphAttributes::new(0.03 * Vec3::X * (p[0] / HEAD).max(0.0), Vec3::ZERO, Vec3::ZERO);
    let Some(VertexAttributeValues::Float32x3(places)) = swollen.attribute(Mesh::ATTRIBUTE_POSITION) else {
        panic!("a ball has places")
    };
    let shape = places.iter().map(push).collect();
    swollen.set_morph_targets(shape);
    let swollen = app.world_mut().resource_mut::<Assets<Mesh>>().add(swollen);
    app.world_mut()
        .entity_mut(mesh)
        .insert((Mesh3d(swollen), MeshMorphWeights::Value { weights: vec![0.0] }));
    drop(asset);
    app.update();
    wait(&mut app);
    let before = after(&mut app, 40, &picture);
    let still = moved(&before, &rest, &bare);
    assert!(still.length() < PIXEL, "a shape that there is none of moves hair: {still} m");
    app.world_mut().entity_mut(mesh).insert(MeshMorphWeights::Value { weights: vec![1.0] });
    let swollen = after(&mut app, 40, &picture);
    swollen.keep("swollen");
    let aside = moved(&swollen, &before, &bare);
    assert!((0.015..0.035).contains(&aside.x), "it moves by {aside} m");
    // Without its body, hair stays where it is.
    app.world_mut().despawn(mesh);
    let left = moved(&after(&mut app, 10, &picture), &swollen, &bare);
    assert!(left.length() < 0.3 * PIXEL, "hair without its body goes {left} m");
}

#[test]
fn hair_off_the_skin_is_not_shown() {
    let mut app = app("assets");
    light(&mut app);
    let (_, picture) = camera(&mut app);
    let bare = settled(&mut app, &picture);
    let hair = wear(&mut app, groom());
    // First on an entity without a mesh, then too far from a mesh.
    let none = app.world_mut().spawn(Transform::default()).id();
    let hair = app.world_mut().spawn((hair, HairSkin::new(none))).id();
    let shown = |app: &mut App| {
        for _ in 0..100 {
            app.update();
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        app.world().get::<HairReady>(hair).is_some_and(HairReady::get)
    };
    assert!(!shown(&mut app));
    let Body { mesh, .. } = body(&mut app, 1.0, |_| 0.0);
    app.world_mut().entity_mut(mesh).insert(Visibility::Hidden);
    let far = HairSkin { at: Some(Mat4::from_translation(0.05 * Vec3::X)), ..HairSkin::new(mesh) };
    app.world_mut().entity_mut(hair).insert(far);
    assert!(!shown(&mut app), "roots are 5 cm away");
    assert!(after(&mut app, 1, &picture).is(&bare));
    app.world_mut().entity_mut(hair).insert(HairSkin { max_root_distance: 0.06, ..far });
    assert!(shown(&mut app), "which is allowed");
    assert!(!after(&mut app, ALL, &picture).is(&bare));
    // Hair moves from a skin to no skin.
    app.world_mut().entity_mut(hair).remove::<HairSkin>();
    assert!(shown(&mut app));
    assert!(!after(&mut app, ALL, &picture).is(&bare));
}
