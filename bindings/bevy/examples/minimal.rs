//! A turning head with hair.
//!
//! `cargo run --release --example minimal`

use bevy::{
    prelude::*,
    render::renderer::{RenderDevice, RenderQueue},
};
use bevy_tresses::{GlobalHairWind, Hair3d, HairGroom, TressesPlugin, groom::styles::Style, tresses::Wind};

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, TressesPlugin::default()))
        .insert_resource(GlobalHairWind(Wind::new(Vec3::new(-3.0, 0.0, -1.0))))
        .insert_resource(ClearColor(Color::srgb(0.12, 0.13, 0.15)))
        .add_systems(Startup, dress)
        .add_systems(Update, rotate_head)
        .run();
}

/// The turning head.
#[derive(Component)]
struct Head;

fn dress(
    mut commands: Commands,
    mut grooms: ResMut<Assets<HairGroom>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
) -> Result {
    // The built-in character. A groom from a file: `assets.load::<HairGroom>("groom.tfx")`, with Bevy's `AssetServer`.
    let groom = HairGroom::character(&device, &queue, &Style::Long(Default::default()), Some(15_000))?;
    let head = groom.head_mesh().ok_or("the character has a head")?;
    let skin = StandardMaterial {
        base_color: Color::linear_rgb(0.5, 0.36, 0.28),
        perceptual_roughness: 0.6,
        ..Default::default()
    };
    // The hair is a child of the head, so it follows the head.
    commands.spawn((
        Head,
        Mesh3d(meshes.add(head)),
        MeshMaterial3d(materials.add(skin)),
        children![Hair3d(grooms.add(groom))],
    ));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.25, 0.16, 0.95).looking_at(Vec3::new(0.0, 0.02, 0.0), Vec3::Y),
    ));
    let towards = |x, y, z| Transform::from_xyz(x, y, z).looking_at(Vec3::ZERO, Vec3::Y);
    commands
        .spawn((DirectionalLight { illuminance: 6_000.0, ..Default::default() }, towards(-0.5, 0.7, 0.7)));
    commands
        .spawn((DirectionalLight { illuminance: 3_000.0, ..Default::default() }, towards(0.8, 0.3, -0.5)));
    commands.insert_resource(GlobalAmbientLight { brightness: 300.0, ..Default::default() });
    Ok(())
}

fn rotate_head(time: Res<Time>, mut head: Single<&mut Transform, With<Head>>) {
    head.rotation = Quat::from_rotation_y(1.2 * (1.3 * time.elapsed_secs()).sin());
}
