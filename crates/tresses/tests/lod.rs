//! Hair at a level of detail covers and shines as hair in full detail does, and changes without a jump.

mod common;

use std::path::PathBuf;
use tresses::{
    Hair, HairOptions, HairRenderer, Pose,
    collide::ColliderPoses,
    draw::{Background, Coverage, DrawOptions, Scene, View},
    frame::{Frame, Recorder},
    glam::{Quat, Vec3},
    gpu::{Gpu, readback::blocking as readback},
    groom::{Groom, SdfGrid, bind, grow::ScalpMap, import, styles},
    light::{Sphere, material::linear},
    lod::{Detail, LodLevel, LodMode, arrange},
    present::ToneMap,
    simulate::SimulationParams,
    strands::StrandVertex,
};

/// Radians per pixel of a portrait lens (30 degrees) 720 pixels high.
const PIXEL_ANGLE: f32 = 0.000_744_3;

struct Stage {
    gpu: Gpu,
    renderer: HairRenderer,
}

impl Stage {
    fn open() -> Option<&'static Self> {
        static STAGE: std::sync::OnceLock<Option<Stage>> = std::sync::OnceLock::new();
        STAGE
            .get_or_init(|| {
                let gpu = common::gpu()?;
                // As the command draws.
                let options = DrawOptions { samples: 1, coverage: Coverage::PEELING, ..Default::default() };
                Some(Stage { renderer: HairRenderer::new(&gpu.device, &options), gpu })
            })
            .as_ref()
    }

    fn style(&self, name: &str, strands: u32) -> (Groom, SdfGrid) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let style = name.parse().unwrap();
        let built = pollster::block_on(styles::character(
            device,
            queue,
            &self.renderer.simulate,
            &style,
            Some(strands),
        ))
        .unwrap();
        (built.groom, built.field)
    }

    fn hair(&self, groom: &Groom, field: Option<&SdfGrid>) -> Hair {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut hair =
            Hair::new(device, queue, &self.renderer, groom, &HairOptions::default(), field).unwrap();
        self.advance(&mut hair, Pose::IDENTITY, 0.0);
        hair
    }

    fn advance(&self, hair: &mut Hair, head: Pose, dt: f32) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut encoder = device.create_command_encoder(&Default::default());
        let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
        let frame = Frame { dt, head, colliders, simulation };
        let renderer = &self.renderer;
        let mut recorder = Recorder { renderer, device, queue, encoder: &mut encoder, timings: None };
        recorder.advance(hair, &frame).unwrap();
        queue.submit([encoder.finish()]);
    }

    fn vertices(&self, hair: &Hair) -> Vec<StrandVertex> {
        readback::buffer(&self.gpu.device, &self.gpu.queue, &hair.strands.vertices).unwrap()
    }

    /// The hair at `detail` from `distance` metres, in a picture `size` pixels high that it fills: linear,
    /// premultiplied.
    fn picture(&self, hair: &mut Hair, detail: Detail, shot: &Shot, size: u32, ssaa: u32) -> Vec<[f32; 4]> {
        // What the stage writes for a picture holds until it is submitted.
        static ONE: std::sync::Mutex<()> = std::sync::Mutex::new(());
        let _one = ONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let (middle, radius) = hair.lod.sphere;
        hair.set_detail(device, queue, detail);
        self.advance(hair, Pose::IDENTITY, 0.0);
        let targets = self.renderer.draw.targets(device, size, size, ssaa).unwrap();
        let eye = middle + shot.direction.normalize() * shot.distance;
        let scene = Scene {
            view: View::look_at(eye, middle, shot.fov(radius), [size; 2]),
            focus: Sphere { center: middle, radius: 1.05 * radius },
            background: Background::transparent(),
            // Linear, and nothing is too bright.
            tone: ToneMap { exposure: 0.25, shoulder: 1.0, desaturation: 0.0 },
            ..Default::default()
        };
        let mut encoder = device.create_command_encoder(&Default::default());
        let renderer = &self.renderer;
        Recorder { renderer, device, queue, encoder: &mut encoder, timings: None }.draw(
            hair,
            None,
            &scene,
            &targets,
            targets.picture(),
        );
        queue.submit([encoder.finish()]);
        let linear = |byte: u8| linear(f32::from(byte) / 255.0);
        let bytes = pollster::block_on(targets.read(device, queue)).unwrap();
        let pixel = |p: &[u8; 4]| [linear(p[0]), linear(p[1]), linear(p[2]), f32::from(p[3]) / 255.0];
        bytes.as_chunks::<4>().0.iter().map(pixel).collect()
    }
}

