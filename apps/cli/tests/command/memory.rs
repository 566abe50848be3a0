//! Memory use is constant: a character moves for hundreds of frames while image size, level of detail and debug view
//! change, and the process does not grow.
//!
//! Each measurement runs in a child process of this executable, so that memory of other tests does not count.

use std::{process::Command, str::FromStr};
use tresses::{
    Gpu, LodMode, LodOptions, drape,
    groom::styles::Style,
    low_level::{DebugDisplay, DebugView},
    renderer::Renderer,
};
use tresses_scene::{
    Colliders, CompanionFiles, Motion, PresetSource, Quality, Scene, Settings, Shelf, Viewpoint,
    camera::Angle,
};

/// Warm-up frames: afterwards all pipelines, buffer sizes and shader variants exist.
const WARM: u32 = 100;
/// Largest allowed growth after the warm-up, bytes.
const MAX_GROWTH: i64 = 20_000_000;
/// The same on a GPU, whose driver may keep more of its own in the memory of the process. Not measured yet.
const MAX_GPU_GROWTH: i64 = 60_000_000;

/// Returns the resident memory of the process, bytes.
fn resident() -> i64 {
    let pages = std::fs::read_to_string("/proc/self/statm").expect("Linux tells");
    let pages: i64 = pages.split(' ').nth(1).and_then(|n| n.parse().ok()).expect("the second number");
    pages * 4096
}

/// Environment variables of a child: number of frames, samples per pixel, and bytes leaked per frame.
const WORK: [&str; 3] = ["TRESSES_MEMORY_FRAMES", "TRESSES_MEMORY_SAMPLES", "TRESSES_MEMORY_LEAK"];

/// Returns the growth of a process that draws `frames` frames with sample masks of `samples` (0: tiles) and
/// leaks `leak` bytes per frame, and the largest allowed growth; `None` without a GPU.
fn growth(frames: u32, samples: u32, leak: u32) -> Option<[i64; 2]> {
    let mut child = Command::new(std::env::current_exe().expect("this runs"));
    child.args(["--exact", "memory::work", "--ignored", "--nocapture"]);
    for (name, value) in WORK.iter().zip([frames, samples, leak]) {
        child.env(name, value.to_string());
    }
    let output = child.output().expect("a process starts");
    let (told, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{told}{errors}");
    if tresses_testing::lacks_gpu(&told) {
        return None;
    }
    let grown = told.lines().find_map(|line| line.split("grown by ").nth(1)?.parse().ok());
    let grown: i64 = grown.expect("the child tells");
    println!("{frames} frames, {samples} samples: {:.1} MB", grown as f64 * 1e-6);
    Some([grown, if told.contains(SOFTWARE) { MAX_GROWTH } else { MAX_GPU_GROWTH }])
}

/// Line that a child prints on a software driver.
const SOFTWARE: &str = "on a software driver";

/// Sequence of debug views, with normal renders in between.
const VIEWS: [Option<DebugView>; 8] = [
    None,
    Some(DebugView::Locks),
    None,
    Some(DebugView::Density),
    None,
    Some(DebugView::Guides),
    None,
    Some(DebugView::Overdraw),
];
const SIZES: [[u32; 2]; 3] = [[64, 40], [48, 48], [80, 32]];
/// Number of frames for which each view, size and level of detail lasts; the sequence repeats after 56 frames.
const LASTS: u32 = 7;
/// Number of frames for the median: single frames briefly hold up to 15 MB more.
const SPAN: u32 = 4 * LASTS;

#[test]
#[ignore = "the work of the others, in a process of its own"]
fn work() {
    let variable = |name| std::env::var(name).ok().and_then(|value| value.parse::<u32>().ok());
    let [Some(frames), Some(samples), Some(leak)] = WORK.map(variable) else { return };
    let gpu = match pollster::block_on(Gpu::open()) {
        Ok(gpu) => gpu,
        Err(error) => return println!("no GPU adapter: {error}"),
    };
    if gpu.context.tier().software {
        println!("{SOFTWARE}");
    }
    let mut quality = Quality::new(SIZES[0]);
    (quality.view.shadow_resolution, quality.view.ambient_resolution) = (64, 8);
    if samples > 0 {
        quality.view.renderer = Renderer::masks(samples);
    }
    let mut settings = Settings::default();
    settings.set("wind.speed", 3.0f32).expect("there is wind");
    settings.set("wind.cells", 16u32).expect("air in large cells");
    settings.set("style.strands", 200u32).expect("there are strands");
    let style = Style::from_str("short").expect("a built-in style");
    let source = PresetSource::default();
    let maps = CompanionFiles::of(&source, Shelf::default()).maps().expect("none");
    let styling = settings.styling(Some(&style), &maps).expect("a styling");
    let base = pollster::block_on(drape::style(&gpu.context, &style, &())).expect("a base");
    let character = pollster::block_on(base.parts(&styling, &())).expect("a character");
    let scene = Scene::new(gpu, character, Colliders::default(), &settings, &quality, &());
    let mut scene = pollster::block_on(scene).expect("a scene");
    scene.apply(&settings).expect("settings are in their ranges");
    let motion = Motion::named("turn").expect("a built-in motion");
    let pivot = scene.character.neck();
    scene.reset(&motion.gesture(0.0, pivot)).expect("the hair comes to rest");
    let (mut leaked, mut held) = (Vec::new(), Vec::new());
    for frame in 0..frames {
        let turn = (frame / LASTS) as usize;
        if frame % LASTS == 0 {
            scene.resize(SIZES[turn % SIZES.len()]).expect("small targets");
            let mode = [LodMode::Off, LodMode::Fixed(0.5), LodMode::Auto][turn % 3];
            scene.set_lod(LodOptions { mode, ..LodOptions::default() }).expect("a level of detail");
            scene.show(VIEWS[turn % VIEWS.len()].map(DebugDisplay::new)).expect("a view");
        }
        let camera = Viewpoint::portrait(Angle::Front, scene.subject(), 1.6, 1.0);
        scene.watch(&camera);
        let pose = motion.gesture(f64::from(frame) / 24.0, pivot);
        scene.advance(&pose, 1.0 / 24.0).expect("a step");
        let mut encoder = scene.gpu.context.device().create_command_encoder(&Default::default());
        scene.record_draw(&mut encoder, None, &camera).expect("a picture");
        scene.gpu.context.queue().submit([encoder.finish()]);
        pollster::block_on(scene.targets().read()).expect("pixels");
        leaked.push(vec![1u8; leak as usize]);
        held.push(resident());
    }
    let usual = |end: u32| {
        let mut last = held[(end - SPAN) as usize..end as usize].to_vec();
        last.sort_unstable();
        last[last.len() / 2]
    };
    println!("grown by {}", usual(frames) - usual(WARM.min(frames / 2)));
}

#[test]
fn memory_is_constant_after_a_hundred_frames() {
    let Some([grown, max]) = growth(150, 0, 0) else { return };
    assert!(grown <= max, "{grown} bytes");
}

#[test]
fn leak_is_detected() {
    // Three times a former leak in `present`.
    let Some([grown, max]) = growth(80, 0, 3_300_000) else { return };
    assert!(grown > max, "{grown} bytes");
}

#[test]
#[ignore = "proof"]
fn memory_is_constant_for_two_thousand_frames() {
    for samples in [0, 1, 4] {
        let Some([grown, max]) = growth(2000, samples, 0) else { return };
        assert!(grown <= max, "{samples} samples: {grown} bytes");
    }
}
