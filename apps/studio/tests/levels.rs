//! Lower quality levels draw coarser hair that covers as much as full quality.

use std::path::Path;
use tresses::{
    Background, Gesture, Gpu, Timings, drape, glam::Vec3, groom::styles::Style, low_level::Detail,
};
use tresses_scene::{
    Colliders, Quality, Scene, Settings, Viewpoint, camera::Angle, measure::MeasuredFrame, motion::Motion,
    settings::HairColor,
};
use tresses_studio::{
    job,
    pace::{LEVELS, QualityLevel},
};

/// Size of the viewport in a window of the initial size, points.
const AREA: [f32; 2] = [884.0, 692.0];

fn stage() -> Option<(Scene, Settings)> {
    let gpu = tresses_testing::gpu_or_skip(pollster::block_on(Gpu::open()))?;
    let mut settings = Settings::default();
    settings.shading.color = HairColor::Blond;
    let view = job::view_options(&settings, gpu.context.tier()).unwrap();
    let quality = Quality { view, ..Quality::new([64, 64]) };
    let stage = pollster::block_on(async {
        let base = drape::style(&gpu.context, &Style::default(), &()).await.unwrap();
        let styling = settings.styling(base.style(), &Default::default()).unwrap();
        let character = base.parts(&styling, &()).await.unwrap();
        let (colliders, progress) = (Colliders::default(), &());
        Scene::new(gpu, character, colliders, &settings, &quality, progress).await.unwrap()
    });
    Some((stage, settings))
}

fn picture(stage: &mut Scene, settings: &Settings, level: &QualityLevel, view: Angle) -> Vec<u8> {
    let size = AREA.map(|side| (side * level.scale).round() as u32);
    stage.resize(size).unwrap();
    level.apply(stage, settings).unwrap();
    assert_eq!(stage.lighting, settings.lights, "each level has all lights");
    // Black skin and overexposed hair: each pixel is clearly one or the other.
    let body = &mut stage.character.body_mut().unwrap().material;
    (body.color, body.gloss) = (Vec3::ZERO, 0.0);
    stage.picture.tone.exposure *= 16.0;
    stage.picture.background = Background::transparent();
    let camera = Viewpoint::portrait(view, stage.subject(), AREA[0] / AREA[1], 1.0);
    let mut encoder = stage.gpu.context.device().create_command_encoder(&Default::default());
    stage.watch(&camera);
    stage.character.reset();
    stage.record_advance(&mut encoder, None, &Gesture::default(), 0.0).unwrap();
    stage.record_draw(&mut encoder, None, &camera).unwrap();
    stage.gpu.context.queue().submit([encoder.finish()]);
    pollster::block_on(stage.targets().read()).unwrap()
}

/// Number of blocks along each edge of an image.
const BLOCKS: usize = 24;

/// Returns the fraction of hair pixels in each block.
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

/// Returns the ratio of hair to the `full` image: overall, and in the dense block that lacks the most.
fn left(full: &[f32], now: &[f32]) -> [f32; 2] {
    let all = now.iter().sum::<f32>() / full.iter().sum::<f32>();
    let dense = full.iter().zip(now).filter(|(full, _)| **full > 0.9);
    [all, dense.map(|(full, now)| now / full).fold(1.0, f32::min)]
}

/// Largest deviation of the overall ratio from 1, and smallest ratio of a dense block.
const ALL: f32 = 0.05;
const LEAST: f32 = 0.75;

fn fits([all, least]: [f32; 2]) -> bool {
    (all - 1.0).abs() < ALL && least > LEAST
}

#[test]
fn lower_levels_cover_as_much() {
    cover_as_much(&[Angle::Back]);
}

#[test]
#[ignore = "proof"]
fn lower_levels_cover_as_much_from_the_side() {
    cover_as_much(&[Angle::ThreeQuarter]);
}

