//! One picture of a built-in character, without a window.
//!
//! `cargo run --example headless -- picture.png`

use tresses::{
    Camera, Hair, Pipelines, Pose, View,
    body::Body,
    collide::ColliderPoses,
    drape,
    frame::{Frame, Recorder, Sight},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::styles::Style,
    light::Sphere,
    simulate::SimulationParams,
    view::{Picture, ViewOptions},
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("where shall the picture go?")?;
    pollster::block_on(picture(&path))
}

async fn picture(path: &str) -> Result<(), Box<dyn std::error::Error>> {
    // Once per device: an engine brings its own device and queue.
    let Gpu { device, queue, .. } = Gpu::open().await?;
    let pipelines = Pipelines::new(&device);
    // Once per groom.
    let style = Style::Long(Default::default());
    let made = drape::character(&device, &queue, &pipelines.simulate, &style, Some(8000)).await?;
    let mut hair =
        Hair::new(&device, &queue, &pipelines, &made.groom, &Default::default(), Some(&made.field))?;
    let mut body = Body::new(&device, &made.mesh);
    // Once per picture that is seen at a time.
    let size = [480, 600];
    let view = View::new(&device, &pipelines, &ViewOptions::default(), size, 1)?;
    let camera = Camera::look_at(Vec3::new(0.25, 0.1, 0.9), Vec3::new(0.0, 0.02, 0.0), 0.55, size);
    let focus = Sphere::around(Vec3::splat(-0.25), Vec3::splat(0.25));
    let picture = Picture { camera, focus, ..Default::default() };
    let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
    // Once per frame: the head turns for a third of a second, and the last frame is drawn.
    for i in 0..20 {
        body.pose = Pose::about(made.neck, Quat::from_rotation_y(0.03 * i as f32));
        let mut encoder = device.create_command_encoder(&Default::default());
        let (pipelines, device, queue) = (&pipelines, &device, &queue);
        let mut recorder = Recorder { pipelines, device, queue, encoder: &mut encoder, timings: None };
        let frame = Frame { dt: 1.0 / 60.0, head: body.pose, colliders, simulation, ..Default::default() };
        let sights = if i == 19 { vec![Sight::new(&view, &picture)] } else { Vec::new() };
        recorder.record(&mut [(&mut hair, frame)], &[&body], sights)?;
        queue.submit([encoder.finish()]);
    }
    let [width, height] = size;
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&view.targets().read(&device, &queue).await?)?;
    Ok(())
}
