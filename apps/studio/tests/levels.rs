//! Lower quality levels cover as much as full quality: a small picture has coarser hair, not less.

use std::{path::Path, sync::Arc};
use tresses::{
    Pipelines, Pose, glam::Vec3, gpu::Gpu, groom::styles::Style, lod::Detail, present::Background,
};
use tresses_scene::{
    Base, Colliders, Quality, Scene, Settings, Viewpoint, camera::Angle, settings::HairColor,
};
use tresses_studio::{
    pace::{LEVELS, Level},
    turn,
};

/// Width and height of the picture in a window of the size that it opens in, points.
const AREA: [f32; 2] = [884.0, 692.0];

fn stage() -> Option<(Scene, Settings)> {
    let Ok(gpu) = pollster::block_on(Gpu::open()) else {
        assert!(std::env::var_os("TRESSES_REQUIRE_GPU").is_none(), "there is no adapter");
        return None;
    };
    let mut settings = Settings::default();
    settings.shading.color = HairColor::Blond;
    let options = turn::draw_options(&settings, &gpu.tier).unwrap();
    let quality = Quality {
        samples: options.samples,
        coverage: options.coverage,
        shadow_resolution: options.shadow_resolution,
        ambient_cells: options.ambient_cells,
        ..Quality::new([64, 64])
    };
    let pipelines = Arc::new(Pipelines::new(&gpu.device));
    let stage = pollster::block_on(async {
        let base = Base::built_in(&Style::default(), &gpu, &pipelines.simulate, &()).await.unwrap();
        let styling = settings.styling(base.style(), &Default::default()).unwrap();
        let character = base.dress(&styling, &()).await.unwrap();
        let physics = settings.physics();
        let (colliders, progress) = (Colliders::default(), &());
        Scene::new(gpu, pipelines, character, colliders, &physics, &quality, progress).await.unwrap()
    });
    Some((stage, settings))
}

fn picture(stage: &mut Scene, settings: &Settings, level: &Level, view: Angle) -> Vec<u8> {
    let size = AREA.map(|side| (side * level.scale).round() as u32);
    stage.resize(size).unwrap();
    level.dress(stage, settings).unwrap();
    assert_eq!(stage.lighting, settings.lights, "each level has all lights");
    // Skin is black in any light, hair is not: what is which is seen of every pixel.
    let body = &mut stage.body.as_mut().unwrap().material;
    (body.color, body.gloss) = (Vec3::ZERO, 0.0);
    stage.picture.tone.exposure *= 16.0;
    stage.picture.background = Background::transparent();
    let camera = Viewpoint::portrait(view, stage.subject(), AREA[0] / AREA[1], 1.0);
    let mut encoder = stage.gpu.device.create_command_encoder(&Default::default());
    stage.watch(&camera);
    stage.rewind();
    stage.record_advance(&mut encoder, None, &Pose::IDENTITY, 0.0).unwrap();
    stage.record_draw(&mut encoder, None, &camera).unwrap();
    stage.gpu.queue.submit([encoder.finish()]);
    pollster::block_on(stage.targets().read(&stage.gpu.device, &stage.gpu.queue)).unwrap()
}

/// Blocks along each edge of a picture.
const BLOCKS: usize = 24;

/// The share of each block of the picture that is hair.
fn hair(stage: &Scene, picture: &[u8]) -> Vec<f32> {
    let [width, height] = stage.targets().size.map(|side| side as usize);
    let mut blocks = vec![[0.0; 2]; BLOCKS * BLOCKS];
    for (i, [r, g, b, alpha]) in picture.as_chunks().0.iter().enumerate() {
        let [x, y] = [i % width * BLOCKS / width, i / width * BLOCKS / height];
        let block = &mut blocks[y * BLOCKS + x];
        block[0] += 1.0;
        block[1] += f32::from(*alpha > 127 && [*r, *g, *b] != [0; 3]);
    }
    blocks.into_iter().map(|[all, hair]| hair / all).collect()
}

/// What there is of the hair in all, and in the block that lacks the most of those that are full of it.
fn left(full: &[f32], now: &[f32]) -> [f32; 2] {
    let all = now.iter().sum::<f32>() / full.iter().sum::<f32>();
    let dense = full.iter().zip(now).filter(|(full, _)| **full > 0.9);
    [all, dense.map(|(full, now)| now / full).fold(1.0, f32::min)]
}

/// How much hair may lack or be too much in all, and how much must be there where it is full.
const ALL: f32 = 0.05;
const LEAST: f32 = 0.75;

fn fits([all, least]: [f32; 2]) -> bool {
    (all - 1.0).abs() < ALL && least > LEAST
}

#[test]
fn what_is_lowered_covers_as_much() {
    cover_as_much(&[Angle::Back]);
}

#[test]
#[ignore = "proof"]
fn what_is_lowered_covers_as_much_from_the_side() {
    cover_as_much(&[Angle::ThreeQuarter]);
}

fn cover_as_much(views: &[Angle]) {
    let Some((mut stage, settings)) = stage() else { return };
    let whole = Level { scale: 0.5, ..Level::FULL };
    // The chords of so few segments sink into the skull.
    let bald = Level { stray: 10.0, ..LEVELS[LEVELS.len() - 1] };
    for &view in views {
        let mut seen = |name: &str, level: &Level| {
            let picture = picture(&mut stage, &settings, level, view);
            if let Some(folder) = std::env::var_os("TRESSES_PICTURES") {
                let path = Path::new(&folder).join(format!("level-{view:?}-{name}.png"));
                let [width, height] = stage.targets().size;
                image::save_buffer(path, &picture, width, height, image::ExtendedColorType::Rgba8).unwrap();
            }
            let Detail { strands, segments, .. } = stage.detail();
            println!("{view:?}, {name}: {strands} strands, {segments:.1} segments");
            hair(&stage, &picture)
        };
        let full = seen("full", &whole);
        for (i, level) in LEVELS.iter().enumerate().skip(4) {
            let left = left(&full, &seen(&i.to_string(), level));
            println!("  {left:.3?}");
            assert!(fits(left), "{view:?}, {level:?}: {left:?}");
        }
        let bald = left(&full, &seen("bald", &bald));
        println!("  {bald:.3?}");
        assert!(!fits(bald), "the comparer sees a bald crown: {bald:?}");
    }
}
