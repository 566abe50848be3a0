//! Renders without a window: the character of `minimal` turns its head for half a second, then a screenshot is saved.
//!
//! `cargo run --release --example headless -- picture.png [long|bob|curly|short] [front|side|back|near|far]`

use bevy::{
    app::PluginsState,
    camera::RenderTarget,
    prelude::*,
    render::{
        render_resource::TextureFormat,
        renderer::{RenderDevice, RenderQueue},
        view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk},
    },
    time::TimeUpdateStrategy,
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_tresses::{
    Hair3d, HairGroom, HairMaterial3d, HairReady, TressesPlugin, groom::styles::Style,
    tresses::light::HairMaterial,
};
use std::time::Duration;

const SIZE: [u32; 2] = [640, 640];

fn main() -> Result<(), BevyError> {
    let mut words = std::env::args().skip(1);
    let path = words.next().ok_or("expected the path of the image to write")?;
    let style = match words.next().as_deref() {
        None | Some("long") => Style::Long(Default::default()),
        Some("bob") => Style::Bob(Default::default()),
        Some("curly") => Style::Curly(Default::default()),
        Some("short") => Style::Short(Default::default()),
        Some(other) => return Err(format!("there is no style {other}").into()),
    };
    let eye = match words.next().as_deref() {
        None | Some("front") => Vec3::new(0.15, 0.14, 1.0),
        Some("side") => Vec3::new(1.0, 0.1, 0.1),
        Some("back") => Vec3::new(-0.2, 0.2, -1.0),
        Some("near") => Vec3::new(0.12, 0.14, 0.45),
        Some("far") => Vec3::new(0.6, 0.6, 4.0),
        Some(other) => return Err(format!("there is no camera {other}").into()),
    };

    let window =
        WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..Default::default() };
    let mut app = App::new();
    app.add_plugins((DefaultPlugins.build().set(window).disable::<WinitPlugin>(), TressesPlugin::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(16_667)))
        .insert_resource(ClearColor(Color::srgb(0.12, 0.13, 0.15)))
        .insert_resource(GlobalAmbientLight { brightness: 300.0, ..Default::default() });
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();

    let world = app.world_mut();
    let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
    let groom = HairGroom::character(device, queue, &style, Some(15_000))?;
    let head = groom.head_mesh().ok_or("the character has a head")?;
    let groom = world.resource_mut::<Assets<HairGroom>>().add(groom);
    let mesh = Mesh3d(world.resource_mut::<Assets<Mesh>>().add(head));
    let skin = StandardMaterial {
        base_color: Color::linear_rgb(0.5, 0.36, 0.28),
        perceptual_roughness: 0.6,
        ..Default::default()
    };
    let skin = MeshMaterial3d(world.resource_mut::<Assets<StandardMaterial>>().add(skin));
    let hair = (Hair3d(groom), HairMaterial3d(HairMaterial::brown()));
    let head = world.spawn((mesh, skin, Transform::default(), children![hair])).id();
    let image = Image::new_target_texture(SIZE[0], SIZE[1], TextureFormat::Rgba8UnormSrgb, None);
    let image = world.resource_mut::<Assets<Image>>().add(image);
    world.spawn((
        Camera3d::default(),
        RenderTarget::from(image.clone()),
        Projection::from(PerspectiveProjection { fov: 0.5, ..Default::default() }),
        Transform::from_translation(eye).looking_at(Vec3::new(0.0, 0.0, 0.0), Vec3::Y),
    ));
    let towards = |x, y, z| Transform::from_xyz(x, y, z).looking_at(Vec3::ZERO, Vec3::Y);
    world.spawn((DirectionalLight { illuminance: 6_000.0, ..Default::default() }, towards(-0.5, 0.7, 0.7)));
    world.spawn((DirectionalLight { illuminance: 3_000.0, ..Default::default() }, towards(0.8, 0.3, -0.5)));

    // Hair is built asynchronously.
    while !app.world_mut().query::<&HairReady>().iter(app.world()).all(HairReady::get) {
        app.update();
    }
    for frame in 0..30 {
        let rotation = Quat::from_rotation_y(0.7 * (0.1 * frame as f32).sin());
        app.world_mut().entity_mut(head).insert(Transform::from_rotation(rotation));
        app.update();
    }
    let saved = |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
        exit.write(AppExit::Success);
    };
    app.world_mut().spawn(Screenshot::image(image)).observe(save_to_disk(path)).observe(saved);
    while app.should_exit().is_none() {
        app.update();
    }
    Ok(())
}
