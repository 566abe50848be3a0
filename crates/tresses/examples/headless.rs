//! One picture of a built-in character, without a window.
//!
//! `cargo run --example headless -- picture.png`

use tresses::{
    Hair, HairRenderer, Pose,
    collide::ColliderPoses,
    drape,
    draw::{Body, DrawOptions, Scene, Targets, View},
    frame::{Frame, Recorder},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::styles::Style,
    light::Sphere,
    simulate::SimulationParams,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("where shall the picture go?")?;
    pollster::block_on(picture(&path))
}

async fn picture(path: &str) -> Result<(), Box<dyn std::error::Error>> {
    // Once per device: an engine brings its own device and queue.
    let Gpu { device, queue, .. } = Gpu::open().await?;
    let renderer = HairRenderer::new(&device, &DrawOptions::default());
    // Once per groom.
    let style = Style::Long(Default::default());
    let made = drape::character(&device, &queue, &renderer.simulate, &style, Some(8000)).await?;
    let mut hair =
        Hair::new(&device, &queue, &renderer, &made.groom, &Default::default(), Some(&made.field))?;
    let body = Body::new(&device, &renderer.draw, &made.mesh);
    let targets = Targets::new(&device, 480, 600, 4, 1)?;
    let view = View::look_at(Vec3::new(0.25, 0.1, 0.9), Vec3::new(0.0, 0.02, 0.0), 0.55, targets.size);
    let focus = Sphere::around(Vec3::splat(-0.25), Vec3::splat(0.25));
    let mut scene = Scene { view, focus, ..Default::default() };
    let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
    // Once per frame: the head turns for a third of a second, and the last frame is drawn.
    for i in 0..20 {
        scene.pose = Pose::about(made.neck, Quat::from_rotation_y(0.03 * i as f32));
        let mut encoder = device.create_command_encoder(&Default::default());
        let (renderer, device, queue) = (&renderer, &device, &queue);
        let mut recorder = Recorder { renderer, device, queue, encoder: &mut encoder, timings: None };
        recorder.advance(&mut hair, &Frame { dt: 1.0 / 60.0, head: scene.pose, colliders, simulation })?;
        if i == 19 {
            recorder.draw(&hair, Some(&body), &scene, &targets, targets.picture());
        }
        queue.submit([encoder.finish()]);
    }
    let [width, height] = targets.size;
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&targets.read(&device, &queue).await?)?;
    Ok(())
}
