//! The library in a page: a groom and its head become a picture after half a second of motion.
//!
//! `cargo run --example portrait -- groom.tfx head.obj portrait.png`

use tresses::{
    Hair, HairOptions, HairRenderer, Pose,
    collide::ColliderPoses,
    draw::{Body, DrawOptions, Scene, Targets, View},
    frame::{Frame, Recorder},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::{self, BindOptions, import, mesh::sdf},
    light::Sphere,
    simulate::SimulationParams,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [groom, head, picture] = std::array::from_fn(|i| std::env::args().nth(i + 1).expect("three paths"));
    // Once per device: an engine brings its own device and queue.
    let Gpu { device, queue, .. } = pollster::block_on(Gpu::open())?;
    let renderer = HairRenderer::new(&device, &DrawOptions::default());
    // Once per groom.
    let (strands, head, _) = import::read_with_head(&[groom], &[head], &Default::default())?;
    let (lo, hi) = strands.bounds().ok_or("the groom is empty")?;
    let groom = groom::bind(&strands, &BindOptions::default())?;
    let field = sdf::build(&head, &Default::default())?;
    let mut hair = Hair::new(&device, &queue, &renderer, &groom, &HairOptions::default(), Some(&field))?;
    let body = Body::new(&device, &renderer.draw, &head);
    let targets = Targets::new(&device, 1280, 720, 4, 1)?;
    // Once per frame.
    let middle = 0.5 * (lo + hi);
    let view = View::look_at(middle + Vec3::new(0.2, 0.05, 0.6), middle, 0.5, targets.size);
    let mut scene = Scene { view, focus: Sphere::around(lo, hi), ..Default::default() };
    for i in 0..30 {
        scene.pose = Pose::about(middle, Quat::from_rotation_y(0.03 * i as f32));
        let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
        let moment = Frame { dt: 1.0 / 60.0, head: scene.pose, colliders, simulation };
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut recorder = Recorder {
            renderer: &renderer,
            device: &device,
            queue: &queue,
            encoder: &mut encoder,
            timings: None,
        };
        recorder.advance(&mut hair, &moment)?;
        if i == 29 {
            recorder.draw(&hair, Some(&body), &scene, &targets, targets.picture());
        }
        queue.submit([encoder.finish()]);
    }
    let mut encoder = png::Encoder::new(std::fs::File::create(picture)?, targets.size[0], targets.size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&pollster::block_on(targets.read(&device, &queue))?)?;
    Ok(())
}
