//! Drawn strands leave obstacles.

mod common;

use std::path::PathBuf;
use tresses::{
    Hair, HairOptions, HairRenderer, Pose,
    avoid::{AvoidMode, AvoidOptions},
    frame::{Frame, Recorder},
    glam::{Quat, Vec3},
    gpu::{Gpu, readback},
    groom::{BindOptions, Groom, GuideCount, SdfGrid, bind, import, mesh::sdf, styles},
    simulate::{ColliderPoses, SimulationParams},
    strands::StrandVertex,
};

struct Case {
    groom: Groom,
    field: SdfGrid,
    neck: Vec3,
}

/// Yaw in degrees at times.
const TURN: &[(f32, f32)] =
    &[(0.0, 0.0), (0.30, 45.0), (0.80, 45.0), (1.30, -45.0), (1.90, -45.0), (2.20, 0.0), (3.0, 0.0)];
const SHAKE: &[(f32, f32)] =
    &[(0.0, 0.0), (0.20, 30.0), (0.50, -30.0), (0.80, 30.0), (1.10, -30.0), (1.30, 0.0), (2.5, 0.0)];
const NOD: &[(f32, f32)] = &[
    (0.0, 0.0), (0.25, 30.0), (0.35, 30.0), (0.70, -14.0), (0.78, -14.0), (1.08, 24.0), (1.16, 24.0), (1.34, 0.0), (2.5, 0.0),
];

fn angle(keys: &[(f32, f32)], t: f32) -> f32 {
    let k = keys.partition_point(|key| key.0 <= t).clamp(1, keys.len() - 1);
    let (a, b) = (keys[k - 1], keys[k]);
    let s = ((t - a.0) / (b.0 - a.0)).clamp(0.0, 1.0);
    (a.1 + (b.1 - a.1) * s * s * s * (10.0 + s * (6.0 * s - 15.0))).to_radians()
}

fn sintel() -> Option<Case> {
    let folder = PathBuf::from(std::env::var_os("TRESSES_ASSETS")?).join("sintel");
    let groom = [folder.join("SintelHairOriginal-sintel_hair.16points.tfx")];
    let (strands, head, _) =
        import::read_with_head(&groom, &[folder.join("sintel.obj")], &Default::default()).unwrap();
    let field = sdf::build(&head, &Default::default()).unwrap();
    let groom = bind(&strands, &BindOptions { guides: GuideCount::OneIn(16), ..Default::default() }).unwrap();
    let top = strands.iter().map(|s| s[0].y).fold(f32::MIN, f32::max);
    Some(Case { groom, field, neck: Vec3::new(0.0, top - 0.165, -0.012) })
}

fn style(gpu: &Gpu, renderer: &HairRenderer, name: &str, strands: Option<u32>) -> Case {
    let built =
        styles::character(&gpu.device, &gpu.queue, &renderer.simulate, &name.parse().unwrap(), strands).unwrap();
    Case { groom: built.groom, field: built.field, neck: built.neck }
}

fn advance(gpu: &Gpu, renderer: &HairRenderer, hair: &mut Hair, head: Pose, dt: f32, whole: bool) -> Vec<StrandVertex> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    let input =
        Frame { dt, head, colliders: &ColliderPoses::default(), simulation: &SimulationParams::default() };
    let mut recorder = Recorder { renderer, device, queue, encoder: &mut encoder, timings: None };
    if whole {
        recorder.advance(hair, &input).unwrap();
    } else {
        recorder.follow(hair, &input);
    }
    queue.submit([encoder.finish()]);
    readback::buffer(device, queue, &hair.strands.vertices).unwrap()
}

#[test]
fn probe() {
    let Some(gpu) = common::gpu() else { return };
    let renderer = HairRenderer::new(&gpu.device, &Default::default());
    let only = std::env::var("ONLY").ok();
    for name in ["long", "bob", "curly", "short", "sintel"] {
        if only.as_ref().is_some_and(|o| !o.contains(name)) { continue; }
        let case = if name == "sintel" { sintel().unwrap() } else { style(&gpu, &renderer, name, Some(6000)) };
        let options = HairOptions { avoid: AvoidOptions::default(), ..Default::default() };
        let n = case.groom.strands.vertex_count as usize;
        println!("{name}: {} guides, {} strands x {n}", case.groom.guides.len(), case.groom.strands.len());
        let rest: Vec<f32> = (0..case.groom.strands.len())
            .flat_map(|i| case.groom.strands.rest_positions(i))
            .map(|p| case.field.sample(p))
            .collect();
        for (motion, keys, axis) in [("turn", TURN, Vec3::Y), ("shake", SHAKE, Vec3::Y), ("nod", NOD, Vec3::X)] {
            let mut hair =
                Hair::new(&gpu.device, &gpu.queue, &renderer, &case.groom, &options, Some(&case.field)).unwrap();
            let mut worst = [[0usize; 4]; 3];
            let mut worst_hit = 0;
            let frames = (keys[keys.len() - 1].0 * 24.0) as usize;
            for i in 0..=frames {
                let t = i as f32 / 24.0;
                let head = Pose::about(case.neck, Quat::from_axis_angle(axis, angle(keys, t)));
                let dt = if i == 0 { 0.0 } else { 1.0 / 24.0 };
                hair.avoidance.options.mode = AvoidMode::ChangeOver;
                let full = advance(&gpu, &renderer, &mut hair, head, dt, true);
                if i % 2 == 1 { continue; }
                hair.avoidance.options.mode = AvoidMode::Off;
                let off = advance(&gpu, &renderer, &mut hair, head, 0.0, false);
                hair.avoidance.options.mode = AvoidMode::PenetratingOnly;
                let alone = advance(&gpu, &renderer, &mut hair, head, 0.0, false);
                let back = head.inverse();
                let mut hits = 0;
                let mut row = [[0usize; 4]; 3];
                for (m, vertices) in [&off, &alone, &full].iter().enumerate() {
                    let mut count = [0usize; 4];
                    for (s, strand) in vertices.chunks(n).enumerate() {
                        let mut any = false;
                        for (j, v) in strand.iter().enumerate().skip(1) {
                            let d = case.field.sample(back.point(v.position));
                            let r = rest[s * n + j];
                            let c = 1.5e-3f32.min(r);
                            let hit = d < c - 5e-4;
                            count[0] += hit as usize;
                            count[1] += (d < r.min(0.0) - 1e-4) as usize;
                            count[2] += (d < r.min(0.0) - 5e-4) as usize;
                            count[3] += (d < r.min(0.0) - 2e-3) as usize;
                            any |= hit;
                        }
                        if m == 0 { hits += any as usize; }
                    }
                    row[m] = count;
                    for k in 0..4 { worst[m][k] = worst[m][k].max(count[k]); }
                }
                worst_hit = worst_hit.max(hits);
                if std::env::var("ROWS").is_ok() { println!("  {t:.2} hits {hits} {row:?}"); }
            }
            let total = (rest.len() as f32) / 100.0;
            println!("{name} {motion}: strands hit {:.1}% ; per mode (contact, below 0.1, below 0.5, below 2 mm) %", worst_hit as f32 * 100.0 / case.groom.strands.len() as f32);
            for m in 0..3 {
                println!("   {:?}", worst[m].map(|c| format!("{:.3}", c as f32 / total)));
            }
        }
    }
}
