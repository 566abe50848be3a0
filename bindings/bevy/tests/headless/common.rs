//! A Bevy app without a window, and images of its cameras.

use bevy::{
    app::PluginsState,
    camera::RenderTarget,
    log::LogPlugin,
    prelude::*,
    render::{
        RenderApp, RenderPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
        render_asset::RenderAssets,
        render_resource::{TextureFormat, TextureUsages},
        renderer::{RenderDevice, RenderQueue},
        settings::{WgpuLimits, WgpuSettings},
        texture::GpuImage,
    },
    time::TimeUpdateStrategy,
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_tresses::{HairGroom, HairReady, TressesPlugin, groom::Strands, tri_mesh};
use std::time::{Duration, Instant};
use tresses::{Context, gpu::readback};

/// Width and height of the images.
pub const SIZE: [u32; 2] = [128, 96];
/// Radius of the head, meters.
pub const HEAD: f32 = 0.08;

/// Creates an app that reads assets from `assets`. Each update takes 1/60 s. Hair casts no shadows on meshes.
pub fn app(assets: &str) -> App {
    app_that_casts(assets, 0.0)
}

/// Creates an app whose hair casts shadows of strength `casts`.
pub fn app_that_casts(assets: &str, casts: f32) -> App {
    app_within(assets, casts, None)
}

/// Creates an app on a device with no more than `limits`.
pub fn app_within(assets: &str, casts: f32, limits: Option<WgpuLimits>) -> App {
    let mut app = App::new();
    let settings = WgpuSettings { constrained_limits: limits, ..Default::default() };
    let window =
        WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..Default::default() };
    let files = AssetPlugin { file_path: assets.into(), ..Default::default() };
    // No pipelined rendering, so that an image belongs to the last update.
    let plugins = DefaultPlugins
        .build()
        .set(window)
        .set(files)
        .disable::<WinitPlugin>()
        .disable::<LogPlugin>()
        .disable::<PipelinedRenderingPlugin>()
        .set(RenderPlugin {
            synchronous_pipeline_compilation: true,
            render_creation: settings.into(),
            ..Default::default()
        });
    app.add_plugins((plugins, TressesPlugin { casts, ..Default::default() }))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(16_667)))
        .insert_resource(ClearColor(Color::BLACK));
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    app
}

/// Returns a fan of straight strands to the right (+X) of a ball, in the plane that a camera on +Z faces.
pub fn fan(count: usize) -> Strands {
    let mut strands = Strands::default();
    for i in 0..count {
        let share = i as f32 / count as f32;
        let angle = (share - 0.5) * 1.6;
        // Some depth, so that there is hair in front of and behind the plane.
        let aside = 0.02 * ((i * 7 % 11) as f32 / 5.0 - 1.0);
        let way = Vec3::new(angle.cos(), angle.sin(), aside / HEAD).normalize();
        strands.push(&(0..12).map(|j| way * (HEAD + 0.1 * j as f32 / 11.0)).collect::<Vec<_>>());
    }
    strands
}

/// Returns the fan as a groom, with the ball as its head.
pub fn groom() -> HairGroom {
    let head = tri_mesh(&Sphere::new(HEAD).mesh().uv(24, 16)).expect("a ball has triangles");
    let hair = HairGroom::from_strands(&fan(1500), &Default::default()).expect("strands are sound");
    hair.with_head(head).expect("a ball is closed")
}

