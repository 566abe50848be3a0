//! What is drawn less finely covers as much as what is drawn in full: a small picture is coarser hair, not less.

use std::sync::Arc;
use tresses::{
    Pose,
    draw::Background,
    glam::Vec3,
    gpu::Gpu,
    groom::{mannequin, styles::Style},
};
use tresses_scene::{Base, Camera, Colliders, Quality, Settings, Stage, camera::View, settings::HairColor};
use tresses_studio::{
    pace::{LEVELS, Level},
    turn,
};

/// Width and height of the picture in a window of the size that it opens in, points.
const AREA: [f32; 2] = [884.0, 692.0];

fn stage(style: &str) -> Option<(Stage, Settings)> {
    let Ok(gpu) = pollster::block_on(Gpu::open()) else {
        assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none(), "there is no adapter");
        return None;
    };
    let mut settings = Settings::default();
    settings.look.color = HairColor::Red;
    let options = turn::draw_options(&settings, &gpu.tier).unwrap();
    let quality = Quality {
        samples: options.samples,
        coverage: options.coverage,
        shadow_resolution: options.shadow_resolution,
        ambient_cells: options.ambient_cells,
        ..Quality::new([64, 64])
    };
    let renderer = Arc::new(quality.renderer(&gpu.device));
    let style: Style = style.parse().unwrap();
    let stage = pollster::block_on(async {
        let base = Base::built_in(&style, &gpu, &renderer.simulate, &()).await.unwrap();
        let styling = settings.styling(base.style(), &Default::default()).unwrap();
        let character = base.dress(&styling, &()).await.unwrap();
        let physics = settings.physics();
        let (colliders, progress) = (Colliders::default(), &());
        let mut stage =
            Stage::new(gpu, renderer, character, colliders, &physics, &quality, progress).await.unwrap();
        stage.offer_coarse(mannequin::mesh_with(48, &()).await);
        stage
    });
    Some((stage, settings))
}

fn picture(stage: &mut Stage, settings: &Settings, level: &Level, view: View) -> Vec<u8> {
    let size = AREA.map(|side| (side * level.scale).round() as u32);
    stage.resize(size).unwrap();
    level.dress(stage, settings).unwrap();
    // Hair is red, skin green: what is which is seen of every pixel.
    stage.look.body.color = Vec3::Y;
    stage.look.body.gloss = 0.0;
    stage.look.background = Background::transparent();
    let camera = Camera::portrait(view, stage.subject(), AREA[0] / AREA[1], 1.0);
    let mut encoder = stage.gpu.device.create_command_encoder(&Default::default());
    stage.watch(&camera);
    stage.rewind();
    stage.record_advance(&mut encoder, None, &Pose::IDENTITY, 0.0).unwrap();
    stage.record_draw(&mut encoder, None, &camera).unwrap();
    stage.gpu.queue.submit([encoder.finish()]);
    pollster::block_on(stage.targets.read(&stage.gpu.device, &stage.gpu.queue)).unwrap()
}

#[test]
fn probe() {
    let style = std::env::var("STYLE").unwrap_or("long".into());
    let Some((mut stage, settings)) = stage(&style) else { return };
    let strays: Vec<f32> =
        std::env::var("STRAYS").unwrap_or_default().split(',').filter_map(|s| s.parse().ok()).collect();
    let mut levels: Vec<Level> = LEVELS.to_vec();
    for s in strays {
        levels.push(Level { stray: s, ..LEVELS[7] });
    }
    for view in [View::Front, View::ThreeQuarter, View::Back] {
        for (i, level) in levels.iter().enumerate() {
            let p = picture(&mut stage, &settings, level, view);
            let px = p.as_chunks::<4>().0;
            let n = px.len() as f32;
            let hair = px.iter().filter(|p| p[3] > 127 && p[1] <= p[0]).count() as f32 / n;
            let skin = px.iter().filter(|p| p[3] > 127 && p[1] > p[0]).count() as f32 / n;
            let d = *stage.detail();
            let t = std::time::Instant::now();
            for _ in 0..4 {
                let _ = picture(&mut stage, &settings, level, view);
            }
            println!(
                "{view:?} {i} stray {}: hair {:.2} skin {:.2} strands {} width {:.2} seg {:.2} {:.0} ms",
                level.stray,
                hair * 100.0,
                skin * 100.0,
                d.strands,
                d.width,
                d.segments,
                t.elapsed().as_secs_f32() * 250.0
            );
            let size = stage.targets.size;
            image::save_buffer(
                format!("/tmp/studio8/{view:?}-{i}.png"),
                &p,
                size[0],
                size[1],
                image::ExtendedColorType::Rgba8,
            )
            .unwrap();
        }
    }
}