#[test]
fn frame_in_parts_is_bit_identical() {
    let Some((mut stage, settings)) = stage() else { return };
    stage.resize([300, 220]).unwrap();
    let camera = Viewpoint::portrait(Angle::default(), stage.subject(), AREA[0] / AREA[1], 1.0);
    let mut picture = |leave: Option<usize>| {
        QualityLevel::STILL.apply(&mut stage, &settings).unwrap();
        stage.character.reset();
        let context = stage.gpu.context.clone();
        let (mut apart, mut encoder) =
            (Timings::of_parts(), context.device().create_command_encoder(&Default::default()));
        let mut timings = leave.map(|_| &mut apart);
        stage.record_advance(&mut encoder, timings.as_deref_mut(), &Gesture::default(), 0.0).unwrap();
        stage.record_draw(&mut encoder, timings, &camera).unwrap();
        let mut parts = apart.parts();
        parts.push(encoder.finish());
        let all = parts.len();
        for (i, part) in parts.into_iter().enumerate() {
            if Some(i) != leave {
                context.queue().submit([part]);
            }
        }
        (pollster::block_on(stage.targets().read()).unwrap(), all)
    };
    let (whole, one) = picture(None);
    let (parts, all) = picture(Some(usize::MAX));
    assert_eq!(one, 1);
    assert!(all > 12, "hair itself is in parts: {all}");
    assert!(whole == parts, "the bits are the same");
    assert!(picture(Some(all / 2)).0 != whole, "a part that is left out is missed");
}

/// Returns the processor time of all threads of this process.
#[cfg(target_os = "linux")]
fn processor() -> std::time::Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    std::time::Duration::new(now.tv_sec.unsigned_abs(), now.tv_nsec as u32)
}

/// Prints the processor time of each level in motion, milliseconds per frame.
#[test]
#[cfg(target_os = "linux")]
#[ignore = "proof"]
fn cost_of_each_level() {
    let Some((mut stage, settings)) = stage() else { return };
    stage.measure_by(processor);
    let motion = Motion::named("shake").unwrap();
    let camera = Viewpoint::portrait(Angle::default(), stage.subject(), AREA[0] / AREA[1], 1.0);
    let all = LEVELS.iter().enumerate().map(|(i, level)| (i.to_string(), level));
    for (name, level) in all.skip(3).chain([("still".into(), &QualityLevel::STILL)]) {
        stage.resample(AREA.map(|side| (side * level.scale).round() as u32), level.ssaa).unwrap();
        stage.character.reset();
        let (frames, mut rows, mut whole) =
            (if level.ssaa > 1 { 6 } else { 40 }, Vec::<(&str, f64)>::new(), 0.0);
        for frame in 0..frames {
            level.apply(&mut stage, &settings).unwrap();
            let pose = motion.gesture(f64::from(frame) / 30.0, stage.character.neck());
            let MeasuredFrame { wall: all, stages, .. } =
                stage.measured_frame(&pose, 1.0 / 30.0, &camera).unwrap();
            if frame < frames / 2 {
                continue;
            }
            whole += all;
            for (name, ms) in stages {
                match rows.iter_mut().find(|row| row.0 == name) {
                    Some(row) => row.1 += ms,
                    None => rows.push((name, ms)),
                }
            }
        }
        let each = 1.0 / f64::from(frames / 2);
        let Detail { strand_count: strands, segment_count: segments, .. } = stage.detail();
        println!("level {name}: {:.1} ms, {strands} strands, {segments:.1} segments", whole * each);
        let rows: Vec<_> = rows.iter().map(|(name, ms)| format!("{name} {:.1}", ms * each)).collect();
        println!("  {}", rows.join(", "));
    }
}

fn cover_as_much(views: &[Angle]) {
    let Some((mut stage, settings)) = stage() else { return };
    let whole = QualityLevel { scale: 0.5, ..QualityLevel::FULL };
    // The chords of so few segments cut through the skull.
    let bald = QualityLevel { stray: 10.0, ..LEVELS[LEVELS.len() - 1] };
    for &view in views {
        let mut seen = |name: &str, level: &QualityLevel| {
            let picture = picture(&mut stage, &settings, level, view);
            if let Some(folder) = std::env::var_os("TRESSES_PICTURES") {
                let path = Path::new(&folder).join(format!("level-{view:?}-{name}.png"));
                let [width, height] = stage.targets().size;
                image::save_buffer(path, &picture, width, height, image::ExtendedColorType::Rgba8).unwrap();
            }
            let Detail { strand_count: strands, segment_count: segments, .. } = stage.detail();
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
