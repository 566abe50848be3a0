//! A skinned character to play with: the head turns on its neck, a ball pushes the hair, and wind blows.
//!
//! `cargo run --release --example character`
//!
//! | keys | |
//! |---|---|
//! | A, D, W, S | turn and nod the head |
//! | arrow keys | walk |
//! | I, K, J, L, U, O | move the ball: up and down, left and right, near and far |
//! | V | toggle wind |
//! | H | next hair color |
//! | M | toggle MSAA |

use bevy::{
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::*,
    render::renderer::{RenderDevice, RenderQueue},
};
use bevy_tresses::{
    GlobalHairWind, Hair3d, HairCollider, HairGroom, HairMaterial3d, HairSkin, TressesPlugin,
    groom::{mannequin::rig, styles::Style},
    skinned_mesh,
    tresses::{Wind, light::HairMaterial},
};

/// Radius of the ball, meters.
const BALL: f32 = 0.05;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, TressesPlugin::default()))
        .insert_resource(ClearColor(Color::srgb(0.12, 0.13, 0.15)))
        .insert_resource(GlobalAmbientLight { brightness: 300.0, ..Default::default() })
        .add_systems(Startup, (dress, furnish))
        .add_systems(Update, (walk, rotate_head, push, blow, dye, smooth))
        .run();
}

/// The root of the character.
#[derive(Component)]
struct Body;

/// A joint, and its fraction of the head's rotation.
#[derive(Component)]
struct RotationFraction(f32);

/// The ball that pushes hair.
#[derive(Component)]
struct Ball;

fn dress(
    mut commands: Commands,
    mut grooms: ResMut<Assets<HairGroom>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut poses: ResMut<Assets<SkinnedMeshInverseBindposes>>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
) -> Result {
    let groom = HairGroom::character(&device, &queue, &Style::Long(Default::default()), Some(15_000))?;
    // Torso, neck and head, as a file with a skinned mesh would contain.
    let bust = groom.mesh.as_deref().ok_or("the character has a mesh")?;
    let (mesh, binds) = skinned_mesh(bust, &rig::rig(bust));
    let body = commands.spawn((Body, Transform::default(), Visibility::default())).id();
    let (mut joints, mut parent, mut from) = (Vec::new(), body, Vec3::ZERO);
    for ((name, at), fraction) in rig::JOINTS.into_iter().zip([0.0, 0.4, 0.6]) {
        let transform = Transform::from_translation(at - from);
        let joint =
            (Name::new(name), RotationFraction(fraction), transform, Visibility::default(), ChildOf(parent));
        (parent, from) = (commands.spawn(joint).id(), at);
        joints.push(parent);
    }
    let skin = materials.add(StandardMaterial {
        base_color: Color::linear_rgb(0.5, 0.36, 0.28),
        perceptual_roughness: 0.6,
        ..Default::default()
    });
    let bent = SkinnedMesh { inverse_bindposes: poses.add(SkinnedMeshInverseBindposes::from(binds)), joints };
    let mesh = commands
        .spawn((Mesh3d(meshes.add(mesh)), MeshMaterial3d(skin), bent, Transform::default(), ChildOf(body)))
        .id();
    // The groom was made for this mesh, so it needs no placement. Its roots follow the skin.
    let hair = (Hair3d(grooms.add(groom)), HairMaterial3d(HairMaterial::brown()), HairSkin::new(mesh));
    commands.spawn((hair, ChildOf(body)));
    Ok(())
}

fn furnish(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Ball,
        HairCollider::sphere(BALL),
        Mesh3d(meshes.add(Sphere::new(BALL))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.25, 0.15))),
        Transform::from_xyz(0.25, -0.05, 0.05),
    ));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.25, 0.16, 1.1).looking_at(Vec3::new(0.0, 0.02, 0.0), Vec3::Y),
    ));
    let towards = |x, y, z| Transform::from_xyz(x, y, z).looking_at(Vec3::ZERO, Vec3::Y);
    commands
        .spawn((DirectionalLight { illuminance: 6_000.0, ..Default::default() }, towards(-0.5, 0.7, 0.7)));
    commands
        .spawn((DirectionalLight { illuminance: 3_000.0, ..Default::default() }, towards(0.8, 0.3, -0.5)));
}

/// Returns -1, 0 or 1, depending on which of two keys is pressed.
fn axis(keys: &ButtonInput<KeyCode>, less: KeyCode, more: KeyCode) -> f32 {
    f32::from(keys.pressed(more)) - f32::from(keys.pressed(less))
}

fn walk(keys: Res<ButtonInput<KeyCode>>, time: Res<Time>, mut body: Single<&mut Transform, With<Body>>) {
    use KeyCode::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp};
    let direction = Vec3::new(axis(&keys, ArrowLeft, ArrowRight), 0.0, axis(&keys, ArrowUp, ArrowDown));
    body.translation += 0.8 * time.delta_secs() * direction.normalize_or_zero();
}

fn rotate_head(
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    mut joints: Query<(&mut Transform, &RotationFraction)>,
) {
    use KeyCode::{KeyA, KeyD, KeyS, KeyW};
    // Exponential smoothing: the head follows quickly, as when shaken.
    let target = Quat::from_rotation_y(1.1 * axis(&keys, KeyA, KeyD))
        * Quat::from_rotation_x(0.5 * axis(&keys, KeyW, KeyS));
    for (mut joint, RotationFraction(fraction)) in &mut joints {
        let own = Quat::IDENTITY.slerp(target, *fraction);
        joint.rotation = joint.rotation.slerp(own, 1.0 - (-9.0 * time.delta_secs()).exp());
    }
}

fn push(keys: Res<ButtonInput<KeyCode>>, time: Res<Time>, mut ball: Single<&mut Transform, With<Ball>>) {
    use KeyCode::{KeyI, KeyJ, KeyK, KeyL, KeyO, KeyU};
    let direction = Vec3::new(axis(&keys, KeyJ, KeyL), axis(&keys, KeyK, KeyI), axis(&keys, KeyU, KeyO));
    ball.translation += 0.4 * time.delta_secs() * direction;
}

fn blow(keys: Res<ButtonInput<KeyCode>>, mut wind: ResMut<GlobalHairWind>) {
    if keys.just_pressed(KeyCode::KeyV) {
        wind.0 = if wind.0.blows() { Wind::default() } else { Wind::new(Vec3::new(-6.0, 0.0, -2.0)) };
    }
}

fn dye(keys: Res<ButtonInput<KeyCode>>, mut hair: Single<&mut HairMaterial3d>, mut count: Local<usize>) {
    if keys.just_pressed(KeyCode::KeyH) {
        *count += 1;
        let colors = [HairMaterial::brown, HairMaterial::blond, HairMaterial::red, HairMaterial::black];
        hair.0 = colors[*count % colors.len()]();
    }
}

fn smooth(keys: Res<ButtonInput<KeyCode>>, mut samples: Single<&mut Msaa>) {
    if keys.just_pressed(KeyCode::KeyM) {
        **samples = if **samples == Msaa::Off { Msaa::Sample4 } else { Msaa::Off };
    }
}
