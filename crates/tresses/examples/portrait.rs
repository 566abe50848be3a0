//! Renders a portrait after half a second of motion: of a groom and a head from files, or of the built-in character.
//!
//! `cargo run --example portrait -- portrait.png groom.tfx head.obj`

use tresses::{
    Camera, Character, Gpu, Picture, Pose, View,
    glam::{Quat, Vec3},
    low_level::Drawing,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: portrait image.png [groom and head ...]")?;
    pollster::block_on(render(&path, &arguments.collect::<Vec<_>>()))
}

async fn render(path: &str, files: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    let tresses = Gpu::open().await?.context;
    let mut ann = match files {
        [] => Character::built_in(&tresses, "bob").await?,
        files => Character::load(&tresses, files).await?,
    };
    let size = [1280, 720];
    let mut view = View::new(&tresses, &Default::default(), size, 1)?;
    let direction = Vec3::new(0.45, 0.1, 0.9).normalize();
    let camera = Camera::framing(ann.subject(), direction, 0.5, size);
    let picture = Picture { camera, ..Default::default() };
    while ann.time() < 0.5 || !view.is_complete().await? {
        ann.gesture.head = Pose::about(ann.neck(), Quat::from_rotation_y(1.8 * ann.time() as f32));
        let mut encoder = tresses.device().create_command_encoder(&Default::default());
        let mut frame = tresses.frame(&mut encoder);
        frame.advance(&mut [&mut ann], 1.0 / 60.0)?;
        if ann.time() >= 0.5 {
            frame.draw_as(&mut view, &[&ann], Drawing::new(&picture))?;
        }
        tresses.queue().submit([encoder.finish()]);
    }
    let mut png = png::Encoder::new(std::fs::File::create(path)?, size[0], size[1]);
    png.set_color(png::ColorType::Rgba);
    Ok(png.write_header()?.write_image_data(&view.targets().read().await?)?)
}