/// From where hair is looked at.
struct Shot {
    distance: f32,
    direction: Vec3,
}

impl Shot {
    /// The field of view that the hair fills.
    fn fov(&self, radius: f32) -> f32 {
        2.0 * (1.1 * radius / self.distance).asin().min(1.2)
    }

    /// As many pixels as the hair has in a picture 720 pixels high.
    fn size(&self, radius: f32) -> u32 {
        (2.0 * (0.5 * self.fov(radius)).tan() / PIXEL_ANGLE).ceil().max(4.0) as u32
    }

    /// What level of detail has for it.
    fn detail(&self, hair: &Hair) -> Detail {
        let radius = hair.lod.sphere.1;
        let pixel = PIXEL_ANGLE * (self.distance - radius).max(0.01);
        hair.lod.detail(pixel, 2.0 * radius / (PIXEL_ANGLE * self.distance))
    }
}

/// The share of the picture that is covered, and the mean luminance of what is covered.
fn measure(picture: &[[f32; 4]]) -> [f32; 2] {
    let covered: f32 = picture.iter().map(|p| p[3]).sum();
    let light: f32 = picture.iter().map(|p| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]).sum();
    [covered / picture.len() as f32, light / covered]
}

/// How much more coverage and luminance the hair has from `shot` than in full detail in a finer picture;
/// `change` perturbs the level of detail.
fn errors(stage: &Stage, hair: &mut Hair, shot: &Shot, change: impl Fn(&mut Detail)) -> [f32; 2] {
    let size = shot.size(hair.lod.sphere.1);
    let mut detail = shot.detail(hair);
    change(&mut detail);
    hair.lod.options.mode = LodMode::Off;
    let full = shot.detail(hair);
    hair.lod.options.mode = LodMode::Auto;
    // At least four times as many samples, and as many as it takes to see strands.
    let reference = measure(&stage.picture(hair, full, shot, size.max(200), 2));
    let seen = measure(&stage.picture(hair, detail, shot, size, 1));
    [0, 1].map(|i| seen[i] / reference[i] - 1.0)
}

/// What coverage and luminance may be off by.
const MOST: f32 = 0.03;
/// And where the hair is less than 20 pixels large: docs/appearance/lod.md says what is not reached there.
const FAR: [f32; 2] = [0.05, 0.1];

fn most(distance: f32) -> [f32; 2] {
    if distance < 30.0 { [MOST; 2] } else { FAR }
}

/// Prints the errors at each of `distances` and holds them against `most`, which they may be at a distance.
fn check(stage: &Stage, name: &str, hair: &mut Hair, distances: &[f32], most: impl Fn(f32) -> [f32; 2]) {
    for &distance in distances {
        // From several sides: what is a few pixels large shines by chance.
        let directions = [Vec3::new(0.5, 0.1, 1.0), Vec3::new(-1.0, 0.3, -0.6), Vec3::new(1.0, 0.1, -0.1)];
        let mut mean = [0f32; 2];
        for direction in directions {
            let error = errors(stage, hair, &Shot { distance, direction }, |_| {});
            mean = [0, 1].map(|i| mean[i] + error[i] / directions.len() as f32);
        }
        let shot = Shot { distance, direction: Vec3::Z };
        let Detail { strands, width, shadow, segments, .. } = shot.detail(hair);
        println!(
            "{name}, {distance} m: {} px, {strands} strands, {width:.2} times as wide, of which light meets \
             {shadow:.2}, {segments:.2} segments: coverage {:+.2} %, luminance {:+.2} %",
            shot.size(hair.lod.sphere.1),
            100.0 * mean[0],
            100.0 * mean[1]
        );
        let most = most(distance);
        assert!(mean[0].abs() < most[0] && mean[1].abs() < most[1], "{name}, {distance} m: {mean:?}");
    }
}

