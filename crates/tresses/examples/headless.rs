//! One picture without a window: `headless OUT.png GROOM HEAD [seconds of shaking]`.

use tresses::{
    Hair, HairOptions, HairRenderer, Pose,
    draw::{Body, DrawOptions, Scene, Targets, View},
    frame::{self, Frame},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::{BindOptions, bind, import, mesh::sdf},
    light::Sphere,
    simulate::{ColliderPoses, SimulationParams},
    wgpu,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<_> = std::env::args().collect();
    let [_, out, groom, head, rest @ ..] = &arguments[..] else {
        return Err("usage: headless OUT.png GROOM HEAD [seconds]".into());
    };
    let seconds: f32 = rest.first().map_or(Ok(0.0), |s| s.parse())?;

    let gpu = pollster::block_on(Gpu::open())?;
    let (device, queue) = (&gpu.device, &gpu.queue);
    let (strands, mesh, _) = import::read_with_head(&[groom], &[head], &Default::default())?;
    let field = sdf::build(&mesh, &Default::default())?;
    let groom = bind(
        &strands,
        &BindOptions {
            guides: if std::env::var("ALL").is_ok() {
                tresses::groom::GuideCount::All
            } else {
                BindOptions::default().guides
            },
            guide_vertices: std::env::var("GV").ok().map(|v| v.parse().unwrap()),
            ..Default::default()
        },
    )?;

    let renderer = HairRenderer::new(device, &DrawOptions { samples: 4, ..Default::default() });
    let body = Body::new(device, &renderer.draw, &mesh);
    let targets = Targets::new(device, 960, 600, 4, 1)?;
    let (lo, hi) = groom.bounds().ok_or("no strands")?;
    let focus = Sphere::around(lo, hi);
    let eye = focus.center + Vec3::new(0.5, 0.06, 0.86) * 3.4 * focus.radius;

    let num = |name: &str, d: f32| std::env::var(name).map_or(d, |a| a.parse().unwrap());
    let base = SimulationParams::default();
    let mut physics = base;
    physics.bending.root *= num("EI", 1.0);
    physics.bending.tip *= num("EI", 1.0) * num("EIT", 1.0);
    physics.goal.root = num("GR", base.goal.root);
    physics.goal.tip = num("GT", base.goal.tip);
    physics.substeps = num("SUB", 4.0) as u32;
    physics.drag = num("DRAG", base.drag);
    physics.bending_damping = num("BD", base.bending_damping);
    let options = HairOptions {
        simulation: physics,
        rest: if std::env::var("NAT").is_ok() {
            tresses::simulate::RestShape::Natural
        } else {
            Default::default()
        },
        ..Default::default()
    };
    let mut hair = Hair::new(
        device,
        queue,
        &renderer,
        &groom,
        &options,
        if std::env::var("NOF").is_ok() { None } else { Some(&field) },
    )?;
    // A second of head shaking in steps of a 60th, then the picture.
    let frames = (seconds * 60.0) as u32;
    for i in 0..=frames {
        let amp: f32 = std::env::var("AMP").map_or(0.7, |a| a.parse().unwrap());
        let angle = amp * (std::f32::consts::TAU * i as f32 / 60.0).sin();
        let pose = Pose::about(focus.center, Quat::from_rotation_y(angle));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let input =
            Frame { dt: 1.0 / 60.0, head: pose, colliders: &ColliderPoses::default(), simulation: &physics };
        frame::advance(&renderer, device, queue, &mut encoder, &mut None, &mut hair, &input)?;
        if i == frames {
            let scene = Scene {
                view: View::look_at(eye, focus.center, 30f32.to_radians(), targets.size),
                focus,
                pose,
                ..Default::default()
            };
            let output = targets.picture();
            frame::draw(
                &renderer,
                device,
                queue,
                &mut encoder,
                &mut None,
                &hair,
                Some(&body),
                &scene,
                &targets,
                output,
            );
        }
        queue.submit([encoder.finish()]);
    }
    let file = std::io::BufWriter::new(std::fs::File::create(out)?);
    let mut png = png::Encoder::new(file, targets.size[0], targets.size[1]);
    png.set_color(png::ColorType::Rgba);
    png.write_header()?.write_image_data(&targets.read(device, queue)?)?;
    Ok(())
}
