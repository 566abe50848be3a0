//! Renders a built-in character that turns its head, without a window: `cargo run --example headless -- picture.png`

use tresses::{
    Camera, Character, Gpu, Picture, Pose, View,
    glam::{Quat, Vec3},
    low_level::Drawing,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    pollster::block_on(render(&std::env::args().nth(1).ok_or("usage: headless image.png")?))
}

async fn render(path: &str) -> Result<(), Box<dyn std::error::Error>> {
    let tresses = Gpu::open().await?.context;
    let mut ann = Character::built_in(&tresses, "long").await?;
    let mut view = View::new(&tresses, &Default::default(), [480, 600], 1)?;
    let camera = Camera::framing(ann.subject(), Vec3::Z, 0.5, [480, 600]);
    let picture = Picture { camera, ..Default::default() };
    while ann.time() < 0.3 || !view.is_complete().await? {
        ann.set_pose(Pose::about(ann.neck(), Quat::from_rotation_y(1.8 * ann.time() as f32)));
        let mut encoder = tresses.device().create_command_encoder(&Default::default());
        let mut frame = tresses.frame(&mut encoder);
        frame.advance(&mut [&mut ann], 1.0 / 60.0)?;
        if ann.time() >= 0.3 {
            frame.draw_as(&mut view, &[&ann], Drawing::new(&picture))?;
        }
        tresses.queue().submit([encoder.finish()]);
    }
    let mut png = png::Encoder::new(std::fs::File::create(path)?, 480, 600);
    png.set_color(png::ColorType::Rgba);
    Ok(png.write_header()?.write_image_data(&view.targets().read().await?)?)
}
