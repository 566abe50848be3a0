//! The library in a page: a groom and its head become a picture after half a second of motion.
//!
//! `cargo run --example portrait -- groom.tfx head.obj portrait.png`

use tresses::{
    Camera, Hair, HairOptions, Pipelines, Pose, View,
    body::Body,
    collide::ColliderPoses,
    frame::{Frame, Recorder, Sight},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::{self, BindOptions, import, mesh::sdf},
    light::Sphere,
    simulate::SimulationParams,
    view::{Picture, ViewOptions},
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [groom, head, picture] = std::array::from_fn(|i| std::env::args().nth(i + 1).expect("three paths"));
    // Once per device: an engine brings its own device and queue.
    let Gpu { device, queue, .. } = pollster::block_on(Gpu::open())?;
    let pipelines = Pipelines::new(&device);
    // Once per groom.
    let (strands, head, _) = import::read_with_head(&[groom], &[head], &Default::default())?;
    let (lo, hi) = strands.bounds().ok_or("the groom is empty")?;
    let groom = groom::bind(&strands, &BindOptions::default())?;
    let field = sdf::build(&head, &Default::default())?;
    let mut hair = Hair::new(&device, &queue, &pipelines, &groom, &HairOptions::default(), Some(&field))?;
    let mut body = Body::new(&device, &head);
    // Once per picture that is seen at a time.
    let size = [1280, 720];
    let view = View::new(&device, &pipelines, &ViewOptions::default(), size, 1)?;
    // Once per frame.
    let middle = 0.5 * (lo + hi);
    let camera = Camera::look_at(middle + Vec3::new(0.2, 0.05, 0.6), middle, 0.5, size);
    let shown = Picture { camera, focus: Sphere::around(lo, hi), ..Default::default() };
    for i in 0..30 {
        body.pose = Pose::about(middle, Quat::from_rotation_y(0.03 * i as f32));
        let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
        let moment = Frame { dt: 1.0 / 60.0, head: body.pose, colliders, simulation, ..Default::default() };
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut recorder = Recorder {
            pipelines: &pipelines,
            device: &device,
            queue: &queue,
            encoder: &mut encoder,
            timings: None,
        };
        let sights = if i == 29 { vec![Sight::new(&view, &shown)] } else { Vec::new() };
        recorder.record(&mut [(&mut hair, moment)], &[&body], sights)?;
        queue.submit([encoder.finish()]);
    }
    let mut encoder = png::Encoder::new(std::fs::File::create(picture)?, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(&pollster::block_on(view.targets().read(&device, &queue))?)?;
    Ok(())
}