/// Adds an image as a camera's render target.
pub fn image(app: &mut App, [width, height]: [u32; 2]) -> Handle<Image> {
    let mut image = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// Adds a camera half a meter in front of the origin. Returns it and its image.
pub fn camera(app: &mut App) -> (Entity, Handle<Image>) {
    let image = image(app, SIZE);
    let camera = (
        Camera3d::default(),
        Msaa::Off,
        Transform::from_xyz(0.0, 0.0, 0.5).looking_at(Vec3::ZERO, Vec3::Y),
        Projection::from(PerspectiveProjection { fov: 0.8, ..Default::default() }),
        RenderTarget::from(image.clone()),
    );
    (app.world_mut().spawn(camera).id(), image)
}

/// Adds a light from the front.
pub fn light(app: &mut App) -> Entity {
    let place = Transform::from_xyz(0.3, 0.5, 1.0).looking_at(Vec3::ZERO, Vec3::Y);
    app.world_mut().spawn((DirectionalLight::default(), place)).id()
}

/// Updates the app until all hair is ready, for as long as a machine takes that runs all tests at the same time.
pub fn wait(app: &mut App) {
    let deadline = Instant::now() + Duration::from_secs(300);
    while Instant::now() < deadline {
        app.update();
        let mut hair = app.world_mut().query::<&HairReady>();
        if hair.iter(app.world()).all(HairReady::get) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("hair is not ready after five minutes");
}

/// Returns the content of an image after `frames` more frames.
pub fn after(app: &mut App, frames: usize, image: &Handle<Image>) -> Picture {
    for _ in 0..frames {
        app.update();
    }
    let world = app.sub_app(RenderApp).world();
    let images = world.resource::<RenderAssets<GpuImage>>();
    let texture = &images.get(image).expect("the image is on the GPU").texture;
    let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
    let bytes = readback::blocking::texture(&Context::new(device.wgpu_device(), queue), texture)
        .expect("the device is there");
    Picture { width: texture.width(), pixels: bytes.as_chunks::<4>().0.to_vec() }
}

/// Returns an image once it no longer changes. Shaders and textures load during the first frames.
pub fn settled(app: &mut App, image: &Handle<Image>) -> Picture {
    let mut last = after(app, 3, image);
    for _ in 0..200 {
        let next = after(app, 1, image);
        if next.is(&last) && next.pixels.iter().all(|pixel| pixel[3] == 255) {
            return next;
        }
        last = next;
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("the picture does not come");
}

/// An image, rows from the top.
#[derive(Clone)]
pub struct Picture {
    pub width: u32,
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// Returns the pixels that differ from `other` by more than rounding.
    pub fn changed(&self, other: &Self) -> Vec<[u32; 2]> {
        assert_eq!(self.pixels.len(), other.pixels.len());
        let differ = |(a, b): (&[u8; 4], &[u8; 4])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 3);
        let all = self.pixels.iter().zip(&other.pixels).enumerate();
        let width = self.width;
        all.filter(|(_, pair)| differ(*pair)).map(|(i, _)| [i as u32 % width, i as u32 / width]).collect()
    }

    /// Whether the image equals `other`, up to rounding.
    pub fn is(&self, other: &Self) -> bool {
        self.changed(other).is_empty()
    }

    /// Returns the mean of all channels of some pixels, 0 to 255.
    pub fn brightness(&self, of: &[[u32; 2]]) -> f32 {
        let value = |[x, y]: &[u32; 2]| {
            let [r, g, b, _] = self.pixels[(y * self.width + x) as usize].map(f32::from);
            (r + g + b) / 3.0
        };
        of.iter().map(value).sum::<f32>() / of.len().max(1) as f32
    }

    /// Writes a PNG for inspection into the folder `TRESSES_PICTURES`, if that is set.
    pub fn keep(&self, name: &str) {
        let Some(folder) = std::env::var_os("TRESSES_PICTURES") else { return };
        let size = bevy::render::render_resource::Extent3d {
            width: self.width,
            height: self.pixels.len() as u32 / self.width,
            depth_or_array_layers: 1,
        };
        let image = Image::new(
            size,
            bevy::render::render_resource::TextureDimension::D2,
            self.pixels.as_flattened().to_vec(),
            TextureFormat::Rgba8UnormSrgb,
            Default::default(),
        );
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        image.try_into_dynamic().expect("it is a picture").to_rgb8().save(path).expect("the folder is there");
    }
}

/// Returns the mean position of pixels.
pub fn middle(pixels: &[[u32; 2]]) -> Vec2 {
    let sum: Vec2 = pixels.iter().map(|[x, y]| Vec2::new(*x as f32, *y as f32)).sum();
    sum / pixels.len().max(1) as f32
}

/// Returns the pixels of `hair` that are well inside the fan, where hair is opaque.
pub fn inside(hair: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let around = |[x, y]: &[u32; 2], k: u32| [(x + k % 3).wrapping_sub(1), (y + k / 3).wrapping_sub(1)];
    hair.iter().filter(|at| (0..9).all(|k| hair.contains(&around(at, k)))).copied().collect()
}