/// From where nothing is left out to where the hair is a few pixels large, metres: all of them for the docs.
fn distances(few: &'static [f32]) -> &'static [f32] {
    if std::env::var_os("TRESSES_FIGURES").is_some() { &[1.0, 2.0, 4.0, 8.0, 16.0, 40.0] } else { few }
}

#[test]
fn coverage_and_luminance_stay_at_any_distance() {
    let Some(stage) = Stage::open() else { return };
    let (groom, _) = stage.style("long", 5000);
    let mut hair = stage.hair(&groom, None);
    check(stage, "long", &mut hair, distances(&[8.0, 16.0, 40.0]), most);
    // The comparer sees strands that are not widened, and light that meets nothing of them.
    let shot = Shot { distance: 8.0, direction: Vec3::Z };
    let [thin, _] = errors(stage, &mut hair, &shot, |detail| detail.width = 1.0);
    assert!(thin < -MOST, "{thin}");
    let [_, lit] = errors(stage, &mut hair, &shot, |detail| detail.shadow *= 0.8);
    assert!(lit > MOST, "{lit}");
}

#[test]
fn other_styles_keep_coverage_and_luminance() {
    let Some(stage) = Stage::open() else { return };
    let (groom, _) = stage.style("short", 5000);
    check(stage, "short", &mut stage.hair(&groom, None), distances(&[40.0]), |_| [MOST; 2]);
    let (groom, _) = stage.style("curly", 5000);
    // Curls of less than a pixel fold over: not reached, docs/appearance/lod.md.
    let most = |distance| if distance < 30.0 { [MOST; 2] } else { [0.1; 2] };
    check(stage, "curly", &mut stage.hair(&groom, None), distances(&[16.0]), most);
}

#[test]
fn real_grooms_keep_coverage_and_luminance() {
    let Some(stage) = Stage::open() else { return };
    let folder = std::env::var_os("TRESSES_ASSETS").map(PathBuf::from);
    let Some(folder) = folder.filter(|f| f.is_dir()) else {
        return println!("skipped: TRESSES_ASSETS names no folder");
    };
    let tressfx =
        ["free", "front", "pulled", "tail"].map(|part| format!("tressfx2_head/hair_{part}_16_guide.tfx"));
    let sintel = ["sintel/SintelHairOriginal-sintel_hair.16points.tfx".to_owned()];
    let few: [&[f32]; 2] = [&[8.0, 40.0], &[16.0]];
    for (name, files, few) in [("Sintel", &sintel[..], few[0]), ("TressFX 2", &tressfx[..], few[1])] {
        let files: Vec<_> = files.iter().map(|file| folder.join(file)).collect();
        if !files.iter().all(|file| file.exists()) {
            println!("skipped: TRESSES_ASSETS has no {name}");
            continue;
        }
        let (strands, _) = import::read(&files, &Default::default()).unwrap();
        let groom = bind(&strands, &Default::default()).unwrap();
        check(stage, name, &mut stage.hair(&groom, None), distances(few), most);
    }
}

/// Mean differences of coverage and colour from each picture to the next.
fn steps(stage: &Stage, hair: &mut Hair, details: &[Detail]) -> Vec<f32> {
    let shot = Shot { distance: 6.0, direction: Vec3::new(0.4, 0.1, 1.0) };
    let size = shot.size(hair.lod.sphere.1);
    let pictures: Vec<_> =
        details.iter().map(|detail| stage.picture(hair, *detail, &shot, size, 1)).collect();
    let difference = |a: &[[f32; 4]], b: &[[f32; 4]]| {
        let pixel = |(a, b): (&[f32; 4], &[f32; 4])| (0..4).map(|i| (a[i] - b[i]).abs()).sum::<f32>();
        a.iter().zip(b).map(pixel).sum::<f32>() / a.len() as f32
    };
    pictures.windows(2).map(|w| difference(&w[0], &w[1])).collect()
}

/// The largest step over the median one.
fn jump(steps: &[f32]) -> f32 {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[sorted.len() - 1] / sorted[sorted.len() / 2].max(1e-9)
}

#[test]
fn nothing_pops() {
    let Some(stage) = Stage::open() else { return };
    let (groom, _) = stage.style("long", 5000);
    let mut hair = stage.hair(&groom, None);
    // The camera stays; only what it is believed to be away grows, by 3 % from frame to frame, through
    // nine buckets and several numbers of segments.
    let start = hair.lod.diameter / hair.lod.options.strand_width;
    let details: Vec<_> = (0..72).map(|i| hair.lod.detail(0.8 * start * 1.03f32.powi(i), 100.0)).collect();
    let last = details[details.len() - 1];
    let first = details[0];
    assert!((first.strands, first.width, first.segments) == (5000, 1.0, 31.0), "{first:?}");
    assert!(last.strands < 1100 && last.segments < 26.0, "{last:?}");
    // The first frames are in full detail: nothing changes.
    let all = steps(stage, &mut hair, &details);
    let moving: Vec<_> = all.iter().copied().skip_while(|step| *step == 0.0).collect();
    println!("{} frames, largest step over median {:.2}", moving.len(), jump(&moving));
    assert!(moving.len() < 66 && jump(&moving) < 3.5, "{moving:?}");
    // Half the step is half the difference, or nearly: it is no noise.
    let finer: Vec<_> = (0..16).map(|i| hair.lod.detail(1.6 * start * 1.005f32.powi(i), 100.0)).collect();
    let coarser: Vec<_> = (0..8).map(|i| hair.lod.detail(1.6 * start * 1.02f32.powi(i), 100.0)).collect();
    let mean = |steps: &[f32]| steps.iter().sum::<f32>() / steps.len() as f32;
    let ratio = mean(&steps(stage, &mut hair, &coarser)) / mean(&steps(stage, &mut hair, &finer));
    println!("four times the step, {ratio:.2} times the difference");
    assert!(ratio > 2.0, "{ratio}");
    // The comparer sees strands that come an octave at a time.
    let octave = |d: &Detail| hair.lod.detail(start * (d.pixel / start).log2().floor().exp2(), 100.0);
    let octaves: Vec<_> = details.iter().map(octave).collect();
    let mut coming = steps(stage, &mut hair, &octaves);
    coming.retain(|step| *step > 0.0);
    coming.extend(moving);
    println!("with octaves of strands {:.2}", jump(&coming));
    assert!(jump(&coming) > 5.0);
}

/// What the order of strands costs `interpolate`: figures for the docs.
#[test]
#[ignore = "figures"]
fn orders() {
    use tresses::{
        interpolate::{Interpolate, InterpolateParams},
        strands::{GuideBuffers, StrandBuffers},
    };
    let Some(stage) = Stage::open() else { return };
    let (device, queue) = (&stage.gpu.device, &stage.gpu.queue);
    let interpolate = Interpolate::new(device);
    for (name, count) in [("long", 30_000), ("short", 60_000)] {
        let (groom, _) = stage.style(name, count);
        let n = groom.strands.vertex_count;
        let mut arranged = groom.strands.clone();
        arrange(&mut arranged);
        let guides =
            GuideBuffers::new(device, groom.guides.len() as u32, groom.guides.vertex_count, n).unwrap();
        let runs = [&groom.strands, &arranged].map(|strands| {
            let buffers = StrandBuffers::new(device, strands.len() as u32, n).unwrap();
            queue.write_buffer(&buffers.bindings, 0, bytemuck::cast_slice(&strands.bindings));
            queue.write_buffer(&buffers.rest, 0, bytemuck::cast_slice(&strands.rest));
            let params = device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: size_of::<InterpolateParams>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            queue.write_buffer(&params, 0, bytemuck::bytes_of(&InterpolateParams::new(&guides, &buffers)));
            (interpolate.bind(device, &params, &guides, &buffers), buffers)
        });
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..25 {
            for ((group, buffers), times) in runs.iter().zip(&mut times) {
                let mut encoder = device.create_command_encoder(&Default::default());
                interpolate.record(&mut encoder.begin_compute_pass(&Default::default()), group, buffers);
                let start = std::time::Instant::now();
                queue.submit([encoder.finish()]);
                device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        let [file, sampled] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            [times[0], times[12]]
        });
        println!(
            "{name}, {count} strands: as they come {file:.2?} ms, arranged {sampled:.2?} ms (least, median)"
        );
    }
}

#[test]
fn fewer_vertices_lie_on_the_same_strand() {
    let Some(stage) = Stage::open() else { return };
    let mut groom = bind(&common::hanging(400, 16, 0.2), &Default::default()).unwrap();
    arrange(&mut groom.strands);
    let mut hair = stage.hair(&groom, None);
    let (device, queue) = (&stage.gpu.device, &stage.gpu.queue);
    let full = *hair.lod.current();
    for segments in [15.0, 14.5, 7.4, 3.0, 1.0] {
        hair.set_detail(device, queue, Detail { segments, strands: 300, ..full });
        stage.advance(&mut hair, Pose::IDENTITY, 0.0);
        let drawn = hair.strands.drawn;
        assert_eq!((drawn.count, drawn.vertex_count), (300, segments.ceil() as u32 + 1));
        let vertices = stage.vertices(&hair);
        for (i, strand) in vertices.chunks(drawn.vertex_count as usize).take(300).enumerate() {
            let rest: Vec<_> = groom.strands.rest_positions(i).collect();
            let expected = tresses::lod::resample(&rest, segments);
            for (v, p) in strand.iter().zip(&expected) {
                assert!(v.position.distance(*p) < 2e-4, "{segments} {i}: {} {p}", v.position);
            }
            // A strand of another number of segments lies elsewhere.
            let other = tresses::lod::resample(&rest, 0.9 * segments);
            let off = strand.iter().zip(&other).map(|(v, p)| v.position.distance(*p)).fold(0.0, f32::max);
            assert!(segments == 1.0 || off > 2e-4);
        }
    }
}

#[test]
fn strands_that_come_back_have_forgotten() {
    let Some(stage) = Stage::open() else { return };
    let mut groom = bind(&common::hanging(600, 16, 0.16), &Default::default()).unwrap();
    arrange(&mut groom.strands);
    let field = common::ball(0.09, 64);
    let mut hair = stage.hair(&groom, Some(&field));
    let (device, queue) = (&stage.gpu.device, &stage.gpu.queue);
    let turn = |t: f32| Pose::about(Vec3::new(0.0, 0.0, -0.02), Quat::from_rotation_y((10.0 * t).sin()));
    for i in 1..40 {
        stage.advance(&mut hair, turn(i as f32 / 60.0), 1.0 / 60.0);
    }
    let amounts = |hair: &Hair| -> Vec<f32> {
        let states: Vec<[f32; 4]> = readback::buffer(device, queue, hair.avoidance.states()).unwrap();
        states.iter().map(|state| state[1]).collect()
    };
    let most = |amounts: &[f32]| amounts.iter().copied().fold(0.0, f32::max);
    let before = amounts(&hair);
    assert!(most(&before[300..]) > 0.9, "{}", most(&before[300..]));
    let full = *hair.lod.current();
    hair.set_detail(device, queue, Detail { strands: 300, ..full });
    stage.advance(&mut hair, turn(40.0 / 60.0), 1.0 / 60.0);
    assert!(most(&amounts(&hair)[300..]) > 0.9, "what is not drawn is left alone");
    hair.set_detail(device, queue, full);
    stage.advance(&mut hair, turn(41.0 / 60.0), 1.0 / 60.0);
    let after = amounts(&hair);
    println!(
        "largest amount {} of those that come back, {} of others",
        most(&after[300..]),
        most(&after[..300])
    );
    assert!(most(&after[300..]) < 0.5 && most(&after[..300]) > 0.9);
}

#[test]
fn painted_levels_act_where_they_are_painted() {
    let Some(stage) = Stage::open() else { return };
    let mut groom = bind(&common::hanging(400, 16, 0.2), &Default::default()).unwrap();
    arrange(&mut groom.strands);
    let mut hair = stage.hair(&groom, None);
    let (device, queue) = (&stage.gpu.device, &stage.gpu.queue);
    let side =
        |left: f32, right: f32| Some(ScalpMap::from_fn(64, move |uv| if uv.x > 0.5 { left } else { right }));
    let levels = [
        LodLevel { size: 400.0, ..Default::default() },
        LodLevel { size: 100.0, density: side(0.0, 1.0), thickness: side(1.0, 2.0) },
    ];
    hair.paint_levels(queue, &groom, &levels, Vec3::ZERO).unwrap();
    hair.lod.options.mode = LodMode::Off;
    let mut scales = |size: f32| -> Vec<(f32, f32)> {
        let detail = hair.lod.detail(1e-3, size);
        hair.set_detail(device, queue, detail);
        stage.advance(&mut hair, Pose::IDENTITY, 0.0);
        let widening: Vec<f32> = readback::buffer(device, queue, &hair.strands.widening).unwrap();
        let root = |i: usize| groom.strands.rest_positions(i).next().unwrap().x;
        // Away from the blend between the two sides.
        (0..400).filter(|i| root(*i).abs() > 0.03).map(|i| (root(i), 1.0 + widening[i])).collect()
    };
    assert!(scales(500.0).iter().all(|(_, scale)| (scale - 1.0).abs() < 1e-3));
    assert!(scales(50.0).iter().all(|(x, scale)| (scale - if *x > 0.0 { 0.0 } else { 2.0 }).abs() < 0.02));
    let half = scales(200.0);
    // Half of the left side's strands are there, and the right side's are one and a half times as wide.
    let left: Vec<_> = half.iter().filter(|(x, _)| *x > 0.0).map(|(_, scale)| *scale).collect();
    let mean = left.iter().sum::<f32>() / left.len() as f32;
    assert!((mean - 0.5).abs() < 0.08, "{mean}");
    assert!(half.iter().filter(|(x, _)| *x < 0.0).all(|(_, scale)| (scale - 1.5).abs() < 0.02));
    // Another groom is refused.
    let other = bind(&common::hanging(300, 16, 0.2), &Default::default()).unwrap();
    assert!(hair.paint_levels(queue, &other, &levels, Vec3::ZERO).is_err());
}

#[test]
fn slower_steps_are_the_same_motion() {
    let Some(stage) = Stage::open() else { return };
    let (groom, field) = stage.style("long", 600);
    let (device, queue) = (&stage.gpu.device, &stage.gpu.queue);
    // A turn by 60 degrees and back in a second, and a second to come to rest.
    let pose = |t: f32| {
        let s = (std::f32::consts::PI * t.min(1.0)).sin();
        Pose::about(Vec3::new(0.0, 1.5, 0.0), Quat::from_rotation_y(s * s * 60f32.to_radians()))
    };
    let run = |slow: &dyn Fn(f32) -> f32| {
        let mut hair = stage.hair(&groom, Some(&field));
        let full = *hair.lod.current();
        (1..=120)
            .map(|i| {
                let t = i as f32 / 60.0;
                hair.set_detail(device, queue, Detail { step: slow(t), ..full });
                stage.advance(&mut hair, pose(t), 1.0 / 60.0);
                stage.vertices(&hair)
            })
            .collect::<Vec<_>>()
    };
    let distance = |a: &[StrandVertex], b: &[StrandVertex]| {
        a.iter().zip(b).map(|(a, b)| a.position.distance(b.position)).sum::<f32>() / a.len() as f32
    };
    let worst = |a: &[Vec<StrandVertex>], b: &[Vec<StrandVertex>]| {
        a.iter().zip(b).map(|(a, b)| distance(a, b)).fold(0.0, f32::max)
    };
    let quick = run(&|_| 1.0);
    let slow = run(&|_| 2.0);
    // Between them while it moves, by 2 % of the step from frame to frame.
    let change = run(&|t| (1.0 + (t - 0.2)).clamp(1.0, 2.0));
    let travel = worst(&quick, &vec![quick[0].clone(); 120]);
    println!(
        "mean difference in the worst frame: {:.2} mm at half the rate, {:.2} mm while it changes, of {:.0} mm travelled; {:.2} mm in the last frame",
        1e3 * worst(&quick, &slow),
        1e3 * worst(&quick, &change),
        1e3 * travel,
        1e3 * distance(&quick[119], &slow[119])
    );
    // Less than a pixel where steps are that long.
    assert!(worst(&quick, &slow) < 6e-3 && worst(&quick, &change) < 6e-3 && travel > 20e-3);
    // Nothing jumps while the rate changes: the largest way in a frame is that of the quick motion.
    let ways =
        |frames: &[Vec<StrandVertex>]| frames.windows(2).map(|w| distance(&w[0], &w[1])).fold(0.0, f32::max);
    println!(
        "largest way in a frame: {:.2} mm, {:.2} mm while the rate changes",
        1e3 * ways(&quick),
        1e3 * ways(&change)
    );
    assert!(ways(&change) < 1.15 * ways(&quick));
    // Another motion is seen.
    assert!(worst(&quick, &quick.iter().skip(4).chain(&quick[..4]).cloned().collect::<Vec<_>>()) > 6e-3);
}
